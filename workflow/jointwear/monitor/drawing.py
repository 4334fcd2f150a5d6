"""Figures of the monitoring page, drawn from the state of a robot as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, tzinfo
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
#: Most steps between the ticks of an axis of a robot, and the gap between two of them as a share of their height.
TICKS, BETWEEN = 4, 0.14
#: Fewer are drawn as points with bars, more as a line with a band.
FEW_POINTS = 40
#: A band that is wider than this many times the usual one is cut at the edge of its row.
WIDE = 4.0


def _time_axis(state: RobotState, zone: tzinfo) -> tuple[np.ndarray, str]:
    """Return where the windows are on the axis of time, and its label."""
    middle = (state.start + state.end) / 2
    if state.dated:
        # Days since 1970 UTC, as matplotlib counts them; only the labels are in the zone.
        return middle / 86400.0, f"time, {getattr(zone, 'key', 'UTC')}"
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


class _Row:
    """Where the values of one robot axis lie in a panel that several share: from `foot` up to `foot` + 1."""

    def __init__(self, foot: float, *values: np.ndarray) -> None:
        known = np.concatenate([v[np.isfinite(v)] for v in values])
        low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
        room = 0.04 * (high - low) or 0.04 * abs(high) or 0.5
        self.foot, self.low, self.high, self.seen = foot, low - room, high + room, len(known) > 0

    def __call__(self, values: np.ndarray) -> np.ndarray:
        return self.foot + (np.asarray(values) - self.low) / (self.high - self.low)

    def ticks(self) -> tuple[np.ndarray, list[str]]:
        """Return where the ticks lie, and their labels."""
        from matplotlib.ticker import MaxNLocator, ScalarFormatter

        if not self.seen:
            return np.zeros(0), []
        found = MaxNLocator(TICKS, steps=[1, 2, 5, 10]).tick_values(self.low, self.high)
        found = found[(found > self.low) & (found < self.high)]
        form = ScalarFormatter(useOffset=False)
        form.create_dummy_axis()
        form.axis.set_view_interval(self.low, self.high)
        form.axis.set_data_interval(self.low, self.high)
        return self(found), form.format_ticks(found)


def draw_timeline(state: RobotState, name: str, output: str | Path, zone: tzinfo = UTC) -> None:
    """Draw an estimate of every axis over time in `zone`, with two standard deviations, baseline and alarms."""
    values, std, unit = state.estimates[name]
    time, label = _time_axis(state, zone)
    w, n = values.shape
    groups = np.array_split(np.arange(w), min(w, MOST_POINTS))
    at = time[[g[len(g) // 2] for g in groups]]
    figure = new_figure(0.45 + 1.15 * n, layout=None)
    # One panel for all axes, each in a row of its own: a panel for every axis takes three times as long.
    axes = figure.subplots()
    Margins(left=0.95, bottom=0.5, top=0.1).apply(figure, 1, 1)
    axes.axvspan(time[0], time[state.baseline - 1], color=palette.GRID, alpha=0.45, linewidth=0)
    told, places, labels = [], [], []
    for j in range(n):
        mean, error = _thin(values[:, j], std[:, j], groups)
        # The first windows of a series know little: a row as high as their band would show nothing else.
        wide = len(groups) >= FEW_POINTS and error > WIDE * _middle(error)
        row = _Row((n - 1 - j) * (1 + BETWEEN), *(np.where(wide, np.nan, mean + s * error) for s in (-2, 2)))
        colour = palette.axis_colour(j + 1)
        if not row.seen:
            axes.text(0.5, row.foot + 0.5, UNJUDGED, transform=axes.get_yaxis_transform(), ha="center", va="center",
                      color=palette.MUTED)  # fmt: skip
        elif len(groups) < FEW_POINTS:
            size = 2 * error / (row.high - row.low)
            axes.errorbar(at, row(mean), yerr=size, fmt="o", markersize=3, color=colour, linewidth=1.0)
        else:
            edges = (np.clip(row(mean + s * error), row.foot, row.foot + 1) for s in (-2, 2))
            axes.fill_between(at, *edges, color=colour, alpha=0.25, linewidth=0)
            axes.plot(at, np.clip(row(mean), row.foot, row.foot + 1), color=colour, linewidth=1.2)
        for k, alarm in enumerate(a for a in state.alarms if a["axis"] == j + 1):
            where = time[np.clip(np.searchsorted(state.end, alarm["time"]), 0, w - 1)]
            dashes = palette.DASHES[k % len(palette.DASHES)]
            axes.plot([where] * 2, [row.foot, row.foot + 1], color=palette.INK, linewidth=1.1, linestyle=dashes)
        axes.text(-0.105, row.foot + 0.5, f"axis {j + 1}\n[{unit}]", transform=axes.get_yaxis_transform(), rotation=90,
                  ha="center", va="center")  # fmt: skip
        axes.axhline(row.foot, color=palette.MUTED, linewidth=0.8)
        at_ticks, words = row.ticks()
        places += list(at_ticks)
        labels += words
        told.append(_told(state, j, mean))
    axes.set_yticks(places, labels)
    axes.set_ylim(0, n + (n - 1) * BETWEEN)
    axes.set_xmargin(0.02)
    axes.set_xlabel(label)
    if state.dated:
        _date_labels(axes, zone)
    title = f"{name.replace('_', ' ')} of every axis over time"
    save(figure, output, title, f"{title}; {'; '.join(told)}.")


def _middle(error: np.ndarray) -> float:
    known = error[np.isfinite(error)]
    return float(np.median(known)) if len(known) else np.inf


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
