"""Joints on which training and test trajectories disagree about the model: one of the two is off, the other is not."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.verdict import AboveNoise, Gap
from jointwear.files.wording import numbered


def unnamed_axes(joints: int, named: Collection[int | None]) -> set[int]:
    """Return the axes, from 1, on which no effect with a name acts: what is off there a name elsewhere says nothing of.

    Parameters
    ----------
    joints : number of them. named : axes, from 1, of the effects that have a name; None of the whole arm acts on all.
    """
    return set() if None in named else set(range(1, joints + 1)) - set(named)


def only_held_out(problem: Problem, above: Sequence[AboveNoise], gap: Gap, asked: Collection[int]) -> list[int]:
    """Return the axes, from 1, whose held-out error noise does not reach, though training shows nothing without a name.

    Parameters
    ----------
    asked : axes, from 1, that are looked at.
    """
    floors = ((a.axis, gap.noise_floor[a.axis - 1]) for a in above if a.axis in asked)
    return [axis for axis, floor in floors if _beyond(problem, axis, gap.augmented[axis - 1], floor, problem.test)]


def only_training(problem: Problem, unsure: Mapping[int, float], gap: Gap, asked: Collection[int]) -> list[int]:
    """Return the axes, from 1, on which training is off by what noise of the test trajectories does not reach.

    Between two records noise of a sensor does not differ as much. What looks like noise of the training trajectories is
    then what the model lacks there, and too irregular for any structure, as the jumps of an encoder that loses counts.

    Parameters
    ----------
    unsure : axis, from 1, -> RMS [N m] of what was taken for noise there, and is more than the test trajectories leave.
    asked : axes, from 1, that are looked at.
    """
    return [
        axis
        for axis, noise in unsure.items()
        if axis in asked and _beyond(problem, axis, noise, gap.augmented[axis - 1], problem.train)
    ]


def _beyond(problem: Problem, axis: int, error: float, noise: float, part: np.ndarray) -> bool:
    """Return whether an error [N m] of a part (N,) of the samples is beyond noise, and large enough to matter.

    It matters to a simulation too: below `smallest_share` of the torque even exact models differ.
    """
    settings = problem.settings
    size = np.sqrt(np.nanmean(problem.measured.torque[part, axis - 1] ** 2))
    return bool(error > settings.noise_sigmas * noise and np.sqrt(error**2 - noise**2) > settings.smallest_share * size)


def held_out_alone(axes: Sequence[int], above: Sequence[AboveNoise]) -> list[str]:
    """Say which axes disagree with the model in the test trajectories alone, in one sentence or none."""
    if not axes:
        return []
    words = (
        f"{numbered('joint', axes)}: {disagreement(axes, above)}, the training trajectories do not; look whether the "
        "records of the test trajectories are sound (torque and motion of one record, sign, unit, the same robot), or "
        "whether something acts there alone"
    )
    return [words]


def training_alone(axes: Sequence[int], unsure: Mapping[int, float], gap: Gap) -> list[str]:
    """Say which axes disagree with the model in the training trajectories alone, in one sentence or none."""
    if not axes:
        return []
    largest = max(unsure[axis] / gap.augmented[axis - 1] for axis in axes)
    words = (
        f"{numbered('joint', axes)}: the training trajectories disagree with the model by up to {largest:.2g} times "
        "what the test trajectories leave, and no effect or structure tells how; noise of a sensor does not differ as "
        "much between records: look whether the records of the training trajectories are sound, and whether positions "
        "jump there, as of an encoder that loses counts"
    )
    return [words]


def disagreement(axes: Sequence[int], above: Sequence[AboveNoise]) -> str:
    """Say by how much the test trajectories of some axes, from 1, disagree with the model."""
    largest = max(a.ratio for a in above if a.axis in axes)
    return f"the test trajectories disagree with the model by up to {largest:.2g} times the noise"
