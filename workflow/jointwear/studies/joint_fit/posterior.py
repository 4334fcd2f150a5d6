"""The experiments nearest to the paper, and the one of them that stands for all."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.storage import open_dataset, read_variable
from jointwear.files.text_files import replace_text
from jointwear.reproduction.published import load_published
from jointwear.robots.robot import load_robot
from jointwear.studies.joint_fit.confirmation import Confirmed, confirm
from jointwear.studies.joint_fit.paper import read_paper
from jointwear.studies.joint_fit.paper_fit import JointExperiment
from jointwear.studies.joint_fit.records import read_experiments, write_confirmed
from jointwear.studies.joint_fit.scores import Scores, aims_met, score
from jointwear.studies.multiverse.settings import analysis_of, experiment_of
from jointwear.studies.recovery.export import robot_data, task_data, write_yaml
from jointwear.studies.recovery.sampled_motion import SEGMENT

FIELDS = tuple(Confirmed.__dataclass_fields__)


def read_confirmed(paths: Sequence[str | Path]) -> tuple[list[JointExperiment], dict[str, np.ndarray]]:
    """Return the experiments of all parts and the fields of :class:`Confirmed`, in the order of the search."""
    experiments: list[JointExperiment] = []
    parts: dict[str, list[np.ndarray]] = {name: [] for name in (*FIELDS, "place")}
    for path in paths:
        experiments += read_experiments(path)
        with open_dataset(path) as data:
            for name, values in parts.items():
                values.append(read_variable(data, path, name))
    fields = {name: np.concatenate(values) for name, values in parts.items()}
    order = np.argsort(fields.pop("place"))
    return [experiments[k] for k in order], {name: values[order] for name, values in fields.items()}


def nearest(distance: np.ndarray, count: int) -> np.ndarray:
    """Return the places of the `count` experiments nearest to the paper, nearest first."""
    return np.argsort(distance, kind="stable")[:count]


def closest(scores: Scores, distance: np.ndarray) -> int:
    """Return the place of the experiment that meets most aims, the nearest of several."""
    return int(np.lexsort((distance, -aims_met(scores)))[0])


def write_posterior(
    robot: str | Path,
    published: str | Path,
    confirmed: str | Path,
    traded: str | Path,
    table: str | Path,
    checked: str | Path,
    robot_file: str | Path,
    task_files: Sequence[str | Path],
    settings: Mapping[str, Any],
) -> None:
    """Keep the nearest experiments; check the closest of all on new random numbers and write it as ordinary files.

    Those that were searched on under other weights descend from a few of the others: they may be the closest, but
    they do not count in the posterior.

    Parameters
    ----------
    confirmed, traded : experiments of the search, and those that were searched on under other weights.
    table : CSV file, one row an experiment that is kept; checked : netCDF file of the closest one.
    settings : of the experiment; `reading` of the config, `kept`, `check_replicates`.
    """
    paper = read_paper(published)
    experiments, fields = read_confirmed([confirmed])
    order = nearest(fields["distance"], settings["kept"])
    scores = score(fields, paper)
    text = io.StringIO()
    names = tuple(Scores.__dataclass_fields__)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["experiment", "mass", "offset", "moment", "shape", "distance", *names])
    for k in order:
        arm = experiments[k].arm
        values = [arm.mass, arm.offset, arm.moment, arm.shape, fields["distance"][k]]
        writer.writerow([k + 1, *(f"{float(v):.6g}" for v in (*values, *(getattr(scores, n)[k] for n in names)))])
    replace_text(table, text.getvalue())
    every, again = read_confirmed([confirmed, traded])
    place = closest(score(again, paper), again["distance"])
    best = every[place]
    once_more = confirm(
        load_robot(robot),
        best,
        paper,
        settings["reading"],
        experiment_of(settings, settings["check_replicates"]),
        analysis_of(settings, load_published(published)),
        "joint check",
    )
    write_confirmed(checked, [best], [once_more], [place], "the closest joint experiment once more", settings)
    payload = (best.arm.mass, 0.0, 0.0, best.arm.offset)
    write_yaml(robot_file, robot_data(robot, ("mass", "com_x", "com_y", "com_z"), payload, "puma560_joint"))
    for t, (name, path) in enumerate(zip(paper.tables.tasks, task_files, strict=True)):
        write_yaml(path, task_data(name, best.start[t], best.stop[t], SEGMENT, best.phase[t]))
