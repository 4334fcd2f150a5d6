"""Files of the test: data sets as any user's, and apart from them the truth.

Data sets go into one folder a batch, with `cases.json` naming file, robot, training and held-out recordings. Truth goes
into one JSON and one netCDF file a batch, elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import read_json, write_json
from jointwear.files.provenance import attributes
from jointwear.files.storage import Variable, read_variables, write_dataset
from jointwear.studies.challenge.generate import TRUTH_STRIDE, CaseData, Truth


def write_case_data(path: str | Path, data: CaseData, title: str, settings: dict[str, Any]) -> None:
    """Write one data set in the native layout of measured data."""
    joints = ("time", "joint")
    variables = {
        "time": Variable(("time",), data.time, "time", "s"),
        "joint": Variable(("joint",), np.arange(1, data.position.shape[1] + 1, dtype="i4"), "number of the joint"),
        "trajectory": Variable(("time",), data.trajectory.astype("i4"), "number of the recording"),
        "position": Variable(joints, data.position, "joint position", "rad"),
        "torque": Variable(joints, data.torque, "motor torque on the joint side", "N m"),
        "temperature": Variable(joints, data.temperature, "motor temperature", "degC"),
    }
    if data.velocity is not None:
        variables["velocity"] = Variable(joints, data.velocity, "joint velocity", "rad/s")
    if data.acceleration is not None:
        variables["acceleration"] = Variable(joints, data.acceleration, "joint acceleration", "rad/s2")
    write_dataset(path, variables, attributes(title, settings))


def padded(arrays: Sequence[np.ndarray], least: tuple[int, ...] = (0, 0)) -> np.ndarray:
    """Stack arrays (..., k, n) of several lengths and numbers of joints; what one lacks is NaN.

    `least` (k, n) is the shape to fill where there are no arrays.
    """
    size = [max([least[d], *(a.shape[d] for a in arrays)]) for d in (-2, -1)]
    lead = arrays[0].shape[:-2] if len(arrays) else ()
    result = np.full((len(arrays), *lead, *size), np.nan)
    for k, array in enumerate(arrays):
        result[k, ..., : array.shape[-2], : array.shape[-1]] = array
    return result


def write_truth(
    json_path: str | Path, netcdf_path: str | Path, truths: Sequence[Truth], settings: dict[str, Any]
) -> None:
    """Write the truth of one batch: facts as JSON, noise-free torque as netCDF.

    Cases have their own numbers of samples and joints: arrays are filled up with NaN. Effects of all cases lie end to
    end along `effect`; `first_effect` (case) says where those of a case begin.
    """
    write_json(json_path, {"cases": [t.facts for t in truths]})
    counts = [len(t.effects) for t in truths]
    torque = padded([t.torque for t in truths])
    variables = {
        "case": Variable(("case",), np.array([t.facts["case"] for t in truths], dtype=object), "name of the case"),
        "torque": Variable(
            ("case", "sample", "joint"),
            torque.astype("f4"),
            f"torque without noise, every {TRUTH_STRIDE}th held-out sample, NaN where not judged",
            "N m",
        ),
        "measured": Variable(
            ("case", "sample", "joint"),
            padded([t.measured for t in truths]).astype("f4"),
            "torque as it was measured at the same samples",
            "N m",
        ),
        "given": Variable(
            ("case", "sample", "joint"),
            padded([t.given for t in truths]).astype("f4"),
            "torque of the given robot on the true motion at the same samples",
            "N m",
        ),
        "first_effect": Variable(("case",), np.cumsum([0, *counts[:-1]]).astype("i4"), "first row along effect"),
        "effect_torque": Variable(
            ("effect", "sample", "joint"),
            padded([term for t in truths for term in t.effects], np.shape(torque)[1:]).astype("f4"),
            "torque of each hidden effect at the same samples",
            "N m",
        ),
    }
    write_dataset(netcdf_path, variables, attributes("Truth of the hidden-effect test", settings))


def read_truth(json_path: str | Path, netcdf_path: str | Path) -> list[Truth]:
    """Read the truth of one batch.

    Raises
    ------
    InputError : naming the file, if it is missing or broken.
    """
    facts = read_json(json_path)["cases"]
    torque, measured, given, first, effects = read_variables(
        netcdf_path, "torque", "measured", "given", "first_effect", "effect_torque"
    )
    ends = [*first[1:], len(effects)]
    return [Truth(f, torque[k], effects[first[k] : ends[k]], measured[k], given[k]) for k, f in enumerate(facts)]
