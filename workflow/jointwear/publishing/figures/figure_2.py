"""Figure 2: KL divergence of every axis while one axis wears."""

from __future__ import annotations

from pathlib import Path

from matplotlib.axes import Axes

from jointwear.publishing.figures import palette
from jointwear.publishing.figures.curves import DivergenceCurves, divergence_curves
from jointwear.publishing.figures.style import direct_label, new_figure, save
from jointwear.reproduction.published import load_published


def _draw(axes: Axes, curves: DivergenceCurves, order: list[int], replicate: int, banded: list[int]) -> None:
    """Draw the medians of all axes in `order` (0-based, the worn one last), with ranges for those in `banded`."""
    kl, worn = curves.divergence, order[-1]
    for rank, j in enumerate(order):
        colour, dashes = palette.axis_colour(j + 1), palette.axis_dashes(j + 1)
        if j in banded:
            axes.fill_between(curves.hour, kl.low[:, j], kl.high[:, j], color=colour, alpha=0.18, linewidth=0)
        axes.plot(
            curves.hour,
            kl.median[:, j],
            color=colour,
            linestyle=dashes,
            linewidth=2.2 if j == worn else 1.3,
            alpha=1.0 if j in banded else 0.5,
            label=f"axis {j + 1}" + (" (worn)" if j == worn else ""),
            zorder=3 + rank,
        )
    axes.plot(
        curves.hour,
        kl.single[:, worn],
        color=palette.axis_colour(worn + 1),
        linewidth=0.7,
        label=f"axis {worn + 1}, replicate {replicate}",
        zorder=2.5,
    )
    axes.set(xlabel="time since the start of wear [h]", xlim=(0, float(curves.hour[-1])))


def draw_figure_2(features: str | Path, published: str | Path, output: str | Path, replicate: int) -> None:
    """Draw the median over replicates of every axis and the 5 to 95 % range, the worn axis in front.

    Where the worn axis stays far below the top of the plot, a second panel shows its range enlarged.

    Parameters
    ----------
    features : features of the worn run to show.
    published : the paper's values; its drawn range is marked where the run is the paper's.
    output : SVG file.
    replicate : drawn as a thin line for the worn axis, 1-based.
    """
    printed, curves = load_published(published), divergence_curves(features, replicate)
    cell, kl = curves.cell, curves.divergence
    worn = cell.axis - 1
    order = [j for j in range(kl.median.shape[1]) if j != worn] + [worn]
    top, enlarged, told = float(kl.high.max()), float(kl.high[:, worn].max()), ""
    if cell == printed.lag_cell:
        low, high = printed.data["figures"]["fig_2"]["y_range_nat"]
        top = max(top, high)
        told = f" The paper's plot spans {low:g} to {high:g} nat."
    two = 0 < enlarged < top / 3
    figure = new_figure(3.5)
    panels = figure.subplots(1, 2 if two else 1, squeeze=False)[0]
    for axes, limit, banded in zip(panels, (max(top * 1.12, 1e-3), enlarged * 1.15), (order, [worn]), strict=False):
        _draw(axes, curves, order, replicate, banded)
        axes.set_ylim(0, limit)
    panels[0].set_ylabel("KL divergence [nat]")
    if told:
        panels[0].axhline(high, color=palette.PUBLISHED, linewidth=1.2)
        direct_label(panels[0], 0, high, f"top of the paper's plot, {high:g} nat", palette.PUBLISHED, offset=(3, 4))
    if two:
        panels[0].set_title("whole range")
        panels[1].set_title(f"range of axis {cell.axis}, enlarged")
    handles, labels = panels[0].get_legend_handles_labels()
    by_axis = sorted(zip(labels, handles, strict=True), key=lambda pair: ("replicate" in pair[0], pair[0]))
    figure.legend(
        [h for _, h in by_axis], [text for text, _ in by_axis], loc="outside upper center", ncols=4, handlelength=2.8
    )
    name = f"KL divergence of every axis, task {cell.task}, wear of {cell.increase_percent:g} % on axis {cell.axis}"
    others = max((kl.median[-1, j] for j in order[:-1]), default=0.0)
    save(
        figure,
        output,
        name,
        f"{name}: median and 5 to 95 % range over {len(curves.peak)} replicates. At the end the worn axis stands at "
        f"{kl.median[-1, worn]:.2g} nat ({kl.low[-1, worn]:.2g} to {kl.high[-1, worn]:.2g}), the medians of the others "
        f"at {others:.2g} nat or less.{told}",
    )
