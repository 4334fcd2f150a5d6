"""The results of the monitor's study for the report's chapter, as plain data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.effects import get_effect
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.json_values import finite
from jointwear.files.storage import open_dataset, read_variable
from jointwear.reproduction.grid import Cell
from jointwear.reproduction.published import Published, load_published
from jointwear.statistics.intervals import counted_share
from jointwear.studies.monitor_study.calibration import coverage
from jointwear.studies.monitor_study.grid_study import LATER, RATE, RATES

#: A cell counts as detected from this probability on.
SURE = 0.99
_HISTORIES = 600


def read_all(path: str | Path) -> dict[str, Any]:
    """Read all variables and attributes of a result file; NaN where floats are missing."""
    with open_dataset(path) as dataset:
        found: dict[str, Any] = {name: read_variable(dataset, path, name) for name in dataset.variables}
        found["attributes"] = {name: dataset.getncattr(name) for name in dataset.ncattrs()}
    return found


def share(successes: int, trials: int) -> dict[str, Any]:
    """Return a share with Wilson's 95 % interval; none of none is no share."""
    return counted_share(successes, trials, empty=0.0)


def rate(count: int, hours: int) -> dict[str, Any]:
    """Return false alarms per 1,000 h with the upper end of the 95 % interval of a Poisson count."""
    from scipy.special import gammaincinv

    return {
        "count": int(count),
        "hours": int(hours),
        "per_1000_h": 1000 * count / hours,
        "at_most": 1000 * float(gammaincinv(count + 1, 0.95)) / hours,
    }


def median(values: np.ndarray) -> float | None:
    """Return the median of the finite values."""
    values = np.asarray(values, dtype=float)
    values = values[np.isfinite(values)]
    return float(np.median(values)) if len(values) else None


def cells_of(task: Mapping[str, Any], name: str) -> list[Cell]:
    """Return the cells of a task's result."""
    return [
        Cell(name, float(g), int(a)) for g, a in zip(task["cell_increase"], task["cell_axis"], strict=True)
    ]  # fmt: skip


def grid(tasks: Mapping[str, Mapping[str, Any]], which: str, published: Published) -> dict[str, Any]:
    """Return the table of the grid under one nominal model, and its cells."""
    rows, located, early, false, hours = [], [], [], 0, 0
    for name, t in tasks.items():
        false += int(t[f"{which}_false"].sum())
        hours += int(t["attributes"]["normal_hours"])
        paper = t["paper_hour"][RATES.index(RATE)]
        for i, cell in enumerate(cells_of(t, name)):
            hour, named = t[f"{which}_hour"][i], t[f"{which}_named"][i]
            judged = bool(t[f"{which}_judged"][cell.axis - 1])
            seen = np.isfinite(hour)
            if judged:
                located += list(named[seen] == cell.axis)
            middle, printed = median(hour), published.detection_hour(cell)
            if printed is not None and middle is not None:
                early.append(printed - middle)
            rows.append(
                {
                    "task": name,
                    "axis": cell.axis,
                    "increase": cell.increase_percent,
                    "judged": judged,
                    "probability": float(seen.mean()),
                    "hour": middle,
                    "published": printed,
                    "located": float(np.mean(named[seen] == cell.axis)) if seen.any() else None,
                    "paper_probability": float(np.isfinite(paper[i]).mean()),
                    "paper_hour": median(paper[i]),
                    "paper_limit_probability": float(np.isfinite(t["paper_limit_hour"][i]).mean()),
                    "paper_limit_hour": median(t["paper_limit_hour"][i]),
                }
            )
    both = [r["paper_hour"] - r["hour"] for r in rows if r["judged"] and r["paper_probability"] >= 0.5]
    return {
        "cells": rows,
        "detected": sum(r["judged"] and r["probability"] >= SURE for r in rows),
        "unjudged": sum(not r["judged"] for r in rows),
        "least": min(r["probability"] for r in rows if r["judged"]),
        "located": share(int(np.sum(located)), len(located)),
        "earlier": median(np.array(early)),
        "published_cells": len(early),
        "earlier_than_method": median(np.array(both)),
        "method_cells": len(both),
        "false": rate(false, hours),
    }


