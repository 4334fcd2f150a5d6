"""Figures of the monitoring page, drawn from the state of a robot as SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, tzinfo
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.monitor.judging.state import RobotState
from jointwear.monitor.presentation.condition import SHOWN_BY
from jointwear.monitor.watching.records import CHANGED, UNJUDGED
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import Margins, new_figure, save

#: More windows than this are drawn as weighted means of neighbours.
MOST_POINTS = 360
#: The same over temperature, where every point is drawn with its bar.
MOST_MARKS = 90
#: Most steps between the ticks of an axis of a robot, and the gap between two of them as a share of their height.
TICKS, BETWEEN = 4, 0.14
#: Length of a tick [points]; as far from it stands its label.
TICK = 3.5
#: Height of the row of an axis over time and over temperature [inches].
TIME_ROW, TEMPERATURE_ROW = 1.15, 0.95
#: Fewer are drawn as points with bars, more as a line with a band.
FEW_POINTS = 40
#: A pause that is longer than so many usual steps between points interrupts line and band: nothing was measured in it.
PAUSE = 4.0
#: Width of the line of the first alarm of an axis, and of those that tell it again [points].
FIRST_ALARM, NEXT_ALARM = 1.6, 0.6
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
        """Return where the ticks (k,) lie, in the panel, and their labels."""
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


class _Panel:
    """One panel in which each axis has a row of its own; a panel for each takes three times as long."""

    def __init__(self, rows: int, height: float) -> None:
        """Begin a figure of `rows` rows, `height` [inches] each."""
        self.figure = new_figure(0.45 + height * rows, layout=None)
        self.axes = self.figure.subplots()
        Margins(left=0.95, bottom=0.5, top=0.1).apply(self.figure, 1, 1)
        self._rows, self._feet = rows, []
        self._places, self._labels = [], []

    def row(self, axis: int, unit: str, *values: np.ndarray) -> _Row:
        """Return the next row, from the top, for values of the 0-based `axis`; its label and ticks are drawn."""
        row = _Row((self._rows - 1 - len(self._feet)) * (1 + BETWEEN), *values)
        beside = self.axes.get_yaxis_transform()
        self._feet.append(row.foot)
        self.axes.text(-0.105, row.foot + 0.5, f"axis {axis + 1}\n[{unit}]", transform=beside, rotation=90,
                       ha="center", va="center")  # fmt: skip
        if not row.seen:
            self.axes.text(0.5, row.foot + 0.5, UNJUDGED, transform=beside, ha="center", va="center",
                           color=palette.MUTED)  # fmt: skip
        places, labels = row.ticks()
        self._places += list(places)
        self._labels += labels
        return row

    def save(self, output: str | Path, title: str, description: str) -> None:
        """Write the figure."""
        from matplotlib.collections import LineCollection
        from matplotlib.markers import TICKLEFT
        from matplotlib.transforms import ScaledTranslation

        across = self.axes.get_yaxis_transform()
        # Ticks of Matplotlib's own are three artists each, and take a third of the time of such a figure.
        self.axes.set_yticks([])
        for places, colour, width, order in (
            (self._places, palette.GRID, 0.7, 0.5),
            (self._feet, palette.MUTED, 0.8, 2),
        ):
            lines = [[(0, place), (1, place)] for place in places]
            self.axes.add_collection(
                LineCollection(lines, colors=colour, linewidths=width, transform=across, zorder=order), autolim=False
            )
        self.axes.plot(
            np.zeros(len(self._places)), self._places, linestyle="none", marker=TICKLEFT, markersize=TICK,
            color=palette.MUTED, markeredgewidth=0.8, transform=across, clip_on=False,
        )  # fmt: skip
        beside = across + ScaledTranslation(-2 * TICK / 72, 0, self.figure.dpi_scale_trans)
        for place, words in zip(self._places, self._labels, strict=True):
            self.axes.text(0, place, words, transform=beside, ha="right", va="center_baseline")
        self.axes.set_ylim(0, self._rows + (self._rows - 1) * BETWEEN)
        self.axes.set_xmargin(0.02)
        save(self.figure, output, title, description)


def draw_timeline(state: RobotState, name: str, output: str | Path, zone: tzinfo = UTC) -> None:
    """Draw an estimate of every axis over time in `zone`, with two standard deviations, baseline and alarms."""
    values, std, unit = state.estimates[name]
    time, label = _time_axis(state, zone)
    w, n = values.shape
    groups = np.array_split(np.arange(w), min(w, MOST_POINTS))
    at = time[[g[len(g) // 2] for g in groups]]
    pauses = _pauses(at)
    panel = _Panel(n, TIME_ROW)
    axes = panel.axes
    if state.baseline.any():
        learnt = np.flatnonzero(state.baseline)
        axes.axvspan(time[learnt[0]], time[learnt[-1]], color=palette.GRID, alpha=0.45, linewidth=0)
    told = []
    first, again = [], []
    for j in range(n):
        mean, error = _thin(values[:, j], std[:, j], groups)
        # The first windows of a series know little: a row as high as their band would show nothing else.
        wide = len(groups) >= FEW_POINTS and error > WIDE * _middle(error)
        row = panel.row(j, unit, *(np.where(wide, np.nan, mean + s * error) for s in (-2, 2)))
        colour = palette.axis_colour(j + 1)
        if row.seen and len(groups) < FEW_POINTS:
            size = 2 * error / (row.high - row.low)
            _points(axes, at, row(mean), size, colour, 1.0)
        elif row.seen:
            low, middle, high = (np.clip(row(mean + s * error), row.foot, row.foot + 1) for s in (-2, 0, 2))
            where, low, middle, high = (np.insert(x, pauses, np.nan) for x in (at, low, middle, high))
            axes.fill_between(where, low, high, color=colour, alpha=0.25, linewidth=0)
            axes.plot(where, middle, color=colour, linewidth=1.2)
            alone = _alone(middle)
            if alone.any():
                axes.plot(where[alone], middle[alone], "o", markersize=2, color=colour)
        for k, alarm in enumerate(a for a in state.counted if a["axis"] == j + 1 and _rests_on(a, name)):
            where = time[np.clip(np.searchsorted(state.end, alarm["time"]), 0, w - 1)]
            (again if k else first).append([(where, row.foot), (where, row.foot + 1)])
        told.append(_told(state, j, mean))
    _mark(axes, first, FIRST_ALARM)
    _mark(axes, again, NEXT_ALARM)
    axes.set_xlabel(label)
    if state.dated:
        _date_labels(axes, zone)
    title = f"{name.replace('_', ' ')} of every axis over time"
    panel.save(output, title, f"{title}; {'; '.join(told)}.")


def _rests_on(alarm: Mapping[str, Any], name: str) -> bool:
    """Whether an alarm is marked beside the estimate `name`: in that of its own quantity, else in those of friction."""
    own = SHOWN_BY.get(alarm["quantity"])
    return own == name if own == "backlash" or name in SHOWN_BY.values() else own is None or name == "friction"


def _pauses(at: np.ndarray) -> np.ndarray:
    """Return the indices of the points (k,) before which a pause lies."""
    steps = np.diff(at)
    return np.flatnonzero(steps > PAUSE * np.median(steps)) + 1 if len(steps) else np.zeros(0, dtype=int)


def _alone(values: np.ndarray) -> np.ndarray:
    """Return which values (k,) have no neighbour that a line could join them to."""
    known = np.concatenate([[False], np.isfinite(values), [False]])
    return known[1:-1] & ~known[:-2] & ~known[2:]


def _points(axes, at: np.ndarray, mean: np.ndarray, size: np.ndarray, colour: str, width: float) -> None:
    """Draw points with bars of half-length `size`, the bars as one line with gaps: one artist in place of hundreds."""
    gaps = np.full(len(at), np.nan)
    bars = np.stack([mean - size, mean + size, gaps], axis=1).ravel()
    axes.plot(np.repeat(at, 3), bars, color=colour, linewidth=width)
    axes.plot(at, mean, "o", markersize=3, color=colour)


def _mark(axes, lines: list, width: float) -> None:
    """Draw alarms as vertical lines, one artist for all of a width."""
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(lines, colors=palette.INK, linewidths=width, zorder=2), autolim=True)


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
    panel = _Panel(len(axes_shown), TEMPERATURE_ROW)
    for j in axes_shown:
        order = np.argsort(state.temperature[:, j], kind="stable")
        groups = np.array_split(order, min(len(order), MOST_MARKS))
        mean, error = _thin(values[:, j], std[:, j], groups)
        row = panel.row(j, unit, mean - 2 * error, mean + 2 * error)
        at = np.array([np.median(state.temperature[g, j]) for g in groups])
        _points(panel.axes, at, row(mean), 2 * error / (row.high - row.low), palette.axis_colour(j + 1), 0.8)
    panel.axes.set_xlabel("temperature [°C]")
    title = f"{name.replace('_', ' ')} over temperature"
    words = "window" if len(state.start) <= MOST_MARKS else "group of windows of like temperature"
    panel.save(output, title, f"{title}, one point per {words} with two standard deviations.")
