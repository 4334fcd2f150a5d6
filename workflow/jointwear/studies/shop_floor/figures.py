"""Figures of the shop floor, drawn from the chapter's results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jointwear.files.json_documents import read_json
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import new_figure, save

#: Where no alarm at all is drawn on a logarithmic axis [per 1,000 h].
NONE = 0.05


def _read(chapter: str | Path) -> dict[str, Any]:
    return read_json(chapter)


def _bar(axes, x: float, rate: dict[str, Any], colour: str, mark: str, label: str | None = None) -> None:
    middle = max(rate["per_1000_h"] or 0.0, NONE)
    low, high = max(rate["low"] or 0.0, NONE), max(rate["high"] or NONE, NONE)
    axes.errorbar(
        x, middle, [[middle - min(low, middle)], [high - middle]], fmt=mark, color=colour, markersize=4.5, label=label
    )


def draw_false_alarms(chapter: str | Path, output: str | Path) -> None:
    """Draw false alarms against the stated rate, before and now, and by confounder at the middle rate."""
    content = _read(chapter)
    now, before = content["rates"], {s["rate"]: s for s in content["before"]}
    figure = new_figure(3.1)
    stated, by = figure.subplots(1, 2, width_ratios=[1, 2], sharey=True)
    rates = [s["rate"] for s in now]
    stated.plot([0.2, 5], [0.2, 5], color=palette.MUTED, linewidth=1, label="as stated")
    for k, s in enumerate(now):
        _bar(stated, s["rate"], s["false"], palette.SERIES[0], "o", None if k else "now")
        if s["rate"] in before:
            _bar(stated, s["rate"] * 1.12, before[s["rate"]]["false"], palette.SERIES[1], "s", None if k else "before")
    stated.set_xscale("log")
    stated.set_yscale("log")
    stated.set_xticks(rates, [f"{r:g}" for r in rates])
    stated.minorticks_off()
    stated.set_xlabel("Stated, in 1,000 h")
    stated.set_ylabel("False alarms in 1,000 h")
    stated.legend(loc="lower right", fontsize=7)
    middle = now[len(now) // 2]
    names = sorted(middle["by_scenario"], key=lambda name: (name == "all", name != "none"))
    for k, name in enumerate(names):
        _bar(by, k, middle["by_scenario"][name], palette.SERIES[0], "o")
        if name in before.get(middle["rate"], {"by_scenario": {}})["by_scenario"]:
            _bar(by, k + 0.25, before[middle["rate"]]["by_scenario"][name], palette.SERIES[1], "s")
    by.axhline(middle["rate"], color=palette.MUTED, linewidth=1)
    by.set_xticks(range(len(names)), [name.replace("_", " ") for name in names], rotation=55, ha="right", fontsize=7.5)
    by.set_title(f"By confounder, {middle['rate']:g} stated")
    by.set_ylim(NONE, 1000)
    save(
        figure, output, "False alarms on the shop floor",
        "Left: false alarms measured against those stated, before and now. Right: by confounder. Bars: 95 % intervals.",
    )  # fmt: skip


def draw_found(chapter: str | Path, output: str | Path) -> None:
    """Draw the share of worn axes found over the days since the onset."""
    content = _read(chapter)
    figure = new_figure(2.6)
    axes = figure.add_subplot()
    for k, line in enumerate(content["curves"]):
        axes.plot(line["days"], line["found"], color=palette.SERIES[k], label=f"{line['rate']:g} in 1,000 h stated")
    axes.set_xlabel("Days since the wear began")
    axes.set_ylabel("Share of worn axes found")
    axes.set_xlim(0, 14)
    axes.set_ylim(0, 1)
    axes.legend(loc="lower right", fontsize=7.5)
    save(
        figure, output, "Worn axes found over time",
        "Lines: share of the axes with growing Coulomb friction that have been found, over the days since the onset.",
    )  # fmt: skip


DRAWINGS = {"false_alarms": draw_false_alarms, "found": draw_found}
