"""Table II as a picture: published and reproduced lags between the axes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.patches import Rectangle

from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import new_figure, save
from jointwear.reproduction.tables import Row, read_table


def _matrix(rows: list[Row], column: str) -> np.ndarray:
    size = max((row["row_axis"] for row in rows), default=0)
    matrix = np.full((size, size), np.nan)
    for row in rows:
        if row[column] is not None:
            matrix[row["row_axis"] - 1, row["column_axis"] - 1] = row[column]
    return matrix


def draw_lag_map(table: str | Path, output: str | Path, replicate: int) -> None:
    """Draw the lags of Table II, the paper's beside those of the named replicate.

    Parameters
    ----------
    table : results/tables/table_ii.nc; without rows (the grid lacks the run) the figure says so.
    output : SVG file.
    replicate : named in the figure, 1-based.
    """
    rows = read_table(table)
    if not rows:
        figure = new_figure(0.8)
        figure.text(0.5, 0.5, "The run of Table II is not in the grid of this configuration.", ha="center", va="center")
        save(figure, output, "Lags of Table II", "The run of Table II is not in the grid of this configuration.")
        return
    panels = [
        ("published", _matrix(rows, "published")),
        (f"reproduced, replicate {replicate}", _matrix(rows, "reproduced")),
    ]
    largest = max(1.0, *(float(np.nanmax(np.abs(m), initial=0)) for _, m in panels))
    figure = new_figure(3.75)
    for axes, (title, matrix) in zip(figure.subplots(1, 2), panels, strict=True):
        n = len(matrix)
        for i in range(n):
            for j in range(n):
                value = matrix[i, j]
                if np.isnan(value):
                    continue
                colour = palette.mix(palette.DIVERGING, 0.5 + 0.5 * value / largest)
                axes.add_patch(Rectangle((j + 0.5, i + 0.5), 1, 1, facecolor=colour, edgecolor=palette.PAPER))
                axes.text(
                    j + 1,
                    i + 1,
                    f"{value:.0f}".replace("-", "−"),
                    ha="center",
                    va="center",
                    color=palette.text_on(colour),
                )
        axes.set(
            xlim=(0.5, n + 0.5), ylim=(n + 0.5, 0.5), aspect="equal", xticks=range(1, n + 1), yticks=range(1, n + 1)
        )
        axes.set(title=title, xlabel="axis j")
        if axes.get_subplotspec().is_first_col():
            axes.set_ylabel("axis i")
        axes.grid(False)
        axes.tick_params(length=0)
        for spine in axes.spines.values():
            spine.set_visible(False)
    first = rows[0]
    run = f"{first['task']}, wear of {first['increase_percent']:g} % on axis {first['axis']}"
    name = f"Lag [h] at maximum correlation, {run}"
    save(
        figure,
        output,
        name,
        f"{name}. Blue: axis j trails axis i; orange: it leads. The values are in the table beside the picture.",
    )
