"""The experiments nearest to the paper, and the one of them that stands for all."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.storage import open_dataset, read_variable
from jointwear.files.text_files import replace_text
from jointwear.reproduction.published import load_published
from jointwear.robots.robot import load_robot
from jointwear.studies.joint_fit.confirmation import Confirmed, confirm
from jointwear.studies.joint_fit.paper import Paper, read_paper
from jointwear.studies.joint_fit.paper_fit import JointExperiment
from jointwear.studies.joint_fit.records import read_experiments, write_confirmed
from jointwear.studies.multiverse.settings import analysis_of, experiment_of
from jointwear.studies.recovery.export import robot_data, task_data, write_yaml
from jointwear.studies.recovery.sampled_motion import SEGMENT

FIELDS = tuple(Confirmed.__dataclass_fields__)


@dataclass(frozen=True)
class Scores:
    """How experiments e compare with the paper, each (e,): `cells` of Table IV with the same outcome, `hour_error` [h]
    median over cells that both detect; `torque_median`, `torque_worst` relative errors of Table V; the same of
    Table VI; `signs` median number of pairs of Table II; `kl` median of the largest divergence [nat]; `figure_3` [h]
    onset of axis 1 of T1 at 10 %, the run of Figures 2 and 3.
    """

    cells: np.ndarray
    hour_error: np.ndarray
    torque_median: np.ndarray
    torque_worst: np.ndarray
    variation_median: np.ndarray
    variation_worst: np.ndarray
    signs: np.ndarray
    kl: np.ndarray
    figure_3: np.ndarray


def score(found: Mapping[str, np.ndarray], paper: Paper, at: int = 0) -> Scores:
    """Return the scores of confirmed experiments.

    Parameters
    ----------
    found : arrays of the fields of :class:`Confirmed` along a first dimension of experiments.
    at : 0 reads Tables V and VI at the printed hours, 1 at the experiment's own.
    """
    tables = paper.tables
    hours = tables.hours.swapaxes(1, 2)
    wanted = np.isfinite(hours)
    right = (found["probability"] >= 0.5) == wanted
    late = np.where(right & wanted, np.abs(found["hour"] - hours), np.nan)
    moving = np.broadcast_to(~tables.at_rest[..., None], tables.maximum.shape).swapaxes(1, 2)
    torque = np.abs(found["maximum"][:, at] / np.where(moving, tables.maximum.swapaxes(1, 2), 1.0) - 1)[:, moving]
    variation = np.abs(found["variation"][:, at] - tables.variation.swapaxes(1, 2))[:, moving]
    return Scores(
        right.sum(axis=(1, 2, 3)),
        np.nanmedian(late.reshape(len(late), -1), axis=1),
        np.median(torque, axis=1),
        torque.max(axis=1),
        np.median(variation, axis=1),
        variation.max(axis=1),
        np.median(found["signs"], axis=1),
        np.median(found["kl_maximum"], axis=1),
        found["hour"][:, 0, 0, 0],
    )


def read_confirmed(paths: Sequence[str | Path]) -> tuple[list[JointExperiment], dict[str, np.ndarray]]:
    """Return the experiments of all parts and the fields of :class:`Confirmed`, in the order of the search."""
    experiments: list[JointExperiment] = []
    parts: dict[str, list[np.ndarray]] = {name: [] for name in (*FIELDS, "place")}
    for path in paths:
        experiments += read_experiments(path)
        with open_dataset(path) as data:
            for name, values in parts.items():
                values.append(read_variable(data, path, name))
    found = {name: np.concatenate(values) for name, values in parts.items()}
    order = np.argsort(found.pop("place"))
    return [experiments[k] for k in order], {name: values[order] for name, values in found.items()}


def nearest(distance: np.ndarray, count: int) -> np.ndarray:
    """Return the places of the `count` experiments nearest to the paper, nearest first."""
    return np.argsort(distance, kind="stable")[:count]


def write_posterior(
    robot: str | Path,
    published: str | Path,
    confirmed: Sequence[str | Path],
    table: str | Path,
    checked: str | Path,
    robot_file: str | Path,
    task_files: Sequence[str | Path],
    settings: Mapping[str, Any],
) -> None:
    """Keep the nearest experiments, check the nearest one again on new random numbers, and write it as ordinary files.

    Parameters
    ----------
    table : CSV file, one row an experiment that is kept; checked : netCDF file of the nearest one.
    settings : of the experiment; `reading` of the config, `kept`, `check_replicates`.
    """
    paper = read_paper(published)
    experiments, found = read_confirmed(confirmed)
    order = nearest(found["distance"], settings["kept"])
    scores = score(found, paper)
    text = io.StringIO()
    names = tuple(Scores.__dataclass_fields__)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["experiment", "mass", "offset", "moment", "shape", "distance", *names])
    for k in order:
        arm = experiments[k].arm
        values = [arm.mass, arm.offset, arm.moment, arm.shape, found["distance"][k]]
        writer.writerow([k + 1, *(f"{float(v):.6g}" for v in (*values, *(getattr(scores, n)[k] for n in names)))])
    replace_text(table, text.getvalue())
    best = experiments[order[0]]
    again = confirm(
        load_robot(robot),
        best,
        paper,
        settings["reading"],
        experiment_of(settings, settings["check_replicates"]),
        analysis_of(settings, load_published(published)),
        "joint check",
    )
    write_confirmed(checked, [best], [again], [int(order[0])], "the nearest joint experiment once more", settings)
    payload = (best.arm.mass, 0.0, 0.0, best.arm.offset)
    write_yaml(robot_file, robot_data(robot, ("mass", "com_x", "com_y", "com_z"), payload, "puma560_joint"))
    for t, (name, path) in enumerate(zip(paper.tables.tasks, task_files, strict=True)):
        write_yaml(path, task_data(name, best.start[t], best.stop[t], SEGMENT, best.phase[t]))
