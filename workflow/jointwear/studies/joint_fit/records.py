"""Files of joint experiments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.studies.joint_fit.confirmation import Confirmed
from jointwear.studies.joint_fit.detection import PcaReading
from jointwear.studies.joint_fit.paper_fit import JointExperiment
from jointwear.studies.joint_fit.pose_search import Arm


def experiment_variables(experiments: Sequence[JointExperiment]) -> dict[str, Variable]:
    """Return experiments as variables along the dimension "experiment"."""
    each, pose = ("experiment",), ("experiment", "task", "axis")
    first = experiments[0].reading
    return {
        "mass": Variable(each, np.array([e.arm.mass for e in experiments]), "mass of the payload", "kg"),
        "offset": Variable(each, np.array([e.arm.offset for e in experiments]), "payload along the tool axis", "m"),
        "shape": Variable(each, np.array([e.arm.shape for e in experiments]), "wear shape", "1"),
        "start": Variable(pose, np.array([e.start for e in experiments]), "position at the start", "rad"),
        "stop": Variable(pose, np.array([e.stop for e in experiments]), "position at the stop", "rad"),
        "phase": Variable(
            ("experiment", "task"), np.array([e.phase for e in experiments]), "time of the first sample", "s"
        ),
        "search_cost": Variable(
            ("experiment", "task"), np.array([e.cost for e in experiments]), "cost that the search ended with", "1"
        ),
        "scaling": Variable(("reading",), np.array([first.scaling]), "scaling of the series"),
        "components": Variable(("reading",), np.array([first.components]), "number of components"),
        "consecutive_hours": Variable(("reading",), np.array([first.consecutive_hours]), "hours in a row", "1"),
    }


def write_experiments(
    path: str | Path, experiments: Sequence[JointExperiment], title: str, settings: Mapping[str, Any]
) -> None:
    """Write experiments that share one reading."""
    write_dataset(path, experiment_variables(experiments), provenance.attributes(title, settings))


def read_experiments(path: str | Path) -> list[JointExperiment]:
    """Read experiments.

    Raises
    ------
    InputError : if the file is missing or damaged.
    """
    with open_dataset(path) as data:
        v = {
            name: read_variable(data, path, name)
            for name in ("mass", "offset", "shape", "start", "stop", "phase", "search_cost")
        }
        reading = PcaReading(
            str(read_variable(data, path, "scaling")[0]),
            str(read_variable(data, path, "components")[0]),
            int(read_variable(data, path, "consecutive_hours")[0]),
        )
    return [
        JointExperiment(
            Arm(float(v["mass"][k]), float(v["offset"][k]), float(v["shape"][k])),
            reading,
            v["start"][k],
            v["stop"][k],
            v["phase"][k],
            v["search_cost"][k],
        )
        for k in range(len(v["mass"]))
    ]


def write_confirmed(
    path: str | Path,
    experiments: Sequence[JointExperiment],
    found: Sequence[Confirmed],
    places: Sequence[int],
    title: str,
    settings: Mapping[str, Any],
    more: Mapping[str, Variable] | None = None,
) -> None:
    """Write experiments with what they gave on new random numbers; `places` are their numbers in the search.

    Parameters
    ----------
    more : further variables along "experiment".
    """
    cell, at = ("experiment", "task", "increase", "axis"), ("experiment", "reading_hour", "task", "increase", "axis")
    each = ("experiment",)

    def stacked(name: str) -> np.ndarray:
        return np.array([getattr(f, name) for f in found])

    variables = {
        "place": Variable(each, np.array(list(places)), "number of the experiment", "1"),
        **experiment_variables(experiments),
        "probability": Variable(cell, stacked("probability"), "share of replicates that detect", "1"),
        "hour": Variable(cell, stacked("hour"), "median hour of detection, NaN below half", "h"),
        "reading_hour": Variable(("reading_hour",), np.array(["printed", "own"]), "when Tables V and VI are read"),
        "maximum": Variable(at, stacked("maximum"), "expected largest |torque|", "N m"),
        "variation": Variable(at, stacked("variation"), "expected coefficient of variation of |torque|", "1"),
        "signs": Variable(("experiment", "replicate"), stacked("signs"), "pairs with the sign of Table II", "1"),
        "right_pairs": Variable(
            ("experiment", "pair"), stacked("right_pairs"), "share of replicates with the sign of Table II", "1"
        ),
        "kl_maximum": Variable(
            ("experiment", "replicate"), stacked("kl_maximum"), "largest divergence of Figure 2", "1"
        ),
        "kept": Variable(("experiment", "task", "replicate"), stacked("kept"), "components kept", "1"),
        "located": Variable(each, stacked("located"), "detected runs whose axis is named", "1"),
        "alarms": Variable(each, stacked("alarms"), "alarms of a normal run", "1"),
        "distance": Variable(each, stacked("distance"), "distance from the paper", "1"),
    }
    write_dataset(path, {**variables, **(more or {})}, provenance.attributes(title, settings))
