"""Check what an entry of the config tells of logs, as far as no log is needed for it.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from jointwear.files.errors import InputError, nearest, shown
from jointwear.files.wording import count
from jointwear.measurement.log_kinds import log_format
from jointwear.measurement.units import CURRENTS, ROLES, SHARES, UNITS, is_known, meant_unit, spelled

#: What stands for a joint in a name under `variables`: its number from 1 (or 0), or its name.
JOINT = "{}"
#: Keys that may hold one number for each joint.
PER_JOINT = ("torque_constant", "scale", "sign")


def names_allowed(role: str, axes: int) -> tuple[tuple[int, ...], str]:
    """Return how many names a role may have in a table of a robot with so many axes, and that in words."""
    if role == "time":
        return (1, 2), "one, or two: date and time of day, or seconds and nanoseconds"
    if role == "trajectory":
        return (1,), "one"
    return (1, axes), f"one, or {axes}, one a joint"


def check_log_entry(
    entry: Mapping[str, Any], where: str, robot: Mapping[str, Any], per_joint: Iterable[str] = PER_JOINT
) -> None:
    """Check `variables`, `units`, `joints` and what is given for each joint.

    Parameters
    ----------
    entry : of ``monitor.robots`` or ``discover.datasets``. where : the entry in words of the config.
    robot : its robot file as read. per_joint : keys that have a number for each joint if they hold a list.

    Raises
    ------
    InputError : naming the key, what is allowed and the nearest.
    """
    joints = robot["joints"]
    _check_roles(entry, where, len(joints))
    named = entry.get("joints")
    if named is not None and len(named) != len(joints):
        raise InputError(
            f"config: '{where}.joints' names {count(len(named), 'joint')}, robot '{robot['name']}' has {len(joints)}"
        )
    for key in per_joint:
        given = entry.get(key)
        if isinstance(given, (list, tuple)) and len(given) != len(joints):
            raise InputError(
                f"config: '{where}.{key}' has {count(len(given), 'value')}, robot '{robot['name']}' has "
                f"{count(len(joints), 'joint')}{_one_or_each(key, given, len(joints))}"
            )
    _check_of_bags(entry, where)


def _one_or_each(key: str, given: Sequence[float], joints: int) -> str:
    """Return how many numbers a key may have, and the one number where all that were given are alike."""
    alike = f"; the nearest valid value is {given[0]:g}, for all joints" if len(set(given)) == 1 and joints > 1 else ""
    if key == "sign":
        return f" (allowed: {joints} values, one for each joint)"
    return f" (allowed: one number for all joints, or {joints}, one for each){alike}"


def _check_of_bags(entry: Mapping[str, Any], where: str) -> None:
    """Refuse keys of bags that would have no effect: beside other logs, unless columns are named by the joints."""
    logs = [entry["measured"]] if "measured" in entry else entry.get("logs") or []
    kinds = [log_format(str(log)) for log in logs]
    by_name = any(JOINT in str(names) for names in (entry.get("variables") or {}).values())
    for key in ("topic",) if by_name else ("joints", "topic"):
        if entry.get(key) is not None and kinds and all(kind not in (None, "bag") for kind in kinds):
            raise InputError(
                f"config: '{where}.{key}' is for ROS 2 bags and says nothing of {shown(str(logs[0]))}; leave it out "
                "(columns are named under 'variables')"
            )


def _check_roles(entry: Mapping[str, Any], where: str, axes: int) -> None:
    """Check `variables` and `units`; raises as :func:`check_log_entry`."""
    for key in ("variables", "units"):
        for role in entry.get(key) or {}:
            if role not in ROLES:
                raise InputError(
                    f"config: '{where}.{key}' has the role '{role}'{nearest(role, ROLES)} (allowed: {', '.join(ROLES)})"
                )
    for role, names in (entry.get("variables") or {}).items():
        several = names if isinstance(names, (list, tuple)) else [names]
        fits, allowed = names_allowed(role, axes)
        if len(several) not in fits:
            raise InputError(
                f"config: '{where}.variables.{role}' has {count(len(several), 'name')}; allowed: {allowed}"
            )
        twice = next((n for k, n in enumerate(several) if n in several[:k]), None)
        if twice is not None and role != "temperature":
            raise InputError(
                f"config: '{where}.variables.{role}' has {shown(str(twice))} twice; each joint has a column of its own"
            )
    for role, unit in (entry.get("units") or {}).items():
        known = [*UNITS[role], *((*CURRENTS, *SHARES) if role == "torque" else ())]
        plain = spelled(role, unit)
        if role != "trajectory" and plain not in known and not is_known(role, plain):
            near = meant_unit(role, plain)
            raise InputError(
                f"config: '{where}.units.{role}' is {shown(str(unit))}{near} (allowed: {', '.join(known)})"
            )
