"""Waves over the angle of the motor, for the fit behind the noise: no basis of structure follows them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jointwear.discovery.linear import chi_square
from jointwear.discovery.noise.noise import Whitener, estimate
from jointwear.discovery.noise.ridge_fit import RidgeFit
from jointwear.discovery.problem.problem import Problem
from jointwear.effects import State, library


def shown_waves(
    problem: Problem,
    axis: int,
    waves: Sequence[np.ndarray],
    white: Whitener,
    take_off: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Return the columns (N_train, k) of the waves over the motor angle that a residual plainly shows, k = 0 for none.

    Left in the residual a cogging torque is taken for noise, and loud noise at its own frequencies hides it. Held
    always, waves that are not there would take a part of the noise: each has to be worth what a name is.

    Parameters
    ----------
    waves : of :func:`waves_in_band`. white : a noise model of the residual. take_off : what the fit so far leaves of
        series (N_train, k).
    """
    accept = problem.settings.accept
    target = white(take_off(problem.discrepancy[problem.train, axis]))
    shown = [np.zeros((len(problem.usable), 0))]
    for columns in waves:
        # What columns share with the fit makes them look larger, not better: few have to be held against it.
        if _gain(white(columns), target) <= 0.5 * accept:
            continue
        if _gain(white(take_off(columns)), target) - np.log(len(waves)) > accept:
            shown.append(columns)
    return np.concatenate(shown, axis=1)


def loud_waves(
    problem: Problem,
    axis: int,
    waves: Sequence[np.ndarray],
    noise: Whitener,
    take_off: RidgeFit,
    left: np.ndarray,
    highest: int,
) -> np.ndarray:
    """Return the columns (N_train, k) of the waves that are louder than the noise, k = 0 for none, the loudest first.

    A noise model of a residual with such a wave has learnt its frequencies: whitened by it next to nothing of the wave
    is left (39 nats of a wave that was 0.87 of a variance). So residuals without the wave are given a noise model of
    their own, and a wave is held whose noise is smaller by the nats that a name needs.

    Parameters
    ----------
    waves : of :func:`waves_in_band`, or other groups of columns. noise : the noise model of what the fit leaves.
    take_off : a fit that knows no noise. left : (N_train,) what it leaves [N m]. highest : order that a noise model may
        have.
    """
    used, label = problem.usable[:, axis], problem.measured.trajectory[problem.train]
    waves, shown = list(waves), [np.zeros((len(used), 0))]
    squares = take_off.squares(waves)
    while waves:
        gained = take_off.gained(waves, squares, left)
        # The loudest by what it takes off the squares; how much better the noise is then, decides.
        best = max(range(len(waves)), key=lambda k: gained[k][0])
        needed = problem.settings.accept + np.log(len(waves))
        if 0.5 * gained[best][0] <= needed * np.mean(left[used] ** 2):
            break
        without = left - take_off(waves[best]) @ gained[best][1]
        quieter = estimate(without, used, label, highest)
        if len(quieter.rows) * np.log(noise.sigma / quieter.sigma) <= needed:
            break
        shown.append(waves.pop(best))
        squares.pop(best)
        left, noise = without, quieter
    return np.concatenate(shown, axis=1)


def waves_in_band(problem: Problem, axis: int, state: State) -> list[np.ndarray]:
    """Return the columns (N_train, k) of every wave over the angle of the motor that the band of the torque holds.

    `state` : training samples that they are made from.
    """
    # How much of a fast wave shakes the joint, and how much its controller answers, is up to the controller.
    states = (state, replace(state, derives=None))
    # Both are held, so that the forms of one wave are one.
    shapes = {
        (effect.identifier, repeats): np.concatenate([effect.columns(s, axis, None, nonlinear) for s in states], axis=1)
        for effect in library().values()
        if effect.waves is not None and not effect.unmet(state, axis)
        for nonlinear in effect.grid(replace(state, derives=None), axis)
        if in_band(problem, axis, repeats := effect.waves(state, axis, nonlinear))
    }
    return list(shapes.values())


def _gain(columns: np.ndarray, target: np.ndarray) -> float:
    """Return the nats beyond chance that columns (m, k) explain of a target (m,), both whitened."""
    gram = columns.T @ columns
    statistic, freedom = chi_square(columns.T @ target, gram, gram)
    return 0.5 * (statistic - freedom)


def in_band(problem: Problem, axis: int, waves: float) -> bool:
    """Return whether a wave that repeats `waves` times in a radian lies in the band of the torque half of the time."""
    return bool(waves * problem.middle_speed[axis] / (2 * np.pi) < problem.measured.band)
