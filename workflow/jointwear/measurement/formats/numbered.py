"""The form of the names of columns with one for each joint: `position_1`, `q1`, `A1 Ist`, `elbow/torque`.orque`."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence

from jointwear.measurement.log_entries import JOINT


def form_of(columns: Collection[str], name: str, close: bool = True) -> str:
    """Return a name of the configuration with :data:`JOINT` in the place of the joint.

    Where it has none the number stands behind a line, as in `position_1`, and where no column has that behind the name
    itself, as in `q1`; the latter only if `close`.
    """
    if JOINT in name:
        return name
    forms = [f"{name}_{JOINT}", *([f"{name}{JOINT}"] if close else [])]
    return next((form for form in forms if numbered_columns(columns, form)), forms[0])


def column_of(form: str, joint: int | str) -> str:
    """Return the name of the column of one joint."""
    return form.replace(JOINT, str(joint))


def numbered_columns(columns: Iterable[str], form: str) -> list[tuple[int, str]]:
    """Return number and name of the columns of a form that has a number in the place of the joint, sorted by number."""
    first, *others = (re.escape(part) for part in form.split(JOINT))
    # The same number everywhere.
    pattern = re.compile(first + "([0-9]{1,6})" + r"\1".join(others))
    return sorted((int(m.group(1)), c) for c in set(columns) if (m := pattern.fullmatch(c)))


def named_columns(columns: Collection[str], form: str, joints: Sequence[str]) -> list[str]:
    """Return the columns of a form that has the name of each joint in its place; nothing where one of them lacks."""
    names = [column_of(form, joint) for joint in joints]
    return names if names and all(name in columns for name in names) else []


def forms_of_joints(columns: Sequence[str], joints: int | None) -> list[str]:
    """Return the forms of names with a number for each of so many joints, of two or more where None is known."""
    found: dict[str, list[str]] = {}
    for column in columns:
        for number in re.finditer(r"[0-9]{1,6}", column):
            found.setdefault(column[: number.start()] + JOINT + column[number.end() :], []).append(column)
    forms = []
    for form, named in found.items():
        numbers = [k for k, _ in numbered_columns(named, form)]
        if numbers and numbers[0] < 2 and len(numbers) == (joints or max(2, numbers[-1] - numbers[0] + 1)):
            forms.append(form)
    return forms
