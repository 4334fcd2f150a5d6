"""The figures of the paper, drawn in one go: they share the start-up of the plotting library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from jointwear.publishing.figures.figure_1 import draw_figure_1
from jointwear.publishing.figures.figure_2 import draw_figure_2
from jointwear.publishing.figures.figure_3 import draw_figure_3
from jointwear.publishing.figures.figure_4 import draw_figure_4


def draw_paper_figures(
    *,
    simulation: str | Path,
    features: str | Path,
    model: str | Path,
    detection: str | Path,
    trajectories: Sequence[str],
    robot: str | Path,
    task: str | Path,
    published: str | Path,
    outputs: Mapping[str, str],
    replicate: int,
    confidence: float,
) -> None:
    """Draw Figures 1 to 4 as SVG.

    Parameters
    ----------
    simulation, features, model, detection : files of the worn run that Figures 1 to 3 show.
    trajectories : commanded motion of every task (Figure 4).
    robot, task : robot file and task file of that run.
    published : the paper's values.
    outputs : SVG file of ``figure_1`` to ``figure_4``.
    replicate : 1-based. confidence : of the control limit.

    Raises
    ------
    InputError : naming the file, if one is damaged.
    """
    draw_figure_1(simulation, robot, task, published, outputs["figure_1"], replicate)
    draw_figure_2(features, published, outputs["figure_2"], replicate)
    draw_figure_3(model, detection, published, outputs["figure_3"], replicate, confidence)
    draw_figure_4(trajectories, published, outputs["figure_4"])
