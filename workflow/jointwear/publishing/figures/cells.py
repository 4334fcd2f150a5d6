"""Which worn run a figure shows. Read by the Snakefile: nothing heavy is imported here."""

from __future__ import annotations

from collections.abc import Sequence

from jointwear.reproduction.grid import Cell


def figure_cell(wanted: Cell, tasks: Sequence[str], axes: Sequence[int], increases: Sequence[float]) -> Cell:
    """Return the run that a figure of the paper shows or, where the grid lacks it, the first run of the grid.

    Parameters
    ----------
    wanted : the run of the paper.
    tasks, axes, increases : the grid of the config, none of them empty.
    """
    grid = [Cell(task, float(increase), axis) for task in tasks for increase in increases for axis in axes]
    return wanted if wanted in grid else grid[0]
