"""Table IV as a picture: detection probability and hour of every run, the paper's hour below."""

from __future__ import annotations

from pathlib import Path

from matplotlib.patches import Rectangle

from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import new_figure, save
from jointwear.reproduction.tables import read_table
from jointwear.reproduction.verdicts import NOT_COMPARABLE

_PANEL_COLUMNS = 2


def draw_detection_map(table: str | Path, output: str | Path) -> None:
    """Draw one panel for every growth, tasks across and axes down, coloured by detection probability.

    Parameters
    ----------
    table : results/tables/table_iv.nc.
    output : SVG file.
    """
    rows = read_table(table)
    increases = sorted({r["increase_percent"] for r in rows})
    tasks = list(dict.fromkeys(r["task"] for r in rows))
    axes_shown = sorted({r["axis"] for r in rows})
    columns = min(len(increases), _PANEL_COLUMNS)
    panels = -(-len(increases) // columns)
    figure = new_figure(panels * (0.46 * len(axes_shown) + 0.75), width=6.6 if columns > 1 or len(tasks) > 3 else 3.9)
    grid = figure.add_gridspec(panels, columns)
    for k, increase in enumerate(increases):
        axes = figure.add_subplot(grid[k // columns, k % columns])
        for row in rows:
            if row["increase_percent"] != increase:
                continue
            x, y = tasks.index(row["task"]), axes_shown.index(row["axis"])
            probability = row["detection_probability"]
            colour = palette.mix(palette.SEQUENTIAL, probability)
            ink = palette.text_on(colour)
            axes.add_patch(
                Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor=colour, edgecolor=palette.PAPER, linewidth=1.5)
            )
            hour = row["hour_median"]
            ours = f"{100 * probability:.0f} %" + ("" if hour is None else f", {hour:.0f} h")
            axes.text(x, y - 0.2, ours, ha="center", va="center", color=ink, fontsize=8.5, fontweight="bold")
            if row["published"] is not None:
                paper = f"paper: {row['published']:.0f} h"
            else:
                paper = "not comparable" if row["verdict"] == NOT_COMPARABLE else "paper: ×"
            axes.text(x, y + 0.24, paper, ha="center", va="center", color=ink, fontsize=7.5)
        axes.set(
            xlim=(-0.5, len(tasks) - 0.5),
            ylim=(len(axes_shown) - 0.5, -0.5),
            xticks=range(len(tasks)),
            yticks=range(len(axes_shown)),
            title=f"growth of {increase:g} %",
        )
        axes.set_xticklabels(tasks)
        axes.set_yticklabels([f"axis {a}" for a in axes_shown])
        axes.grid(False)
        axes.tick_params(length=0)
        for spine in axes.spines.values():
            spine.set_visible(False)
    detected = sum(r["detection_probability"] >= 0.5 for r in rows)
    name = "Detection probability and median hour of every run"
    save(
        figure,
        output,
        name,
        f"{name}; {detected} of {len(rows)} runs are detected in at least half of the replicates. A cross marks runs "
        "that the paper did not detect. The values are in the table beside the picture.",
    )
