"""Which columns of a table hold which role: one for each joint, found by the form of their names."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path

from jointwear.files.errors import InputError, closest, nearest
from jointwear.files.wording import count as counted
from jointwear.measurement.formats.chunk import JOINT_ROLES, NEEDED
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.named_units import without_units
from jointwear.measurement.formats.numbered import (
    column_of,
    form_of,
    forms_of_joints,
    named_columns,
    numbered_columns,
)
from jointwear.measurement.log_entries import JOINT, names_allowed

#: Most columns of a table: eight roles of a thousand axes and what a logger writes beside them.
MOST_COLUMNS = 10_000
#: Most names that a message tells, and letters of each.
_MOST_NAMES, _LONGEST = 24, 120


def check_count(path: Path, count: int) -> None:
    """Check the number of columns of a table.

    Raises
    ------
    InputError : if there are more than :data:`MOST_COLUMNS`.
    """
    if count > MOST_COLUMNS:
        raise InputError(f"{path}: has {count} columns (allowed: at most {MOST_COLUMNS})")


def find_columns(path: Path, columns: Iterable[str], layout: Layout) -> dict[str, list[str]]:
    """Return role -> columns of a table.

    A joint role has one column an axis, by :mod:`.numbered`; a time may have two, :mod:`.two_times`.

    Raises
    ------
    InputError : if a role that is needed or named in the config is not there, or has another number of axes.
    """
    there = list(columns)
    check_count(path, len(there))
    found: dict[str, list[str]] = {}
    for role, name in layout.names.items():
        # `position_1 [deg]` is position_1.
        known = without_units(role, there)
        if not isinstance(name, str):
            found[role] = _listed(path, role, name, known, there, layout)
        elif name in known and role not in ("position", "velocity", "acceleration", "torque"):
            found[role] = [known[name]]
        elif role in JOINT_ROLES and (names := _of_joints(path, role, known, there, layout)):
            found[role] = [known[c] for c in names]
    for name in layout.program:
        if name not in there:
            raise InputError(
                f"{path}: has no column '{name}' of 'program.columns'{nearest(name, there)} (it has: {_few(there)})"
            )
    if layout.program:
        found["program"] = list(layout.program)
    lost = next((role for role in (*NEEDED, *sorted(layout.given)) if role not in found), None)
    if lost is not None:
        raise _without(path, lost, there, found, layout)
    wanted = {name for names in found.values() for name in names}
    twice = next((name for name, count in Counter(there).items() if count > 1 and name in wanted), None)
    if twice is not None:
        raise InputError(f"{path}: names the column '{twice}' twice")
    axes = layout.axes or len(found["position"])
    for role, names in found.items():
        if role in JOINT_ROLES and len(names) != axes and not (role == "temperature" and len(names) == 1):
            whose = "the robot" if layout.axes else "the position"
            raise InputError(
                f"{path}: has {counted(len(names), 'column')} of {role}, {whose} has {counted(axes, 'joint')}"
                f"{_next_missing(layout, role, names, axes, there)}"
            )
    return found


def _without(
    path: Path, role: str, there: Sequence[str], found: Mapping[str, Sequence[str]], layout: Layout
) -> InputError:
    """Return what is raised where a table has not the columns of a role; `found`: role -> columns of the others."""
    name = layout.names[role]
    looked = column_of(_form(role, there, layout), 1) if role in JOINT_ROLES else name
    if role in JOINT_ROLES and (label := _of_long_form(there)):
        return InputError(
            f"{path}: has no {role} (looked for '{looked}'); it looks like one row for each value, named in "
            f"'{label}', which is not read: write one row for each time and one column for each name, as "
            f"pandas does by table.pivot(index=..., columns='{label}', values=...) (it has: {_few(there)})"
        )
    taken = {column for columns in found.values() for column in columns}
    proposed = _one_a_joint(role, [column for column in there if column not in taken], layout)
    return InputError(
        f"{path}: has no {role} (looked for '{looked}'){nearest(looked, there)}; name it under 'variables'{proposed} "
        f"(it has: {_few(there)})"
    )


def _listed(
    path: Path, role: str, names: Sequence[str], known: Mapping[str, str], there: Sequence[str], layout: Layout
) -> list[str]:
    """Return the columns of a role that the configuration lists."""
    missing = next((c for c in names if c not in known), None)
    if missing is not None:
        # A column that the config names for something else is not the one that is looked for.
        named = {c for name in layout.names.values() for c in ([name] if isinstance(name, str) else name)}
        unused = [c for c in there if c not in named]
        has = f"not used: {_few(unused)}" if unused else f"it has: {_few(there)}"
        raise InputError(f"{path}: has no column '{missing}' for {role}{nearest(missing, unused)} ({has})")
    # That the joint roles have a name for each axis is asked of all of them together.
    fits, allowed = names_allowed(role, len(names))
    if len(names) not in fits:
        raise InputError(f"{path}: 'variables.{role}' has {counted(len(names), 'name')}; allowed: {allowed}")
    return [known[c] for c in names]


def _of_joints(path: Path, role: str, known: Mapping[str, str], there: Sequence[str], layout: Layout) -> list[str]:
    """Return the names of the columns of a joint role, one an axis, by the form that the configuration gives them."""
    form = _form(role, known, layout)
    numbered = numbered_columns(known, form)
    if not numbered:
        return named_columns(known, form, layout.joints) if JOINT in str(layout.names[role]) else []
    numbers = [k for k, _ in numbered]
    twice = next((pair for pair in pairwise(numbered) if pair[0][0] == pair[1][0]), None)
    if twice is not None:
        raise InputError(f"{path}: the columns '{twice[0][1]}' and '{twice[1][1]}' are of the same joint")
    if numbers[0] > 1 or numbers != list(range(numbers[0], numbers[0] + len(numbers))):
        lost = column_of(form, next(k for k in range(min(numbers[0], 1), numbers[-1]) if k not in numbers))
        raise InputError(
            f"{path}: the columns '{column_of(form, 1)}', '{column_of(form, 2)}' ... have gaps ({_few(there)}): "
            f"'{lost}' is missing{_what_mends(role, lost, layout, there)}"
        )
    return [name for _, name in numbered]


def _one_a_joint(role: str, there: Sequence[str], layout: Layout) -> str:
    """Return how a joint role may be named where columns have a number for each joint; else nothing."""
    forms = forms_of_joints(there, layout.axes) if role in JOINT_ROLES else []
    return f", as '{role}: \"{forms[0]}\"' if it is one of {_few([f'{f!r}' for f in forms])}" if forms else ""


def _form(role: str, known: Collection[str], layout: Layout) -> str:
    """Return the form of the names of a joint role. What nobody asks for is not looked for under a looser one."""
    return form_of(known, str(layout.names[role]), close=role in NEEDED or role in layout.given)


def _what_mends(role: str, lost: str, layout: Layout, there: Sequence[str]) -> str:
    """Return what to do where one column of a role is missing: look whether a column that nothing reads is it; of a
    torque that was not measured an empty one will do, for the monitor judges the other axes without."""
    clauses = []
    if other := _renamed(lost, layout, there):
        clauses.append(
            f"rename the column '{other}', which nothing reads, to '{lost}' in this log if it is that one, or name it "
            f"under 'variables' where all logs of the robot have it ({role}: [...], one column for each joint)"
        )
    if role == "torque":
        clauses.append(f"log '{lost}', or write it as an empty column to have the other axes monitored")
    return "".join(f"; {clause}" for clause in clauses)


def _renamed(lost: str, layout: Layout, there: Sequence[str]) -> str:
    """Return the column that a missing one may have become: of those that nothing reads, and that end in its number if
    in any, the one of the nearest name, or the only one; empty where none is likely."""
    read = set(layout.program)
    for role, name in layout.names.items():
        known = without_units(role, there)
        joints = numbered_columns(known, _form(role, known, layout)) if isinstance(name, str) else []
        names = [name, *(c for _, c in joints)] if isinstance(name, str) else name
        read |= {known[c] for c in names if c in known}
    number = re.compile(r"[0-9]+$")
    own = number.findall(lost)
    # What stands in brackets is no part of a name.
    unread = {re.sub(r"\s*[\[(][^\[\]()]*[\])]\s*$", "", c): c for c in there if c not in read}
    unread = {name: c for name, c in unread.items() if number.findall(name) in ([], own)}
    near = closest(lost, unread)
    return unread[near] if near else next(iter(unread.values())) if len(unread) == 1 else ""


def _next_missing(layout: Layout, role: str, names: Sequence[str], axes: int, there: Sequence[str]) -> str:
    """Return which numbered column a role with fewer `names` than axes has no more, and what to do; else nothing."""
    name = layout.names[role]
    if not isinstance(name, str) or not 0 < len(names) < axes:
        return ""
    form = _form(role, names, layout)
    (first, _), *_ = numbered_columns(names, form) or [(1, "")]
    lost = column_of(form, first + len(names))
    return f": '{lost}' is missing{_what_mends(role, lost, layout, there)}"


#: Columns of a table in long form: what names the quantity of a row, and what holds its value.
_NAMES_OF_LONG = ("tag", "variable", "name", "signal", "channel", "field", "_field", "metric", "key", "topic")
_VALUES_OF_LONG = ("value", "_value", "val")
#: Most columns that such a table has: those two, the time, and what a data base writes beside them.
_MOST_OF_LONG = 12


def _of_long_form(there: Sequence[str]) -> str:
    """Return the column that names the quantity of each row of a table in long form; empty where it is none."""
    plain = {name.strip().lower(): name for name in there}
    if len(there) > _MOST_OF_LONG or not any(name in plain for name in _VALUES_OF_LONG):
        return ""
    return next((plain[name] for name in _NAMES_OF_LONG if name in plain), "")


def _few(names: Sequence[str]) -> str:
    told = [name if len(name) <= _LONGEST else f"{name[:_LONGEST]}..." for name in names[:_MOST_NAMES]]
    return ", ".join(told) + (", ..." if len(names) > _MOST_NAMES else "")
