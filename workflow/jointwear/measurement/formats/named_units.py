"""Units that a table tells: in the names of its columns, as ``position [deg]``, or in a row of units."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from jointwear.files.errors import InputError
from jointwear.measurement.units import CURRENTS, SHARES, UNITS, is_known, size_of, spelled

#: What stands in brackets at the end of the name of a column.
_IN_NAME = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]\s*$")


def is_unit(role: str, text: str) -> bool:
    """Return whether a text is a unit of a role, or of what is logged as its torque."""
    plain = spelled(role, text)
    return bool(text.strip()) and (is_known(role, plain) or (role == "torque" and plain in (*CURRENTS, *SHARES)))


def unit_of(cells: Sequence[str], role: str) -> str | list[str]:
    """Return the unit of a role, or one for each of its columns where they differ; a cell without one, as beside a cell
    that was merged, has that of the first."""
    stated = [cell for cell in cells if cell]
    if len({spelled(role, cell) for cell in stated}) < 2:
        return stated[0] if stated else ""
    return [cell or stated[0] for cell in cells]


def units_in_names(columns: Mapping[str, Sequence[str]]) -> dict[str, str | list[str]]:
    """Return role -> unit, or one for each column, where the names of columns hold one in brackets at their end.

    What is in brackets and is no unit of the role, as in ``position (raw)``, tells nothing.
    """
    found = {}
    for role, names in columns.items():
        if role not in UNITS or role == "trajectory":
            continue
        if unit := unit_of([_unit_in(role, name) for name in names], role):
            found[role] = unit
    return found


def without_units(role: str, columns: Iterable[str]) -> dict[str, str]:
    """Return name -> column: the names of columns, and those of a unit of the role in brackets without that.

    A name that is there as it is goes before one with a unit, and of two with a unit none is taken.
    """
    found = {column: column for column in columns}
    plain = [(_IN_NAME.sub("", column).rstrip(), column) for column in found if _unit_in(role, column)]
    times = Counter(name for name, _ in plain)
    return {name: column for name, column in plain if times[name] == 1} | found


def _unit_in(role: str, name: str) -> str:
    """Return the unit of a role that the name of a column holds in brackets at its end; empty where there is none."""
    match = _IN_NAME.search(name)
    return match[1] if match and role in UNITS and is_unit(role, match[1]) else ""


def with_names(
    path: Path, columns: Mapping[str, Sequence[str]], row: Mapping[str, str | list[str]], stated: Mapping[str, str]
) -> dict[str, str | list[str]]:
    """Return role -> unit of a table, or one for each column: that of the row of units, else of the names of columns.

    Parameters
    ----------
    columns : role -> names of columns. row : role -> unit of the row of units. stated : role -> unit of the
        configuration, which goes before both.

    Raises
    ------
    InputError : where the two tell different units and the configuration none.
    """
    named = units_in_names(columns)
    for role in named.keys() & row.keys() - stated.keys():
        count = len(columns[role])
        one, other = ([u] * count if isinstance(u, str) else u for u in (named[role], row[role]))
        for name, a, b in zip(columns[role], one, other, strict=True):
            if is_unit(role, b) and _size(role, a) != _size(role, b):
                raise InputError(
                    f"{path}: the name of the column '{name}' says '{a}', the row of units '{b}'; state which it is, "
                    f"as units: {{{role}: ...}}"
                )
    return {**named, **row}


def _size(role: str, unit: str) -> tuple[float, str]:
    """Return what two spellings of one unit have in common."""
    plain = spelled(role, unit)
    return (float(f"{size_of(role, plain):.9g}"), "" if is_known(role, plain) and role != "temperature" else plain)