def paper_of(tasks: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return what the paper's detector does at the same rate, and at its own limit."""
    k, named, false, hours, limit_false, limit_hours = RATES.index(RATE), [], 0, 0, 0, 0
    detected = limit_detected = 0
    for t in tasks.values():
        false += int(t["paper_false"][k])
        hours += int(t["attributes"]["paper_checked_hours"])
        limit_false += int(t["attributes"]["paper_limit_false"])
        limit_hours += int(t["attributes"]["normal_hours"])
        seen = np.isfinite(t["paper_hour"][k])
        named += list((t["paper_named"] == t["cell_axis"][:, None])[seen])
        detected += int((seen.mean(axis=1) >= SURE).sum())
        limit_detected += int((np.isfinite(t["paper_limit_hour"]).mean(axis=1) >= SURE).sum())
    return {
        "false": rate(false, hours),
        "detected": detected,
        "located": share(int(np.sum(named)), len(named)),
        "limit_false": rate(limit_false, limit_hours),
        "limit_detected": limit_detected,
    }


def forecasts(tasks: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return coverage and width of the 80 % interval, by shape and issue."""
    rows = []
    first = next(iter(tasks.values()))
    for k, shape in enumerate(first["shape"]):
        for issue, later in enumerate((0, LATER)):
            low, middle, high, true = (
                np.concatenate([t[f"forecast_{k}_{part}"][issue].ravel() for t in tasks.values()])
                for part in ("low", "median", "high", "true")
            )
            told = np.isfinite(low) & np.isfinite(true)
            low, middle, high, true = low[told], middle[told], high[told], true[told]
            ahead = true > 0
            held = (low <= np.maximum(true, 0)) & (np.maximum(true, 0) <= high)
            with np.errstate(invalid="ignore"):
                width = (high - low)[ahead]
            rows.append(
                {
                    "shape": float(shape),
                    "later": later,
                    "ahead": share(int(held[ahead].sum()), int(ahead.sum())),
                    "all": share(int(held.sum()), len(held)),
                    "early": float(np.mean(true[ahead] > high[ahead])) if ahead.any() else None,
                    "late": float(np.mean(true[ahead] < low[ahead])) if ahead.any() else None,
                    "width": finite(np.median(width)) if ahead.any() else None,
                    "error": finite(np.median(np.abs(middle - true)[ahead])) if ahead.any() else None,
                }
            )
    return rows


def pairs(tasks: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return how often both of two axes that wear at once are named by the end of the run."""
    both, least = [], 1.0
    for t in tasks.values():
        judged = t["exact_judged"] > 0
        seen = np.isfinite(t["pair_light"]) & np.isfinite(t["pair_heavy"])
        for a in np.flatnonzero(judged):
            for b in np.flatnonzero(judged):
                if a != b:
                    both += list(seen[a, b])
                    least = min(least, float(seen[a, b].mean()))
    return {**share(int(np.sum(both)), len(both)), "least": least}


def curves(tasks: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return delay against false alarms, wear size and noise; medians over judged cells and replicates."""

    def middle(name: str, k: int) -> float | None:
        return median(np.concatenate([t[name][k][judged(t)].ravel() for t in tasks.values()]))

    def detected(name: str, k: int) -> float:
        return float(np.mean(np.concatenate([np.isfinite(t[name][k][judged(t)]).ravel() for t in tasks.values()])))

    def judged(t: Mapping[str, Any]) -> np.ndarray:
        return t["exact_judged"][t["cell_axis"] - 1] > 0

    hours = sum(int(t["attributes"]["normal_hours"]) for t in tasks.values())
    checked = sum(int(t["attributes"]["paper_checked_hours"]) for t in tasks.values())
    first = next(iter(tasks.values()))

    def total(name: str, k: int) -> int:
        return int(sum(t[name][k] for t in tasks.values()))

    def at_rate(k: int, name: str, normal_hours: int) -> dict[str, Any]:
        delay = {"hour": middle(f"{name}_hour", k), "share": detected(f"{name}_hour", k)}
        return rate(total(f"{name}_false", k), normal_hours) | delay

    def sized(k: int) -> np.ndarray:
        parts = [t["size_hour"][k][t["exact_judged"][t["size_axis"] - 1] > 0] for t in tasks.values()]
        return np.concatenate([p.ravel() for p in parts])

    return {
        "rates": [
            {"asked": r, "model": at_rate(k, "curve", hours), "paper": at_rate(k, "paper", checked)}
            for k, r in enumerate(RATES)
        ],
        "sizes": [
            {"size": float(s), "hour": median(sized(k)), "share": float(np.isfinite(sized(k)).mean())}
            for k, s in enumerate(first["size"])
        ],
        "noises": [
            {
                "noise": float(s), "hour": middle("noise_hour", k), "share": detected("noise_hour", k),
                "false": rate(total("noise_false", k), hours),
            }
            for k, s in enumerate(first["noise"])
        ],
        "shapes": [
            {"shape": float(s), "hour": middle("shape_hour", k), "share": detected("shape_hour", k)}
            for k, s in enumerate(first["shape"])
        ],
    }  # fmt: skip


def peers_of(tasks: Mapping[str, Mapping[str, Any]], peers: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return every peer beside both detectors at the same stated rate."""
    first, rows = next(iter(peers.values())), []
    one = RATES.index(float(first["attributes"]["rate_per_1000_h"]))
    checked = sum(int(p["attributes"]["checked_hours"]) for p in peers.values())

    def row(name: str, hours: Sequence[np.ndarray], false: dict[str, Any], located: dict[str, Any] | None) -> None:
        sure = sum(int((np.isfinite(h).mean(axis=1) >= SURE).sum()) for h in hours)
        whole = np.concatenate([h.ravel() for h in hours])
        found = float(np.isfinite(whole).mean())
        rows.append(
            {"name": name, "detected": sure, "share": found, "hour": median(whole), "false": false, "located": located}
        )

    def judged(t: Mapping[str, Any]) -> np.ndarray:
        return t["exact_judged"][t["cell_axis"] - 1] > 0

    count = first["hour"].shape[2]
    model = [t["curve_hour"][one][judged(t)][:, :count] for t in tasks.values()]
    names = [
        (t["curve_named"][one] == t["cell_axis"][:, None])[judged(t)][:, :count][np.isfinite(m)]
        for t, m in zip(tasks.values(), model, strict=True)
    ]
    right = np.concatenate([n.ravel() for n in names])
    hours = sum(int(t["attributes"]["normal_hours"]) for t in tasks.values())
    false = rate(sum(int(t["curve_false"][one]) for t in tasks.values()), hours)
    row("model", model, false, share(int(right.sum()), len(right)))
    paper = [t["paper_hour"][one][judged(t)][:, :count] for t in tasks.values()]
    named = np.concatenate(
        [
            (t["paper_named"] == t["cell_axis"][:, None])[judged(t)][:, :count][np.isfinite(m)]
            for t, m in zip(tasks.values(), paper, strict=True)
        ]
    )
    paper_hours = sum(int(t["attributes"]["paper_checked_hours"]) for t in tasks.values())
    paper_false = rate(sum(int(t["paper_false"][one]) for t in tasks.values()), paper_hours)
    row("paper", paper, paper_false, share(int(named.sum()), len(named)))
    for k, name in enumerate(first["peer"]):
        found = [p["hour"][k][judged(tasks[t])] for t, p in peers.items()]
        located = None
        if name == "kernel_kl":
            right = np.concatenate(
                [
                    (p["kernel_kl_named"] == p["cell_axis"][:, None])[judged(tasks[t])][np.isfinite(h)]
                    for (t, p), h in zip(peers.items(), found, strict=True)
                ]
            )
            located = share(int(right.sum()), len(right))
        row(str(name), found, rate(sum(int(p["false"][k]) for p in peers.values()), checked), located)
    return rows


def factory_of(results: Mapping[str, Mapping[str, Any]], decisions: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return false alarms per week and detection of both detectors in every scenario."""
    rows = []
    for name, r in results.items():
        weeks = float(r["attributes"]["weeks"])
        detectors = {}
        for d, detector in enumerate(("model", "paper")):
            detectors[detector] = {
                str(case): {
                    "per_week": float(r["false"][k, d]) / weeks,
                    "count": int(r["false"][k, d]),
                    "share": float(np.isfinite(r["hour"][k, d]).mean()),
                    "hour": median(r["hour"][k, d]),
                }
                for k, case in enumerate(r["case"])
            }
            before, after = (int(r["false"][list(r["case"]).index(c), d]) for c in ("uncorrected", "corrected"))
            # With nothing left the ratio is at least that of one more alarm.
            detectors[detector]["fewer"] = {"ratio": before / max(after, 1), "at_least": after == 0}
        named = [[get_effect(e["effect"]).phrase, e["axis"]] for said in decisions[name] for e in said["effects"]]
        effects: dict[str, list[int]] = {}
        for effect, axis in named:
            effects.setdefault(effect, [])
            if axis is not None:
                effects[effect].append(int(axis))
        rows.append(
            {
                "scenario": name,
                "weeks": weeks,
                "detectors": detectors,
                "effects": [{"effect": k, "axes": sorted(v)} for k, v in effects.items()],
                "located": {str(c): float(r["located"][k].mean()) for k, c in enumerate(r["case"])},
            }
        )
    return rows


def write_chapter(
    tasks: Mapping[str, str], peers: Mapping[str, str], factory: Mapping[str, str], decisions: Mapping[str, str],
    published: str | Path, output: str | Path, seed: int,
) -> None:  # fmt: skip
    """Assemble the results of all stages.

    Parameters
    ----------
    tasks, peers : task -> file of :func:`..grid_study.study_task` and :func:`..peers.study_peers`.
    factory, decisions : scenario -> file of :func:`..factory_study.study_factory` and what discovery said.
    """
    read = {name: read_all(path) for name, path in tasks.items()}
    known = load_published(published)
    held = coverage(seed, _HISTORIES, 0.8)
    said = {name: read_json(path)["rounds"] for name, path in decisions.items()}
    first = next(iter(read.values()))
    chapter = {
        "rate": RATE,
        "replicates": int(first["exact_hour"].shape[1]),
        "exact": grid(read, "exact", known),
        "wrong": grid(read, "wrong", known),
        "paper": paper_of(read),
        "pairs": pairs(read),
        "forecasts": forecasts(read),
        "other_growth": {name: share(int(v.sum()), len(v)) for name, v in held.items()},
        "curves": curves(read),
        "peers": peers_of(read, {name: read_all(path) for name, path in peers.items()}),
        "peer_replicates": int(read_all(next(iter(peers.values())))["hour"].shape[2]),
        "factory": factory_of({name: read_all(path) for name, path in factory.items()}, said),
    }
    write_json(output, chapter)
