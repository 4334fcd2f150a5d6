"""The stages of ``snakemake shop_floor`` after the simulation, one function each: files in, files out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import read_json, write_json
from jointwear.statistics.intervals import counted_share
from jointwear.studies.shop_floor.aims import aims
from jointwear.studies.shop_floor.judging import outcomes
from jointwear.studies.shop_floor.kept import kept_robot
from jointwear.studies.shop_floor.plan import RATES, robots_of
from jointwear.studies.shop_floor.scores import curve, poisson_rate, summary


def judge_batch(seed_set: str, batch: str, windows: str | Path, output: str | Path) -> None:
    """Judge the robots of a batch at every stated rate; `windows` is the folder of
    :func:`jointwear.studies.shop_floor.kept.simulate_batch`."""
    folder = Path(windows).parents[2]
    facts = []
    for index in robots_of(batch):
        cell, statistics, refused = kept_robot(seed_set, index, folder)
        facts += [fact | {"refused": refused} for fact in outcomes(cell, statistics, RATES)]
    write_json(output, {"facts": facts})


def summarise(
    outcomes: Sequence[str | Path], before: str | Path, grid: Mapping[str, str | Path], output: str | Path
) -> None:
    """Assemble the results of the chapter.

    Parameters
    ----------
    outcomes : files of :func:`judge_batch`. before : scores of the judge that this one took the place of, as written
        by ``sample --summary``. grid : task -> file of
        :func:`jointwear.studies.monitor_study.grid_judgement.judge_grid`.
    """
    facts = [fact for path in outcomes for fact in read_json(path)["facts"]]
    rates = sorted({f["rate"] for f in facts})
    scores = [summary([f for f in facts if f["rate"] == rate]) for rate in rates]
    chapter = {
        "rates": scores,
        "aims": aims(scores),
        "curves": [{"rate": rate, **curve([f for f in facts if f["rate"] == rate])} for rate in rates],
        "refused": sum(bool(f["refused"]) for f in facts if f["rate"] == rates[0]),
        "before": read_json(before, list),
        "grid": paper_grid({task: read_json(path) for task, path in grid.items()}),
    }
    write_json(output, chapter)


def paper_grid(tasks: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
    """Return what the judgement finds on the paper's grid: cells that move, those found in every run, false alarms."""
    cells = [{"task": task, **cell} for task, found in tasks.items() for cell in found["cells"] if cell["moves"]]
    runs, detected = sum(c["runs"] for c in cells), sum(c["detected"] for c in cells)
    hours = [c["hour"] for c in cells if c["hour"] is not None]
    some = next(iter(tasks.values()))
    return {
        "cells": len(cells),
        "whole": sum(c["detected"] == c["runs"] for c in cells),
        "replicates": max(c["runs"] for c in cells),
        "rate": some["rate"],
        "detected": counted_share(detected, runs),
        "named": counted_share(sum(c["named"] for c in cells), runs),
        "hour": float(np.median(hours)) if hours else None,
        "missed": [f"{c['task']} axis {c['axis']}, {c['increase']:g} %" for c in cells if c["detected"] < c["runs"]],
        "false": poisson_rate(sum(t["false"] for t in tasks.values()), sum(t["hours"] for t in tasks.values())),
    }
