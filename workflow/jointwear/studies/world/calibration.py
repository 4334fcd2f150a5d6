"""Does the probability of a name mean what it says? python -m jointwear.studies.world.calibration ROWS.

Reads judged rows of choosing cases (`--save` of `python -m jointwear.studies.world`), fits a logistic model of "this
name is right" and prints the expected calibration error of names that the fit had not seen: every case is left out in
turn with its fold.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, log_expit

from jointwear.discovery.search.calibration import FEATURES, FILE, features
from jointwear.files.json_documents import read_json, write_json
from jointwear.studies.challenge.reliability import calibration_error

#: Standard deviation of the prior of each coefficient but the first: with a few wrong names among a hundred, a fit
#: without one would be certain of everything.
PRIOR = 1.0
#: More evidence and a larger share make no name less probable, structure that is left makes none more so.
SENSE = ((None, None), (0.0, None), (0.0, None), (None, 0.0))
#: Folds of cases.
FOLDS = 8

Row = Mapping[str, Any]


def names_of(rows: Sequence[Row]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return features (k, p) of all names, whether each is right (k,), and the place of its case (k,)."""
    table, right, case = [], [], []
    for place, row in enumerate(rows):
        for name in row["names"]:
            if name.get("log_odds") is not None:
                table.append(features(name["log_odds"], name["share"], name["left"]))
                right.append(bool(name["right"]))
                case.append(place)
    return np.array(table).reshape(-1, len(FEATURES)), np.array(right), np.array(case)


def fit(table: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the coefficients (p,) of a logistic model, the most probable ones under the prior.

    A mean name that is right and one that is wrong are added to those seen (Laplace): that all were right makes none
    certain.
    """
    middle = table.mean(axis=0)
    table, right = np.concatenate([table, [middle, middle]]), np.append(right, [True, False])
    precision = np.full(table.shape[1], PRIOR**-2.0)
    precision[0] = 0.0

    def loss(c: np.ndarray) -> float:
        score = table @ c
        return float(-np.sum(np.where(right, log_expit(score), log_expit(-score))) + 0.5 * precision @ c**2)

    start = np.zeros(table.shape[1])
    start[0] = np.log(right.sum() / np.sum(~right))
    return minimize(loss, start, method="L-BFGS-B", bounds=SENSE).x


def cross_fitted(rows: Sequence[Row]) -> tuple[float | None, int]:
    """Return the expected calibration error, and the count, of names whose cases the fit had not seen."""
    table, right, case = names_of(rows)
    left_out = []
    for fold in range(FOLDS):
        own = case % FOLDS == fold
        if own.any() and (~own).any():
            probability = expit(table[own] @ fit(table[~own], right[~own]))
            left_out += [
                {"probability": float(p), "right": bool(r)} for p, r in zip(probability, right[own], strict=True)
            ]
    return calibration_error([{"names": left_out}])


def summary(rows: Sequence[Row], source: str) -> dict[str, Any]:
    """Return what is stored: the coefficients and where they come from."""
    table, right, _ = names_of(rows)
    error, count = cross_fitted(rows)
    return {
        "features": list(FEATURES),
        "coefficients": [float(f"{c:.4g}") for c in fit(table, right)],
        "source": source,
        "cases": len(rows),
        "names": count,
        "right": int(right.sum()),
        "cross_fitted_calibration_error": error,
    }


def main(arguments: list[str] | None = None) -> int:
    """Parse arguments, fit, print, store."""
    parser = argparse.ArgumentParser(prog="python -m jointwear.studies.world.calibration", description=__doc__)
    parser.add_argument("rows", nargs="+", type=Path, help="judged rows of choosing cases")
    parser.add_argument("--source", help="what the rows are, in words; default: choosing cases of the tier")
    parser.add_argument("--store", action="store_true", help="write the fit beside the code of discovery that uses it")
    given = parser.parse_args(arguments)
    rows = [row for path in given.rows for row in read_json(path)["cases"]]
    stored = summary(rows, f"{len(rows)} {given.source or 'choosing cases of the tier world'}")
    print(json.dumps(stored, indent=1))
    if given.store:
        write_json(FILE, stored)
    return 0


if __name__ == "__main__":
    sys.exit(main())
