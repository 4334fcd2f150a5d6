"""The worn runs of the paper's grid, and which of them a result file belongs to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.storage import open_dataset


@dataclass(frozen=True, order=True)
class Cell:
    """One worn run: task, growth of the friction [%], 1-based axis."""

    task: str
    increase_percent: float
    axis: int

    @property
    def attributes(self) -> dict[str, Any]:
        """Global attributes that name the run in each of its result files."""
        return {"task": self.task, "increase_percent": self.increase_percent, "worn_axis": self.axis}


def cell_in(path: str | Path) -> Cell | None:
    """Return the worn run that a result file names, None for one of another run.

    Raises
    ------
    InputError : if the file cannot be read.
    """
    with open_dataset(path) as dataset:
        if "worn_axis" not in dataset.ncattrs():
            return None
        return Cell(str(dataset.task), float(dataset.increase_percent), int(dataset.worn_axis))


def cell_of(path: str | Path) -> Cell:
    """Return the worn run that a result file belongs to.

    Raises
    ------
    InputError : if the file cannot be read, or is not that of a worn run.
    """
    cell = cell_in(path)
    if cell is None:
        raise InputError(f"{path}: is not the file of a worn run: it has no attribute 'worn_axis'")
    return cell


def run_attributes(path: str | Path) -> dict[str, Any]:
    """Return the attributes with which a result made from `path` names the same run; none unless a run with wear."""
    cell = cell_in(path)
    return {} if cell is None else cell.attributes


def worn_runs(paths: Iterable[str | Path]) -> dict[Cell, str]:
    """Return the files of worn runs among those of all runs, as :func:`by_cell`."""
    return by_cell([path for path in paths if cell_in(path) is not None])


def by_cell(paths: Iterable[str | Path]) -> dict[Cell, str]:
    """Return the files of worn runs by cell, in the order of the paper's tables: task, increase, axis.

    Raises
    ------
    InputError : as :func:`cell_of`.
    """
    return dict(sorted((cell_of(p), str(p)) for p in paths))
