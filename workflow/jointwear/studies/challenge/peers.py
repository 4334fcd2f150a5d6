"""Other methods on the same data: PySINDy (STLSQ), plain least squares, SysIdentPy (FROLS).

Each is run with several settings; which one counts is decided on the seeds for choosing. Needs the packages of
requirements/peers.in.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.storage import open_dataset
from jointwear.studies.challenge.arms import given_robot
from jointwear.studies.challenge.peer_terms import AxisProblem, build_problems

#: Settings tried: threshold in residual standard deviations, limit of abs(t), multiple of the BIC's price.
SETTINGS = {
    "PySINDy STLSQ": (0.05, 0.1, 0.2, 0.4, 0.8),
    "least squares": (3.5, 6.0, 10.0, 20.0, 40.0),
    "SysIdentPy FROLS": (1.0, 3.0, 10.0, 30.0),
}
_MOST_TERMS = 15


def stlsq(problem: AxisProblem, threshold: float) -> np.ndarray:
    """Return the coefficients (p,) of PySINDy's sequentially thresholded least squares.

    The threshold counts in standard deviations of the residual; terms have unit RMS.
    """
    from pysindy.optimizers import STLSQ

    scale = max(float(np.std(problem.target)), 1e-12)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = STLSQ(threshold=threshold, alpha=1e-3, max_iter=20).fit(problem.terms, problem.target[:, None] / scale)
    return np.asarray(model.coef_).ravel() * scale


def least_squares(problem: AxisProblem, limit: float) -> np.ndarray:
    """Return the least-squares coefficients (p,) with abs(t) above the limit, all others zero."""
    a, y = problem.terms, problem.target
    inverse = np.linalg.pinv(a.T @ a, rcond=1e-10, hermitian=True)
    theta = inverse @ (a.T @ y)
    noise = np.sum((y - a @ theta) ** 2) / max(len(y) - a.shape[1], 1)
    return np.where(np.abs(theta) > limit * np.sqrt(noise * np.diag(inverse)), theta, 0.0)


def frols(problem: AxisProblem, price: float) -> np.ndarray:
    """Return the coefficients (p,) of the terms that SysIdentPy's error reduction ratio picks, as many as BIC allows.

    `price` multiplies the logarithm of the number of samples in the criterion.
    """
    from sysidentpy.basis_function import Polynomial
    from sysidentpy.model_structure_selection import FROLS

    a, y = problem.terms, problem.target
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = FROLS(order_selection=False, n_terms=1, basis_function=Polynomial(degree=1))
        model.max_lag = 0
        _, order, _ = model.error_reduction_ratio(a, y[:, None], min(_MOST_TERMS, a.shape[1]))
    order = np.asarray(order, dtype=int).ravel()
    best, chosen = len(y) * np.log(np.mean(y**2)), np.zeros(a.shape[1])
    for count in range(1, len(order) + 1):
        picked = order[:count]
        theta = np.linalg.lstsq(a[:, picked], y, rcond=None)[0]
        value = len(y) * np.log(np.mean((y - a[:, picked] @ theta) ** 2)) + price * count * np.log(len(y))
        if value < best:
            best, chosen = value, np.zeros(a.shape[1])
            chosen[picked] = theta
    return chosen


_METHODS: dict[str, Callable[[AxisProblem, float], np.ndarray]] = {
    "PySINDy STLSQ": stlsq,
    "least squares": least_squares,
    "SysIdentPy FROLS": frols,
}


def effects_of(problems: list[AxisProblem], coefficients: list[np.ndarray]) -> list[list[Any]]:
    """Return [effect, 1-based axis or None, energy] for every effect with a term that was kept, largest first.

    The energy is what the fit of its axis loses without the effect's terms, the others fitted again, over the variance
    of the residual: collinear terms cannot inflate it. That of a payload is summed over the axes.
    """
    energy: dict[tuple[str, int | None], float] = {}
    for axis, (problem, theta) in enumerate(zip(problems, coefficients, strict=True)):
        kept = np.flatnonzero(theta)
        full = _square_sum(problem, kept)
        for name in dict.fromkeys(problem.effects[k] for k in kept):
            others = [k for k in kept if problem.effects[k] != name]
            key = (name, None if name == "payload" else axis + 1)
            lost = (_square_sum(problem, others) - full) / max(full / len(problem.target), 1e-18)
            energy[key] = energy.get(key, 0.0) + float(lost)
    ordered = sorted(energy.items(), key=lambda item: -item[1])
    return [[name, axis, value] for (name, axis), value in ordered]


def _square_sum(problem: AxisProblem, kept) -> float:
    terms = problem.terms[:, kept]
    rest = problem.target
    if terms.shape[1]:
        rest = rest - terms @ np.linalg.lstsq(terms, rest, rcond=1e-10)[0]
    return float(rest @ rest)


def solve_batch_with_peers(folder: str | Path, output: str | Path) -> None:
    """Run every peer with every setting on a batch of data sets and write the effects named.

    Raises
    ------
    InputError : if a file is missing or broken, or the peers' packages are not installed.
    """
    try:
        import pysindy  # noqa: F401
        import sysidentpy  # noqa: F401
    except ImportError as error:
        raise InputError(
            f"the peers need '{error.name}': install requirements/peers.in into an environment of its own "
            "and set JOINTWEAR_PEERS_PYTHON to its python"
        ) from None
    folder = Path(folder)
    listed = read_json(folder / "cases.json")
    entries = []
    for case in listed["cases"]:
        with open_dataset(folder / case["file"]) as dataset:
            data = {name: np.asarray(v[...]) for name, v in dataset.variables.items()}
        robot = given_robot(case)
        start = time.process_time()
        problems = build_problems(data, robot, tuple(case["train"]), listed["inertial_prior"])
        prepared = time.process_time() - start
        answers = []
        for method, solve in _METHODS.items():
            for setting in SETTINGS[method]:
                start = time.process_time()
                named = effects_of(problems, [solve(p, setting) for p in problems])
                seconds = prepared + time.process_time() - start
                answers.append({"method": method, "setting": setting, "named": named, "seconds": round(seconds, 3)})
        entries.append({"case": case["case"], "answers": answers})
    write_json(output, {"cases": entries})
