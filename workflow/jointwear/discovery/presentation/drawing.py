"""Figures of the discovery page, drawn from the result files of one data set as SVG."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.patches import Rectangle

from jointwear.discovery.problem.regimes import (
    Regimes,
    axis_of_most,
    pose_of_most,
    read_model_samples,
    residual_by_regime,
)
from jointwear.files.json_documents import read_json
from jointwear.files.shown_numbers import number
from jointwear.files.storage import open_dataset, read_variables
from jointwear.measurement.clock import GAP
from jointwear.publishing.figures import palette
from jointwear.publishing.figures.style import new_figure, save

MODELS = ("nominal", "retuned", "augmented")


#: Most samples of the torque that are drawn over time.
SAMPLES_SHOWN = 1200
#: Widths [inches] of a joint of a map and of the names beside it: that of an ordinary arm fills a phone, where a number
#: in every cell is read without scrolling.
_OF_JOINT, _OF_NAMES = 0.46, 1.6
#: Characters of a label below a map that a joint has room for.
_OF_LABEL = 5
#: Longest line [characters] of a name beside a map.
_LINE = 21


def _map_width(joints: int) -> float:
    """Return the width [inches] of a map with a column for every joint."""
    return _OF_NAMES + _OF_JOINT * joints


def _wrapped(name: str) -> str:
    return "\n".join(textwrap.wrap(name, _LINE))


def draw_regimes(regimes: Regimes, output: str | Path) -> None:
    """Draw the residual torque in N m by joint and regime, after retuning; the colour is the share of the residual."""
    joints = len(regimes.residual)
    rows = max(len(regimes.arguments), 1)
    figure = new_figure(0.42 * rows + 0.9, width=_map_width(joints))
    axes = figure.add_subplot()
    for j, k in np.argwhere(np.isfinite(regimes.rms)):
        share = float(regimes.share[j, k])
        colour = palette.mix(palette.SEQUENTIAL, share)
        axes.add_patch(Rectangle((j - 0.5, k - 0.5), 1, 1, facecolor=colour, edgecolor=palette.PAPER))
        text = f"{number(float(regimes.rms[j, k]), 2)}\n{100 * share:.0f} %"
        axes.text(j, k, text, ha="center", va="center", fontsize=7.5, color=palette.text_on(colour))
    axes.set(xlim=(-0.5, joints - 0.5), ylim=(rows - 0.5, -0.5))
    whole = ["at rest" if np.isnan(r) else number(float(r), 2) for r in regimes.residual]
    axes.set_xticks(range(joints), [f"{j + 1}\n{text}" for j, text in enumerate(whole)])
    # Below the columns of an arm of few joints one line would be cut.
    axes.set_xlabel(textwrap.fill("joint, and its whole residual [N m]", _OF_LABEL * (joints + 1)))
    axes.set_yticks(range(len(regimes.arguments)), [_wrapped(a) for a in regimes.arguments])
    axes.grid(False)
    text = "Residual torque after retuning that a mean over each regime explains, RMS in N m and share of the square"
    most = regimes.largest()
    if most is not None:
        text += (
            f"; most on joint {most['joint']} over {most['argument']}: {number(most['rms'], 2)} N m, "
            f"{100 * most['share']:.0f} % of {number(most['residual'], 2)} N m"
        )
    save(figure, output, "Residual torque by joint and regime", f"{text}.")


def draw_where(where: str | Path, output: str | Path) -> None:
    """Draw the map of structure that retuning leaves: joints across, arguments down."""
    argument, joint, structure = read_variables(where, "argument", "joint", "structure")
    figure = new_figure(0.3 * len(argument) + 0.9, width=_map_width(len(joint)))
    axes = figure.add_subplot()
    most = max(float(np.nanmax(structure, initial=1.0)), 10.0)
    for k in range(len(argument)):
        for j in range(len(joint)):
            value = structure[j, k]
            if not np.isfinite(value):
                continue
            colour = palette.mix(palette.SEQUENTIAL, float(np.log1p(max(value, 0.0)) / np.log1p(most)))
            axes.add_patch(Rectangle((j - 0.5, k - 0.5), 1, 1, facecolor=colour, edgecolor=palette.PAPER))
            axes.text(j, k, f"{max(value, 0):.0f}", ha="center", va="center", fontsize=8, color=palette.text_on(colour))
    axes.set(xlim=(-0.5, len(joint) - 0.5), ylim=(max(len(argument), 1) - 0.5, -0.5))
    axes.set_xticks(range(len(joint)), [str(j) for j in joint])
    axes.set_xlabel("joint")
    axes.set_yticks(range(len(argument)), [_wrapped(a) for a in argument])
    axes.grid(False)
    text = "Structure left after retuning, in nats, by joint and argument"
    if np.isfinite(structure).any():
        j, k = np.unravel_index(int(np.nanargmax(structure)), structure.shape)
        text += f"; most on joint {joint[j]} over {argument[k]}"
    text += "."
    save(figure, output, "Where the model disagrees", text)


def draw_gap(verdict: str | Path, output: str | Path) -> None:
    """Draw the gap of the three models and the noise floor, one group of bars per joint."""
    gap = read_json(verdict)["gap"]
    kinds = (*MODELS, "noise_floor")
    n = len(gap["nominal"])
    figure = new_figure(2.6)
    axes = figure.add_subplot()
    floors = np.array([np.nan if x is None else x for x in gap["nominal"]], dtype=float)
    for i, kind in enumerate(kinds):
        values = np.array([np.nan if x is None else x for x in gap[kind]], dtype=float)
        share = 100 * values / floors
        axes.bar(np.arange(n) + 0.2 * (i - 1.5), share, 0.19, color=palette.SERIES[i], label=kind.replace("_", " "))
    axes.set_xticks(range(n), [f"joint {j + 1}" for j in range(n)])
    axes.set_ylabel("RMS error, % of nominal")
    axes.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.5, 1.16))
    words = "; ".join(
        f"joint {j + 1} {gap['nominal'][j]:.3g}, {gap['retuned'][j]:.3g}, {gap['augmented'][j]:.3g} N m"
        for j in range(n)
        if gap["nominal"][j] is not None
    )
    save(figure, output, "Gap on held-out motion", f"RMS error of the nominal, retuned and augmented model: {words}.")


def draw_held_out(models: str | Path, axis: int, output: str | Path) -> None:
    """Draw measured and simulated torque of a 0-based axis over the longest held-out stretch without a gap."""
    time, trajectory, torque, *found = read_variables(models, "time", "trajectory", "torque", *MODELS)
    index = np.flatnonzero(_test_of(models, trajectory))
    if not len(index):
        index = np.arange(len(time))
    index = longest_run(index, time)[:SAMPLES_SHOWN]
    figure = new_figure(2.9)
    axes = figure.add_subplot()
    t = time[index] - time[index[0]]
    axes.plot(t, torque[index, axis], color=palette.MUTED, linewidth=2.6, alpha=0.5, label="measured")
    for i, (kind, values) in enumerate(zip(MODELS, found, strict=True)):
        axes.plot(
            t, values[index, axis], color=palette.SERIES[i], linestyle=palette.DASHES[i], linewidth=1.2, label=kind
        )
    axes.set(xlabel="time [s]", ylabel=f"torque of joint {axis + 1} [N m]")
    axes.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.5, 1.16))
    errors = [float(np.sqrt(np.mean((torque[index, axis] - v[index, axis]) ** 2))) for v in found]
    text = ", ".join(f"{k} {e:.3g} N m" for k, e in zip(MODELS, errors, strict=True))
    save(figure, output, "Held-out torque", f"Torque of joint {axis + 1} on held-out motion; RMS error: {text}.")


def longest_run(index: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Return the longest run of samples in a row in which time (m,) [s] goes on without a gap."""
    step = np.diff(time[index])
    usual = np.median(step[step > 0]) if np.any(step > 0) else 0.0
    breaks = (np.diff(index) != 1) | (step <= 0) | (step > GAP * usual)
    return max(np.split(index, np.flatnonzero(breaks) + 1), key=len)


