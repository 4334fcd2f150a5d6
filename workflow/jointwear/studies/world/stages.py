"""The tier as stages of the workflow: answer a batch, score a part, keep its summary."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from jointwear import __version__
from jointwear.discovery import Settings
from jointwear.files.json_documents import read_json, write_json
from jointwear.studies.challenge.reliability import reliability
from jointwear.studies.world.answers import answer
from jointwear.studies.world.case import generate
from jointwear.studies.world.packages import mujoco
from jointwear.studies.world.plan import COUNTS, DRAWINGS, SEED, Case, batches, part_batches
from jointwear.studies.world.scores import score

#: Rooms that a verdict depends on.
SOURCES = ("discovery", "effects", "measurement", "robots")


def solve_case(case: Case) -> dict[str, Any]:
    """Make a case in a folder that goes away, and return its judged row."""
    with tempfile.TemporaryDirectory() as folder:
        return answer(generate(case, folder))


def solve_if_possible(case: Case) -> dict[str, Any] | None:
    """Return the judged row of a case, None where its plant cannot be integrated or its controller loses it."""
    try:
        return solve_case(case)
    except ArithmeticError:
        return None


def answer_batch(seed_set: str, index: int, output: str | Path) -> None:
    """Make the cases of a batch, give them to discovery, and write the judged rows as JSON.

    A plant that cannot be integrated with its time step, or that its controller loses, is no case; its name is listed
    under `left_out`.

    Raises
    ------
    InputError : if the packages of the plants are not installed.
    """
    rows, left_out = [], []
    for case in batches(seed_set)[index]:
        row = solve_if_possible(case)
        if row is None:
            left_out.append(case.name)
        else:
            rows.append(row)
    write_json(output, {"sources": sources_digest(), "cases": rows, "left_out": left_out})


def sources_digest() -> str:
    """Return a digest of the source files that decide a verdict: what discovery is made of."""
    library = Path(__file__).resolve().parents[2]
    digest = hashlib.sha256()
    for room in SOURCES:
        for path in sorted((library / room).rglob("*.py")):
            digest.update(path.relative_to(library).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def write_scores(rows_paths: Sequence[str | Path], part: str, rows_path: str | Path, scores_path: str | Path) -> None:
    """Write all rows of a part, and their scores with what they depend on.

    Raises
    ------
    InputError : if a file of a batch is missing or broken.
    """
    contents = [read_json(path) for path in rows_paths]
    rows = [row for content in contents for row in content["cases"]]
    sources = sorted({content["sources"] for content in contents})
    left_out = [name for content in contents for name in content["left_out"]]
    write_json(rows_path, {"cases": rows})
    write_json(scores_path, {**summary(rows, part, sources), "left_out": left_out})


def summary(rows: Sequence[dict[str, Any]], part: str, sources: Sequence[str]) -> dict[str, Any]:
    """Return what the page shows of a part: its scores, and which cases, seeds, settings and versions made them."""
    seed_set, count = part_batches(part)
    settings = asdict(Settings())
    return {
        "part": part,
        "seed": SEED,
        "drawing": DRAWINGS[seed_set],
        "cases": len(rows),
        "cases_of_the_whole_set": sum(COUNTS.values()),
        "batches": count,
        "jointwear": __version__,
        "mujoco": mujoco().__version__,
        "sources": list(sources),
        "settings": settings,
        "settings_digest": hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest()[:16],
        "command": f"snakemake --cores 2 results/challenge/world/{part}/scores.json",
        "kinds": dict(Counter(r["kind"] for r in rows)),
        "arms": dict(Counter(r["arm"] for r in rows)),
        "scores": score(rows),
        "reliability": reliability(rows),
        "by_subject": by_subject(rows),
    }


def by_subject(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return for every single effect and disturbance how many cases could be seen and were answered rightly."""
    result = []
    for kind, field in (("single", "exact_set"), ("outside", "unknown_only"), ("retuned", "retuned")):
        for subject in sorted({r["subject"] for r in rows if r["kind"] == kind}):
            mine = [r for r in rows if r["kind"] == kind and r["subject"] == subject]
            seen = [r for r in mine if r["identifiable"]]
            wrong = Counter(
                " + ".join(f"{name}" for name, _ in r["named"]) or r["verdict"] for r in seen if not r[field]
            )
            right = sum(bool(r[field]) for r in seen)
            result.append(
                {
                    "kind": kind,
                    "subject": subject,
                    "cases": len(mine),
                    "identifiable": len(seen),
                    "right": right,
                    "instead": [f"{answer} ({number})" for answer, number in wrong.most_common(3)],
                }
            )
    return result


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else str(value)
