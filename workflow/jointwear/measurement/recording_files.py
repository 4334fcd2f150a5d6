"""Read measured data of any supported layout into a :class:`Recording`, and keep recordings as netCDF."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.errors import InputError, nearest, shown
from jointwear.files.regular_files import check_regular
from jointwear.files.storage import Variable, open_dataset, read_attribute, read_variable, write_dataset
from jointwear.measurement.formats import Layout, read_log
from jointwear.measurement.formats.arrow import holds_numbers
from jointwear.measurement.formats.chunk import check_count, numbered_columns
from jointwear.measurement.formats.netcdf import floats
from jointwear.measurement.log_kinds import log_format
from jointwear.measurement.possible import LARGEST_LABEL, check_clock, possible, without_sentinels
from jointwear.measurement.recording import Recording
from jointwear.measurement.units import ROLES, UNITS, converted
from jointwear.robots.robot_file import read_robot_file

_JOINT_ROLES = ("position", "velocity", "acceleration", "torque", "temperature")


def load_recording(entry: Mapping[str, Any], name: str = "recording", root: str | Path = ".") -> Recording:
    """Read the data of one entry of ``discover.datasets``.

    Parameters
    ----------
    entry : `measured` (netCDF, CSV, Parquet or a ROS 2 bag), optional `joints` and `topic` of a bag, `variables`
        (role: name), `units` (role: unit), `train`,
        `test`.
    name : of the data set, for messages. root : folder that relative paths count from.

    Raises
    ------
    InputError : if a file, variable or unit is not known; the message names it and what there is.
    """
    path = Path(root) / entry["measured"]
    names = {role: role for role in ROLES} | dict(entry.get("variables") or {})
    for role in entry.get("variables") or {}:
        if role not in ROLES:
            raise InputError(
                f"data set '{name}': 'variables' has the role '{role}'{nearest(role, ROLES)} "
                f"(allowed: {', '.join(ROLES)})"
            )
    suffix = path.suffix.lower()
    if suffix in (".nc", ".nc4", ".cdf", ".netcdf"):
        found, units = _from_netcdf(path, names, set(entry.get("variables") or {}))
    elif suffix in (".csv", ".parquet"):
        found, units = _from_table(path, _read_table(path), names), {}
    elif log_format(path) == "bag":
        found, units = _from_bag(path, entry, names), {}
    else:
        raise InputError(
            f"{path}: unknown kind of file '{suffix}' (allowed: .nc, .csv, .parquet, .mcap, .db3, a bag's folder)"
        )
    for role, unit in (entry.get("units") or {}).items():
        if role not in UNITS:
            raise InputError(f"data set '{name}': 'units' has the role '{role}'{nearest(role, ROLES)}")
        units[role] = unit
    for role in ("time", "position", "torque"):
        if role not in found:
            raise InputError(f"{path}: has no {role} (looked for '{names[role]}'); name it under 'variables'")
    for role in list(found):
        values = without_sentinels(found[role]) if role in _JOINT_ROLES else found[role]
        found[role] = converted(values, role, units.get(role), name)
        if role in _JOINT_ROLES:
            found[role] = possible(found[role], role)
            if not np.isfinite(found[role]).any():
                raise InputError(f"{path}: {role} holds no number that an arm can have")
    _check_shapes(path, found)
    check_clock(path, found["time"])
    count = len(found["time"])
    if "trajectory" in found:
        labels = found["trajectory"]
        with np.errstate(invalid="ignore"):
            whole = (labels == np.round(labels)) & (np.abs(labels) <= LARGEST_LABEL)
        if not whole.all():
            raise InputError(f"{path}: '{names['trajectory']}' must hold whole numbers of at most {LARGEST_LABEL}")
        trajectory = labels.astype(int)
    else:
        trajectory = np.zeros(count, dtype=int)
    if np.any((np.diff(found["time"]) <= 0) & (np.diff(trajectory) == 0)):
        raise InputError(f"{path}: the time does not rise within a trajectory")

    def labels_of(key: str) -> tuple[int, ...] | None:
        return None if entry.get(key) is None else tuple(int(x) for x in entry[key])

    return Recording(
        time=found["time"],
        trajectory=trajectory,
        position=found["position"],
        torque=found["torque"],
        velocity=found.get("velocity"),
        acceleration=found.get("acceleration"),
        temperature=found.get("temperature"),
        train=labels_of("train"),
        test=labels_of("test"),
        name=name,
        encoder_step=None if entry.get("encoder_step") is None else float(entry["encoder_step"]),
        torque_kind=entry.get("torque_kind") or "motor",
        encoder_side=entry.get("encoder_side") or "motor",
    )


def _check_shapes(path: Path, found: Mapping[str, np.ndarray]) -> None:
    """Check that every role has a row for each sample and a column for each joint."""
    count, joints = len(found["time"]), found["position"].shape[1]
    for role in _JOINT_ROLES:
        shape = np.shape(found.get(role, found["position"]))
        if shape != (count, joints) and not (role == "temperature" and shape in ((count,), (count, 1))):
            raise InputError(f"{path}: {role} has shape {shape}; {count} samples of {joints} joints are expected")


def _from_netcdf(
    path: Path, names: Mapping[str, str], wanted: set[str]
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    found, units = {}, {}
    with open_dataset(path) as dataset:
        for role, variable in names.items():
            if not isinstance(variable, str):
                raise InputError(f"{path}: 'variables' names a list for {role}; a netCDF file has one variable for it")
            if variable not in dataset.variables:
                if role in wanted:
                    raise InputError(
                        f"{path}: has no variable '{variable}' for {role}{nearest(variable, dataset.variables)} "
                        f"(it has: {', '.join(dataset.variables)})"
                    )
                continue
            values = floats(path, dataset.variables[variable], read_variable(dataset, path, variable))
            dimensions = 1 if role in ("time", "trajectory") else 2
            if values.ndim != dimensions and not (role == "temperature" and values.ndim == 1):
                raise InputError(f"{path}: '{variable}' has {values.ndim} dimensions; {role} needs {dimensions}")
            found[role] = values
            unit = getattr(dataset.variables[variable], "units", None)
            if unit is not None:
                units[role] = str(unit)
    sizes = {role: len(values) for role, values in found.items()}
    if len(set(sizes.values())) > 1:
        raise InputError(f"{path}: variables differ in length ({', '.join(f'{r} {s}' for r, s in sizes.items())})")
    return found, units


def _from_bag(path: Path, entry: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, np.ndarray]:
    """Read the joint states of a ROS 2 bag; the time counts from its first message."""
    joints = entry.get("joints") or [joint["name"] for joint in read_robot_file(entry["robot"])["joints"]]
    layout = Layout(axes=len(joints), joints=tuple(joints), names=names, topic=entry.get("topic"))
    chunks = list(read_log(path, layout))
    found = {role: np.concatenate([getattr(c, role) for c in chunks]) for role in ("time", "position", "torque")}
    if all(c.velocity is not None for c in chunks):
        found["velocity"] = np.concatenate([c.velocity for c in chunks])
    found["time"] = found["time"] - found["time"][0]
    return found


def _read_table(path: Path) -> dict[str, np.ndarray]:
    """Return the columns of a table that hold numbers; text, such as notes, is left out."""
    check_regular(path)
    if path.suffix.lower() == ".parquet":
        try:
            import pyarrow.parquet as parquet
        except ImportError:
            raise InputError(f"{path}: reading Parquet needs the package pyarrow; install it or write CSV") from None
        try:
            with parquet.ParquetFile(path) as file:
                check_count(path, len(file.schema_arrow.names))
                table = file.read()
            _check_unique(path, table.column_names)
            return {
                name: np.asarray(column.to_numpy(), dtype=float)
                for name, column in zip(table.column_names, table.columns, strict=True)
                if holds_numbers(column.type)
            }
        except InputError:
            raise
        except Exception as error:  # the library raises whatever a damaged file causes
            raise InputError(f"{path}: is truncated or not a Parquet file ({error})") from None
    try:
        with path.open(encoding="utf-8", newline="") as file:
            header = next(csv.reader(file), None)
            if not header:
                raise InputError(f"{path}: is empty")
            header = [h.strip() for h in header]
            check_count(path, len(header))
            _check_unique(path, header)
            rows = np.genfromtxt(file, delimiter=",", dtype=float, ndmin=2)
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except (ValueError, csv.Error) as error:
        raise InputError(
            f"{path}: cannot be read as CSV ({error}); a data set is UTF-8 with commas between the columns and decimal "
            "points: write it so, or let learn_normal read it as the monitor does"
        ) from None
    if rows.size == 0 or rows.shape[1] != len(header):
        raise InputError(
            f"{path}: the header names {len(header)} columns, the rows have {rows.shape[1] if rows.size else 0}"
        )
    return dict(zip(header, rows.T, strict=True))


def _check_unique(path: Path, names: Sequence[str]) -> None:
    twice = next((name for name, count in Counter(names).items() if name and count > 1), None)
    if twice is not None:
        raise InputError(f"{path}: names the column '{shown(twice)[1:-1]}' twice")


def _from_table(path: Path, table: Mapping[str, np.ndarray], names: Mapping[str, str]) -> dict[str, np.ndarray]:
    found = {}
    for role, base in names.items():
        if role in ("time", "trajectory", "temperature") and isinstance(base, str) and base in table:
            found[role] = table[base]
            continue
        if role not in _JOINT_ROLES:
            continue
        if not isinstance(base, str):
            missing = [column for column in base if column not in table]
            if missing:
                raise InputError(
                    f"{path}: has no column {shown(missing[0])} of numbers for {role}{nearest(missing[0], table)}"
                )
            found[role] = np.stack([table[column] for column in base], axis=1)
            continue
        numbered = numbered_columns(table, base)
        if not numbered:
            continue
        if [k for k, _ in numbered] != list(range(1, len(numbered) + 1)):
            raise InputError(
                f"{path}: the columns '{base}_1', '{base}_2' ... have gaps ({', '.join(c for _, c in numbered)})"
            )
        found[role] = np.stack([table[column] for _, column in numbered], axis=1)
    return found


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
    """Read what :func:`write_recording` wrote."""
    with open_dataset(path) as dataset:
        name = str(read_attribute(dataset, path, "dataset"))
        labels = [np.atleast_1d(read_attribute(dataset, path, k)) for k in ("train", "test")]
        known = set(dataset.ncattrs()) & {"encoder_step", "torque_kind", "encoder_side"}
        told = {k: getattr(dataset, k) for k in known}
    try:
        train, test = (tuple(int(x) for x in given) for given in labels)
    except (TypeError, ValueError):
        raise InputError(f"{path}: 'train' and 'test' must be numbers; delete it and run again") from None
    step = told.get("encoder_step")
    found, _ = _from_netcdf(Path(path), {role: role for role in ROLES}, set())
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