def _test_of(models: str | Path, trajectory: np.ndarray) -> np.ndarray:
    with open_dataset(models) as dataset:
        return np.isin(trajectory, np.atleast_1d(dataset.test))


def axis_of(effect: dict[str, Any], models: str | Path) -> int:
    """Return the 0-based axis on which an effect is shown; one of the whole arm where it matters most."""
    return effect["axis"] - 1 if effect["axis"] is not None else axis_of_most(read_model_samples(models))


def _argument_of(effect: dict[str, Any], place: int, models: str | Path, axis: int) -> tuple[np.ndarray, str]:
    """Return what an effect depends on at every sample, and its label; of the whole arm a position that moves it."""
    if effect["axis"] is None:
        joint = pose_of_most(read_model_samples(models), axis)
        position = read_variables(models, "position")[0]
        return position[:, joint], f"position of joint {joint + 1} [rad]"
    regime = effect["regime"]
    unit = regime["unit"].replace("deg", "°")
    return read_variables(models, "argument")[0][place], f"{regime['argument']} [{unit}]"


def draw_effect(effect: dict[str, Any], place: int, models: str | Path, output: str | Path) -> None:
    """Draw the residual against the argument of one effect, before (retuned) and after (augmented), all motion.

    Points are means of 40 bins; a solid line is motion forward, a dashed one motion backward.

    Parameters
    ----------
    place : of the effect among those of the verdict, from 0.
    """
    axis = axis_of(effect, models)
    argument, label = _argument_of(effect, place, models, axis)
    usable, velocity, torque, retuned, augmented = (
        v[:, axis] for v in read_variables(models, "usable", "velocity", "torque", "retuned", "augmented")
    )
    figure = new_figure(2.9)
    axes = figure.add_subplot()
    spans = []
    for name, values, colour in (("retuned", retuned, palette.SERIES[1]), ("augmented", augmented, palette.SERIES[2])):
        span = 0.0
        for sense, style in ((1, "solid"), (-1, (0, (3, 1.5)))):
            chosen = (usable > 0) & (np.sign(velocity) == sense) & np.isfinite(argument)
            if chosen.sum() < 40:
                continue
            edges = np.unique(np.quantile(argument[chosen], np.linspace(0, 1, 41)))
            place = np.clip(np.searchsorted(edges, argument[chosen], side="right") - 1, 0, len(edges) - 2)
            residual = (torque - values)[chosen]
            counts = np.bincount(place, minlength=len(edges) - 1)
            means = np.bincount(place, residual, len(edges) - 1) / np.maximum(counts, 1)
            centres = 0.5 * (edges[1:] + edges[:-1])
            axes.plot(
                centres[counts > 0],
                means[counts > 0],
                color=colour,
                linestyle=style,
                label=f"{name}, {'forward' if sense > 0 else 'backward'}",
            )
            span = max(span, float(np.ptp(means[counts > 0])))
        spans.append(f"{name} {span:.3g} N m")
    axes.set(xlabel=label, ylabel=f"residual of joint {axis + 1} [N m]")
    axes.legend(ncols=2, loc="upper center", bbox_to_anchor=(0.5, 1.26))
    text = f"Mean residual of joint {axis + 1} over {label}; range of the means: {', '.join(spans)}."
    save(figure, output, f"{effect['effect']}: before and after", text)


