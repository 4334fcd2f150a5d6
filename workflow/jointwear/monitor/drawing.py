"""Figures of the monitoring page, drawn from the state of a robot as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, tzinfo
from pathlib import Path

import numpy as np

from jointwear.monitor.judge import CHANGED, UNJUDGED
from jointwear.monitor.state import RobotState
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import Margins, new_figure, save

#: More windows than this are drawn as weighted means of neighbours.
MOST_POINTS = 360
#: The same over temperature, where every point is drawn with its bar.
MOST_MARKS = 90
#: Fewer are drawn as points with bars, more as a line with a band.
FEW_POINTS = 40


def _time_axis(state: RobotState, zone: tzinfo) -> tuple[np.ndarray, str]:
    """Return where the windows are on the axis of time, and its label."""
    middle = (state.start + state.end) / 2
    if state.dated:
        # Dates go to matplotlib as UTC, in which no hour comes twice; only the labels are in the zone.
        moments = np.array([datetime.fromtimestamp(t, tz=UTC) for t in middle])
        return moments, f"time, {getattr(zone, 'key', 'UTC')}"
    return (middle, "time of the logs [s]") if state.short else (middle / 3600, "time of the logs [h]")


def _thin(values: np.ndarray, std: np.ndarray, groups: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return weighted means and their standard deviations over groups of windows."""
    mean, error = np.full(len(groups), np.nan), np.full(len(groups), np.nan)
    for k, group in enumerate(groups):
        good = group[np.isfinite(values[group]) & (std[group] > 0)]
        if len(good):
            weight = 1 / std[good] ** 2
            mean[k], error[k] = np.average(values[good], weights=weight), np.sqrt(1 / weight.sum())
    return mean, error


def draw_timeline(state: RobotState, name: str, output: str | Path, zone: tzinfo = UTC) -> None:
    """Draw an estimate of every axis over time in `zone`, with two standard deviations, baseline and alarms."""
    values, std, unit = state.estimates[name]
    time, label = _time_axis(state, zone)
    w, n = values.shape
    groups = np.array_split(np.arange(w), min(w, MOST_POINTS))
    at = time[[g[len(g) // 2] for g in groups]]
    figure = new_figure(0.45 + 1.15 * n, layout=None)
    panels = figure.subplots(n, 1, sharex=True, squeeze=False)[:, 0]
    Margins(left=0.95, bottom=0.5, top=0.1, between=(0.0, 0.16)).apply(figure, 1, n)
    told = []
    for j, axes in enumerate(panels):
        mean, error = _thin(values[:, j], std[:, j], groups)
        colour = palette.axis_colour(j + 1)
        if len(groups) < FEW_POINTS:
            axes.errorbar(at, mean, yerr=2 * error, fmt="o", markersize=3, color=colour, linewidth=1.0)
        else:
            axes.fill_between(at, mean - 2 * error, mean + 2 * error, color=colour, alpha=0.25, linewidth=0)
            axes.plot(at, mean, color=colour, linewidth=1.2)
        axes.axvspan(time[0], time[state.baseline - 1], color=palette.GRID, alpha=0.45, linewidth=0)
        for k, alarm in enumerate(a for a in state.alarms if a["axis"] == j + 1):
            where = time[np.clip(np.searchsorted(state.end, alarm["time"]), 0, w - 1)]
            axes.axvline(where, color=palette.INK, linewidth=1.1, linestyle=palette.DASHES[k % len(palette.DASHES)])
        if not np.isfinite(mean).any():
            axes.text(0.5, 0.5, UNJUDGED, transform=axes.transAxes, ha="center", va="center", color=palette.MUTED)
            axes.set_yticks([])
        axes.set_ylabel(f"axis {j + 1}\n[{unit}]")
        told.append(_told(state, j, mean))
    panels[-1].set_xlabel(label)
    if state.dated:
        _date_labels(panels[-1], zone)
    title = f"{name.replace('_', ' ')} of every axis over time"
    save(figure, output, title, f"{title}; {'; '.join(told)}.")


def _told(state: RobotState, j: int, mean: np.ndarray) -> str:
    known = mean[np.isfinite(mean)]
    if not len(known):
        return f"axis {j + 1} cannot be judged"
    word = "changed" if (state.status[:, j] == CHANGED).any() else "no change found"
    return f"axis {j + 1} from {known[0]:.3g} to {known[-1]:.3g}, {word}"


def _date_labels(axes, zone: tzinfo) -> None:
    from matplotlib.dates import AutoDateLocator, ConciseDateFormatter

    locator = AutoDateLocator(minticks=3, maxticks=8, tz=zone)
    axes.xaxis.set_major_locator(locator)
    axes.xaxis.set_major_formatter(ConciseDateFormatter(locator, tz=zone))


def draw_temperature(state: RobotState, name: str, axes_shown: Sequence[int], output: str | Path) -> None:
    """Draw an estimate over temperature for some 0-based axes."""
    values, std, unit = state.estimates[name]
    columns = min(len(axes_shown), 3)
    rows = -(-len(axes_shown) // columns)
    figure = new_figure(0.5 + 1.8 * rows, layout=None)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    Margins(left=0.75, bottom=0.5, between=(0.75, 0.8)).apply(figure, columns, rows)
    for axes in panels[len(axes_shown) :]:
        axes.set_axis_off()
    for axes, j in zip(panels, axes_shown, strict=False):
        order = np.argsort(state.temperature[:, j], kind="stable")
        groups = np.array_split(order, min(len(order), MOST_MARKS))
        mean, error = _thin(values[:, j], std[:, j], groups)
        axes.errorbar(
            [float(np.median(state.temperature[g, j])) for g in groups],
            mean,
            yerr=2 * error,
            fmt="o",
            markersize=3.5,
            color=palette.axis_colour(j + 1),
            linewidth=0.8,
        )
        axes.set_title(f"axis {j + 1}")
        axes.set_xlabel("temperature [°C]")
        axes.set_ylabel(f"[{unit}]")
    title = f"{name.replace('_', ' ')} over temperature"
    words = "window" if len(state.start) <= MOST_MARKS else "group of windows of like temperature"
    save(figure, output, title, f"{title}, one point per {words} with two standard deviations.")
