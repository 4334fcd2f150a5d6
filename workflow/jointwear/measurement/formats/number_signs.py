"""What the points and commas in the numbers of a CSV log stand for, by its first rows."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from jointwear.files.errors import InputError, shown

#: Numbers with a decimal comma, and with a decimal point.
_COMMA = re.compile(r"\s*[-+]?\d+,\d+(e[-+]?\d+)?\s*", re.IGNORECASE)
_POINT = re.compile(r"\s*[-+]?\d*\.\d+(e[-+]?\d+)?\s*", re.IGNORECASE)
#: A number that may have a point between its thousands, and one that is too small for any.
_THOUSANDS, _BELOW = re.compile(r"\s*[-+]?[1-9]\d{0,2}\.\d{3}\s*"), re.compile(r"\s*[-+]?[1-9]\d{0,2}\s*")
#: Fewest numbers with three digits behind a point, and none with fewer, and fewest different whole numbers beside them:
#: a logger that leaves out zeros at the end writes one number in ten with fewer digits, and one in a thousand whole.
FEWEST, FEWEST_WHOLE = 10, 3


def decimal_sign(path: Path, columns: Mapping[str, Sequence[str]]) -> str:
    """Return the decimal sign of the numbers of a log, a point or a comma.

    Parameters
    ----------
    columns : name -> the first cells of each column that is read as numbers.

    Raises
    ------
    InputError : where one column has commas and another one points, or points stand between thousands.
    """
    commas = {name: found for name, cells in columns.items() if (found := _first(_COMMA, cells))}
    points = {name: found for name, cells in columns.items() if (found := _mostly(_POINT, cells))}
    mostly = {name: found for name in commas if (found := _mostly(_COMMA, columns[name]))}
    if mostly and points:
        (one, comma), (other, point) = next(iter(mostly.items())), next(iter(points.items()))
        raise InputError(
            f"{path}: column '{one}' holds {shown(comma)} and column '{other}' {shown(point)}: is the comma a decimal "
            "sign, or between thousands? Write all numbers with one decimal sign and nothing between thousands"
        )
    for name, cells in columns.items():
        parted = [cell for cell in cells if _THOUSANDS.fullmatch(cell)]
        below = sorted({cell.strip() for cell in cells if _BELOW.fullmatch(cell)})
        pointed = sum(bool(_POINT.fullmatch(cell)) for cell in cells)
        if len(parted) >= FEWEST and len(below) >= FEWEST_WHOLE and pointed == len(parted):
            raise InputError(
                f"{path}: column '{name}' holds {shown(parted[0].strip())} beside {shown(below[-1])}: is the point "
                "between thousands? Write the numbers without it, or all with the same number of decimals"
            )
    return "," if commas else "."


def _first(form: re.Pattern[str], cells: Sequence[str]) -> str:
    """Return the first cell of a form, empty where none is."""
    return next((cell for cell in cells if form.fullmatch(cell)), "")


def _mostly(form: re.Pattern[str], cells: Sequence[str]) -> str:
    """Return the first cell of a form where at least half of the cells with anything in them have it; else empty."""
    full = [cell for cell in cells if cell.strip()]
    found = [cell for cell in full if form.fullmatch(cell)]
    return found[0] if 2 * len(found) >= len(full) > 0 else ""
