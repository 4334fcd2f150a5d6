"""Transfer test: a cause found on two tasks must serve the third."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, write_dataset
from jointwear.robots.robot import Robot, load_robot
from jointwear.statistics.randomness import generator
from jointwear.studies.recovery.candidates import Explanation, candidate
from jointwear.studies.recovery.choice import finalists
from jointwear.studies.recovery.fit import fit_tables, read_fit, settings_of
from jointwear.studies.recovery.problem import TableProblem, TableSettings
from jointwear.studies.recovery.search import Effort, search_task
from jointwear.studies.recovery.tables import Tables, read_tables


def left_out_cost(
    robot: Robot,
    tables: Tables,
    chosen: Explanation,
    settings: TableSettings,
    effort: Effort,
    random,
    outward: np.ndarray,
) -> np.ndarray:
    """Return (t,) mean squared weighted residual of every task when the candidate was fitted to the others.

    Wear shape and the candidate's parameters come from the other tasks; only the poses are fitted to the task.

    Parameters
    ----------
    outward : (t,) durations of the way out [s], as the fit to all tasks chose them.
    """
    count = len(tables.tasks)
    result = np.empty(count)
    for task in range(count):
        others = [k for k in range(count) if k != task]
        fit = fit_tables(robot, tables.task_subset(others), chosen, settings, effort, random, outward=outward[others])
        alone = TableProblem(
            robot,
            tables.task_subset([task]),
            chosen,
            settings,
            frozen=np.concatenate([[fit.shape], fit.effect]),
            outward=outward[[task]],
        )
        _, cost = search_task(alone, random, effort)
        result[task] = 2 * cost / alone.data_count
    return result


def transfer_candidates(
    robot: str | Path, published: str | Path, fits: Sequence[str | Path], output: str | Path, settings: dict[str, Any]
) -> None:
    """Run the transfer test for the candidates that are worth it.

    Parameters
    ----------
    fits : files of all fits.
    settings : `seed`, `transfer` (fields of Effort), `comparison` (fields of Settings).
    """
    tables, arm = read_tables(published), load_robot(robot)
    known = {fit.candidate: fit for fit in map(read_fit, fits)}
    names = finalists(known)
    effort = Effort(**settings["transfer"])
    values = [
        left_out_cost(
            arm,
            tables,
            candidate(name),
            settings_of(settings["comparison"]),
            effort,
            generator(settings["seed"], "transfer", name, replicate=0),
            known[name].outward,
        )
        for name in names
    ]
    variables = {
        "candidate": Variable(("candidate",), np.array(names), "what may be missing"),
        "task": Variable(("task",), np.array(tables.tasks), "task that was left out"),
        "mean_square": Variable(
            ("candidate", "task"), np.array(values), "mean squared weighted residual of the task that was left out", "1"
        ),
    }
    write_dataset(output, variables, provenance.attributes("transfer test of the candidates", settings))
