"""Does the comparison name what was left out, where the truth is known? Synthetic tables with a hidden cause."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.robots.robot import Robot, load_robot
from jointwear.statistics.randomness import generator
from jointwear.studies.recovery.candidates import candidate
from jointwear.studies.recovery.choice import choose, parts
from jointwear.studies.recovery.fit import NOISE_VARIANCE, ExplanationFit, fit_tables, settings_of
from jointwear.studies.recovery.plan import NOT_TOLD_APART, NOTHING
from jointwear.studies.recovery.problem import TableProblem, TableSettings
from jointwear.studies.recovery.search import Effort
from jointwear.studies.recovery.tables import TORQUE_ROUNDING, Tables, read_tables


@dataclass(frozen=True)
class Case:
    """Synthetic `tables`, the hidden `cause` and its parameters `truth` (p,)."""

    tables: Tables
    cause: str
    truth: np.ndarray


def draw_truth(cause: str, random: np.random.Generator) -> np.ndarray:
    """Return the parameters of a hidden cause.

    A payload of 1 to 4 kg within 0.05 to 0.15 m along the tool axis, a gravity of 0.7 to 0.9 or 1.1 to 1.5 times its
    value, motions 4 to 10 times as fast, or none.
    """
    if cause == "payload":
        return np.array([random.uniform(1, 4), 0.0, 0.0, random.uniform(0.05, 0.15)])
    if cause == "gravity_scale":
        return np.array([random.uniform(0.7, 0.9) if random.random() < 0.5 else random.uniform(1.1, 1.5)])
    if cause == "faster_segments":
        return np.array([random.uniform(4, 10)])
    return np.zeros(0)


def synthetic_case(
    robot: Robot, pattern: Tables, cause: str, settings: TableSettings, random: np.random.Generator
) -> Case:
    """Return tables such as the paper would have printed, from random poses and one draw of the noise.

    Hours, resting axes and pauses are those of `pattern`; poses are random with spans of at least 20 degrees.
    """
    truth = draw_truth(cause, random)
    problem = TableProblem(robot, pattern, candidate(cause), settings)
    while True:
        theta = random.uniform(problem.lower, problem.upper)
        wide = [
            abs(theta[b] - theta[a]) > np.radians(20)
            for task, pairs in enumerate(problem.pairs_by_task)
            for axis, (a, b) in enumerate(pairs)
            if not pattern.at_rest[task, axis]
        ]
        if all(wide):
            break
    place = problem.trajectory_count
    theta[place] = random.uniform(1.2, 3.0)
    theta[place + 1 :] = truth
    predicted = problem.predict(problem.free(theta[None]))
    level = np.repeat(predicted.torque[0], settings.repeats, axis=1)  # (t, samples, n, c)
    share = settings.disturbance_share * np.abs(predicted.torque[0]).mean(axis=1, keepdims=True)
    encoder = settings.encoder / settings.time_step**2 * robot.armature[:, None]
    noise = np.sqrt(share**2 + encoder**2) * random.standard_normal(level.shape)
    size = np.abs(level + noise)
    maximum = np.round(size.max(axis=1), 3)
    maximum[pattern.at_rest] = np.where(maximum[pattern.at_rest] <= 2 * TORQUE_ROUNDING, 0.0, maximum[pattern.at_rest])
    variation = np.round(size.std(axis=1, ddof=settings.ddof) / size.mean(axis=1), 3)
    tables = Tables(pattern.tasks, pattern.increase_percent, pattern.hours, maximum, variation, pattern.run_hours)
    return Case(tables, cause, truth)


def name_cause(
    robot: Robot, tables: Tables, settings: TableSettings, effort: Effort, random: np.random.Generator
) -> tuple[str, dict[str, ExplanationFit]]:
    """Return the chosen candidate among nothing and all single components, and the fits.

    Candidates are tried in the order of their number of parameters, and no more of them once one reproduces the
    tables to within their noise: the criterion cannot prefer one with more parameters to it.
    """
    fits: dict[str, ExplanationFit] = {}
    for name in sorted((NOTHING, *NOT_TOLD_APART), key=lambda n: len(candidate(n).parameters)):
        # One that slow motion cannot tell from it may have been tried already.
        if set(NOT_TOLD_APART.get(name, ())) & set(fits):
            continue
        fits[name] = fit_tables(robot, tables, candidate(name), settings, effort, random)
        if fits[name].variance <= NOISE_VARIANCE:
            break
    return choose(fits), fits


def named_rightly(cause: str, chosen: str) -> bool:
    """Return whether the chosen candidate is the cause or one that slow motion cannot tell from it."""
    same = NOT_TOLD_APART.get(cause, ())
    return chosen in (cause, *same)


def validate_case(
    robot: str | Path, published: str | Path, output: str | Path, cause: str, number: int, settings: dict[str, Any]
) -> None:
    """Make one synthetic case, name its cause, write both.

    Parameters
    ----------
    published : the tables whose hours and layout the synthetic ones take over.
    settings : `seed`, `search` (fields of Effort), `comparison` (fields of Settings).
    """
    arm, comparison = load_robot(robot), settings_of(settings["comparison"])
    random = generator(settings["seed"], "validation", cause, replicate=number)
    case = synthetic_case(arm, read_tables(published), cause, comparison, random)
    chosen, fits = name_cause(arm, case.tables, comparison, Effort(**settings["search"]), random)
    names = list(fits)
    variables = {
        "candidate": Variable(("candidate",), np.array(names), "what may be missing"),
        "bic": Variable(("candidate",), np.array([fits[n].bic for n in names]), "Bayesian information criterion", "1"),
        "mean_square": Variable(
            ("candidate",), np.array([fits[n].variance for n in names]), "mean squared weighted residual", "1"
        ),
    }
    attributes = provenance.attributes("synthetic tables with a hidden cause", settings)
    estimate = fits[chosen].effect if parts(chosen) else np.zeros(0)
    attributes |= {"cause": cause, "chosen": chosen, "number": number}
    attributes |= {"truth": [float(x) for x in case.truth] or [0.0], "estimate": [float(x) for x in estimate] or [0.0]}
    write_dataset(output, variables, attributes)


def summarise_validation(cases: Sequence[str | Path], output: str | Path) -> None:
    """Write one row a case: hidden cause, chosen candidate, whether it was named rightly.

    A hidden cause can also leave tables that other poses reproduce to within their noise without it, such as a weaker
    gravity. No comparison can name it then; such cases are marked, and count as not named.
    """
    causes, chosen, margins, needless = [], [], [], []
    for path in cases:
        with open_dataset(path) as data:
            bic, mean_square = (read_variable(data, path, n) for n in ("bic", "mean_square"))
            names = [str(n) for n in data["candidate"][:]]
            causes.append(data.getncattr("cause"))
            chosen.append(data.getncattr("chosen"))
        margins.append(np.sort(bic)[1] - bic.min() if len(bic) > 1 else np.nan)
        needless.append(causes[-1] != NOTHING and mean_square[names.index(NOTHING)] <= NOISE_VARIANCE)
    right = np.array([named_rightly(a, b) for a, b in zip(causes, chosen, strict=True)])
    each = ("case",)
    variables = {
        "cause": Variable(each, np.array(causes), "hidden cause"),
        "chosen": Variable(each, np.array(chosen), "candidate that was chosen"),
        "right": Variable(each, right.astype("i1"), "1 if named rightly", "1"),
        "needless": Variable(
            each, np.array(needless).astype("i1"), "1 if other poses reproduce the tables without the cause", "1"
        ),
        "margin": Variable(each, np.array(margins), "lead of the best criterion over the second", "1"),
    }
    attributes = {
        "Conventions": "CF-1.8",
        "title": "validation of the recovery",
        "cases": len(right),
        "named_rightly": int(right.sum()),
        "needless": int(np.sum(needless)),
    }
    write_dataset(output, variables, attributes)
