"""Figure 3: Q residuals in training and under wear, with the control limit and the onset."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from jointwear.publishing.figures import palette
from jointwear.publishing.figures.curves import residual_curves
from jointwear.publishing.figures.style import direct_label, new_figure, save
from jointwear.reproduction.published import load_published
from jointwear.statistics.intervals import spread_over_replicates

#: Share of the worn hours beyond which a label has no room to the right of its line.
ROOM = 0.75


def _side(right: bool) -> dict:
    """Return how a label is placed to the right or to the left of its line."""
    return {"ha": "left", "offset": (4, 0)} if right else {"ha": "right", "offset": (-4, 0)}


def draw_figure_3(
    model: str | Path,
    detection: str | Path,
    published: str | Path,
    output: str | Path,
    replicate: int,
    confidence: float,
) -> None:
    """Draw the Q-statistic on a logarithmic scale: median, 5 to 95 % range and one replicate.

    Training is shown for as many hours as the worn run has, the last ones before the wear starts.

    Parameters
    ----------
    model, detection : normal model of the task and scores of the worn run.
    published : the paper's values; its onset is marked where the run is taken for the paper's.
    output : SVG file.
    replicate : 1-based.
    confidence : of the control limit, named in the figure.
    """
    printed, curves = load_published(published), residual_curves(model, detection, replicate)
    cell, end = curves.cell, float(curves.hour[-1])
    figure = new_figure(3.7)
    axes = figure.add_subplot()
    axes.set_yscale("log")
    shown = curves.training_hour > -end
    # A residual of zero, as a constant series has it or a model that keeps every component, has no place on a
    # logarithmic scale.
    floor = 1e-30
    for hour, q, part, colour, label in (
        (curves.training_hour, curves.training, shown, palette.SERIES[2], "training"),
        (curves.hour, curves.run, np.ones(len(curves.hour), dtype=bool), palette.SERIES[0], "wear"),
    ):
        low, high, median, single = (np.maximum(v[part], floor) for v in (q.low, q.high, q.median, q.single))
        axes.fill_between(hour[part], low, high, color=colour, alpha=0.2, linewidth=0)
        axes.plot(hour[part], single, color=colour, linewidth=0.6, label=f"{label}, replicate {replicate}")
        axes.plot(hour[part], median, color=colour, linewidth=2.0, label=f"{label}, median")
    limit = curves.limit
    axes.axhspan(max(float(limit.low), floor), max(float(limit.high), floor), color=palette.SERIES[1], alpha=0.25, lw=0)
    axes.axhline(
        max(float(limit.median), floor),
        color=palette.SERIES[1],
        linestyle=palette.DASHES[1],
        label=f"limit ({100 * confidence:g} %), median",
    )
    axes.axvline(0, color=palette.MUTED, linewidth=1.0)
    median, low, high = spread_over_replicates(curves.onset)
    detected = np.isfinite(curves.onset).mean()
    told = f"Detected in {100 * detected:.0f} % of {len(curves.onset)} replicates"
    bottom, top = axes.get_ylim()
    axes.set_ylim(bottom, top * (top / bottom) ** 0.2)
    # One label above the other, each on the side away from the other line: they stay apart wherever the lines are.
    upper, lower = (top * (top / bottom) ** share for share in (0.12, 0.03))
    paper = printed.data["figures"]["fig_3"]["onset_hours_after_start_of_wear"] if cell == printed.lag_cell else None
    if np.isfinite(median):
        axes.axvspan(low, high, color=palette.SERIES[5], alpha=0.25, linewidth=0)
        axes.axvline(median, color=palette.SERIES[0], linewidth=1.2)
        text = f"our onset {median:.0f} h"
        right = paper is not None and paper < median and median < ROOM * end
        direct_label(axes, median, upper, text, palette.SERIES[0], **_side(right))
        told += f", at the median hour {median:.0f} ({low:.0f} to {high:.0f})"
    told += "."
    if paper is not None:
        axes.axvline(paper, color=palette.PUBLISHED, linewidth=1.2, linestyle=palette.DASHES[2])
        right = not (np.isfinite(median) and paper < median) and paper < ROOM * end
        direct_label(axes, paper, lower, f"paper {paper:g} h", palette.PUBLISHED, **_side(right))
        told += f" The paper's figure has {paper:g} h."
    axes.set(
        xlabel="time since the start of wear [h] (training before 0)",
        ylabel="Q residual (log scale)",
        xlim=(float(curves.training_hour[shown][0]), end),
    )
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, handlelength=2.6)
    name = f"Q residuals, task {cell.task}, training and wear of {cell.increase_percent:g} % on axis {cell.axis}"
    save(figure, output, name, f"{name}, with the {100 * confidence:g} % limit. {told}")
