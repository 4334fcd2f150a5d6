"""Figures of the multiverse; each function draws one from the stages' files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.patches import Rectangle

from jointwear.files.storage import open_dataset, read_variable
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import direct_label, new_figure, save
from jointwear.studies.multiverse.summary import chosen_reading, influences, lag_rule


def _words(name: str) -> str:
    words = {"kl": "KL", "pca": "PCA", "q": "Q"}
    return " ".join(words.get(word, word) for word in name.split("_"))


def draw_readings(scored: str | Path, output: str | Path) -> None:
    """Draw agreement with Table IV against the error of the hours, one dot a reading."""
    with open_dataset(scored) as dataset:
        names = ("agreement", "hour_error", "kind", "best", "choice_pca_input")
        agreement, hours, kind, best, inputs = (read_variable(dataset, scored, n) for n in names)
    kind, inputs = kind.astype(str), inputs.astype(str)
    figure = new_figure(3.9)
    axes = figure.add_subplot()
    axes.axvspan(31.5, 36.5, ymax=10.0 / 42.0, color=palette.PUBLISHED_AREA, zorder=0)
    direct_label(axes, 34.0, 5.0, "aim", palette.PUBLISHED, offset=(0, 0), ha="center", va="center")
    # Dots of whole cells would hide each other: a fixed spread, the same at every call.
    jitter = (np.arange(len(agreement)) * 0.618034 % 1 - 0.5) * 0.7
    marks = "osD^v"
    for i, name in enumerate(sorted(set(inputs))):
        chosen = inputs == name
        axes.scatter(
            agreement[chosen] + jitter[chosen],
            hours[chosen],
            s=11,
            marker=marks[i % len(marks)],
            color=palette.SERIES[i],
            alpha=0.75,
            linewidths=0,
            label=f"PCA on {_words(name)}",
        )
    axes.scatter(
        agreement[best] + jitter[best],
        hours[best],
        s=40,
        facecolors="none",
        edgecolors=palette.INK,
        linewidths=0.8,
        label=f"the {len(best)} that go on",
    )
    axes.plot(
        agreement[0] + jitter[0], hours[0], marker="+", markersize=13, mew=2, ls="", color=palette.INK, label="default"
    )
    axes.set_xlim(max(agreement.min() - 1.5, -0.5), 36.5)
    axes.set_ylim(0, 42)
    axes.set_xlabel("Cells of Table IV, of 36, on which detection agrees")
    axes.set_ylabel("Median error of the hour [h], at most 40")
    axes.legend(loc="lower left", handletextpad=0.4)
    low, high = int(agreement.min()), int(agreement.max())
    save(
        figure,
        output,
        "Readings of the text against Table IV",
        f"{len(agreement)} readings agree on {low} to {high} of 36 cells; {int((agreement >= 32).sum())} reach 32, "
        f"{int((kind == 'sample').sum())} belong to the space-filling sample.",
    )


def draw_influence(influence: str | Path, output: str | Path) -> None:
    """Draw what share of the variance of two scores each dimension explains."""
    effects = influences(influence)
    chosen = [("agreement", "Cells of Table IV that agree"), ("hour_error", "Error of the hours")]
    order = [e["name"] for e in effects["penalty"]["main"]][:12]
    figure = new_figure(0.9 + 0.27 * len(order))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (score, title), colour in zip(panels, chosen, palette.SERIES, strict=False):
        share = {e["name"]: e["share"] for e in effects[score]["main"]}
        values = [100 * share.get(name, 0.0) for name in order]
        axes.barh(range(len(order)), values, color=colour, height=0.65)
        for i, value in enumerate(values):
            axes.text(value, i, f" {value:.0f}" if value >= 0.5 else " 0", va="center", fontsize=8, color=palette.INK)
        axes.set_title(title)
        axes.set_xlabel("Variance explained [%]")
        axes.set_xlim(0, max([*values, 1]) * 1.18)
        axes.grid(axis="y", visible=False)
    panels[0].set_yticks(range(len(order)), [_words(name) for name in order])
    panels[0].invert_yaxis()
    strongest = effects["agreement"]["main"][0]
    save(
        figure,
        output,
        "Which ambiguity decides",
        f"Main effects over the space-filling sample; the strongest for agreement is {_words(strongest['name'])} with "
        f"{100 * strongest['share']:.0f} % of the variance.",
    )


def draw_cells(choice: str | Path, output: str | Path) -> None:
    """Draw detection probability and hour of the chosen reading in every cell, beside the paper's hour."""
    found = chosen_reading(choice)
    cells = found["cells"]
    tasks, columns = max(c["task"] for c in cells), max(c["column"] for c in cells)
    axes_count = max(c["axis"] for c in cells)
    figure = new_figure(0.75 + 0.42 * axes_count)
    panels = figure.subplots(1, tasks, sharey=True)
    for axes, t in zip(np.atleast_1d(panels), range(1, tasks + 1), strict=True):
        axes.grid(visible=False)
        for cell in (c for c in cells if c["task"] == t):
            x, y = cell["column"] - 1, cell["axis"] - 1
            colour = palette.mix(palette.SEQUENTIAL, cell["probability"])
            axes.add_patch(Rectangle((x - 0.48, y - 0.46), 0.96, 0.92, facecolor=colour, edgecolor="none"))
            ours = f"{cell['hour']:.0f} h" if cell["hour"] is not None else "×"
            paper = f"{cell['published']:.0f} h" if cell["published"] is not None else "×"
            mark = "" if cell["agrees"] else "  ≠"
            axes.text(
                x,
                y,
                f"{ours} | {paper}{mark}",
                ha="center",
                va="center",
                fontsize=8,
                color=palette.text_on(colour),
                fontweight="bold" if not cell["agrees"] else "normal",
            )
        axes.set_xlim(-0.5, columns - 0.5)
        axes.set_ylim(axes_count - 0.5, -0.5)
        axes.set_xticks(range(columns), ["10 %", "20 %"][:columns])
        axes.set_title(f"T{t}")
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
    np.atleast_1d(panels)[0].set_yticks(range(axes_count), [f"axis {a + 1}" for a in range(axes_count)])
    agree = sum(c["agrees"] for c in cells)
    save(
        figure,
        output,
        "The chosen reading, cell by cell",
        f"Hour of detection, ours and the paper's, on pose sets that were not used to choose; dark where detection is "
        f"likely. {agree} of {len(cells)} cells agree.",
    )


