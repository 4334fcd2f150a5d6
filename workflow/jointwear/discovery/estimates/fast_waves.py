"""What filters and lags of a log take of a wave over the motor angle, the more the faster it runs.

A log of the torque is smoothed, averaged or a fraction of a sample late, and of a fast wave of many teeth that takes a
part that nothing in the log tells. What slow samples say of the wave is the better measure of it.
"""

from __future__ import annotations

import numpy as np

from jointwear.discovery.linear import Fit, posterior_mean
from jointwear.discovery.problem.candidates import Candidate, prior_std, raw_columns
from jointwear.discovery.problem.whitening import White
from jointwear.effects import Effect, State, get_effect

#: Share of a wave that has to be left where its whole height is read off what is left.
LEAST = 0.01


def lost_to_speed(white: White, fit: Fit, candidate: Candidate) -> float:
    """Return the share of a wave that is missing because filters and lags of a log take more the faster it runs.

    What the slowest samples say of its amplitude, over what all of them say, beyond what their noise makes of it; 0 for
    what is no wave.
    """
    effect, problem, axis = get_effect(candidate.effect), white.problem, candidate.axis
    if effect.waves is None:
        return 0.0
    columns = raw_columns(white, candidate)
    speed = np.abs(problem.train_state.velocity[:, axis])
    slow = (speed <= np.median(speed[problem.usable[:, axis]]))[:, None]
    std = prior_std(white, candidate, columns)
    parts = np.concatenate([columns * slow, columns * ~slow], axis=1)
    b, gram = fit.gram({axis: white.columns(axis, parts)})
    covariance = np.linalg.inv(gram + np.diag(1 / np.tile(std, 2) ** 2))
    own = slice(0, len(std))
    there = float(np.linalg.norm((covariance @ b)[own]))
    whole = float(np.linalg.norm(posterior_mean(*fit.gram({axis: white.columns(axis, columns)}), std)))
    noise = float(np.trace(covariance[own, own])) / len(std)
    missing = max(0.0, there - whole)
    return float(np.sqrt(max(0.0, missing**2 - noise))) / max(whole, 1e-300)


def draw_unfiltered(
    effect: Effect, state: State, candidate: Candidate, moving: np.ndarray, draws: int, rng: np.random.Generator
) -> np.ndarray:
    """Draw by how much (draws,) the largest torque of a wave is above that in the log, whose filters take fast waves.

    How much of what they take is there is not known: anything from nothing to what the filters are known to take.
    """
    if effect.left is None or candidate.axis is None:
        return np.ones(draws)
    left = effect.left(state, candidate.axis, candidate.nonlinear) * np.ones(len(moving))
    tall, _ = effect.shape(state, candidate.axis, candidate.nonlinear)
    told = moving & (left > LEAST)
    if not told.any():
        return np.ones(draws)
    whole, seen = np.abs(tall[told] / left[told]).max(), np.abs(tall[told]).max()
    return 1.0 + (whole / max(seen, 1e-300) - 1.0) * rng.uniform(size=draws)
