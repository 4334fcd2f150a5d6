"""Give the data sets of one batch to discovery and keep what it says. Never reads truth."""

from __future__ import annotations

import dataclasses
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.discovery.pipeline import MODELS, Discovery, discover
from jointwear.discovery.settings import Settings
from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.provenance import attributes
from jointwear.files.storage import Variable, open_dataset, write_dataset
from jointwear.measurement.recording import Recording, elapsed_time
from jointwear.robots.robot import Robot
from jointwear.studies.challenge.arms import given_robot
from jointwear.studies.challenge.case_files import padded

#: Held-out predictions are kept for every so many samples, as in the truth files.
STRIDE = 5


def read_recording(path: Path, train: Sequence[int], test: Sequence[int]) -> Recording:
    """Read one data set in the native layout.

    Raises
    ------
    InputError : naming the file, if it is missing or broken.
    """
    with open_dataset(path) as dataset:
        values = {name: np.asarray(v[...]) for name, v in dataset.variables.items() if name != "joint"}
    return Recording(**values, train=tuple(train), test=tuple(test), name=path.stem)


def with_words(recording: Recording, told: Mapping[str, Any]) -> Recording:
    """Return the recording with what the user says of it, as far as a recording can hold it."""
    fields = {f.name for f in dataclasses.fields(recording)}
    return dataclasses.replace(recording, **{k: v for k, v in told.items() if k in fields})


def solve(recording: Recording, robot: Robot, settings: Settings) -> tuple[dict[str, Any], np.ndarray, float]:
    """Return the verdict as in verdict.json (or {"refused": reason}), the torque of nominal, retuned and augmented
    model over every fifth held-out sample (3, k, n) [N m], and the processor time [s]."""
    start = time.process_time()
    held = np.flatnonzero(np.isin(recording.trajectory, recording.test))[::STRIDE]
    try:
        verdict = discover(recording, robot, settings)
    except InputError as error:
        nothing = np.full((len(MODELS), len(held), recording.joints), np.nan)
        return {"refused": str(error)}, nothing, time.process_time() - start
    seconds = time.process_time() - start
    torque = np.array([at_samples(verdict, verdict.torques[model], recording, held) for model in MODELS])
    return json.loads(verdict.to_json()), torque, seconds


def at_samples(verdict: Discovery, torque: np.ndarray, recording: Recording, wanted: np.ndarray) -> np.ndarray:
    """Return a model's torque at the wanted samples of the recording; discovery may have used other instants."""
    result = np.full((len(wanted), torque.shape[1]), np.nan)
    # Discovery lays recordings end to end, and of a high rate its first instant is not that of the recording.
    clock = elapsed_time(recording.time, recording.trajectory)[wanted]
    for label in np.unique(recording.trajectory[wanted]):
        mine, theirs = recording.trajectory[wanted] == label, verdict.sample_trajectory == label
        for joint in range(torque.shape[1]):
            result[mine, joint] = np.interp(clock[mine], verdict.sample_time[theirs], torque[theirs, joint])
    return result


def solve_batch(folder: str | Path, json_path: str | Path, netcdf_path: str | Path, settings: dict[str, Any]) -> None:
    """Solve every data set of a batch and write verdicts (JSON) and held-out predictions (netCDF).

    Parameters
    ----------
    folder : holds `cases.json` and one netCDF file a case. settings : of :class:`jointwear.discovery.Settings`.

    Raises
    ------
    InputError : if a file of the batch is missing or broken.
    """
    folder = Path(folder)
    listed = read_json(folder / "cases.json")
    entries, torques = [], []
    for case in listed["cases"]:
        recording = with_words(read_recording(folder / case["file"], case["train"], case["test"]), case["told"])
        robot = given_robot(case)
        said, torque, seconds = solve(recording, robot, Settings(inertial_prior=listed["inertial_prior"], **settings))
        entries.append({"case": case["case"], "seconds": round(seconds, 3), "verdict": said})
        torques.append(torque)
    write_json(json_path, {"cases": entries})
    variables = {
        "case": Variable(("case",), np.array([e["case"] for e in entries], dtype=object), "name of the case"),
        "model": Variable(("model",), np.array(MODELS, dtype=object), "model that predicts the torque"),
        "torque": Variable(
            ("case", "model", "sample", "joint"),
            padded(torques).astype("f4"),
            f"predicted torque, every {STRIDE}th held-out sample",
            "N m",
        ),
    }
    write_dataset(netcdf_path, variables, attributes("Predictions of the hidden-effect test", settings))
