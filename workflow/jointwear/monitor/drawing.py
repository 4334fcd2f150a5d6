"""Figures of the monitoring page, drawn from the state of a robot as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, tzinfo
from pathlib import Path

import numpy as np

from jointwear.monitor.judge import CHANGED, UNJUDGED
from jointwear.monitor.state import RobotState
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.panels import Panel, Scale, limits, write_panels
from jointwear.publishing.figures.ticks import Ticks, date_ticks, number_ticks

#: Width of a figure [points]: text of 9 points is then 10 px or more on a page that shows it 480 px wide.
WIDTH = 475.2
#: Room [points] left of a panel for its labels, above the first one, below the last one, right of it.
LEFT, TOP, BOTTOM, RIGHT = 66.0, 8.0, 36.0, 8.0
#: Height of a panel over time, and the gap below it.
PANEL, BETWEEN = 71.0, 11.5
#: Height of a panel over temperature, its title above, its labels below it and left of it.
SQUARE, HEAD, FOOT, SIDE = 82.0, 18.0, 42.0, 54.0
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
        return middle, f"time, {getattr(zone, 'key', 'UTC')}"
    return (middle, "time of the logs [s]") if state.short else (middle / 3600, "time of the logs [h]")


def _thin(values: np.ndarray, std: np.ndarray, groups: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return weighted means and their standard deviations over groups of windows."""
    order = np.concatenate(groups)
    first = np.cumsum([0, *[len(g) for g in groups[:-1]]])
    good = (np.isfinite(values) & (std > 0))[order]
    weight = np.where(good, 1 / np.where(good, std[order], 1.0) ** 2, 0.0)
    total = np.add.reduceat(weight, first)
    pulled = np.add.reduceat(weight * np.where(good, values[order], 0.0), first)
    known = np.where(total > 0, total, np.nan)
    return pulled / known, 1 / np.sqrt(known)


def draw_timeline(state: RobotState, name: str, output: str | Path, zone: tzinfo = UTC) -> None:
    """Draw an estimate of every axis over time in `zone`, with two standard deviations, baseline and alarms."""
    values, std, unit = state.estimates[name]
    time, label = _time_axis(state, zone)
    w, n = values.shape
    groups = np.array_split(np.arange(w), min(w, MOST_POINTS))
    at = time[[g[len(g) // 2] for g in groups]]
    x = Scale(*limits(time), LEFT, WIDTH - RIGHT)
    ticks = date_ticks(x.low, x.high, zone) if state.dated else number_ticks(x.low, x.high, 8)
    panels, told = [], []
    for j in range(n):
        mean, error = _thin(values[:, j], std[:, j], groups)
        colour = palette.axis_colour(j + 1)
        top = TOP + j * (PANEL + BETWEEN)
        panel = Panel(x, Scale(*limits(mean - 2 * error, mean + 2 * error), top + PANEL, top), j + 1)
        panel.span(time[0], time[state.baseline - 1], palette.GRID)
        panel.ticks_of_x(ticks, j == n - 1, label if j == n - 1 else "")
        seen = bool(np.isfinite(mean).any())
        up = number_ticks(panel.y.low, panel.y.high, 4) if seen else Ticks(np.zeros(0), ())
        panel.ticks_of_y(up, (f"axis {j + 1}", f"[{unit}]"))
        if not seen:
            panel.words(UNJUDGED)
        elif len(groups) < FEW_POINTS:
            panel.bars(at, mean, 2 * error, colour)
        else:
            panel.band(at, mean - 2 * error, mean + 2 * error, colour)
            panel.line(at, mean, colour)
        for k, alarm in enumerate(a for a in state.alarms if a["axis"] == j + 1):
            where = time[np.clip(np.searchsorted(state.end, alarm["time"]), 0, w - 1)]
            panel.upright(where, palette.DASHES[k % len(palette.DASHES)])
        panel.frame()
        panels.append(panel)
        told.append(_told(state, j, mean))
    title = f"{name.replace('_', ' ')} of every axis over time"
    size = WIDTH, TOP + n * PANEL + (n - 1) * BETWEEN + BOTTOM
    write_panels(output, size, panels, title, f"{title}; {'; '.join(told)}.")


def _told(state: RobotState, j: int, mean: np.ndarray) -> str:
    known = mean[np.isfinite(mean)]
    if not len(known):
        return f"axis {j + 1} cannot be judged"
    word = "changed" if (state.status[:, j] == CHANGED).any() else "no change found"
    return f"axis {j + 1} from {known[0]:.3g} to {known[-1]:.3g}, {word}"


def draw_temperature(state: RobotState, name: str, axes_shown: Sequence[int], output: str | Path) -> None:
    """Draw an estimate over temperature for some 0-based axes."""
    values, std, unit = state.estimates[name]
    columns = min(len(axes_shown), 3)
    rows = -(-len(axes_shown) // columns)
    wide = (WIDTH - RIGHT) / columns
    panels = []
    for k, j in enumerate(axes_shown):
        order = np.argsort(state.temperature[:, j], kind="stable")
        groups = np.array_split(order, min(len(order), MOST_MARKS))
        mean, error = _thin(values[:, j], std[:, j], groups)
        at = np.array([float(np.median(state.temperature[g, j])) for g in groups])
        shown = np.isfinite(mean) & np.isfinite(at)
        at, mean, error = at[shown], mean[shown], error[shown]
        left, top = (k % columns) * wide + SIDE, (k // columns) * (HEAD + SQUARE + FOOT) + HEAD
        x = Scale(*limits(at), left, (k % columns + 1) * wide)
        panel = Panel(x, Scale(*limits(mean - 2 * error, mean + 2 * error), top + SQUARE, top), k + 1)
        panel.title(f"axis {j + 1}")
        panel.ticks_of_x(number_ticks(x.low, x.high, 4), name="temperature [°C]")
        panel.ticks_of_y(number_ticks(panel.y.low, panel.y.high), (f"[{unit}]",))
        panel.bars(at, mean, 2 * error, palette.axis_colour(j + 1))
        panel.frame()
        panels.append(panel)
    title = f"{name.replace('_', ' ')} over temperature"
    words = "window" if len(state.start) <= MOST_MARKS else "group of windows of like temperature"
    size = WIDTH, rows * (HEAD + SQUARE + FOOT)
    write_panels(output, size, panels, title, f"{title}, one point per {words} with two standard deviations.")
