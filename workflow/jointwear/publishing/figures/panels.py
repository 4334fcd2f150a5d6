"""Figures of plain panels (lines, bands, bars over a number or a time), written as SVG without a drawing library.

A page for every robot after every day is drawn often; these panels take a fiftieth of the time that Matplotlib does,
and nothing is imported for them. Lengths are points, y counted downwards, as SVG does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np

from jointwear.files.text_files import replace_text
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.seal import sealed
from jointwear.publishing.figures.ticks import Ticks

#: Size of text, of the marks of the ticks, and from a mark to its label.
TEXT, TICK, GAP = 9.0, 3.5, 3.5
#: Room left around the values, as a share of their span.
MARGIN = 0.04
#: From the line that a text stands on to its middle, as a share of its size.
_MIDDLE = 0.36


@dataclass(frozen=True)
class Scale:
    """Values `low` to `high` drawn from `start` to `stop` [points]."""

    low: float
    high: float
    start: float
    stop: float

    def __call__(self, values: np.ndarray | float) -> np.ndarray:
        """Return where values are drawn."""
        return self.start + (np.asarray(values) - self.low) / (self.high - self.low) * (self.stop - self.start)


def limits(*values: np.ndarray) -> tuple[float, float]:
    """Return the finite range of values with some room; 0 to 1 where there is none."""
    known = np.concatenate([v[np.isfinite(v)] for v in values])
    if not len(known):
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())
    room = MARGIN * (high - low) or MARGIN * abs(high) or 0.5
    return low - room, high + room


def _style(**given: object) -> str:
    return "; ".join(f"{name.replace('_', '-')}: {value}" for name, value in given.items())


def _text(x: float, y: float, words: str, anchor: str = "middle", colour: str = palette.INK, more: str = "") -> str:
    style = _style(font_size=f"{TEXT:g}px", font_family="'DejaVu Sans', sans-serif", text_anchor=anchor, fill=colour)
    return f'<text style="{style}{more}" x="{x:.2f}" y="{y:.2f}">{escape(words)}</text>'


@dataclass
class Panel:
    """One panel: its `x` and `y` scales, the latter from the lower edge to the upper one, and what was `drawn`."""

    x: Scale
    y: Scale
    number: int
    drawn: list[str] = field(default_factory=list)

    def _path(self, points: str, **style: object) -> None:
        clip = f'clip-path="url(#panel{self.number})"'
        self.drawn.append(f'<path d="{points}" {clip} style="{_style(**style)}"/>')

    def line(self, x: np.ndarray, y: np.ndarray, colour: str, width: float = 1.2) -> None:
        """Draw a line through points (k,), broken where one is not finite."""
        parts = [_through(self.x(x[run]), self.y(y[run])) for run in _runs(np.isfinite(y))]
        if parts:
            self._path("".join(parts), fill="none", stroke=colour, stroke_width=width, stroke_linejoin="round")

    def band(self, x: np.ndarray, low: np.ndarray, high: np.ndarray, colour: str) -> None:
        """Fill the area between two lines (k,), broken where one is not finite."""
        parts = []
        for run in _runs(np.isfinite(low) & np.isfinite(high)):
            there = self.x(x[run])
            around = np.concatenate([self.y(low[run]), self.y(high[run])[::-1]])
            parts.append(_through(np.concatenate([there, there[::-1]]), around) + "z")
        if parts:
            self._path("".join(parts), fill=colour, fill_opacity=0.25)

    def bars(self, x: np.ndarray, y: np.ndarray, half: np.ndarray, colour: str, radius: float = 1.6) -> None:
        """Draw points (k,) with bars up and down."""
        for a, b, c in zip(self.x(x), self.y(y), self.y(y + half), strict=True):
            if np.isfinite(b) and np.isfinite(c):
                self._path(f"M{a:.2f} {c:.2f}V{2 * b - c:.2f}", stroke=colour, stroke_width=0.9)
                self.drawn.append(f'<circle cx="{a:.2f}" cy="{b:.2f}" r="{radius}" style="fill: {colour}"/>')

    def span(self, first: float, last: float, colour: str) -> None:
        """Fill what lies between two values of x."""
        a, b = self.x(first), self.x(last)
        self._path(f"M{a:.2f} {self.y.start:.2f}H{b:.2f}V{self.y.stop:.2f}H{a:.2f}z", fill=colour, fill_opacity=0.45)

    def upright(self, x: float, dashes: str | tuple, colour: str = palette.INK, width: float = 1.1) -> None:
        """Draw a vertical line; `dashes` as in :data:`~jointwear.publishing.figures.palette.DASHES`."""
        style = {} if isinstance(dashes, str) else {"stroke_dasharray": " ".join(f"{width * d:g}" for d in dashes[1])}
        where = f"M{self.x(x):.2f} {self.y.start:.2f}V{self.y.stop:.2f}"
        self._path(where, stroke=colour, stroke_width=width, **style)

    def words(self, words: str) -> None:
        """Write into the middle of the panel."""
        x, y = (self.x.start + self.x.stop) / 2, (self.y.start + self.y.stop) / 2
        self.drawn.append(_text(x, y + _MIDDLE * TEXT, words, colour=palette.MUTED))

    def title(self, words: str) -> None:
        """Write above the panel."""
        self.drawn.append(_text(self.x.start, self.y.stop - 5, words, "start", more="; font-weight: bold"))

    def ticks_of_x(self, ticks: Ticks, labelled: bool = True, name: str = "") -> None:
        """Draw the grid and the marks of x, with labels and a name below where wanted."""
        foot = self.y.start
        for x, words in zip(self.x(ticks.places), ticks.labels, strict=True):
            self.drawn.append(_grid(f"M{x:.2f} {foot:.2f}V{self.y.stop:.2f}"))
            self.drawn.append(_mark(f"M{x:.2f} {foot:.2f}v{TICK}"))
            if labelled:
                self.drawn.append(_text(x, foot + TICK + GAP + 0.76 * TEXT, words))
        below = foot + TICK + GAP + 2.4 * TEXT
        if labelled and ticks.common:
            self.drawn.append(_text(self.x.stop, below, ticks.common, "end"))
        if name:
            self.drawn.append(_text((self.x.start + self.x.stop) / 2, below, name))

    def ticks_of_y(self, ticks: Ticks, names: Sequence[str] = (), away: float = 34.0) -> None:
        """Draw the grid, the marks and the labels of y, with lines of names beside them, the last one `away`."""
        edge = self.x.start
        for y, words in zip(self.y(ticks.places), ticks.labels, strict=True):
            self.drawn.append(_grid(f"M{edge:.2f} {y:.2f}H{self.x.stop:.2f}"))
            self.drawn.append(_mark(f"M{edge:.2f} {y:.2f}h{-TICK}"))
            self.drawn.append(_text(edge - TICK - GAP, y + _MIDDLE * TEXT, words, "end"))
        y = (self.y.start + self.y.stop) / 2
        for k, name in enumerate(reversed(names)):
            x = edge - away - 1.2 * TEXT * k
            turned = f'<g transform="translate({x:.2f} {y:.2f}) rotate(-90)">'
            self.drawn.append(f"{turned}{_text(0, 0, name)}</g>")

    def frame(self) -> None:
        """Draw the left and the lower edge."""
        edges = f"M{self.x.start:.2f} {self.y.stop:.2f}V{self.y.start:.2f}H{self.x.stop:.2f}"
        self.drawn.append(_mark(edges))


def _grid(points: str) -> str:
    return f'<path d="{points}" style="{_style(stroke=palette.GRID, stroke_width=0.7)}"/>'


def _mark(points: str) -> str:
    return f'<path d="{points}" style="{_style(fill="none", stroke=palette.MUTED, stroke_width=0.8)}"/>'


def _through(x: np.ndarray, y: np.ndarray) -> str:
    """Return a path through points; a single one is a short line."""
    points = [f"{a:.2f} {b:.2f}" for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    return f"M{points[0]}h0.01" if len(points) == 1 else "M" + "L".join(points)


def _runs(good: np.ndarray) -> list[slice]:
    """Return the runs of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(int)))
    return [slice(a, b) for a, b in edges.reshape(-1, 2).tolist()]


def write_panels(
    path: str | Path, size: tuple[float, float], panels: Sequence[Panel], title: str, description: str
) -> None:
    """Write panels as one SVG of a size [points], with its title and the description that stands in for the picture."""
    width, height = size
    clips = [
        f'<clipPath id="panel{p.number}"><rect x="{p.x.start:.2f}" y="{p.y.stop:.2f}" '
        f'width="{p.x.stop - p.x.start:.2f}" height="{p.y.start - p.y.stop:.2f}"/></clipPath>'
        for p in panels
    ]
    size_of = f'width="{width:g}pt" height="{height:g}pt" viewBox="0 0 {width:g} {height:g}"'
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" {size_of} version="1.1">',
        f" <title>{escape(title)}</title>",
        f" <desc>{escape(description)}</desc>",
        f" <defs>{''.join(clips)}</defs>",
        f' <rect width="{width:g}" height="{height:g}" style="fill: {palette.PAPER}"/>',
        *[" <g>" + "\n  ".join(["", *p.drawn]) + "\n </g>" for p in panels],
        "</svg>",
    ]
    replace_text(path, sealed("\n".join(lines) + "\n"))
