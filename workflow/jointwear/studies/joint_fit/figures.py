"""Figures of the joint fit, drawn from its chapter."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from jointwear.files.json_documents import read_json
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import direct_label, new_figure, save

PICTURES = ("cells", "frontier", "trade")


def draw_cells(chapter: dict[str, Any], output: str | Path) -> None:
    """Draw Table IV: the paper beside the nearest experiment on new random numbers."""
    cells = chapter["check"]["cells"]
    share = {(c["task"], c["column"], c["axis"]): c["agree"] / chapter["kept"] for c in chapter["cells"]}
    figure = new_figure(3.3)
    panels = figure.subplots(1, 3, sharey=True)
    for t, axes in enumerate(panels, start=1):
        axes.grid(visible=False)
        for cell in (c for c in cells if c["task"] == t):
            x, y = cell["column"] - 1, cell["axis"] - 1
            colour = palette.mix(palette.SEQUENTIAL, share[t, cell["column"], cell["axis"]])
            axes.add_patch(Rectangle((x - 0.48, y - 0.46), 0.96, 0.92, facecolor=colour, edgecolor="none"))
            ours = f"{cell['hour']:.0f} h" if cell["hour"] is not None else "×"
            paper = f"{cell['published']:.0f} h" if cell["published"] is not None else "×"
            wrong = not cell["agrees"]
            axes.text(
                x,
                y,
                f"{paper} | {ours}{'  ≠' if wrong else ''}",
                ha="center",
                va="center",
                fontsize=8,
                color=palette.text_on(colour),
                fontweight="bold" if wrong else "normal",
            )
        axes.set_xlim(-0.5, 1.5)
        axes.set_ylim(5.5, -0.5)
        axes.set_xticks(range(2), ["10 %", "20 %"])
        axes.set_title(f"T{t}")
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
    panels[0].set_yticks(range(6), [f"axis {a + 1}" for a in range(6)])
    agreed = sum(c["agrees"] for c in cells)
    save(
        figure,
        output,
        "One experiment for Table IV",
        f"Hour of detection in every cell, the paper's and that of the nearest joint experiment on new random numbers; "
        f"{agreed} of {len(cells)} cells have the same outcome. Dark where most of the experiments agree.",
    )


def draw_frontier(chapter: dict[str, Any], output: str | Path) -> None:
    """Draw the cells that agree against the payload, and against the reading before the local search."""
    points = chapter["frontier"]
    figure = new_figure(3.4)
    left, right = figure.subplots(1, 2, width_ratios=[1.1, 1])
    # Whole cells of equal payloads would hide each other: a fixed spread, the same at every call.
    jitter = (np.arange(len(points)) * 0.618034 % 1 - 0.5) * 0.35
    for kept, colour, label in ((False, palette.MUTED, "farther"), (True, palette.SERIES[0], "posterior")):
        own = [k for k, p in enumerate(points) if p["kept"] == kept]
        left.scatter(
            [points[k]["moment"] for k in own],
            [points[k]["cells"] + jitter[k] for k in own],
            s=18,
            color=colour,
            alpha=0.8,
            linewidths=0,
            label=label,
        )
    left.axhline(31.5, color=palette.PUBLISHED, lw=1, ls=palette.DASHES[1])
    direct_label(left, min(p["moment"] for p in points), 31.5, "aim: 32", palette.PUBLISHED, offset=(0, -11))
    left.set_ylim(min(29, min(p["cells"] for p in points) - 1), 36.7)
    left.set_xlabel("Payload, first moment [kg m]")
    left.set_ylabel("Cells of Table IV, of 36")
    left.set_title("Cells against payload")
    left.legend(loc="lower right", fontsize=8)
    ranked = chapter["readings"]["ranked"]
    groups: dict[str, dict[str, Any]] = {}
    for reading in ranked:
        name = f"{reading['scaling']}, {reading['components'].replace('_', ' ')}"
        if name not in groups or reading["cells"] > groups[name]["cells"]:
            groups[name] = reading
    names = sorted(groups, key=lambda n: groups[n]["cells"])
    values = [groups[n]["cells"] for n in names]
    right.barh(range(len(names)), values, color=palette.SERIES[0], height=0.62)
    for k, value in enumerate(values):
        right.text(value, k, f" {value:.1f}", va="center", fontsize=8)
    right.set_yticks(range(len(names)), names)
    right.set_xlim(20, 36)
    right.grid(axis="y", visible=False)
    right.set_xlabel("Cells before the local search")
    right.set_title("Cells against reading")
    save(
        figure,
        output,
        "How many cells one experiment can explain",
        f"Cells of Table IV that agree, {min(p['cells'] for p in points):.0f} to "
        f"{max(p['cells'] for p in points):.0f} of 36 over {len(points)} experiments with payloads of "
        f"{min(p['moment'] for p in points):.2f} to {max(p['moment'] for p in points):.2f} kg m, and by reading.",
    )


def draw_trade(chapter: dict[str, Any], output: str | Path) -> None:
    """Draw what one aim costs: hours against the torques of Table V, and cells against the signs of Table II."""
    first, more = chapter["frontier"], chapter["searched_on"]
    signed = [p for p in more if p["signs_weight"] > 1]
    fitted = [p for p in more if p["signs_weight"] <= 1]
    groups = [
        (first, palette.MUTED, "o", "search"),
        (fitted, palette.SERIES[0], "s", "Tables V and VI weigh more"),
        (signed, palette.SERIES[1], "^", "signs weigh more"),
    ]
    aims = {c["name"]: c for c in chapter["checks"]}
    figure = new_figure(3.5)
    panels = figure.subplots(1, 2)
    for points, colour, marker, label in groups:
        look = {"s": 20, "marker": marker, "color": colour, "alpha": 0.85, "linewidths": 0, "label": label}
        panels[0].scatter([100 * p["torque_median"] for p in points], [p["hour_error"] for p in points], **look)
        # Whole cells would hide each other: a fixed spread, the same at every call.
        spread = (np.arange(len(points)) * 0.618034 % 1 - 0.5) * 0.35
        cells = [p["cells"] + s for p, s in zip(points, spread, strict=True)]
        panels[1].scatter([p["signs"] for p in points], cells, **look)
    aim = {"color": palette.PUBLISHED, "lw": 1, "ls": palette.DASHES[1]}
    panels[0].axvline(100 * aims["torque_median"]["high"], **aim)
    panels[0].axhline(aims["hour_error"]["high"], **aim)
    panels[0].set_xlabel("Table V, median error [%]")
    panels[0].set_ylabel("Table IV, median error of the hours [h]")
    panels[0].set_title("Hours against torques")
    panels[1].axvline(aims["signs"]["low"], **aim)
    panels[1].axhline(aims["cells"]["low"] - 0.5, **aim)
    panels[1].set_xlabel("Table II, signs of 15, mean run")
    panels[1].set_ylabel("Table IV, cells of 36")
    panels[1].set_title("Cells against signs")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
    save(
        figure,
        output,
        "What one aim costs in the others",
        f"Hours of Table IV against torques of Table V, and its cells against the signs of Table II, for {len(first)} "
        f"experiments of the search and {len(more)} that were searched on under other weights. Dashed: the aims. "
        f"The most signs in the mean run are {max(p['signs'] for p in (*first, *more)):.1f} of 15.",
    )


def draw_controls(chapter: dict[str, Any], output: str | Path) -> None:
    """Draw the distance that the same small effort leaves for our paper, papers of known origin and shuffled ones."""
    found = chapter
    kinds = [
        ("ours", "this paper"),
        ("known", "papers of\nknown origin"),
        ("shuffled", "this paper,\nTable IV shuffled"),
    ]
    figure = new_figure(2.7)
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, key, label in (
        (left, "cells", "Cells of Table IV, of 36"),
        (right, "distance", "Distance from all tables"),
    ):
        for k, (kind, _) in enumerate(kinds):
            values = np.array(found[kind][key])
            spread = (np.arange(len(values)) * 0.618034 % 1 - 0.5) * 0.4
            axes.scatter(values, k + spread, s=20, color=palette.SERIES[k], linewidths=0, alpha=0.85)
            axes.plot([np.median(values)] * 2, [k - 0.33, k + 0.33], color=palette.INK, lw=1.4)
        axes.set_xlabel(label)
        axes.grid(axis="y", visible=False)
    left.set_yticks(range(len(kinds)), [words for _, words in kinds])
    left.invert_yaxis()
    left.xaxis.set_major_locator(MaxNLocator(integer=True))
    right.set_xscale("log")
    save(
        figure,
        output,
        "The same fit to other papers",
        "Median cells that agree: "
        + ", ".join(f"{words.replace(chr(10), ' ')} {np.median(found[kind]['cells']):.0f}" for kind, words in kinds)
        + ".",
    )


def draw(picture: str, chapter: str | Path, output: str | Path) -> None:
    """Draw the figure named `picture`, of :data:`PICTURES` or "controls", from its chapter's JSON file."""
    content = read_json(chapter)
    drawings = {"cells": draw_cells, "frontier": draw_frontier, "trade": draw_trade, "controls": draw_controls}
    drawings[picture](content, output)
