"""The figure of the side-by-side view: hours of detection, printed and of both experiments."""

from __future__ import annotations

from pathlib import Path

from jointwear.files.json_documents import read_json
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import new_figure, save

_NOT_DETECTED = 142.0  # h; a row of its own above the last hour of a run


def draw_hours(chapter: str | Path, output: str | Path) -> None:
    """Draw Table IV of paper, literal reading and closest experiment, from the chapter's JSON file.

    Raises
    ------
    InputError : if the chapter is missing or not JSON.
    """
    rows = read_json(chapter, dict)["tables"]["table_iv"]
    kinds = (
        ("published", "paper", "x", palette.PUBLISHED),
        ("literal", "literal", "s", palette.SERIES[1]),
        ("closest", "closest", "o", palette.SERIES[0]),
    )
    tasks = list(dict.fromkeys(r["task"] for r in rows))
    figure = new_figure(3.1)
    panels = figure.subplots(1, len(tasks), sharey=True, squeeze=False)[0]
    for axes, task in zip(panels, tasks, strict=True):
        own = [r for r in rows if r["task"] == task]
        for key, label, marker, colour in kinds:
            hours = [_NOT_DETECTED if r[key] is None else r[key] for r in own]
            axes.scatter(range(len(own)), hours, s=26, marker=marker, color=colour, label=label, alpha=0.9)
        for place in range(1, len(own)):
            if own[place]["increase_percent"] != own[place - 1]["increase_percent"]:
                axes.axvline(place - 0.5, color=palette.MUTED, lw=0.8)
        axes.axhspan(_NOT_DETECTED - 6, _NOT_DETECTED + 6, color=palette.GRID, zorder=0)
        axes.set_xticks(range(len(own)), [str(r["axis"]) for r in own], fontsize=7.5)
        axes.set_title(task)
        axes.grid(axis="x", visible=False)
        axes.set_xlabel("Worn axis; 10 %, then 20 %")
    panels[0].set_ylim(0, _NOT_DETECTED + 6)
    panels[0].set_yticks([*range(0, 121, 20), _NOT_DETECTED], [*map(str, range(0, 121, 20)), "not\ndetected"])
    panels[0].set_ylabel("Hour of detection")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    same = {key: sum((r[key] is None) == (r["published"] is None) for r in rows) for key in ("literal", "closest")}
    save(
        figure,
        output,
        "Table IV: paper, literal and closest",
        f"Hour of detection in {len(rows)} cells. The literal reading has the paper's outcome in {same['literal']}, "
        f"the closest experiment in {same['closest']}.",
    )
