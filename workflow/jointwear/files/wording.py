"""Words that messages have in common."""

from __future__ import annotations

from collections.abc import Iterable


def numbered(noun: str, numbers: Iterable[int]) -> str:
    """Return `joint 3`, `joints 1 and 2` or `joints 1, 2 and 5`, of a noun whose plural ends in s."""
    *others, last = [str(number) for number in numbers]
    return f"{noun}s {', '.join(others)} and {last}" if others else f"{noun} {last}"