def draw_all(verdict: str | Path, where: str | Path, models: str | Path, folder: str | Path) -> dict[str, Path]:
    """Draw every figure of a data set into `folder`; return name: file, the effects' as ``effect_1`` and so on."""
    content = read_json(verdict)
    folder = Path(folder)
    figures = {name: folder / f"{name}.svg" for name in ("regimes", "where", "gap", "held_out")}
    draw_regimes(residual_by_regime(read_model_samples(models)), figures["regimes"])
    draw_where(where, figures["where"])
    draw_gap(verdict, figures["gap"])
    draw_held_out(models, axis_shown(content, models), figures["held_out"])
    for place, effect in enumerate(content["effects"]):
        figures[f"effect_{place + 1}"] = folder / f"effect_{place + 1}.svg"
        draw_effect(effect, place, models, figures[f"effect_{place + 1}"])
    return figures


def axis_shown(content: dict[str, Any], models: str | Path) -> int:
    """The axis on which the first effect is shown; without one that whose gap is farthest above its noise."""
    if content["effects"]:
        return axis_of(content["effects"][0], models)
    gap = content["gap"]
    ratio = [(a / f if a is not None and f else -1.0) for a, f in zip(gap["nominal"], gap["noise_floor"], strict=True)]
    return int(np.argmax(ratio))
