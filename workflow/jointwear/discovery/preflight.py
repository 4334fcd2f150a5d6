"""Before the run: what was recorded, whether it can belong to the robot, and what this motion can and cannot show.

Nothing is fitted to the torque but the level and colour of its noise, so that the check takes seconds and says nothing
of what discovery will find.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.discovery.posing import pose_problem
from jointwear.discovery.problem.candidates import Dictionary, build_dictionary
from jointwear.discovery.problem.identifiability import Visible, identifiability
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.whitening import White, whiten
from jointwear.discovery.search.smallest_sizes import smallest_size
from jointwear.discovery.settings import Settings
from jointwear.discovery.undecided import NUMERICAL, reason
from jointwear.effects import check_effects, get_effect
from jointwear.files.errors import InputError
from jointwear.files.json_values import as_json, six_digits
from jointwear.files.shown_numbers import number
from jointwear.files.text_files import replace_text
from jointwear.files.wording import numbered
from jointwear.measurement.checks.checked import Checked
from jointwear.measurement.derived.even_steps import step_of
from jointwear.measurement.recording import Recording, split
from jointwear.measurement.recording_files import load_recording
from jointwear.measurement.refused import what_mends
from jointwear.measurement.units import POSITION_WORDS, spelled
from jointwear.publishing.report.rendering import render_page
from jointwear.robots.robot import Robot, load_robot

#: Unit of the size of what has none of its own.
OF_FRICTION = "share of the friction of the joint"
#: A step of time this many times the usual one is a gap.
GAP = 1.5
#: Share of the samples of an axis in motion below which more motion is asked for.
MOVING = 0.3
#: Share of the samples below whose speed the stated one lies.
SPEED = 0.95


@dataclass(frozen=True)
class Trajectory:
    """One trajectory: its label, what it is for, length [s], samples, gaps and the longest of them [s]."""

    label: int
    role: str
    seconds: float
    samples: int
    gaps: int
    longest_gap: float


@dataclass(frozen=True)
class Joint:
    """One joint as recorded.

    Attributes
    ----------
    travel [rad], speed : 95 % quantile [rad/s]. moving : share of samples in motion. encoder_step : smallest step of
    the position [rad], None where there is none. cutoff : of the filter behind its derivatives [Hz]. torque : RMS,
    noise : its standard deviation [N m]; None where the joint cannot be judged.
    """

    axis: int
    travel: float
    speed: float
    moving: float
    encoder_step: float | None
    cutoff: float | None
    torque: float
    noise: float | None


@dataclass(frozen=True)
class Shown:
    """An effect on one axis: the size from which this motion shows it, or the reason why not.

    The size is in `unit`, which is empty where there is no size. `rival` is the effect that it cannot be told from.
    """

    effect: str
    axis: int | None
    smallest_size: float | None
    rival: str
    reason: str
    unit: str = ""


@dataclass(frozen=True)
class DataCheck:
    """What a data set allows; `refused` says why discovery would refuse it, with `suggestion`."""

    dataset: str
    refused: str
    suggestion: str
    rate_hz: float | None = None
    torque_kind: str = "motor"
    encoder_side: str = "motor"
    trajectories: tuple[Trajectory, ...] = ()
    joints: tuple[Joint, ...] = ()
    passed: tuple[str, ...] = ()
    restrictions: tuple[str, ...] = ()
    shown: tuple[Shown, ...] = ()
    not_shown: tuple[Shown, ...] = ()
    pairs: tuple[Shown, ...] = ()
    advice: tuple[str, ...] = ()

    def to_json(self) -> str:
        """Return the text of check.json."""
        return json.dumps(as_json(asdict(self)), indent=1, allow_nan=False) + "\n"


def check_data(recording: Recording, robot: Robot, settings: Settings | None = None) -> DataCheck:
    """Check a recording against a robot without looking for anything that is missing.

    Raises
    ------
    Refused : an InputError with a suggestion, as discovery itself would.
    """
    whole = split(recording)
    posed = pose_problem(whole, robot, settings or Settings())
    recording, problem, restrictions = posed.recording, posed.problem, list(posed.restrictions)
    try:
        noise, shown, not_shown, pairs = _shown(problem)
    except NUMERICAL as error:
        restrictions.append(reason(error))
        noise, shown, not_shown, pairs = [None] * robot.joints, [], [], []
    joints = _joints(recording, problem, noise)
    return DataCheck(
        dataset=recording.name,
        refused="",
        suggestion="",
        rate_hz=six_digits(1.0 / step_of(recording.time, recording.trajectory)),
        torque_kind=recording.torque_kind,
        encoder_side=recording.encoder_side,
        trajectories=tuple(_trajectories(whole)),
        joints=tuple(joints),
        passed=tuple(checks_passed(robot, recording.units.get("position") or "rad", posed.checked)),
        restrictions=tuple(restrictions),
        shown=tuple(shown),
        not_shown=tuple(_once(not_shown, problem)),
        pairs=tuple(pairs),
        advice=tuple(_advice(recording, problem, joints, not_shown, pairs)),
    )


def checks_passed(robot: Robot, unit: str, checked: Checked) -> Iterator[str]:
    """Yield in words what was checked of a recording, with positions in `unit`, that is not refused."""
    yield f"{robot.joints} joints, as the robot"
    read_as = spelled("position", unit)
    yield f"positions are in {POSITION_WORDS.get(read_as, read_as)}"
    if checked.axes_asked:
        sign = "sign, " if checked.signs_sure else ""
        yield f"no other {sign}order or side of the axes, nor a zero a quarter turn off, fits the model clearly better"


def _shown(problem: Problem) -> tuple[list[float | None], list[Shown], list[Shown], list[Shown]]:
    """Return the noise [N m] of every joint, and the effects that the motion shows, hides and leaves in pairs."""
    white = whiten(problem, estimate_noise(problem))
    dictionary = build_dictionary(white)
    shown, not_shown, pairs = _visible(white, dictionary)
    for effect, axis, why in dictionary.not_tried:
        not_shown.append(Shown(effect, None if axis is None else axis + 1, None, "", why))
    told = [None if w is None or a in problem.too_coarse else w.marginal for a, w in enumerate(white.whiteners)]
    return told, shown, not_shown, pairs


def _trajectories(recording: Recording) -> list[Trajectory]:
    step = step_of(recording.time, recording.trajectory)
    found = []
    for label in recording.labels:
        time = recording.time[recording.trajectory == label]
        steps = np.diff(time)
        gaps = steps[steps > GAP * step]
        role = "train" if label in recording.train else "test" if label in recording.test else "not used"
        longest = float(gaps.max()) if len(gaps) else 0.0
        found.append(Trajectory(label, role, six_digits(np.ptp(time)), len(time), len(gaps), six_digits(longest)))
    return found


def _joints(recording: Recording, problem: Problem, noise: list[float | None]) -> list[Joint]:
    measured = problem.measured
    found = []
    for j in range(recording.joints):
        values = recording.position[np.isfinite(recording.position[:, j]), j]
        cutoff, step = measured.cutoff[j], problem.encoder_steps[j]
        found.append(
            Joint(
                axis=j + 1,
                travel=six_digits(np.ptp(values)),
                speed=six_digits(np.quantile(np.abs(measured.velocity[:, j]), SPEED)),
                moving=six_digits(np.mean(measured.usable[:, j])),
                encoder_step=float(step) if np.isfinite(step) else None,
                cutoff=six_digits(cutoff) if np.isfinite(cutoff) else None,
                torque=six_digits(np.sqrt(np.nanmean(recording.torque[:, j] ** 2))),
                noise=None if noise[j] is None else six_digits(noise[j]),
            )
        )
    return found


def _visible(white: White, dictionary: Dictionary) -> tuple[list[Shown], list[Shown], list[Shown]]:
    """Return the effects that the motion shows, those that it does not, and the pairs that it cannot tell apart."""
    needed = white.problem.settings.visible
    whole = {candidate.effect: blocks for candidate, blocks, _ in dictionary.whole if candidate.axis is None}
    best: dict[tuple, Visible] = {}
    for v in identifiability(white, dictionary):
        key = (v.effect, v.axis)
        if key not in best or v.energy > best[key].energy:
            best[key] = v
    shown, not_shown, pairs = [], [], []
    for v in best.values():
        axis = None if v.axis is None else v.axis + 1
        if v.energy < needed:
            not_shown.append(Shown(v.effect, axis, None, "", f"too weak at {v.at}"))
        elif v.left < needed:
            pairs.append(Shown(v.effect, axis, None, v.rival, "the rival takes most of it"))
        else:
            size = smallest_size(white, v, whole.get(v.effect))
            if np.isfinite(size):
                shown.append(Shown(v.effect, axis, six_digits(size), "", "", v.unit or OF_FRICTION))
            else:
                not_shown.append(Shown(v.effect, axis, None, "", "links that are a little off do the same"))
    return shown, not_shown, pairs


def _once(found: list[Shown], problem: Problem) -> list[Shown]:
    """Return entries that are the same on every judged axis as one."""
    axes: dict[tuple[str, str], list[Shown]] = {}
    for one in found:
        axes.setdefault((one.effect, one.reason), []).append(one)
    result = []
    for (effect, why), same in axes.items():
        if len(same) > 1 and len(same) >= len(problem.judged):
            result.append(Shown(effect, None, None, "", why))
        else:
            result += same
    return result


def _advice(
    recording: Recording, problem: Problem, joints: list[Joint], not_shown: list[Shown], pairs: list[Shown]
) -> list[str]:
    """Return what to record instead, the most useful first."""
    found = []
    still = [j.axis for j in joints if j.moving < MOVING]
    if still:
        found.append(f"Move {numbered('joint', still)} for a larger part of the time.")
    if len(recording.train) < 3:
        found.append("Record at least three trajectories to learn from: each is left out in turn to check every name.")
    if not problem.state.has_temperature:
        found.append("Record the temperature of the motors or gears: effects of temperature cannot be seen without.")
    wanted = dict.fromkeys(p.effect for p in [*pairs, *not_shown])
    for effect in list(wanted)[:6]:
        if get_effect(effect).identifiable and get_effect(effect).excitation:
            found.append(f"For {get_effect(effect).phrase}: {get_effect(effect).excitation}.")
    return found


def write_check(
    name: str, entry: Mapping[str, Any], robot: str | Path, settings: Settings, output: str | Path, page: str | Path
) -> DataCheck:
    """Check one data set, write the result as JSON and as a page, and return it; a refusal is a result too."""
    try:
        arm = load_robot(robot)
        check_effects(arm)
        found = check_data(load_recording(entry, name), arm, settings)
    except InputError as error:
        found = DataCheck(name, str(error), what_mends(error))
    replace_text(output, found.to_json())
    seen = {s.effect for s in found.shown}
    hidden = dict.fromkeys(s.effect for s in [*found.pairs, *found.not_shown] if s.effect not in seen)
    context = {
        "check": found,
        "number": number,
        "phrase": lambda effect: get_effect(effect).phrase,
        "least_share": settings.smallest_share,
        "of_friction": OF_FRICTION,
        "seen": seen,
        "hidden": [get_effect(effect).phrase for effect in hidden],
    }
    replace_text(page, render_page("check.html.j2", context))
    return found
