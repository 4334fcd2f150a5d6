"""What the test trajectories say once everything is decided: the gap, its noise floor, and whether they contradict.

They choose no effect, no parameter and no robot file. They can only make a verdict `unknown`: a model that training
cannot fault, and that fails on motion that it has not seen, is not called complete.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointwear.discovery.model.final_model import Final
from jointwear.discovery.model.noise_floor import floor_with_names
from jointwear.discovery.noise.bursts import rings, struck_together
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.trajectories_apart import (
    disagreement,
    held_out_alone,
    only_held_out,
    only_training,
    training_alone,
    unnamed_axes,
)
from jointwear.discovery.verdict import AboveNoise, Gap
from jointwear.files.json_values import six_digits
from jointwear.files.wording import numbered

#: Times the held-out error of the augmented model above which an estimate of noise holds what the model lacked: between
#: two records noise of a sensor does not differ as much.
ABOVE_ALL = 2.0


@dataclass(frozen=True)
class Ringing:
    """Noise [N m] of an axis that comes in bursts, and the axes, from 1, that have theirs at the same instants.

    Where none has it hides the torque.
    """

    noise: float
    beside: tuple[int, ...] = ()


@dataclass(frozen=True)
class HeldOut:
    """What the test trajectories say of the files that were written; axes count from 1.

    Attributes
    ----------
    gap : RMS errors, with a noise floor that is told. unsure : axis -> estimate of its noise [N m] that was too high.
    ringing : axis -> what comes in bursts there. above : axes whose error stays above the noise.
    alone : axes without a name that disagree here alone. trained : likewise, in the training trajectories alone.
    suspected : axes above the noise on which an effect is only suspected.
    to_the_noise : whether the error is near the floor on every axis that has both.
    """

    gap: Gap
    unsure: Mapping[int, float]
    ringing: Mapping[int, Ringing]
    above: tuple[AboveNoise, ...]
    alone: tuple[int, ...]
    trained: tuple[int, ...]
    suspected: tuple[int, ...]
    to_the_noise: bool

    @property
    def contradicts(self) -> bool:
        """Whether more is there than training has a name for."""
        return bool(self.alone or self.trained or self.suspected or self.ringing)

    def in_words(self) -> Iterable[str]:
        """Yield what a reader has to know of it."""
        yield from noise_too_high(self.gap, self.unsure)
        yield from noise_in_bursts(self.ringing)
        yield from held_out_alone(self.alone, self.above)
        yield from training_alone(self.trained, self.unsure, self.gap)
        yield from _without_a_name(self.suspected, self.above)


def held_out(final: Final, torques: Mapping[str, np.ndarray]) -> HeldOut:
    """Ask the test trajectories about a model whose files are written.

    Parameters
    ----------
    torques : (m, n) [N m] of the nominal, retuned and augmented model.
    """
    outcome, problem = final.outcome, final.outcome.problem
    left = {u.axis for u in outcome.unexplained}
    gap, unsure = with_told_floor(measure_gap(problem, torques, floor_with_names(final)), problem.too_coarse)
    gap, ringing = without_bursts(problem, torques["augmented"], gap, left)
    margin = problem.settings.near_the_floor
    above = above_the_noise(gap, margin)
    named = [e.named.candidate.axis for e in (*final.estimates, *final.unwritten)]
    asked = set() if left else unnamed_axes(len(gap.augmented), [None if a is None else a + 1 for a in named])
    return HeldOut(
        gap,
        unsure,
        ringing,
        above,
        alone=tuple(only_held_out(problem, above, gap, asked)),
        trained=tuple(only_training(problem, unsure, gap, asked)),
        suspected=() if left else tuple(_suspected(final, above)),
        to_the_noise=_to_the_noise(gap, margin),
    )


def measure_gap(problem: Problem, torques: Mapping[str, np.ndarray], floor: Iterable[float | None]) -> Gap:
    """Return the RMS error of every model over moving samples of the test trajectories, with the noise floor.

    Parameters
    ----------
    torques : model -> torque (m, n) [N m]. floor : RMS of the noise [N m] of each axis, None where it is not judged.
    """
    usable = problem.measured.usable & problem.test[:, None]

    def errors(kind: str) -> tuple[float | None, ...]:
        square = (problem.measured.torque - torques[kind]) ** 2
        return tuple(
            six_digits(np.sqrt(np.mean(square[usable[:, j], j]))) if usable[:, j].any() else None
            for j in range(square.shape[1])
        )

    return Gap(
        errors("nominal"),
        errors("retuned"),
        errors("augmented"),
        tuple(None if f is None else six_digits(f) for f in floor),
    )


def with_told_floor(gap: Gap, coarse: Collection[int]) -> tuple[Gap, dict[int, float]]:
    """Return the gap with a noise floor that is told, and of which axes, from 1, an estimate [N m] was too high.

    None is told of axes too coarse in time (`coarse`, 0-based). Noise is no more than what the augmented model leaves
    of motion that it has not seen.
    """
    floor, unsure = list(gap.noise_floor), {}
    for axis, (left, noise) in enumerate(zip(gap.augmented, gap.noise_floor, strict=True)):
        if axis in coarse:
            floor[axis] = None
        elif left is not None and noise is not None and noise > ABOVE_ALL * left:
            floor[axis], unsure[axis + 1] = left, noise
    return replace(gap, noise_floor=tuple(floor)), unsure


def noise_too_high(gap: Gap, unsure: Mapping[int, float]) -> Iterable[str]:
    """Yield in words of which axes the noise was estimated higher than all that is left of the held-out motion."""
    for axis, noise in unsure.items():
        yield (
            f"joint {axis}: noise was estimated as {noise:.2g} N m, while the augmented model leaves "
            f"{gap.augmented[axis - 1]:.2g} N m of the held-out motion: the estimate holds what the model lacked, or "
            "noise of the training trajectories alone, and what is smaller may be missed; log at a higher rate"
        )


def without_bursts(
    problem: Problem, model: np.ndarray, gap: Gap, explained: Collection[int]
) -> tuple[Gap, dict[int, Ringing]]:
    """Return the gap with a floor that no joint rings above, and of which axes, from 1, the noise was ringing.

    Parameters
    ----------
    model : (m, n) [N m] torque of the augmented model. explained : axes, from 0, of which it is said already that more
        than noise is left.
    """
    measured, floor, ringing = problem.measured, list(gap.noise_floor), {}
    asked = [axis for axis, noise in enumerate(floor) if noise is not None and axis not in explained]
    together = _together(problem, model, [axis for axis in asked if _matters(problem, axis, floor[axis])])
    for axis in asked:
        noise, torque, usable = floor[axis], measured.torque[:, axis], measured.usable[:, axis]
        hides = rings(noise, torque - model[:, axis], torque, usable, measured.trajectory)
        if hides or axis in together:
            left, beside = gap.augmented[axis], () if hides else tuple(other + 1 for other in together[axis])
            floor[axis], ringing[axis + 1] = noise if left is None else min(noise, left), Ringing(noise, beside)
    return replace(gap, noise_floor=tuple(floor)), ringing


def _matters(problem: Problem, axis: int, noise: float) -> bool:
    """Return whether noise [N m] is more of the torque of an axis than any form is known to."""
    torque = problem.measured.torque[problem.measured.usable[:, axis], axis]
    return bool(len(torque)) and noise > problem.settings.form_error * float(np.std(torque))


def _together(problem: Problem, model: np.ndarray, axes: Collection[int]) -> dict[int, tuple[int, ...]]:
    measured = problem.measured
    if len(axes) < 2:
        return {}
    sizes = np.abs(np.stack([measured.velocity, measured.acceleration, measured.torque], axis=-1))
    left = measured.torque - model
    return struck_together(left, measured.usable, measured.trajectory, sizes, axes, problem.settings)


def noise_in_bursts(ringing: Mapping[int, Ringing]) -> Iterable[str]:
    """Yield in words of which axes what was taken for noise is ringing."""
    for axis, found in ringing.items():
        bursts = "hides the torque and comes in bursts"
        if found.beside:
            bursts = f"comes in bursts, at the same instants as on {numbered('joint', found.beside)}"
        yield (
            f"joint {axis}: what looks like noise there, {found.noise:.2g} N m, {bursts}, which "
            "no sensor's noise does; lost motion in the gear behind the encoder of the motor rings like "
            "that, or a resonance that motion excites, or the torque signal is poor: what the model lacks there cannot "
            "be told; compare motor and link with a second encoder, or look at the raw torque"
        )


def above_the_noise(gap: Gap, margin: float) -> tuple[AboveNoise, ...]:
    """Return the axes on which the held-out error stays above the noise floor by more than `margin`, and the ratio."""
    return tuple(
        AboveNoise(axis, float(f"{a / max(f, 1e-300):.4g}"))
        for axis, (a, f) in enumerate(zip(gap.augmented, gap.noise_floor, strict=True), start=1)
        if a is not None and f is not None and a > (1 + margin) * f
    )


def _to_the_noise(gap: Gap, margin: float) -> bool:
    pairs = [(a, f) for a, f in zip(gap.augmented, gap.noise_floor, strict=True) if a is not None and f is not None]
    return bool(pairs) and not above_the_noise(gap, margin)


def _suspected(final: Final, above: Sequence[AboveNoise]) -> list[int]:
    """Return the axes, from 1, on which an effect is suspected and the held-out error stays above the noise.

    What it stood for is there, in training and in the test trajectories, and has no name.
    """
    axes = {one.candidate.axis for one, _ in final.suspects}
    return [a.axis for a in above if None in axes or a.axis - 1 in axes]


def _without_a_name(axes: Sequence[int], above: Sequence[AboveNoise]) -> list[str]:
    """Say which axes lack something for which an effect is only suspected, in one sentence or none."""
    if not axes:
        return []
    words = (
        f"{numbered('joint', axes)}: what the model lacks is like a suspected effect, but none of the library describes"
        f" it; {disagreement(axes, above)}"
    )
    return [words]
