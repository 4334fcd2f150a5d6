"""Read measured data of any supported layout into a :class:`Recording`, and keep recordings as netCDF."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, open_dataset, read_attribute, read_variable, write_dataset
from jointwear.measurement.formats import layout_of, read_log
from jointwear.measurement.formats.chunk import (
    JOINT_ROLES,
    NEEDED,
    UNLABELLED,
    Chunk,
    RowsLeftOut,
    joined,
    unread_in_words,
)
from jointwear.measurement.formats.netcdf import floats
from jointwear.measurement.log_kinds import log_format
from jointwear.measurement.possible import LARGEST_LABEL, check_clock
from jointwear.measurement.recording import Recording
from jointwear.measurement.row_order import rows_in_order
from jointwear.measurement.turns import unwrapped
from jointwear.measurement.units import ROLES
from jointwear.robots.robot_file import read_robot_file


def load_recording(entry: Mapping[str, Any], name: str = "recording", root: str | Path = ".") -> Recording:
    """Read the data of one entry of ``discover.datasets``, in any form that a log of a monitored robot may have.

    Parameters
    ----------
    entry : `measured` (netCDF, CSV, Parquet or a ROS 2 bag); of a bag also `joints` or the `robot` file that names
        them, and `topic`; optional `variables` (role: name), `units` (role: unit), `torque_constant`, `scale`, `sign`,
        `train`, `test`.
    name : of the data set, for messages. root : folder that relative paths count from.

    Raises
    ------
    InputError : if a file, variable or unit is not known; the message names it and what there is.
    """
    path = Path(root) / entry["measured"]
    joints = None
    if log_format(path) == "bag":
        joints = entry.get("joints") or [j["name"] for j in read_robot_file(Path(root) / entry["robot"])["joints"]]
    chunks, left_out = [], ""
    try:
        for chunk in read_log(path, layout_of(entry, joints)):
            chunks.append(chunk)
    except RowsLeftOut as told:
        # A write that was cut costs its row; the step in time beside it is a gap like any other.
        if not chunks:
            raise
        left_out = str(told).removeprefix(f"{path}: ")
    whole = joined(chunks)
    whole, without = _without_empty(path, whole)
    cells = unread_in_words(chunk.unread for chunk in chunks)
    check_clock(path, whole.time, whole.units.get("time", "s"))
    trajectory = np.zeros(len(whole.time), dtype=int) if whole.trajectory is None else whole.trajectory
    if (trajectory == UNLABELLED).any():
        label = (entry.get("variables") or {}).get("trajectory", "trajectory")
        row = int(np.argmax(trajectory == UNLABELLED))
        value = next(chunk.no_label for chunk in chunks if chunk.no_label)
        raise InputError(
            f"{path}: '{label}' must hold whole numbers of at most {LARGEST_LABEL}; sample {row + 1} holds {value}"
        )
    whole, trajectory, disordered = rows_in_order(whole, trajectory)
    _check_rises(path, whole.time, trajectory)

    def labels_of(key: str) -> tuple[int, ...] | None:
        return None if entry.get(key) is None else tuple(int(x) for x in entry[key])

    return Recording(
        # Counted from a date, times would leave fewer digits for the steps.
        time=whole.time - whole.time[0] if whole.dated else whole.time,
        trajectory=trajectory,
        position=unwrapped(whole.position),
        torque=whole.torque,
        velocity=whole.velocity,
        acceleration=whole.acceleration,
        temperature=whole.temperature,
        train=labels_of("train"),
        test=labels_of("test"),
        name=name,
        encoder_step=None if entry.get("encoder_step") is None else float(entry["encoder_step"]),
        torque_kind=entry.get("torque_kind") or "motor",
        encoder_side=entry.get("encoder_side") or "motor",
        units=whole.units,
        factors=whole.factors,
        missing=whole.missing,
        unread="; ".join(filter(None, (*without, left_out, disordered, cells))),
    )


def _without_empty(path: Path, whole: Chunk) -> tuple[Chunk, list[str]]:
    """Return a log without the roles of which no value can be used, and what went in words.

    Raises
    ------
    InputError : where it is the position or the torque, which nothing replaces.
    """
    empty = [r for r in JOINT_ROLES if (x := getattr(whole, r)) is not None and not np.isfinite(x).any()]
    for role in empty:
        if role in NEEDED:
            raise InputError(f"{path}: {role} holds no number that an arm can have")
    told = [f"the {role} holds no number that an arm can have and was left out" for role in empty]
    missing = {role: numbers for role, numbers in whole.missing.items() if role not in empty}
    return replace(whole, **dict.fromkeys(empty), missing=missing), told


def _check_rises(path: Path, time: np.ndarray, trajectory: np.ndarray) -> None:
    """Check that time rises within each trajectory.

    Raises
    ------
    InputError : with the first sample at which it does not, and how many there are.
    """
    wrong = np.flatnonzero((np.diff(time) <= 0) & (np.diff(trajectory) == 0))
    if not len(wrong):
        return
    first = int(wrong[0])
    how = "is that of" if time[first + 1] == time[first] else "lies before that of"
    order = np.lexsort((time, np.cumsum(np.diff(trajectory, prepend=trajectory[:1]) != 0)))
    sorts = bool(np.all((np.diff(time[order]) > 0) | (np.diff(trajectory[order]) != 0)))
    mend = "sort the rows by time, or" if sorts else "leave out rows that come twice, or"
    raise InputError(
        f"{path}: the time of sample {first + 2} ({time[first + 1]:.9g} s) {how} the sample before it, as of "
        f"{len(wrong)} of {len(time)} samples; within a trajectory the time has to rise: {mend} label the trajectories"
    )


def write_recording(recording: Recording, path: str | Path, settings: Mapping[str, Any]) -> None:
    """Keep a recording under native names; train and test labels become attributes."""
    count, n = recording.position.shape
    variables = {
        "joint": Variable(("joint",), np.arange(1, n + 1), "number of the joint", "1"),
        "time": Variable(("instant",), recording.time, "time", "s"),
        "trajectory": Variable(("instant",), recording.trajectory, "label of the trajectory", "1"),
        "position": Variable(("instant", "joint"), recording.position, "joint position", "rad"),
        "torque": Variable(("instant", "joint"), recording.torque, "measured torque, joint side", "N m"),
    }
    for role, unit in (("velocity", "rad/s"), ("acceleration", "rad/s2"), ("temperature", "degC")):
        values = getattr(recording, role)
        if values is not None:
            values = np.broadcast_to(values[:, None], (count, n)) if values.ndim == 1 else values
            variables[role] = Variable(("instant", "joint"), values, f"measured {role}", unit)
    attributes = provenance.attributes(f"measured data set {recording.name}, checked", settings)
    attributes |= {"dataset": recording.name, "train": list(recording.train), "test": list(recording.test)}
    attributes |= {"torque_kind": recording.torque_kind, "encoder_side": recording.encoder_side}
    if recording.encoder_step is not None:
        attributes["encoder_step"] = recording.encoder_step
    write_dataset(path, variables, attributes)


def read_recording(path: str | Path) -> Recording:
    """Read what :func:`write_recording` wrote.

    Raises
    ------
    InputError : if the file is none of these, or was changed or damaged since.
    """
    with open_dataset(path) as dataset:
        name = str(read_attribute(dataset, path, "dataset"))
        labels = [np.atleast_1d(read_attribute(dataset, path, k)) for k in ("train", "test")]
        known = set(dataset.ncattrs()) & {"encoder_step", "torque_kind", "encoder_side"}
        told = {k: getattr(dataset, k) for k in known}
        there = [role for role in ROLES if role in dataset.variables]
        found = {role: floats(path, dataset.variables[role], read_variable(dataset, path, role)) for role in there}
    try:
        train, test = (tuple(int(x) for x in given) for given in labels)
    except (TypeError, ValueError):
        raise InputError(f"{path}: 'train' and 'test' must be numbers; delete it and run again") from None
    step = told.get("encoder_step")
    return Recording(
        time=found["time"],
        trajectory=found["trajectory"].astype(int),
        position=found["position"],
        torque=found["torque"],
        velocity=found.get("velocity"),
        acceleration=found.get("acceleration"),
        temperature=found.get("temperature"),
        train=train,
        test=test,
        name=name,
        encoder_step=None if step is None else float(step),
        torque_kind=str(told.get("torque_kind", "motor")),
        encoder_side=str(told.get("encoder_side", "motor")),
    )