def draw_lag_rule(lags: str | Path, output: str | Path) -> None:
    """Draw the mean cross-correlation of the worn with the other axes, and the accuracy of the rule by version."""
    with open_dataset(lags) as dataset:
        lag, observed, expected = (read_variable(dataset, lags, n) for n in ("lag", "observed", "expected"))
    found = lag_rule(lags)
    figure = new_figure(3.1)
    left, right = figure.subplots(1, 2, width_ratios=[1.15, 1])
    left.plot(lag, observed[0], color=palette.SERIES[0], label="raw")
    left.plot(lag, expected, color=palette.INK, ls=(0, (2, 2)), lw=1.2, label="raw, others constant")
    left.plot(lag, observed[1], color=palette.SERIES[1], ls=palette.DASHES[1], label="means removed")
    left.axvline(0, color=palette.MUTED, lw=0.8)
    left.set_xlabel("Lag of the other axis [h]")
    left.set_ylabel("Mean correlation, over its maximum")
    left.set_title("A rising series against the others")
    left.set_ylim(top=1.12)
    left.legend(loc="upper right", fontsize=7.5, handlelength=1.6)
    names = {
        "as_they_are": "worn",
        "others_centred": "worn, others\ncentred",
        "reversed_in_time": "worn, time\nreversed",
        "normal_week": "normal week\n(any axis)",
    }
    for k, (correlation, colour) in enumerate(zip(("raw", "means_removed"), palette.SERIES, strict=False)):
        shares = [
            found["versions"][v][correlation]["wrong" if v == "normal_week" else "right"]["share"] or 0.0 for v in names
        ]
        place = np.arange(len(names)) + (k - 0.5) * 0.38
        right.barh(place, [100 * s for s in shares], height=0.36, color=colour, label=_words(correlation))
        for x, y in zip(shares, place, strict=True):
            right.text(100 * x, y, f" {100 * x:.0f}", va="center", fontsize=8)
    right.set_yticks(range(len(names)), list(names.values()))
    right.invert_yaxis()
    right.set_xlim(0, 112)
    right.grid(axis="y", visible=False)
    right.set_xlabel("Runs in which the rule names\nthe worn axis, or any [%]")
    right.legend(loc="center right", bbox_to_anchor=(1.0, 0.38), fontsize=8)
    raw = found["versions"]["as_they_are"]["raw"]["right"]["share"] or 0.0
    reverse = found["versions"]["reversed_in_time"]["raw"]["right"]["share"] or 0.0
    save(
        figure,
        output,
        "Why the lag rule works",
        f"The raw correlation names the worn axis in {100 * raw:.0f} % of the detected runs and in "
        f"{100 * reverse:.0f} % of the same runs reversed in time.",
    )


def draw(
    picture: str,
    scored: str | Path,
    influence: str | Path,
    choice: str | Path,
    lags: str | Path,
    output: str | Path,
) -> None:
    """Draw the figure named `picture`: readings, influence, cells or lag_rule.

    Raises
    ------
    ValueError : for another name.
    """
    if picture == "readings":
        draw_readings(scored, output)
    elif picture == "influence":
        draw_influence(influence, output)
    elif picture == "cells":
        draw_cells(choice, output)
    elif picture == "lag_rule":
        draw_lag_rule(lags, output)
    else:
        raise ValueError(f"no figure is called {picture}")
