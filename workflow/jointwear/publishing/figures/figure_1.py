"""Figure 1: friction torque of the worn axis while its Coulomb friction grows."""

from __future__ import annotations

from pathlib import Path

from jointwear.publishing.figures import palette
from jointwear.publishing.figures.curves import friction_curves
from jointwear.publishing.figures.style import direct_label, new_figure, save
from jointwear.reproduction.grid import cell_of
from jointwear.reproduction.published import load_published


def draw_figure_1(
    simulation: str | Path,
    robot: str | Path,
    task: str | Path,
    published: str | Path,
    output: str | Path,
    replicate: int,
) -> None:
    """Draw the friction torque in both directions, with the noise of one replicate as dots.

    Parameters
    ----------
    simulation : file of the worn run to show.
    robot, task : robot file and task file of that run.
    published : the paper's values; its drawn range is marked where the run is the paper's.
    output : SVG file.
    replicate : 1-based.
    """
    cell, printed = cell_of(str(simulation)), load_published(published)
    curves = friction_curves(simulation, robot, task, replicate)
    figure = new_figure(3.3)
    axes = figure.add_subplot()
    end = float(curves[0].hour[-1])
    told = []
    if cell == printed.lag_cell:
        low, high = printed.data["figures"]["fig_1"]["y_range_nm"]
        axes.axhspan(low, high, color=palette.PUBLISHED_AREA, linewidth=0, zorder=0)
        axes.axhline(low, color=palette.PUBLISHED, linewidth=0.8, zorder=0.5)
        axes.axhline(high, color=palette.PUBLISHED, linewidth=0.8, zorder=0.5)
        direct_label(axes, 0, high, f"the paper's plot: {low:g} to {high:g} N m", palette.PUBLISHED, offset=(3, 4))
        told.append(f"The paper's plot spans {low:g} to {high:g} N m.")
    for curve, colour, dashes in zip(curves, palette.SERIES, ("solid", palette.DASHES[1]), strict=False):
        speed = f"at {abs(curve.velocity):.2f} rad/s" if curve.velocity else "axis at rest, Coulomb part alone"
        label = f"{curve.direction} direction, {speed}"
        axes.plot(curve.hour, curve.measured, ".", markersize=3, color=colour, alpha=0.55)
        axes.plot(curve.hour, curve.friction, color=colour, linestyle=dashes, label=label)
        told.append(
            f"{curve.direction.capitalize()} direction: from {curve.friction[0]:.2f} to {curve.friction[-1]:.2f} N m."
        )
    axes.plot(
        [], [], ".", markersize=4, color=palette.MUTED, label=f"with disturbance and noise (replicate {replicate})"
    )
    axes.set(xlabel="time since the start of wear [h]", ylabel="size of friction torque [N m]", xlim=(0, end))
    axes.legend(loc="upper left", bbox_to_anchor=(0, 1.22), ncols=2, handlelength=2.4, borderaxespad=0)
    name = f"Friction torque of axis {cell.axis}, task {cell.task}, Coulomb growth of {cell.increase_percent:g} %"
    save(figure, output, name, f"{name} in {end:g} h (equation 7). " + " ".join(told))
