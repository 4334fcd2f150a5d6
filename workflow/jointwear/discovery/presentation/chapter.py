"""The chapter of the report on one data set: the verdict in plain words, its figures, and what was hidden."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear.discovery.presentation.drawing import (
    axis_of,
    axis_shown,
    draw_effect,
    draw_gap,
    draw_held_out,
    draw_regimes,
    draw_where,
)
from jointwear.discovery.presentation.page import body_in_words, lead
from jointwear.discovery.problem.regimes import read_model_samples, residual_by_regime
from jointwear.effects import library
from jointwear.files.json_documents import read_json, write_json

#: Figures of the chapter, in the order of their files.
PICTURES = ("regimes", "effect", "gap", "where")


def write_chapter(
    verdict: str | Path,
    where: str | Path,
    models: str | Path,
    hidden: Mapping[str, Any],
    output: str | Path,
    figures: Mapping[str, str | Path],
) -> None:
    """Write the results of the chapter and draw its figures.

    Parameters
    ----------
    verdict, where, models : results of `discover` for the data set.
    hidden : `effect`, `axis` that the maker of the data hid, and `inertial_error`, `drive_error`, `noise` as shares.
    output : JSON file.
    figures : SVG files by the names of PICTURES. Without a named effect, `effect` shows the held-out torque.
    """
    content = read_json(verdict)
    known = library()
    regimes = residual_by_regime(read_model_samples(models))
    draw_regimes(regimes, figures["regimes"])
    draw_where(where, figures["where"])
    draw_gap(verdict, figures["gap"])
    if content["effects"]:
        draw_effect(content["effects"][0], 0, models, figures["effect"])
    else:
        draw_held_out(models, axis_shown(content, models), figures["effect"])
    found = [
        {
            "effect": e["effect"],
            "name": known[e["effect"]].phrase,
            "equation": known[e["effect"]].equation,
            "axis": e["axis"],
            "source_axis": e["source_axis"],
            "shown_on": axis_of(e, models) + 1,
            "body": body_in_words(e),
            "tie_set": [known[t].phrase for t in e["tie_set"]],
            "evidence_nats": e["evidence_nats"],
        }
        for e in content["effects"]
    ]
    right = bool(found) and (found[0]["effect"], found[0]["axis"]) == (hidden["effect"], hidden["axis"])
    data = {
        "dataset": content["dataset"],
        "verdict": content["verdict"],
        "lead": lead(content),
        "effects": found,
        "largest": regimes.largest(),
        "gap": content["gap"],
        "hidden": {**hidden, "name": known[hidden["effect"]].phrase},
        "named_rightly": right,
        "exactly": right and len(found) == 1,
    }
    write_json(output, data)
