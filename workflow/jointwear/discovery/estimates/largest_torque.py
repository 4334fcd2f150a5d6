"""The largest torque of a named effect on the held-out motion, with its 95 % interval."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.discovery.estimates.curvature import Spreads
from jointwear.discovery.estimates.fast_waves import draw_unfiltered
from jointwear.discovery.estimates.forms import Form, changed_in_holes
from jointwear.discovery.estimates.peak_torque import DRAWS, draw_form_errors, draw_torque, height
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, on_all_axes, raw_columns
from jointwear.discovery.problem.instruments import band_limited
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.whitening import White
from jointwear.effects import State, get_effect

#: Speed, over that from which the largest torque is stated, at which no sample lies beside a reversal any more.
NOT_BESIDE = 3.0
#: Quantiles of what is drawn between which the torque lies with the confidence that a verdict states.
ENDS = (0.025, 0.975)
#: Share of a peak in which all of its rate of torque is noise that motion is left at least.
LEAST_MOTION = 1e-3


@dataclass(frozen=True)
class Peak:
    """The largest torque of an effect on the held-out motion [N m].

    Attributes
    ----------
    value : that of the effect as it was fitted, or the median of what is drawn where that does not reach it.
    low, high : ends of the 95 % interval of what is drawn, wide enough for the effect as fitted.
    beyond : that of the effect as fitted where it lies outside of what is drawn with that probability, else None.
    """

    value: float
    low: float
    high: float
    beyond: float | None = None


def peak_of(fitted: float, drawn: np.ndarray) -> Peak:
    """Return the largest torque [N m] with its interval, from that of the effect as fitted and what is drawn (d,).

    The form that is fitted is one of those that are drawn, and on other motion it may be the highest of them. It is no
    best value then, but what the robot file does: the interval reaches as far, and it is told that it does.
    """
    low, high = (float(x) for x in np.quantile(drawn, ENDS))
    if low <= fitted <= high:
        return Peak(fitted, low, high)
    return Peak(float(np.median(drawn)), min(low, fitted), max(high, fitted), fitted)


@dataclass(frozen=True)
class Fitted:
    """What was fitted to an effect.

    Attributes
    ----------
    coefficients, covariance : (p,) and (p, p) of its columns, `own` of them, and behind them of its `form` if it bends.
    parameters, std : by name. spreads : of the nonlinear ones that are free.
    lost : share of a wave that logs take of fast motion.
    """

    candidate: Candidate
    form: Form | None
    coefficients: np.ndarray
    covariance: np.ndarray
    own: int
    parameters: dict[str, float]
    std: dict[str, float]
    spreads: Spreads
    lost: float

    def torque(self, state: State) -> np.ndarray:
        """Return the torque (m, n) [N m] on every axis, as a robot file has it in holes of the argument."""
        torque = all_columns(state, self.candidate, self.form) @ self.coefficients
        if self.form is not None:
            bends = self.coefficients[self.own :]
            torque[:, self.candidate.axis] += changed_in_holes(self.form, self.parameters, bends, state)
        return torque


def all_columns(state: State, candidate: Candidate, form: Form | None) -> np.ndarray:
    """Return the columns (m, n, p) of an effect, and of its form if it bends, on every axis."""
    effect = get_effect(candidate.effect)
    if effect.whole_arm:
        return effect.columns(state, 0, None, candidate.nonlinear)
    if on_all_axes(candidate):
        return effect.spread(state, candidate.axis, candidate.source, candidate.nonlinear)[..., None]
    own = effect.columns(state, candidate.axis, candidate.source, candidate.nonlinear)
    if form is not None:
        own = np.concatenate([own, form.columns(state)], axis=1)
    full = np.zeros((len(own), state.position.shape[1], own.shape[1]))
    full[:, candidate.axis] = own
    return full


def largest_torque(white: White, terms: list[Term], fitted: Fitted, rng: np.random.Generator) -> Peak:
    """Return the largest torque of an effect on the held-out motion with its interval.

    Parameters
    ----------
    terms : of the model, those of the effect left out.
    """
    problem, candidate = white.problem, fitted.candidate
    effect, test, moving = get_effect(candidate.effect), problem.state.part(problem.test), _moving(problem)
    # An effect of one axis that shakes others too has the size that it has on its own.
    own_axis = slice(None) if candidate.axis is None else [candidate.axis]

    def largest(state: State) -> float:
        return float(np.max(np.abs(fitted.torque(state)[:, own_axis]), initial=0.0, where=moving[:, own_axis]))

    peak = largest(test)
    if candidate.axis is None:
        sampled = _of_whole_arm(fitted, test, moving, rng)
    elif effect.scaled:
        # Its bends follow rates of torque, whose highest samples are noise: the peak is as uncertain as the parameter.
        error = fitted.std[effect.scaled] / max(abs(fitted.parameters[effect.scaled]), 1e-12)
        sampled = peak * np.abs(1.0 + error * rng.standard_normal(DRAWS))
    else:
        sampled = _of_axis(white, terms, fitted, test, moving[:, candidate.axis], rng)
    sampled = sampled * draw_form_errors(effect, problem.settings, rng)
    if effect.waves is not None:
        sampled = sampled * (1.0 + fitted.lost * np.abs(rng.standard_normal(DRAWS)))
        sampled = sampled * draw_unfiltered(effect, test, candidate, moving[:, candidate.axis], DRAWS, rng)
    if effect.timing and candidate.axis is not None and peak > 0:
        # How much of the highest rate of torque is noise is not known: what the instruments leave is motion.
        cutoffs = white.cutoffs[candidate.axis]
        cutoff = cutoffs.late if effect.shifts(candidate.nonlinear) else cutoffs.timing
        measured = problem.measured
        calm = largest(band_limited(test, candidate.axis, cutoff, measured.rate, measured.vague_ends))
        sampled = sampled * np.clip(calm / peak, LEAST_MOTION, 1.0) ** rng.uniform(size=DRAWS)
    return peak_of(peak, sampled)


def _moving(problem: Problem) -> np.ndarray:
    """Return the mask (m, n) of the held-out samples for which the largest torque is stated."""
    moving = problem.moving[problem.test]
    fast = moving & (np.abs(problem.state.velocity[problem.test]) >= problem.settings.judged_speed)
    # Of an axis that is nowhere as fast the largest torque is what it is while it creeps.
    return np.where(fast.any(axis=0), fast, moving)


def _of_whole_arm(fitted: Fitted, test: State, moving: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Draw the largest torque (DRAWS,) [N m] of an effect on the whole arm."""
    columns = all_columns(test, fitted.candidate, fitted.form)
    # Ten columns on every axis: thinned, the largest torque is a slow function of the pose.
    keep = slice(None, None, max(1, len(columns) // 300))
    covariance = fitted.covariance
    root = np.linalg.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance) + 1e-300))
    draws = fitted.coefficients[:, None] + root @ rng.standard_normal((len(covariance), DRAWS))
    sampled = np.abs(np.einsum("mnk,kd->mnd", columns[keep], draws) * moving[keep][:, :, None])
    return sampled.max(axis=(0, 1), initial=0.0)


def _of_axis(
    white: White, terms: list[Term], fitted: Fitted, test: State, moving: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Draw the largest torque (DRAWS,) [N m] of an effect on one axis, of which `moving` (m,) samples count."""
    problem, candidate = white.problem, fitted.candidate
    torque = raw_columns(white, candidate) @ fitted.coefficients[: fitted.own]
    torque = torque[problem.usable[:, candidate.axis]]
    size, reach = height(torque), float(np.abs(torque).max(initial=0.0))
    sampled = np.abs(draw_torque(white, terms, candidate, fitted.spreads, size, reach, test, rng)[moving])
    if get_effect(candidate.effect).sequential:
        # How close to a reversal the torque is what the form says is not known.
        speed = np.abs(test.velocity[moving, candidate.axis])
        slowest = problem.settings.judged_speed * rng.uniform(1.0, NOT_BESIDE, DRAWS)
        sampled = np.where(speed[:, None] >= slowest, sampled, 0.0)
    return sampled.max(axis=0, initial=0.0)
