"""Figures of the monitor's study; each draws one from the chapter's results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import read_json
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import new_figure, save

_MODEL, _PAPER = palette.SERIES[0], palette.SERIES[1]


def _read(chapter: str | Path) -> dict[str, Any]:
    return read_json(chapter, object)


def _nan(values: list[float | None]) -> np.ndarray:
    return np.array([np.nan if v is None else v for v in values], dtype=float)


def draw_hours(chapter: str | Path, output: str | Path) -> None:
    """Draw the hour of detection of every cell: published, the paper's method at equal false alarms, and ours."""
    cells = [c for c in _read(chapter)["exact"]["cells"] if c["judged"]]
    figure = new_figure(3.4)
    axes = figure.add_subplot()
    place = np.arange(len(cells))
    axes.plot(
        place, _nan([c["published"] for c in cells]), "x", color=palette.PUBLISHED, mew=1.8, label="published", zorder=4
    )
    paper = [c["paper_hour"] if c["paper_probability"] >= 0.5 else None for c in cells]
    axes.plot(place, _nan(paper), "s", color=_PAPER, markersize=4.5, label="paper's method, same false alarms")
    axes.plot(place, _nan([c["hour"] for c in cells]), "o", color=_MODEL, markersize=4.5, label="model-based")
    axes.set_xticks(place, [f"{c['axis']}" for c in cells], fontsize=7.5)
    axes.set_xlabel("Worn axis, task by task; 10 % first, then 20 %")
    axes.set_ylabel("Hour of detection (median)")
    axes.set_ylim(0, 125)
    for k in range(1, len(cells)):
        if cells[k]["task"] != cells[k - 1]["task"]:
            axes.axvline(k - 0.5, color=palette.MUTED, linewidth=0.8)
    for task in dict.fromkeys(c["task"] for c in cells):
        here = [k for k, c in enumerate(cells) if c["task"] == task]
        axes.text(np.mean(here), 119, task, ha="center", va="top", color=palette.MUTED)
    axes.legend(loc="lower right", ncols=3, fontsize=7.5)
    text = (
        "Dots: median hour of detection of every cell of the grid by the model-based detector, earlier than the rest."
    )
    save(figure, output, "Hour of detection, cell by cell", text)


def draw_curves(chapter: str | Path, output: str | Path) -> None:
    """Draw the delay against false alarms, size of wear and noise."""
    curves = _read(chapter)["curves"]
    figure = new_figure(2.9)
    rates, sizes, noises = figure.subplots(1, 3)
    for name, label, colour, mark in (
        ("model", "model-based", _MODEL, "o-"),
        ("paper", "paper's method", _PAPER, "s--"),
    ):
        x = [max(r[name]["per_1000_h"], 0.02) for r in curves["rates"]]
        rates.plot(x, _nan([r[name]["hour"] for r in curves["rates"]]), mark, color=colour, markersize=4, label=label)
    rates.set_xscale("log")
    rates.set_xlabel("False alarms in 1,000 h")
    rates.set_ylabel("Hour of detection (median)")
    rates.legend(loc="lower left", fontsize=7)
    sizes.plot(
        [s["size"] for s in curves["sizes"]], _nan([s["hour"] for s in curves["sizes"]]), "o-", color=_MODEL, ms=4
    )
    sizes.set_xlabel("Growth of friction after 120 h [%]")
    noises.plot(
        [s["noise"] for s in curves["noises"]], _nan([s["hour"] for s in curves["noises"]]), "o-", color=_MODEL, ms=4
    )
    noises.set_xlabel("Noise, times the paper's")
    for axes in (rates, sizes, noises):
        axes.set_ylim(0, 120)
    save(
        figure, output, "What the delay depends on",
        "Three curves: hour of detection against rate of false alarms, size of wear and size of noise.",
    )  # fmt: skip


def draw_factory(chapter: str | Path, output: str | Path) -> None:
    """Draw false alarms per week of both detectors before and after discovery."""
    rows = _read(chapter)["factory"]
    figure = new_figure(2.8)
    panels = figure.subplots(1, 2, sharey=True)
    place, width = np.arange(len(rows)), 0.26
    cases = (
        ("uncorrected", "nominal model"),
        ("longer", "longer normal period alone"),
        ("corrected", "after discovery"),
    )
    for axes, detector, title in zip(panels, ("model", "paper"), ("Model-based", "Paper's method"), strict=True):
        for k, (case, label) in enumerate(cases):
            values = [max(r["detectors"][detector][case]["per_week"], 0.02) for r in rows]
            axes.bar(place + (k - 1) * width, values, width, color=palette.SERIES[k], label=label)
        axes.set_yscale("log")
        axes.set_ylim(0.02, 20000)
        axes.set_xticks(place, [r["scenario"] for r in rows], fontsize=8)
        axes.set_title(title)
        axes.grid(axis="x", visible=False)
    panels[0].set_ylabel("False alarms a week")
    panels[0].legend(loc="upper left", fontsize=7, ncols=1)
    save(
        figure, output, "False alarms under factory conditions",
        "Bars: false alarms a week with the nominal model, with a longer normal period, and with the augmented model.",
    )  # fmt: skip


DRAWINGS = {"hours": draw_hours, "curves": draw_curves, "factory": draw_factory}
