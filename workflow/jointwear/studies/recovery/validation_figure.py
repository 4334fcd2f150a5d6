"""The figure of the test of the verdict: hidden cause against named cause."""

from __future__ import annotations

from pathlib import Path

from matplotlib.patches import Rectangle

from jointwear.files.json_documents import read_json
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import new_figure, save


def draw_validation(chapter: str | Path, output: str | Path) -> None:
    """Draw how often each hidden cause was given each name, from the chapter's JSON file.

    Raises
    ------
    InputError : if the chapter is missing or not JSON.
    """
    found = read_json(chapter, dict)
    answers = found["answers"]
    figure = new_figure(2.5)
    axes = figure.subplots()
    for y, row in enumerate(found["causes"]):
        for x, answer in enumerate(answers):
            count = row["chosen"][answer]
            colour = palette.mix(palette.SEQUENTIAL, count / row["cases"])
            axes.add_patch(Rectangle((x - 0.49, y - 0.46), 0.98, 0.92, facecolor=colour, edgecolor="none"))
            text = f"{count} of {row['cases']}" if answer == row["cause"] else f"{count}" if count else ""
            weight = "bold" if answer == row["cause"] else "normal"
            axes.text(x, y, text, ha="center", va="center", color=palette.text_on(colour), fontweight=weight)
    axes.set_xlim(-0.5, len(answers) - 0.5)
    axes.set_ylim(len(found["causes"]) - 0.5, -0.5)
    axes.set_xticks(range(len(answers)), [a.replace("_", " ") for a in answers])
    axes.set_yticks(range(len(found["causes"])), [row["cause"].replace("_", " ") for row in found["causes"]])
    axes.set_xlabel("named")
    axes.set_ylabel("hidden")
    axes.tick_params(length=0)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    told = "; ".join(f"{row['cause'].replace('_', ' ')} {row['right']} of {row['cases']}" for row in found["causes"])
    save(figure, output, "Hidden cause and what was named", f"Named rightly: {told}.")
