"""From the config's settings to what the stages of the multiverse share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jointwear.reproduction.published import Published
from jointwear.studies.multiverse.evaluation import Analysis
from jointwear.studies.multiverse.scoring import Target, target_of
from jointwear.studies.multiverse.shared_torque import SharedExperiment


def experiment_of(settings: Mapping[str, Any], replicates: int) -> SharedExperiment:
    """Return what all readings share, from `seed`, `noise`, `sampling`, `wear_hours` and `normal_hours`."""
    return SharedExperiment(
        settings["seed"],
        replicates,
        **settings["noise"],
        **settings["sampling"],
        wear_hours=settings["wear_hours"],
        normal_hours=settings["normal_hours"],
    )


def analysis_of(settings: Mapping[str, Any], published: Published) -> Analysis:
    """Return the analysis of the paper's own grid, whatever part of it the config asks the reproduction for."""
    grid = published.data["table_iii_design"]
    cell = published.lag_cell
    resting = [
        (task, axis + 1)
        for task, columns in published.data["table_v_max_abs_torque_nm"].items()
        for axis, values in enumerate(zip(*columns.values(), strict=True))
        if not any(values)
    ]
    rest_task, rest_axis = resting[0] if resting else ("", 1)
    return Analysis(
        settings["bins"],
        settings["confidence"],
        settings["variance_share"],
        tuple(grid["axes"]),
        tuple(float(v) for v in grid["increase_percent"]),
        cell.task,
        cell.axis,
        cell.increase_percent,
        rest_task,
        rest_axis,
    )


def paper_tasks(published: Published) -> list[str]:
    """Return the tasks that the paper ran."""
    return list(published.data["table_iii_design"]["tasks"])


def paper_target(published: Published, analysis: Analysis) -> Target:
    """Return what the paper prints for the runs of the analysis."""
    return target_of(published, paper_tasks(published), list(analysis.increases), list(analysis.axes))
