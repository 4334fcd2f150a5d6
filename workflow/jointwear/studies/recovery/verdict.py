"""What was missing from the published experiment, in the layout that `discover` uses too."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import write_json
from jointwear.files.json_values import six_digits
from jointwear.files.storage import open_dataset, read_variable
from jointwear.robots.robot import load_robot
from jointwear.studies.recovery.candidates import COMPONENTS, Component, Parameter, candidate
from jointwear.studies.recovery.choice import choose, parts, runner_up
from jointwear.studies.recovery.fit import ExplanationFit, read_fit
from jointwear.studies.recovery.plan import NOTHING
from jointwear.studies.recovery.tables import Tables, read_tables

#: Mean squared weighted residual from which a verdict is unknown: three per cent of the torque in the root mean square.
UNEXPLAINED = 9.0
#: Relative standard deviation of a maximum of a published table.
SCATTER = 0.0045


def cells(tables: Tables, fit: ExplanationFit) -> list[dict[str, Any]]:
    """Return one entry for every table cell: published, reproduced, errors."""
    result = []
    for t, task in enumerate(tables.tasks):
        for axis in range(tables.maximum.shape[1]):
            for c, increase in enumerate(tables.increase_percent):
                place = (t, axis, c)
                published = tables.maximum[place]
                result.append(
                    {
                        "task": task,
                        "axis": axis + 1,
                        "increase_percent": float(increase),
                        "published_maximum": float(published),
                        "reproduced_maximum": six_digits(fit.maximum[place]),
                        "error_percent": None
                        if published == 0
                        else six_digits(100 * (fit.maximum[place] / published - 1)),
                        "published_variation": float(tables.variation[place]),
                        "reproduced_variation": six_digits(fit.variation[place]),
                    }
                )
    return result


def contradictions(tables: Tables, coulomb: np.ndarray) -> list[dict[str, Any]]:
    """Return cells of Table V that no wear curve can bring together.

    Two tasks with the same hours in both columns have the same worn friction, and nothing else differs between
    the columns. On an axis whose torque is friction alone the columns must then differ by the same.

    Parameters
    ----------
    coulomb : (n,) larger Coulomb level of each axis [N m].
    """
    result = []
    hours, axis = tables.reading_hours, 0  # axis 1 bears no gravity
    for a in range(len(tables.tasks)):
        for b in range(a + 1, len(tables.tasks)):
            if not np.array_equal(hours[a, axis], hours[b, axis]):
                continue
            change = np.diff(tables.maximum[[a, b], axis], axis=1)[:, 0]
            # That of four maxima.
            scatter = 2 * SCATTER * tables.maximum[[a, b], axis].mean()
            if abs(change[0] - change[1]) > 3 * scatter:
                result.append(
                    {
                        "tasks": [tables.tasks[a], tables.tasks[b]],
                        "axis": axis + 1,
                        "hours": [float(h) for h in hours[a, axis]],
                        "change": [six_digits(x) for x in change],
                        "unit": "N m",
                        "largest_possible_scatter": six_digits(3 * scatter),
                        "reason": "same hours and same friction, so the columns must differ alike; axis "
                        f"{axis + 1} bears no gravity (Coulomb friction {coulomb[axis]:.3g} N m)",
                    }
                )
    return result


def _parameter(p: Parameter, value: float, std: float) -> dict[str, Any]:
    return {"value": six_digits(value), "std": six_digits(std), "unit": p.unit}


def build_verdict(
    tables: Tables,
    fits: Mapping[str, ExplanationFit],
    transferred: Mapping[str, float],
    coulomb: np.ndarray,
    ensemble: Mapping[str, np.ndarray] | None = None,
) -> dict[str, Any]:
    """Return the verdict.

    Parameters
    ----------
    fits : by candidate.
    transferred : mean squared weighted residual on left-out tasks, by candidate, of those that were tested.
    coulomb : (n,) larger Coulomb level of each axis [N m].
    ensemble : values over the solutions, by parameter, for what is identifiable.
    """
    chosen = choose(fits, transferred)
    fit, second = fits[chosen], runner_up(fits, chosen)
    effects, retuned, place = [], [], 0
    for component in candidate(chosen).components:
        own = slice(place, place + len(component.parameters))
        place = own.stop
        estimates = list(zip(component.parameters, fit.effect[own], fit.std[own], strict=True))
        if component.kind == "effect":
            effects.append(_named_effect(component, estimates, chosen, fits, transferred))
        else:
            retuned += _retuned(component, estimates)
    verdict = "effects" if effects else "retuned" if retuned else "none"
    if fit.variance > UNEXPLAINED:
        verdict = "unknown"
    return {
        "dataset": "published tables V and VI",
        "verdict": verdict,
        "candidate": chosen,
        "effects": effects,
        "retuned": retuned,
        "unexplained": contradictions(tables, coulomb),
        "gap": _gap(tables, fits, fit),
        "not_identifiable": _not_identifiable(chosen, ensemble),
        "next_experiment": None,
        "runner_up": {
            "candidate": second,
            "bic": six_digits(fits[second].bic),
            "behind_nats": six_digits((fits[second].bic - fit.bic) / 2),
            "mean_square": six_digits(fits[second].variance),
        },
        "wear_shape": six_digits(fit.shape),
        "mean_square": six_digits(fit.variance),
        "cells": cells(tables, fit),
    }


def _named_effect(
    component: Component,
    estimates: Sequence[tuple[Parameter, float, float]],
    chosen: str,
    fits: Mapping[str, ExplanationFit],
    transferred: Mapping[str, float],
) -> dict[str, Any]:
    """Return the entry of an effect of the candidate that was `chosen`, with what it is worth against that without it.

    Parameters
    ----------
    estimates : its parameters, each with value and standard deviation. fits, transferred : as of :func:`build_verdict`.
    """
    without = parts(chosen) - {component.name}
    reduced = "+".join(c.name for c in candidate(chosen).components if c.name in without) or NOTHING
    gain = None
    if chosen in transferred and reduced in transferred:
        gain = six_digits(1 - transferred[chosen] / transferred[reduced])
    return {
        "effect": component.name,
        "axis": None,
        "source_axis": None,
        "tie_set": sorted({component.name, *component.same_in_slow_motion}, key=lambda n: n != component.name),
        "parameters": {
            p.name if p.axis is None else f"{p.name}_{p.axis}": _parameter(p, v, s) for p, v, s in estimates
        },
        "regime": None,
        "evidence_nats": six_digits((fits[reduced].bic - fits[chosen].bic) / 2),
        "cross_validated_gain": gain,
        "candidates_with_it": sum(component.name in parts(n) for n in fits),
    }


def _retuned(component: Component, estimates: Sequence[tuple[Parameter, float, float]]) -> list[dict[str, Any]]:
    """Return the entries of the parameters that a component of the model corrects; `estimates` as above."""
    return [
        {
            "parameter": p.name,
            "axis": p.axis,
            "nominal": p.nominal,
            "value": six_digits(v),
            "std": six_digits(s),
            "unit": p.unit,
            "tie_set": [component.name, *component.same_in_slow_motion],
            "kind": component.kind,
        }
        for p, v, s in estimates
    ]


def _gap(tables: Tables, fits: Mapping[str, ExplanationFit], fit: ExplanationFit) -> dict[str, Any]:
    """Return how far maxima [N m] of the arm as published, retuned and as `fit` says lie from the printed ones."""

    def off(by: ExplanationFit) -> list[float]:
        return [six_digits(x) for x in np.abs(by.maximum - tables.maximum).ravel()]

    return {
        "unit": "N m",
        "per": "table cell, |reproduced - published| maximum; order in `cells`",
        "cells": [f"{c['task']} axis {c['axis']} {c['increase_percent']:g} %" for c in cells(tables, fit)],
        "nominal": off(fits[NOTHING]),
        "retuned": off(_best_retuned(fits)),
        "augmented": off(fit),
        "noise_floor": [six_digits(x) for x in (SCATTER * tables.maximum).ravel()],
    }


def _best_retuned(fits: Mapping[str, ExplanationFit]) -> ExplanationFit:
    names = [n for n in fits if parts(n) and all(COMPONENTS[p].kind == "retuned" for p in parts(n))]
    return min((fits[n] for n in names), key=lambda f: f.bic) if names else fits[NOTHING]


def _not_identifiable(chosen: str, ensemble) -> list[dict[str, Any]]:
    result = [
        {"effects": [p, *COMPONENTS[p].same_in_slow_motion], "axis": None, "reason": "alike in slow motion"}
        for p in parts(chosen)
        if COMPONENTS[p].same_in_slow_motion
    ]
    if "payload" in parts(chosen) and ensemble is not None:
        mass, z = ensemble["mass"], ensemble["com_z"]
        spread = {
            name: (float(np.min(v)), float(np.max(v)))
            for name, v in (("mass", mass), ("com_z", z), ("product", mass * z))
        }
        relative = {
            name: float(np.std(v) / np.mean(v)) for name, v in (("mass", mass), ("com_z", z), ("product", mass * z))
        }
        result.append(
            {
                "effects": ["payload"],
                "axis": None,
                "reason": "mass and offset trade off against poses",
                "range_over_solutions": {k: [six_digits(x) for x in v] for k, v in spread.items()},
                "relative_spread": {k: six_digits(v) for k, v in relative.items()},
                "correlation_of_mass_and_offset": six_digits(np.corrcoef(mass, z)[0, 1]) if len(mass) > 2 else None,
            }
        )
    return result


def write_comparison(
    path: str | Path, fits: Mapping[str, ExplanationFit], transferred: Mapping[str, float], tables: Tables
) -> None:
    """Write one row a candidate, best criterion first."""
    moving = ~tables.at_rest
    columns = [
        "candidate",
        "parameters",
        "data",
        "cost",
        "mean_square",
        "bic",
        "aicc",
        "median_error_percent",
        "worst_error_percent",
    ]
    with Path(path).open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*columns, "left_out_mean_square"])
        for name, fit in sorted(fits.items(), key=lambda item: item[1].bic):
            error = 100 * np.abs(fit.maximum / np.where(tables.maximum > 0, tables.maximum, 1) - 1)[moving]
            scores = [fit.cost, fit.variance, fit.bic, fit.aicc, np.median(error), error.max(), transferred.get(name)]
            text = ["" if x is None else f"{x:.6g}" for x in scores]
            writer.writerow([name, fit.parameters, fit.data, *text])


def judge(
    robot: str | Path,
    published: str | Path,
    fits: Sequence[str | Path],
    transfer: str | Path,
    ensemble: str | Path,
    verdict: str | Path,
    comparison: str | Path,
) -> None:
    """Compare all fits and write the verdict and the comparison.

    Parameters
    ----------
    robot : the unloaded arm; published : file of the published values; fits, transfer, ensemble : what the other
        rules wrote; verdict : JSON; comparison : CSV.
    """
    arm, tables = load_robot(robot), read_tables(published)
    known = {fit.candidate: fit for fit in map(read_fit, fits)}
    with open_dataset(transfer) as data:
        names = [str(n) for n in data["candidate"][:]]
        transferred = dict(zip(names, read_variable(data, transfer, "mean_square").mean(axis=1), strict=True))
    with open_dataset(ensemble) as data:
        values = read_variable(data, ensemble, "effect")
        solutions = {str(n): values[:, k] for k, n in enumerate(data["parameter"][:])}
    coulomb = np.maximum(arm.coulomb_positive, -arm.coulomb_negative)
    result = build_verdict(tables, known, transferred, coulomb, solutions)
    write_json(verdict, result)
    write_comparison(comparison, known, transferred, tables)
