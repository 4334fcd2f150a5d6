"""Numbers as text, the same way on every page and in every message."""

from __future__ import annotations

import math
import re
from typing import Any

MISSING = "–"
#: Below this a deviation would need more decimals than a table holds.
SMALLEST_STD = 1e-6
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
#: A digit behind a letter of a unit.
_POWER = re.compile(r"(?<=[A-Za-z])[0-9]")
_THIN = "\u202f"  # narrow space that does not break


def is_missing(value: Any) -> bool:
    """Whether there is no number to show."""
    return value is None or (isinstance(value, float) and math.isnan(value))


def number(value: float | None, digits: int = 3, plus: bool = False) -> str:
    """Return a number with `digits` significant digits; whole numbers of more digits stay whole."""
    if is_missing(value):
        return MISSING
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    size = abs(value)
    if size != 0 and (size < 1e-3 or size >= 1e5):
        mantissa, exponent = f"{value:.{max(digits - 1, 0)}e}".split("e")
        mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
        text = f"{mantissa}·10{str(int(exponent)).translate(_RAISED)}"
    else:
        whole = len(str(int(size))) if size >= 1 else (0 if size == 0 else math.floor(math.log10(size)) + 1)
        text = f"{value:.{max(digits - max(whole, 0) if size >= 1 else digits - whole, 0)}f}"
        if "." in text:
            text = text.rstrip("0").rstrip(".")
    if plus and value > 0:
        text = "+" + text
    return text.replace("-", "−")


def unit(text: str) -> str:
    """Return a unit as readers know it: kg m² for the kg m2 of files, °C for degC."""
    return _POWER.sub(lambda power: power[0].translate(_RAISED), text.replace("degC", "°C"))


def fixed(value: float | None, decimals: int, plus: bool = False) -> str:
    """Return a number with a fixed number of decimals, for columns of a table."""
    if is_missing(value):
        return MISSING
    text = f"{value:{'+' if plus else ''}.{decimals}f}"
    if float(text) == 0:
        text = text.lstrip("+-")
    return text.replace("-", "−")


def with_std(value: float | None, std: float | None, plus: bool = False) -> str:
    """Return a number ± its standard deviation, two digits of it, with as many decimals for the number (GUM 7.2.6).

    Without a deviation, or with one below :data:`SMALLEST_STD`, the number stands alone.
    """
    if is_missing(value) or is_missing(std) or not SMALLEST_STD <= std < math.inf:
        return number(value, plus=plus)
    # As rounded: 0.0996 is 0.10.
    decimals = max(1 - int(f"{std:.1e}".split("e")[1]), 0)
    return f"{fixed(value, decimals, plus)} ± {fixed(std, decimals)}"


def percent(share: float | None, decimals: int = 0, plus: bool = False) -> str:
    """Return a share as percent; with its sign where `plus`."""
    return MISSING if is_missing(share) else f"{fixed(100 * share, decimals, plus)}{_THIN}%"


def span(low: float | None, high: float | None, decimals: int) -> str:
    """Return a range, one number where both ends read the same."""
    if is_missing(low) or is_missing(high):
        return MISSING
    first, last = fixed(low, decimals), fixed(high, decimals)
    if first == last:
        return first
    # A dash between numbers is shorter, but beside a minus sign it misleads.
    return f"{first}–{last}" if low >= 0 else f"{first} to {last}"


def span_percent(low: float | None, high: float | None, decimals: int = 0) -> str:
    """Return a range of shares as percent."""
    if is_missing(low) or is_missing(high):
        return MISSING
    return f"{span(100 * low, 100 * high, decimals)}{_THIN}%"


def run_name(run: str) -> str:
    """Return the name of a run as people say it: axis1_10percent is "axis 1, 10 %"."""
    axis, _, growth = run.removeprefix("axis").removesuffix("percent").partition("_")
    return f"axis {axis}, {growth}{_THIN}%" if growth else run
