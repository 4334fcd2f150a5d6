"""The files of one worn run over all stages, and the names of runs."""

from __future__ import annotations

import re
from dataclasses import dataclass

_CELL = re.compile(r"(?P<task>[^/]+)/axis(?P<axis>\d+)_(?P<increase>[0-9.]+)percent\.nc$")


@dataclass(frozen=True, order=True)
class Cell:
    """One worn run: task, growth of the friction [%], 1-based axis."""

    task: str
    increase_percent: float
    axis: int


def cell_of(path: str) -> Cell:
    """Return the worn run that a result file belongs to.

    Raises
    ------
    ValueError : if the path is not the file of a worn run.
    """
    match = _CELL.search(str(path))
    if match is None:
        raise ValueError(f"{path} is not the file of a worn run")
    return Cell(match["task"], float(match["increase"]), int(match["axis"]))


def by_cell(paths: list[str]) -> dict[Cell, str]:
    """Return the files of worn runs by cell, in the order of the paper's tables: task, increase, axis."""
    return dict(sorted((cell_of(p), str(p)) for p in paths))
