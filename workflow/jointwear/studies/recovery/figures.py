"""Figures of the recovery; each function draws one from the chapter's results."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.ticker import FixedLocator, NullFormatter, ScalarFormatter

from jointwear.files.json_documents import read_json
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import direct_label, new_figure, save

_WORDS = {"faster_segments": "faster motion", "torque_constant_error": "torque constants"}


def candidate_words(name: str) -> str:
    """Return the name of a candidate as a reader says it."""
    return " + ".join(_WORDS.get(part, part.replace("_", " ")) for part in name.split("+"))


def draw_bound(chapter: Mapping[str, Any], output: str | Path) -> None:
    """Draw the largest torque of the unloaded arm against the segment time, and the published maxima."""
    bound = chapter["bound"]
    times, held = np.array(bound["segment_times"]), np.array(bound["held"], dtype=float)
    shown = [a for a in bound["axes"] if a["axis"] in (2, 3, 4, 5)]
    figure = new_figure(4.3)
    panels = figure.subplots(2, 2, sharex=True).ravel()
    for axes, entry in zip(panels, shown, strict=True):
        a = entry["axis"] - 1
        axes.plot(times, held[:, a], color=palette.SERIES[0])
        axes.axhline(entry["published"], color=palette.PUBLISHED, lw=1.4, ls=(0, (6, 1.5)))
        axes.axhline(entry["static"], color=palette.MUTED, lw=0.9, ls=(0, (1.2, 1.2)))
        top = entry["published"] * 2.0
        axes.set_ylim(0, top)
        axes.set_xscale("log")
        axes.set_xlim(1.0, 30.0)
        axes.xaxis.set_major_locator(FixedLocator([1, 2, 5, 10, 30]))
        axes.xaxis.set_major_formatter(ScalarFormatter())
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_title(f"Axis {entry['axis']}")
        direct_label(
            axes,
            29.0,
            entry["published"],
            f"Table V {entry['published']:.3g}",
            palette.PUBLISHED,
            offset=(0, 3),
            ha="right",
            va="bottom",
        )
        direct_label(
            axes,
            1.05,
            entry["static"],
            f"at rest {entry['static']:.3g}",
            palette.MUTED,
            offset=(0, -3),
            ha="left",
            va="top",
        )
    for axes in panels[2:]:
        axes.set_xlabel("Time of one segment [s]")
    for axes in panels[::2]:
        axes.set_ylabel("Largest |torque| [N m]")
    save(
        figure,
        output,
        "What the unloaded arm can reach",
        "Largest torque over all poses of the unloaded arm with friction worn by 20 %, against the time of a segment, "
        "and the largest value of Table V: "
        + ", ".join(f"axis {a['axis']} {a['slow']:.3g} against {a['published']:.3g} N m" for a in shown)
        + f" at {bound['slow_segment_time']:.0f} s.",
    )


def draw_payload(chapter: Mapping[str, Any], output: str | Path) -> None:
    """Draw the error of every published maximum with the best poses of the unloaded arm and with the payload."""
    cells = [c for c in chapter["tables"]["cells"] if c["before_percent"] is not None]
    figure = new_figure(5.6)
    panels = figure.subplots(1, 2, sharex=True)
    columns = sorted({c["increase_percent"] for c in cells})
    for axes, increase in zip(panels, columns, strict=False):
        own = [c for c in cells if c["increase_percent"] == increase]
        for y, cell in enumerate(own):
            low, high = sorted((max(cell["after_percent"], 0.01), max(cell["before_percent"], 0.01)))
            axes.plot([low, high], [y, y], color=palette.GRID, lw=2.2, solid_capstyle="butt", zorder=1)
            axes.plot(max(cell["before_percent"], 0.01), y, "s", ms=5, color=palette.SERIES[1], zorder=2)
            axes.plot(max(cell["after_percent"], 0.01), y, "o", ms=5, color=palette.SERIES[0], zorder=3)
        axes.axvline(5.0, color=palette.PUBLISHED, lw=1.2, ls=(0, (6, 1.5)))
        axes.set_xscale("log")
        axes.set_xlim(0.009, 100)
        axes.xaxis.set_major_locator(FixedLocator([0.01, 0.1, 1, 10, 100]))
        axes.xaxis.set_major_formatter(lambda v, _: f"{v:g}")
        axes.set_ylim(len(own) - 0.4, -0.6)
        axes.set_yticks(range(len(own)), [f"{c['task']} axis {c['axis']}" for c in own])
        axes.grid(axis="y", visible=False)
        axes.set_title(f"Friction growth {increase:g} %")
        axes.set_xlabel("Error of the largest torque [%]")
    panels[0].plot([], [], "s", ms=5, color=palette.SERIES[1], label="unloaded arm")
    panels[0].plot([], [], "o", ms=5, color=palette.SERIES[0], label="with payload")
    panels[0].plot([], [], color=palette.PUBLISHED, lw=1.2, ls=(0, (6, 1.5)), label="5 %")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    t = chapter["tables"]
    save(
        figure,
        output,
        "Table V without and with the payload",
        f"Each with its own best poses. Median error {t['median_percent_before']:.2g} % without, "
        f"{t['median_percent']:.2g} % with; largest {t['worst_percent_before']:.3g} % and {t['worst_percent']:.2g} %.",
    )


def draw_candidates(chapter: Mapping[str, Any], output: str | Path) -> None:
    """Draw the criterion of all candidates, best first."""
    rows = chapter["comparison"]
    names = [r["candidate"] for r in rows]
    shown = [n for n in names if "+" not in n] + [n for n in names if "+" in n][:12]
    shown = sorted(shown, key=names.index)
    bic = {r["candidate"]: r["bic"] for r in rows}
    left = {r["candidate"]: r["mean"] for r in chapter["transfer"]}
    figure = new_figure(0.9 + 0.235 * len(shown))
    axes = figure.add_subplot()
    values = [bic[n] - bic[names[0]] for n in shown]
    colours = [palette.SERIES[0] if "payload" in n.split("+") else palette.SERIES[1] for n in shown]
    axes.barh(range(len(shown)), values, color=colours, height=0.66)
    for y, (name, value) in enumerate(zip(shown, values, strict=True)):
        tail = f", left-out task {left[name]:.3g}" if name in left else ""
        axes.text(value, y, f" {value:.0f}{tail}", va="center", fontsize=8)
    axes.set_yticks(range(len(shown)), [candidate_words(n) for n in shown])
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.set_xlim(0, max(values) * 1.3)
    axes.set_xlabel("Behind the best by this much (BIC)")
    save(
        figure,
        output,
        "What may be missing, compared",
        "Bayesian information criterion behind the best candidate; blue: with a payload, orange: without. "
        + "; ".join(f"{candidate_words(n)} {v:.0f}" for n, v in zip(shown[:6], values[:6], strict=True))
        + ".",
    )


def draw_ensemble(chapter: Mapping[str, Any], output: str | Path) -> None:
    """Draw payload mass against offset over the pose sets, and the wear shape."""
    ensemble = chapter["ensemble"]
    mass, z, shape = (np.array(ensemble[k], dtype=float) for k in ("mass", "com_z", "shape"))
    figure = new_figure(3.0)
    left, right = figure.subplots(1, 2, width_ratios=[1.4, 1])
    left.plot(mass, z, "o", ms=4, color=palette.SERIES[0], alpha=0.8)
    grid = np.linspace(mass.min() * 0.9, mass.max() * 1.05, 50)
    moment = ensemble["product"]["median"]
    left.plot(grid, moment / grid, color=palette.MUTED, lw=1.0, ls=(0, (3, 1)))
    label = f"m z = {moment:.2g} kg m"
    direct_label(left, grid[0], moment / grid[0], label, palette.MUTED, offset=(6, 0), va="bottom")
    left.plot(2.5, 0.1, marker="*", ms=10, color=palette.PUBLISHED)
    direct_label(left, 2.5, 0.1, "rated 2.5 kg at 0.1 m", palette.PUBLISHED, offset=(7, -9))
    left.set_xlabel("Mass of the payload [kg]")
    left.set_ylabel("Offset along the tool axis [m]")
    right.hist(shape, bins=12, color=palette.SERIES[0])
    right.set_xlabel("Wear shape constant (c2 x 120 h)")
    right.set_ylabel("Pose sets")
    save(
        figure,
        output,
        "Payload and wear shape over the pose sets",
        f"{ensemble['solutions']} pose sets that reproduce Tables V and VI: mass {mass.min():.2g} to "
        f"{mass.max():.2g} kg, product of mass and offset {ensemble['product']['low']:.2g} to "
        f"{ensemble['product']['high']:.2g} kg m.",
    )


def draw_prediction(chapter: Mapping[str, Any], output: str | Path) -> None:
    """Draw the predicted probability of detection in every cell beside what the paper found."""
    cells = chapter["prediction"]["cells"]
    tasks = list(dict.fromkeys(c["task"] for c in cells))
    figure = new_figure(3.4)
    panels = figure.subplots(1, len(tasks), sharey=True)
    for axes, task in zip(np.atleast_1d(panels), tasks, strict=True):
        own = [c for c in cells if c["task"] == task]
        for cell in own:
            y = cell["axis"] + (0.18 if cell["increase_percent"] == 20 else -0.18)
            detected = cell["published"] is not None
            axes.plot([cell["low"], cell["high"]], [y, y], color=palette.GRID, lw=2.5, zorder=1)
            axes.plot(
                cell["probability"],
                y,
                "o" if cell["increase_percent"] == 10 else "D",
                ms=5.5,
                mfc=palette.PUBLISHED if detected else palette.PAPER,
                mec=palette.PUBLISHED,
                zorder=2,
            )
        axes.axvline(0.5, color=palette.MUTED, lw=0.8)
        axes.set_xlim(-0.05, 1.05)
        axes.set_title(task)
        axes.set_xlabel("P(detected), predicted")
        axes.grid(axis="y", visible=False)
    first = np.atleast_1d(panels)[0]
    numbers = sorted({c["axis"] for c in cells})
    first.set_yticks(numbers, [f"axis {a}" for a in numbers])
    first.set_ylim(max(numbers) + 0.5, min(numbers) - 0.5)
    for mark, label in (("o", "10 %"), ("D", "20 %")):
        first.plot([], [], mark, ls="", ms=5.5, color=palette.MUTED, label=label)
    first.plot([], [], "o", ls="", ms=5.5, mfc=palette.PUBLISHED, mec=palette.PUBLISHED, label="the paper detects")
    first.plot([], [], "o", ls="", ms=5.5, mfc=palette.PAPER, mec=palette.PUBLISHED, label="it does not")
    figure.legend(*first.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    p = chapter["prediction"]
    save(
        figure,
        output,
        "Table IV predicted from Tables V and VI",
        f"The prediction agrees with the paper in {p['agreement']} of {len(cells)} cells; bars span pose sets.",
    )


PICTURES: dict[str, Callable[[Mapping[str, Any], str | Path], None]] = {
    "bound": draw_bound,
    "payload": draw_payload,
    "candidates": draw_candidates,
    "ensemble": draw_ensemble,
    "prediction": draw_prediction,
}


def draw(picture: str, chapter: str | Path, output: str | Path) -> None:
    """Draw the figure named `picture` (a key of PICTURES) from the chapter's JSON file."""
    PICTURES[picture](read_json(chapter, object), output)
