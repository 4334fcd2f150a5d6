"""Figure 4: path of the end effector of every task, from above and from the side."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from jointwear.files.storage import read_variables
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import new_figure, save
from jointwear.reproduction.published import load_published

_COLUMNS = 4
_VIEWS = (("top view", 0, 1, "y [m]"), ("side view", 0, 2, "z [m]"))


def draw_figure_4(trajectories: list[str], published: str | Path, output: str | Path) -> None:
    """Draw one column a task; start and stop are told apart by shape and colour.

    Parameters
    ----------
    trajectories : files results/trajectories/<task>.nc.
    published : the paper's values, for the range of its axes.
    output : SVG file.
    """
    low, high = load_published(published).data["figures"]["fig_4"]["axis_range_m"]
    paths = {Path(p).stem: read_variables(p, "end_effector", "waypoint") for p in trajectories}
    reach = max(float(np.abs(path).max()) for path, _ in paths.values())
    # The paper's axes, unless a task of the user reaches beyond them.
    span = (low, high) if low <= -reach and reach <= high else (-1.05 * reach, 1.05 * reach)
    # One column a task, the side view below the top view; a single task has them side by side.
    alone = len(paths) == 1
    columns = 2 if alone else min(len(paths), _COLUMNS)
    rows = 1 if alone else 2 * -(-len(paths) // columns)
    figure = new_figure(rows * (5.9 / columns + 0.25) + 0.3)
    grid = figure.add_gridspec(rows, columns)
    told = []
    for k, (task, (path, stops)) in enumerate(paths.items()):
        for row, (view, across, up, label) in enumerate(_VIEWS):
            place = grid[0, row] if alone else grid[2 * (k // columns) + row, k % columns]
            axes = figure.add_subplot(place)
            axes.plot(path[:, across], path[:, up], color=palette.SERIES[0], linewidth=1.4)
            axes.plot(0, 0, "+", color=palette.MUTED, markersize=6)
            for name, mark, colour, point in (
                ("start", "o", palette.SERIES[2], stops[0]),
                ("stop", "s", palette.SERIES[1], stops[-1]),
            ):
                axes.plot(
                    point[across],
                    point[up],
                    mark,
                    color=colour,
                    markersize=6.5,
                    markeredgecolor=palette.PAPER,
                    label=name,
                )
            axes.set(xlim=span, ylim=span, aspect="equal", title=f"{task}, {view}")
            if span == (low, high):
                ticks = np.linspace(low, high, 5)
                labels = [f"{t:g}".replace("-", "−") for t in ticks]
                axes.set_xticks(ticks, labels)
                axes.set_yticks(ticks, labels)
            if row == 1 or alone:
                axes.set_xlabel("x [m]")
            if k % columns == 0:
                axes.set_ylabel(label)
        if k == 0:
            handles = axes.get_legend_handles_labels()
        start, stop = (", ".join(f"{v:.2f}" for v in point) for point in (stops[0], stops[-1]))
        told.append(f"{task} from ({start}) m to ({stop}) m.")
    figure.legend(*handles, loc="outside lower center", ncols=2)
    name = "End-effector path of every task, top and side view"
    save(figure, output, name, f"{name}; x, y, z in the base frame. " + " ".join(told))
