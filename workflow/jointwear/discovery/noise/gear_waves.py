"""Waves over the angle of a joint that are no whole number in a turn of its motor: gears between motor and joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.discovery.noise.noise import estimate
from jointwear.discovery.noise.ridge_fit import RidgeFit
from jointwear.discovery.noise.spectra import SURROUNDINGS, around
from jointwear.discovery.structure import KNOTS, STILL
from jointwear.effects.motor_waves import ORDER, ORDERS

#: Waves in the whole travel from which on one is not structure over the position, which has knots for fewer.
FEWEST_WAVES = KNOTS["position"] / 3
#: Waves that are looked for on one axis, those of whole orders included.
MOST = 3
#: Cells of the spectrum in the width of a line, and samples of the angle in the fastest wave.
CELLS, SAMPLES = 4, 4
#: Fewest steps in a turn of an encoder at a joint: with fewer a controller hardly holds its arm.
STEPS = 2**12
#: Steps, in widths of a line, by which the largest wave is refined from a cell of the spectrum.
NEARER = np.array([0.2, 0.05, 0.0125])


def gear_orders(
    residual: np.ndarray,
    take_off: RidgeFit,
    position: np.ndarray,
    torque: np.ndarray,
    used: np.ndarray,
    label: np.ndarray,
    gear_ratio: float,
    fastest: float,
    accept: float,
    encoder_step: float = np.nan,
) -> tuple[float, ...]:
    """Return the orders, waves in a turn of the motor, of plain waves that are no whole order of `ORDERS`.

    Stages of a gear mesh at orders of their own, and a residual with such a wave is taken for noise. A wave, of one
    height or in proportion to the torque, has to stand out of the spectrum over the angle, and the noise without it has
    to be smaller by the nats that a name needs, and by the cells that were searched. One that repeats with the step of
    an encoder, or several times in it, is what a controller answers to that step: it is taken off, and no gear's.

    Parameters
    ----------
    residual : (N,) [N m]. take_off : a fit to the samples `used` (N,) that holds no waves. position, torque : (N,) of
    the axis. label : (N,) record. fastest : waves in a radian of the joint that the log holds. encoder_step : step of
    the positions of the axis [rad], NaN where none is known.
    """
    angle = position[used]
    travel = float(np.ptp(angle))
    gear = abs(gear_ratio)
    fastest = min(fastest, ORDER.upper * gear)
    if travel < STILL or fastest * travel < 4 * np.pi * FEWEST_WAVES:
        return ()
    size = 2 ** int(np.ceil(np.log2(SAMPLES * CELLS * fastest * travel / (2 * np.pi))))
    place = np.floor((angle - angle.min()) / (CELLS * travel) * size).astype(int)
    # The fastest wave lies below a quarter of the rate; the cells beyond are those around it.
    waves = 2 * np.pi * np.arange(min(size // 2, size // SAMPLES + SURROUNDINGS)) / (CELLS * travel)
    asked = (waves >= 2 * np.pi * FEWEST_WAVES / travel) & (waves <= fastest)
    heights = (np.ones(len(residual)), torque / max(float(np.sqrt(np.mean(torque[used] ** 2))), 1e-300))
    left, noise = take_off(residual), None
    found: list[float] = []
    line = 2 * np.pi / travel
    needed = accept + np.log(2 * asked.sum())
    for _ in range(MOST):
        starts = []
        for height in heights:
            power = np.abs(np.fft.rfft(np.bincount(place, (left * height)[used], size))[: len(waves)]) ** 2
            starts.append((float(waves[np.argmax(np.where(asked, power / around(power), 0.0))]), height))
        again = take_off.again(left)
        best = _largest(again, take_off, position, starts)
        if 0.5 * best.gained <= needed * np.mean(left[used] ** 2):
            break
        for step in line * NEARER:
            nearby = [(best.many + k * step, best.height) for k in range(-4, 5)]
            best = _largest(again, take_off, position, nearby)
        many, without = best.many, left - take_off(best.columns) @ best.size
        noise = noise or estimate(left, used, label)
        quieter = estimate(without, used, label)
        if len(quieter.rows) * np.log(noise.sigma / quieter.sigma) <= needed:
            break
        known = np.array([*ORDERS, *found]) * gear
        if min(np.abs(many - known).min(), _from_steps(many, encoder_step)) > 0.5 * line:
            found.append(float(many / gear))
        left, noise = without, quieter
    return tuple(found)


def _from_steps(many: float, step: float) -> float:
    """Return how far a wave, by its number in a turn of the joint, is from the nearest of an encoder's steps.

    Such a wave repeats a whole number of times in a step. The step is that of the log, `step` [rad], or of what a
    controller reads, which may be fewer bits than are logged: with a power of two steps in a turn, at least
    :data:`STEPS`.
    """
    once = [float(STEPS)]
    if np.isfinite(step):
        once.append(2 * np.pi / step)
    return min(abs(many - max(round(many / each), 1) * each) for each in once)


@dataclass(frozen=True)
class _Wave:
    """A wave by its number in a radian, its `height` and `columns` (N, 2), their coefficients `size` (2,), and what it
    takes off the squares of a residual."""

    gained: float
    many: float
    height: np.ndarray
    columns: np.ndarray
    size: np.ndarray


def _largest(
    again: np.ndarray, take_off: RidgeFit, position: np.ndarray, asked: list[tuple[float, np.ndarray]]
) -> _Wave:
    """Return the wave that takes most off the squares of a residual of which `again` (N,) is :meth:`.RidgeFit.again`.

    Parameters
    ----------
    asked : waves in a radian, with their height (N,).
    """
    columns = [
        np.stack([np.sin(many * position), np.cos(many * position)], axis=1) * height[:, None] for many, height in asked
    ]
    found = take_off.gained_of(columns, take_off.squares(columns), again)
    best = max(range(len(asked)), key=lambda k: found[k][0])
    gained, size = found[best]
    return _Wave(gained, *asked[best], columns[best], size)
