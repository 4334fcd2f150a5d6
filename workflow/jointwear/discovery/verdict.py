"""The verdict on one data set, typed, in the layout of verdict.json."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from typing import Any

#: Words of a verdict; `NONE` is that on data that contradict nothing of the given robot.
NONE, RETUNED, EFFECTS, UNKNOWN = "none", "retuned", "effects", "unknown"


@dataclass(frozen=True)
class Quantity:
    """A parameter of an effect; `std` is None for one that was not estimated."""

    value: float
    std: float | None
    unit: str


@dataclass(frozen=True)
class Regime:
    """Range of the argument of an effect over the training samples that could be judged."""

    argument: str
    range: tuple[float, float]
    unit: str


@dataclass(frozen=True)
class PeakTorque:
    """Largest torque of an effect on the held-out motion [N m] with its interval.

    Its form and that of filters are not known exactly, nor where it vanishes: the interval allows for that, so that it
    may be wider than the standard deviations of the parameters say.

    Attributes
    ----------
    as_fitted : that of the effect as it was fitted, where it lies at an end of the interval that was widened to reach
        it and `value` is the median of all forms that may be; else None, and `value` is the effect as fitted.
    """

    value: float
    low: float
    high: float
    as_fitted: float | None = None
    unit: str = "N m"
    confidence: float = 0.95


@dataclass(frozen=True)
class NamedEffect:
    """One effect that the model lacks; axes are 1-based.

    Attributes
    ----------
    tie_set : effects that explain the data as well, the named one first.
    probability : that it is there, given the data and the library; calibrated from `log_odds`, which are coarsened,
        `cross_validated_gain` and `structure_left`.
    lowers_error : probability that it lowers the squared error [N m] on records left out.
    gain_share : drop of the mean squared error on records left out, over the noise variance of the axis.
    structure_left : whether structure that no effect explains is left on its axis.
    repeated : share of the runs without one group of recordings that name it too, None where there are no groups.
    derived : what follows from the parameters, as the stiffness of an elastic gear: as right as those are that no data
        estimate.
    """

    effect: str
    axis: int | None
    source_axis: int | None
    tie_set: tuple[str, ...]
    parameters: dict[str, Quantity]
    regime: Regime
    peak_torque: PeakTorque
    evidence_nats: float
    probability: float
    log_odds: float
    cross_validated_gain: float
    lowers_error: float
    gain_share: float
    structure_left: bool = False
    repeated: float | None = None
    derived: dict[str, Quantity] = field(default_factory=dict)


@dataclass(frozen=True)
class Retuned:
    """A parameter that the model has and that the data contradict; values as in the robot file."""

    parameter: str
    axis: int
    nominal: float
    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class MovingBody:
    """A body that would explain a corrected link mass that the prior of the links hardly allows.

    Attributes
    ----------
    link : 1-based. mass : [kg], negative for one that the robot file has and the robot has not. sigmas : standard
        deviations of its prior by which the mass of the link is off.
    """

    link: int
    mass: float
    sigmas: float


@dataclass(frozen=True)
class Structure:
    """Structure of one axis over an argument that no effect explains.

    Attributes
    ----------
    range : of the argument, where the structure is strongest. share_of_range : how much of all that the motion covers
        of the argument that is; nearly 1 says nothing of where.
    """

    axis: int
    argument: str
    range: tuple[float, float]
    unit: str
    p_value: float
    share_of_range: float = 0.0


@dataclass(frozen=True)
class Suspect:
    """An effect that the data favour on an axis that stays unexplained: it may stand in for what has no name."""

    effect: str
    axis: int | None
    source_axis: int | None
    evidence_nats: float
    reason: str


@dataclass(frozen=True)
class MissedGate:
    """A gate that a candidate missed: what it reached and what the gate asks for."""

    gate: str
    reached: float
    needed: float


@dataclass(frozen=True)
class Lost:
    """A candidate that came close: the gate that refused it first, what it reached and what the gate asks for.

    `gates` : every gate that it missed, this one included, in the order in which they were asked.
    """

    effect: str
    axis: int | None
    source_axis: int | None
    evidence_nats: float
    gate: str
    reached: float
    needed: float
    gates: tuple[MissedGate, ...] = ()


@dataclass(frozen=True)
class NotTried:
    """An effect that these data do not allow to test; `axis` is None for all axes."""

    effect: str
    axis: int | None
    reason: str


@dataclass(frozen=True)
class Gap:
    """RMS error [N m] of every model on held-out motion, one value per axis; None where an axis cannot be judged."""

    nominal: tuple[float | None, ...]
    retuned: tuple[float | None, ...]
    augmented: tuple[float | None, ...]
    noise_floor: tuple[float | None, ...]
    unit: str = "N m"
    per: str = "axis, RMS over moving samples of the test trajectories"


@dataclass(frozen=True)
class AboveNoise:
    """A joint whose error on held-out motion stays above the noise; `ratio` is that error over the noise floor."""

    axis: int
    ratio: float


@dataclass(frozen=True)
class BuildsUp:
    """A joint whose Coulomb friction builds up with the speed, which no robot file holds: the torque was put right.

    `form` : "as a tanh", "as an arctan" or "in proportion to speed". `speed` : scale of the form [rad/s].
    """

    axis: int
    form: str
    speed: float


@dataclass(frozen=True)
class NotIdentifiable:
    """Effects that this motion cannot show or cannot tell apart."""

    effects: tuple[str, ...]
    axis: int | None
    reason: str


@dataclass(frozen=True)
class GivenUp:
    """One step of a fall back: what was given up, and the error over that of the given robot that led to it."""

    step: str
    ratio: float


@dataclass(frozen=True)
class FallBack:
    """An axis on which a model was put back because it predicted records left out worse than the given robot.

    There is one for each model and axis. On an axis on which structure is left that nothing explains, or on which a
    model gains and loses by turns, it is put back too, in whole or in part: `ratio` may be below 1. An effect may be
    named and yet not written: it is there, but its torque carries so much noise that the file is better without.

    Attributes
    ----------
    ratio : error of the model as it was fitted, on records left out, over that of the given robot.
    step : what was given up in words, in that order. steps : the same one by one, each with the error that led to it.
        What mends one axis may cost another, which is put back next: the errors need not fall.
    kept : what is written for the axis, in words. held_out : error of the file on held-out motion over that of the
        given robot, None where the axis cannot be judged.
    """

    model: str
    axis: int
    ratio: float
    step: str
    steps: tuple[GivenUp, ...]
    kept: str
    held_out: float | None


@dataclass(frozen=True)
class NextExperiment:
    """What the next experiment would separate: shares of the first effect that the second cannot imitate."""

    effects: tuple[str, str]
    axis: int
    share_now: float
    share_then: float


@dataclass(frozen=True)
class Verdict:
    """What discovery says about one data set.

    Attributes
    ----------
    verdict : none, retuned, effects or unknown.
    to_the_noise : whether the held-out error is near the noise floor on every axis that could be judged.
    above_the_noise : the axes on which it is not: a verdict is not complete there, structure told or not.
    misfits : optimisers that ended at their start or on a bound, in words; an entry is a reason for doubt.
    noise_untold : the axes of which the noise floor is not known: too few samples lie between reversals (the floor is
        None, and nothing is named), or its estimate holds what the model lacked or comes in bursts that hide the
        torque or strike several joints at once (the floor is no more than the held-out error).
    rings : those of them whose noise comes in bursts.
    bodies : that would explain corrected link masses.
    builds_up : joints whose friction builds up with the speed, which was put right before anything was asked.
    free_identification : RMS error [N m] of a fit of all parameters without a prior, per axis.
    filter_cutoff_hz : of the filter that derived velocity and acceleration, per axis; None where none did.
    """

    dataset: str
    verdict: str
    effects: tuple[NamedEffect, ...]
    retuned: tuple[Retuned, ...]
    unexplained: tuple[Structure, ...]
    suspects: tuple[Suspect, ...]
    gap: Gap
    to_the_noise: bool
    lost: tuple[Lost, ...]
    not_tried: tuple[NotTried, ...]
    not_identifiable: tuple[NotIdentifiable, ...]
    fallbacks: tuple[FallBack, ...]
    misfits: tuple[str, ...]
    restrictions: tuple[str, ...]
    next_experiment: str | None = None
    next_experiment_purpose: NextExperiment | None = None
    free_identification: tuple[float | None, ...] = ()
    filter_cutoff_hz: tuple[float | None, ...] = ()
    above_the_noise: tuple[AboveNoise, ...] = ()
    builds_up: tuple[BuildsUp, ...] = ()
    noise_untold: tuple[int, ...] = ()
    rings: tuple[int, ...] = ()
    bodies: tuple[MovingBody, ...] = ()

    def to_data(self) -> dict[str, Any]:
        """Return plain dicts and lists in the layout of verdict.json."""
        return _plain(asdict(self))

    def to_json(self) -> str:
        """Return the text of verdict.json."""
        return json.dumps(self.to_data(), indent=1, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(x) for key, x in value.items()}
    return [_plain(x) for x in value] if isinstance(value, (list, tuple)) else value
