"""What every reader yields, and what it needs to know."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from jointwear.files.errors import InputError, shown
from jointwear.files.wording import count as counted
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.programs import with_log_name
from jointwear.measurement.late_samples import LATE
from jointwear.measurement.possible import LARGEST_LABEL, possible, without_sentinels
from jointwear.measurement.units import CURRENTS, SHARES, UNITS, converted, spelled

JOINT_ROLES = ("position", "velocity", "acceleration", "torque", "temperature")
NEEDED = ("time", "position", "torque")
#: Keys of the config that turn or scale what is logged.
FACTORS = ("torque_constant", "scale", "sign")
#: In place of a label that is none: no whole number, or one that cannot be stored.
UNLABELLED = -LARGEST_LABEL - 1
#: Times between these count as seconds since 1970 UTC: 2001 to 2286.
UNIX_TIMES = (1e9, 1e10)
_EPOCHS = (1e3, 1e6, 1e9)


class RowsLeftOut(InputError):
    """Said after the last sample: all was read but rows of a wrong length, or of times that do not exist."""


@dataclass(frozen=True)
class Chunk:
    """Samples of a robot with n joints, in the order of the log.

    `time` (m,) [s], since 1970 UTC where `dated`. `position`, `torque` (m, n) [rad], [N m]; `velocity`,
    `acceleration`, `temperature` (m, n) or None where the log has none. `trajectory` (m,) integer label,
    :data:`UNLABELLED` where there is none, or None; `program` (m,) text, empty where unknown, or None. `units`: role ->
    unit that the config or the log states, as :data:`~jointwear.measurement.units.UNITS` spells it. `factors`: those
    of the config that the arrays are multiplied by already, :class:`~jointwear.measurement.stated.Stated`. `missing`:
    role -> values that were read as missing. `unread`: how many rows held a cell that cannot be read, which was left
    out, and the first of them in words. `no_label`: what the log has in place of the first label that is none, in
    words. `none_such`: how many rows have a time that does not exist in the zone of the
    log, NaN, and the first of them in words.
    """

    time: np.ndarray
    position: np.ndarray
    torque: np.ndarray
    velocity: np.ndarray | None = None
    acceleration: np.ndarray | None = None
    temperature: np.ndarray | None = None
    trajectory: np.ndarray | None = None
    program: np.ndarray | None = None
    dated: bool = False
    units: Mapping[str, str] = field(default_factory=dict)
    factors: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    missing: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    unread: tuple[int, str] = (0, "")
    none_such: tuple[int, str] = (0, "")
    no_label: str = ""


#: What a chunk has for each of its samples.
_ARRAYS = ("time", *JOINT_ROLES, "trajectory", "program")


def rows_of(chunk: Chunk, chosen: slice | np.ndarray) -> Chunk:
    """Return some rows of a chunk; `chosen`, a slice, an index or a mask (m,)."""
    return replace(chunk, **{name: None if (x := getattr(chunk, name)) is None else x[chosen] for name in _ARRAYS})


def joined(chunks: Sequence[Chunk], fill: bool = False) -> Chunk:
    """Return the chunks of one log that follow each other as one; `unread`, `no_label` and `none_such` are not kept.

    Parameters
    ----------
    fill : NaN stands where some chunks lack a joint role, as messages of a bag may; else such a role is left out, so
        that it is derived throughout.
    """

    def whole(role: str) -> np.ndarray | None:
        parts = [getattr(chunk, role) for chunk in chunks]
        given = [part for part in parts if part is not None]
        if not given or (len(given) < len(parts) and not (fill and role in JOINT_ROLES)):
            return None
        shape = given[0].shape[1:]
        return np.concatenate(
            [np.full((len(c.time), *shape), np.nan) if p is None else p for p, c in zip(parts, chunks, strict=True)]
        )

    missing = {
        role: tuple(sorted({x for chunk in chunks for x in chunk.missing.get(role, ())}))
        for role in dict.fromkeys(role for chunk in chunks for role in chunk.missing)
    }
    dated = all(chunk.dated for chunk in chunks)
    said = {"units": chunks[0].units, "factors": chunks[0].factors}
    return Chunk(**{role: whole(role) for role in _ARRAYS}, dated=dated, missing=missing, **said)


def unread_in_words(told: Iterable[tuple[int, str]]) -> str:
    """Return what the `unread` of chunks says together, empty where all was read."""
    found = [(count, words) for count, words in told if count]
    more = sum(count for count, _ in found) - 1
    if not found:
        return ""
    others = f", and {more} more rows hold such a cell" if more else ""
    return f"{found[0][1]}{others}; what cannot be read was left out as missing"


def make_chunk(
    path: Path,
    values: Mapping[str, np.ndarray],
    layout: Layout,
    units: Mapping[str, str | list[str]],
    dated: bool,
) -> Chunk:
    """Return a chunk from raw values: units converted, shapes checked.

    Parameters
    ----------
    values : role -> array; joint roles (m, n), temperature also (m,).
    units : role -> unit as the log says, or one for each column; the config goes before it.
    dated : whether time is already in seconds since 1970 UTC.

    Raises
    ------
    InputError : if an array has not the shape of its role, or the layout another count of joints; if the config has one
        unit for columns of which the log says that they differ.
    """
    axes = layout.axes or int(np.prod(np.shape(values["position"])[1:]))
    factors = {key: given for key in FACTORS if (given := getattr(layout, key)) is not None}
    for key, given in factors.items():
        if len(given) not in (1, axes):
            raise InputError(f"{path}: '{key}' has {counted(len(given), 'value')} for {counted(axes, 'joint')}")
    found: dict[str, np.ndarray] = {}
    stated: dict[str, str] = {}
    missing: dict[str, tuple[float, ...]] = {}
    for role, raw in values.items():
        if role == "program":
            continue
        array = np.asarray(raw, dtype=float)
        unit = None if role == "time" and dated else layout.units.get(role, units.get(role))
        apart = units.get(role)
        if isinstance(apart, list):
            _check_apart(path, role, apart, layout)
            unit = next(iter(UNITS[role]))
        if unit is not None:
            stated[role] = spelled(role, unit)
        if role in JOINT_ROLES:
            # As logged: once scaled, -9999 A is a torque like any other.
            array, marks = without_sentinels(array)
            missing |= {role: marks} if marks else {}
            if isinstance(apart, list) and array.shape[1:] == (len(apart),):
                columns = [converted(x, role, u, str(path)) for x, u in zip(array.T, apart, strict=True)]
                array = np.stack(columns, axis=1)
        if role == "torque":
            if layout.torque_constant is not None:
                stated.setdefault(role, "A")
            array, unit = _as_torque(path, array, unit, layout)
        try:
            found[role] = converted(array, role, unit, str(path))
        except InputError as error:
            raise InputError(str(error).replace("data set '", "log '", 1)) from None
    if not dated:
        found["time"], dated = _in_seconds(found["time"], stated="time" in layout.units)
    count = len(found["time"])
    for role in JOINT_ROLES:
        if role in found:
            found[role] = _of_joints(path, role, found[role], count, axes, layout)
    trajectory, no_label = found.pop("trajectory", None), ""
    if trajectory is not None:
        with np.errstate(invalid="ignore"):
            known = (trajectory == np.round(trajectory)) & (np.abs(trajectory) <= LARGEST_LABEL)
        if not known.all():
            value = float(trajectory[np.argmin(known)])
            no_label = "no number" if np.isnan(value) else f"{value:.10g}"
        trajectory = np.where(known, trajectory, UNLABELLED).astype(np.int64)
    program = with_log_name(path, layout, values.get("program"), count)
    said = {"units": stated, "factors": factors}
    labels = {"trajectory": trajectory, "no_label": no_label}
    return Chunk(**found, **labels, program=program, dated=dated, missing=missing, **said)


def _check_apart(path: Path, role: str, apart: list[str], layout: Layout) -> None:
    """Check that columns of a role in units of their own can be read.

    Raises
    ------
    InputError : where the config states one unit for all of them, or some are no torque.
    """
    told = " and ".join(f"'{unit}'" for unit in dict.fromkeys(apart))
    if role in layout.units:
        raise InputError(
            f"{path}: the log says {told} for {role}, 'units' of the configuration '{layout.units[role]}' for "
            f"all columns; leave out {role} there, or write all columns in one unit"
        )
    if role == "torque" and any(spelled(role, unit) in (*CURRENTS, *SHARES) for unit in apart):
        raise InputError(f"{path}: the log says {told} for torque; write all columns in N m, or all as currents")


def _in_seconds(time: np.ndarray, stated: bool) -> tuple[np.ndarray, bool]:
    """Return times (m,) [s], and whether they count from 1970; `stated` says that their unit is."""
    known = time[np.isfinite(time)]
    if not len(known):
        return time, False
    # Milliseconds, microseconds or nanoseconds since 1970 can be nothing else: no other clock reads so much.
    sizes = (1.0,) if stated else (1.0, *_EPOCHS)
    kinds = np.array([(UNIX_TIMES[0] * k <= known) & (known < UNIX_TIMES[1] * k) for k in sizes])
    kind = np.where(kinds.any(axis=0), kinds.argmax(axis=0), len(sizes))
    # A few stamps of a clock that was not set yet decide nothing.
    shared = np.bincount(kind)[kind] > LATE
    of = int(kind[np.argmax(shared)])
    return time / (*sizes, 1.0)[of], of < len(sizes)


def _of_joints(path: Path, role: str, array: np.ndarray, count: int, axes: int, layout: Layout) -> np.ndarray:
    """Return the values (count, axes) of a joint role: one temperature for all joints, impossible values as NaN, the
    sign that is configured.

    Raises
    ------
    InputError : if they have another shape.
    """
    if role == "temperature" and (array.ndim == 1 or array.shape[1] == 1):
        array = np.broadcast_to(array.reshape(count, 1), (count, axes))
    if array.shape != (count, axes):
        if layout.axes and array.ndim == 2 and array.shape[1] != axes:
            raise InputError(
                f"{path}: {role} is of {counted(array.shape[1], 'joint')}, the robot file that 'robot' names "
                f"has {axes}: {shown(', '.join(layout.joints))}"
            )
        raise InputError(
            f"{path}: {role} has shape {array.shape}; {counted(count, 'sample')} of {counted(axes, 'joint')} are "
            "expected"
        )
    array = possible(array, role)
    return array * np.array(layout.sign) if layout.sign is not None and role in _SIGNED else array


#: Roles that turn round with an axis.
_SIGNED = ("position", "velocity", "acceleration", "torque")


def _as_torque(path: Path, array: np.ndarray, unit: str | None, layout: Layout) -> tuple[np.ndarray, str | None]:
    """Return what is logged as torque in N m (or another unit of torque, which is returned), scaled as configured.

    Raises
    ------
    InputError : where current or a share of a rating is logged and nothing says what torque it is.
    """
    stated = "" if unit is None else str(unit).strip()
    plain = spelled("torque", stated) if stated else ""
    if plain in SHARES:
        raise InputError(
            f"{path}: the torque is in '{plain}' of a rating; give 'units: {{torque: N m}}' and as 'scale' the torque "
            "in N m of one of them, for each axis"
        )
    if plain in CURRENTS or (layout.torque_constant is not None and not plain):
        if layout.torque_constant is None:
            raise InputError(
                f"{path}: the torque is logged as current in {plain}; give 'torque_constant' in N m/A on the joint "
                "side, for each axis"
            )
        array, unit = array * (CURRENTS.get(plain, 1.0) * np.array(layout.torque_constant)), None
    elif layout.torque_constant is not None:
        raise InputError(
            f"{path}: the torque is in '{stated}', and 'torque_constant' is for currents; leave it out, or give "
            "'units: {torque: A}'"
        )
    return (array if layout.scale is None else array * np.array(layout.scale)), unit
