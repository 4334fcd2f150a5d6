"""Names and units of a robot's logs, as its entry of the config tells them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from jointwear.files.errors import InputError, nearest
from jointwear.measurement.units import ROLES


@dataclass(frozen=True)
class Layout:
    """Names and units of a robot's logs.

    `axes` of the robot, or None where it is as many as the log has positions.
    `names`: role -> name in the log, or a list of names, one an axis. `given`: roles that the config names, which
    must be there. `units`: role -> unit. `joints`: names of the joints in messages, in order of the axes. `topic` of
    a bag, or None. `torque_constant` [N m/A], where the torque is logged as current; `scale` of the torque; `sign` of
    position and torque; each one an axis, or None. `time_zone` of stamps that do not name one (IANA), default UTC.
    `program`: columns that together name the program; `program_of`: (pattern, program) of the names of logs.
    """

    axes: int | None
    joints: tuple[str, ...]
    names: Mapping[str, str | Sequence[str]]
    given: frozenset[str] = frozenset()
    units: Mapping[str, str] = field(default_factory=dict)
    topic: str | None = None
    torque_constant: tuple[float, ...] | None = None
    scale: tuple[float, ...] | None = None
    sign: tuple[float, ...] | None = None
    time_zone: str | None = None
    program: tuple[str, ...] = ()
    program_of: tuple[tuple[str, str], ...] = ()


def layout_of(entry: Mapping[str, Any], joint_names: Sequence[str] | None) -> Layout:
    """Return the layout that an entry of ``monitor.robots`` or ``discover.datasets`` describes.

    Parameters
    ----------
    joint_names : of its robot, in order of the axes; None takes as many as the log has, which a bag does not tell.

    Raises
    ------
    InputError : if a role is not known.
    """
    for key in ("variables", "units"):
        for role in entry.get(key) or {}:
            if role not in ROLES:
                raise InputError(
                    f"config: '{key}' has the role '{role}'{nearest(role, ROLES)} (allowed: {', '.join(ROLES)})"
                )
    axes = None if joint_names is None else len(joint_names)
    variables, program = dict(entry.get("variables") or {}), entry.get("program") or {}
    columns = program.get("columns") or ()
    return Layout(
        axes=axes,
        joints=tuple(entry.get("joints") or joint_names or ()),
        names={role: role for role in ROLES} | variables,
        given=frozenset(variables),
        units=dict(entry.get("units") or {}),
        topic=entry.get("topic"),
        time_zone=entry.get("time_zone"),
        program=(columns,) if isinstance(columns, str) else tuple(columns),
        program_of=tuple((program.get("logs") or {}).items()),
        **{key: _each(entry.get(key), axes) for key in ("torque_constant", "scale", "sign")},
    )


def _each(given: Any, axes: int | None) -> tuple[float, ...] | None:
    """Return one number an axis of a key that may be one number, or just that one; None without the key."""
    if given is None:
        return None
    return tuple(float(x) for x in given) if isinstance(given, (list, tuple)) else (float(given),) * (axes or 1)
