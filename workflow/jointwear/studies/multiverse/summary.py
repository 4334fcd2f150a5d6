"""The results of the multiverse for the report's chapter, as plain data."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import parse_json, write_json
from jointwear.files.json_values import finite
from jointwear.files.storage import open_dataset, read_variable
from jointwear.reproduction import readings as ambiguities_of
from jointwear.statistics.intervals import counted_share
from jointwear.studies.multiverse.records import CLAIMS, SCORES

_QUESTIONS = {
    "wear_shape": "How large is c2 x 120 h, the shape constant of equation (7)?",
    "consecutive_hours": "How many hours in a row above the limit make an onset?",
}


def question(name: str) -> str:
    """Return the question that a dimension stands for."""
    known = ambiguities_of.ambiguities()
    return known[name].question if name in known else _QUESTIONS.get(name, name)


def meaning(name: str, value: str) -> str:
    """Return what a choice means, in words."""
    known = ambiguities_of.ambiguities()
    if name not in known:
        return value
    return " ".join((known[name].alternatives[value].__doc__ or value).split()).rstrip(".")


def scored_readings(path: str | Path) -> dict[str, Any]:
    """Return the summary of results/multiverse/readings.nc."""
    with open_dataset(path) as dataset:

        def read(name: str) -> np.ndarray:
            return read_variable(dataset, path, name)

        dimensions = [str(v) for v in read("dimension")]
        default = dict(zip(dimensions, (str(v) for v in read("default")), strict=True))
        kind = read("kind").astype(str)
        scores = {k: read(k) for k in ("agreement", "balanced_agreement", "hour_error", "penalty", "located_share")}
        best = read("best")
        choices = {k: read(f"choice_{k}").astype(str) for k in dimensions}
        supported = {k: read(f"claim_{k}").astype(bool) for k in CLAIMS}
        wrong = read("wrong_share")
        single = read("single_run_agreement")
    count = len(kind)
    return {
        "readings": count,
        "kinds": {k: int((kind == k).sum()) for k in dict.fromkeys(kind)},
        "dimensions": len(dimensions),
        "alternatives": int(sum(len(set(v)) for v in choices.values())),
        "default": {
            "agreement": finite(scores["agreement"][0]),
            "hour_error": finite(scores["hour_error"][0]),
            "located_share": finite(scores["located_share"][0]),
            "rank": int((scores["penalty"] < scores["penalty"][0]).sum()) + 1,
        },
        "agreement": {
            "lowest": finite(scores["agreement"].min()),
            "median": finite(np.median(scores["agreement"])),
            "highest": finite(scores["agreement"].max()),
            "at_least_32": int((scores["agreement"] >= 32).sum()),
            "meets_the_aim": int(((scores["agreement"] >= 32) & (scores["hour_error"] <= 10)).sum()),
        },
        "best": [
            {
                "reading": int(i),
                "agreement": finite(scores["agreement"][i]),
                "balanced": finite(scores["balanced_agreement"][i]),
                "single_run": finite(single[i]),
                "hour_error": finite(scores["hour_error"][i]),
                "located": finite(scores["located_share"][i]),
                "penalty": finite(scores["penalty"][i]),
                "differs": [
                    {"name": k, "value": choices[k][i], "meaning": meaning(k, choices[k][i])}
                    for k in dimensions
                    if choices[k][i] != default[k]
                ],
            }
            for i in best
        ],
        "claims": [
            {
                "claim": k,
                "meaning": text,
                "all": counted_share(supported[k].sum(), count),
                "sample": counted_share(supported[k][kind == "sample"].sum(), int((kind == "sample").sum())),
                "best": counted_share(supported[k][best].sum(), len(best)),
            }
            for k, text in CLAIMS.items()
        ],
        "always_wrong": int((wrong == 1).sum()),
        "mostly_wrong": int((wrong > 0.5).sum()),
    }


def influences(path: str | Path) -> dict[str, Any]:
    """Return the summary of results/multiverse/influence.nc."""
    with open_dataset(path) as dataset:
        names = [
            "score",
            "main_name",
            "main_share",
            "main_p_value",
            "main_levels",
            "pair_first",
            "pair_second",
            "pair_share",
            "pair_p_value",
            "pair_levels",
        ]
        values = {n: read_variable(dataset, path, n) for n in names}
    result: dict[str, Any] = {}
    for s, score in enumerate(values["score"].astype(str)):
        main = [
            {
                "name": str(name),
                "question": question(str(name)),
                "share": finite(values["main_share"][s, i]),
                "p_value": finite(values["main_p_value"][s, i]),
                "levels": parse_json(str(values["main_levels"][s, i]), "main_levels", object),
            }
            for i, name in enumerate(values["main_name"][s])
            if str(name)
        ]
        pairs = [
            {
                "names": [str(first), str(values["pair_second"][s, i])],
                "share": finite(values["pair_share"][s, i]),
                "p_value": finite(values["pair_p_value"][s, i]),
                "levels": parse_json(str(values["pair_levels"][s, i]), "pair_levels", object),
            }
            for i, first in enumerate(values["pair_first"][s])
            if str(first)
        ]
        result[score] = {"main": main, "pairs": pairs}
    return result


def chosen_reading(path: str | Path) -> dict[str, Any]:
    """Return the summary of results/multiverse/choice.nc."""
    with open_dataset(path) as dataset:
        best = int(dataset.chosen_reading)
        choices = {
            n.removeprefix("choice_"): str(read_variable(dataset, path, n)[best])
            for n in dataset.variables
            if n.startswith("choice_")
        }

        def read(name: str) -> np.ndarray:
            return read_variable(dataset, path, name)

        score = read("score").astype(str)
        chosen = dict(zip(score, map(finite, read("chosen_score")), strict=True))
        honest = dict(zip(score, map(finite, read("honest_score")), strict=True))
        agreement, choosing = read("agreement"), read("choosing").astype(bool)
        probability, hour, published = read("honest_probability"), read("honest_hour"), read("published_hour")
        wrong, pooled = read("wrong_share"), read("pooled_agreement")
        names = read("pose_set").astype(str)
    tasks, increases, axes = probability.shape
    cells = []
    for t in range(tasks):
        for c in range(increases):
            for a in range(axes):
                printed = finite(published[t, c, a])
                cells.append(
                    {
                        "task": t + 1,
                        "column": c + 1,
                        "axis": a + 1,
                        "published": printed,
                        "probability": finite(probability[t, c, a]),
                        "hour": finite(hour[t, c, a]),
                        "agrees": bool((probability[t, c, a] >= 0.5) == (printed is not None)),
                        "wrong_share": finite(wrong[t, c, a]),
                    }
                )
    return {
        "reading": choices,
        "meanings": {k: meaning(k, v) for k, v in choices.items()},
        "questions": {k: question(k) for k in choices},
        "chosen_score": chosen,
        "honest_score": honest,
        "pose_sets": len(names),
        "choosing": int(choosing.sum()),
        "reporting": int((~choosing).sum()),
        "candidates": len(agreement),
        "highest_pooled_agreement": int(pooled.max()),
        "highest_single_agreement": int(agreement.max()),
        "pairs": counted_share((agreement >= 32).sum(), agreement.size),
        "cells": cells,
        "wrong_in_all_candidates": [c for c in cells if c["wrong_share"] == 1],
    }


def lag_rule(path: str | Path) -> dict[str, Any]:
    """Return the summary of results/multiverse/lag_rule.nc."""
    with open_dataset(path) as dataset:

        def read(name: str) -> np.ndarray:
            return read_variable(dataset, path, name)

        versions, correlations = read("version").astype(str), read("correlation").astype(str)
        right, wrong, nothing, runs = read("right"), read("wrong"), read("nothing"), read("runs")
        rise = [read(n) for n in ("rise_low", "rise_high", "rise_runs")]
        hits, signs, named = read("rise_right"), read("sign_right"), read("named")
    return {
        "versions": {
            v: {
                c: {
                    "right": counted_share(right[i, k], runs[i]),
                    "wrong": counted_share(wrong[i, k], runs[i]),
                    "nothing": counted_share(nothing[i, k], runs[i]),
                }
                for k, c in enumerate(correlations)
            }
            for i, v in enumerate(versions)
        },
        "rise": [
            {
                "low": finite(low),
                "high": finite(high),
                "runs": int(count),
                **{c: counted_share(hits[k, b], count) for k, c in enumerate(correlations)},
            }
            for b, (low, high, count) in enumerate(zip(*rise, strict=True))
        ],
        "sign_right": dict(zip(correlations, map(finite, signs), strict=True)),
        "named_in_normal_week": {c: [int(v) for v in named[k]] for k, c in enumerate(correlations)},
    }


def mixture(path: str | Path, choice: str | Path) -> dict[str, Any]:
    """Return the summary of results/multiverse/mixture.nc; `choice` holds the bound of every candidate."""
    with open_dataset(choice) as dataset:
        bound = read_variable(dataset, choice, "mixture_bound")
    with open_dataset(path) as dataset:
        values = {k: finite(read_variable(dataset, path, k)[0]) for k in SCORES}
        choices = {
            n.removeprefix("choice_"): str(read_variable(dataset, path, n)[0])
            for n in dataset.variables
            if n.startswith("choice_")
        }
        solutions = [str(v) for v in read_variable(dataset, path, "pose_set")]
        probability = read_variable(dataset, path, "detection_probability")
        published = read_variable(dataset, path, "published_hour")
    wrong = (probability >= 0.5) != np.isfinite(published)
    return {
        "reading": choices,
        "solutions": solutions,
        "scores": values,
        "highest_bound": int(bound.max()),
        "candidates_at_least_32": int((bound >= 32).sum()),
        "candidates": len(bound),
        "wrong": [{"task": int(t) + 1, "column": int(c) + 1, "axis": int(a) + 1} for t, c, a in np.argwhere(wrong)],
    }


def write_chapter(
    scored: str | Path,
    influence: str | Path,
    choice: str | Path,
    mixed: str | Path,
    lags: str | Path,
    output: str | Path,
) -> None:
    """Write everything that the chapter says as JSON."""
    content = {
        "scored": scored_readings(scored),
        "influence": influences(influence),
        "choice": chosen_reading(choice),
        "mixture": mixture(mixed, choice),
        "lag_rule": lag_rule(lags),
    }
    write_json(output, content)
