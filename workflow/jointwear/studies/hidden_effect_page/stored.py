"""The small summary of the hidden-effect test that is kept with the project."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear.files.json_documents import read_json, write_json
from jointwear.studies.challenge.plan import part_batches
from jointwear.studies.challenge.tiers import COUNTS, DRAWINGS, TIERS
from jointwear.studies.hidden_effect_page.page import write_page


def write_stored(scores: str | Path, output: str | Path, part: str, seed: int, settings: Mapping[str, Any]) -> None:
    """Write the scores of a part with what they depend on: seed, settings of discovery, and how much was run.

    Raises
    ------
    InputError : if the scores are missing or broken.
    """
    content = read_json(scores)
    seed_set, counts = part_batches(part)
    digest = hashlib.sha256(json.dumps(dict(settings), sort_keys=True).encode()).hexdigest()[:16]
    head = {
        "part": part,
        "seed": seed,
        "drawing": DRAWINGS[seed_set],
        "cases": content["cases"],
        "cases_of_the_whole_set": len(TIERS) * sum(COUNTS[seed_set].values()),
        "batches": counts,
        "settings": dict(settings),
        "settings_digest": digest,
        "command": f"snakemake --cores 2 results/challenge/{part}/stored.json",
    }
    write_json(output, {**head, "tiers": content["tiers"]})


def write_stored_page(
    stored: str | Path, peers: str | None, output: str | Path, world: str | None = None, limits: str | None = None
) -> None:
    """Write the page from the summary that is kept with the project, with `peers`, `world` and `limits` if kept."""
    content = read_json(stored)
    write_page(
        str(stored),
        peers,
        str(output),
        content["part"],
        content["seed"],
        content["command"],
        content["drawing"],
        world,
        limits,
    )
