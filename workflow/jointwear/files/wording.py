"""Words that messages have in common."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def numbered(noun: str, numbers: Iterable[int], plural: str = "") -> str:
    """Return `joint 3`, `joints 1 and 2` or `joints 1, 2 and 5`; `plural` of a noun that does not take an s."""
    every = [str(number) for number in numbers]
    return f"{plural or noun + 's' if len(every) > 1 else noun} {listed(every)}"


def name_axes(axes: Sequence[int]) -> str:
    """Return `axis 3` or `axes 1, 2 and 5`, empty without any."""
    return numbered("axis", axes, "axes") if axes else ""


def count(many: int, noun: str, plural: str = "") -> str:
    """Return a count with its noun in singular or plural; `plural` of a noun that does not take an s."""
    return f"{many} {noun}" if many == 1 else f"{many} {plural or noun + 's'}"


def significant(value: float, digits: int = 3) -> str:
    """Return a number with `digits` significant digits, and no power of ten where people write none: 1000, 0.00101."""
    return f"{float(f'{value:.{digits}g}'):.10g}"


def digits_apart(value: float, other: float) -> int:
    """Return how many significant digits, three or more, tell two numbers apart: 5 for 0.98996 and 0.99.

    Where none of the ten that :func:`significant` writes do, it is three.
    """
    enough = (n for n in range(3, 11) if significant(value, n) != significant(other, n))
    return next(enough, 3)


def listed(words: Iterable[str]) -> str:
    """Return `a`, `a and b` or `a, b and c`; at least one word."""
    *others, last = words
    return f"{', '.join(others)} and {last}" if others else last
