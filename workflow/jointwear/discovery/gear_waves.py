"""Waves over the angle of a joint that are no whole number in a turn of its motor: gears between motor and joint."""

from __future__ import annotations

import numpy as np

from jointwear.discovery.linear import fitted
from jointwear.discovery.noise import estimate
from jointwear.discovery.ridge_fit import RidgeFit
from jointwear.discovery.spectra import around
from jointwear.discovery.structure import KNOTS, STILL
from jointwear.effects.motor_waves import ORDER, ORDERS

#: Waves in the whole travel from which on one is not structure over the position, which has knots for fewer.
FEWEST = KNOTS["position"] / 3
#: Waves that are looked for on one axis, those of whole orders included.
MOST = 3
#: Cells of the spectrum in the width of a line, and samples of the angle in the fastest wave.
CELLS, SAMPLES = 4, 4
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
) -> tuple[float, ...]:
    """Return the orders, waves in a turn of the motor, of plain waves that are no whole order of `ORDERS`.

    Stages of a gear mesh at orders of their own, and a residual with such a wave is taken for noise. A wave, of one
    height or in proportion to the torque, has to stand out of the spectrum over the angle, and the noise without it has
    to be smaller by the nats that a name needs, and by the cells that were searched.

    Parameters
    ----------
    residual : (N,) [N m]. take_off : a fit to the samples `used` (N,) that holds no waves. position, torque : (N,) of
    the axis. label : (N,) record. fastest : waves in a radian of the joint that the log holds.
    """
    angle = position[used]
    travel = float(np.ptp(angle))
    gear = abs(gear_ratio)
    fastest = min(fastest, ORDER.upper * gear)
    if travel < STILL or fastest * travel < 4 * np.pi * FEWEST:
        return ()
    size = 2 ** int(np.ceil(np.log2(SAMPLES * CELLS * fastest * travel / (2 * np.pi))))
    place = np.floor((angle - angle.min()) / (CELLS * travel) * size).astype(int)
    waves = 2 * np.pi * np.arange(size // 2) / (CELLS * travel)
    asked = (waves >= 2 * np.pi * FEWEST / travel) & (waves <= fastest)
    heights = (np.ones(len(residual)), torque / max(float(np.sqrt(np.mean(torque[used] ** 2))), 1e-300))
    left, noise = take_off(residual), None
    found: list[float] = []
    line = 2 * np.pi / travel
    needed = accept + np.log(2 * asked.sum())
    for _ in range(MOST):
        starts = []
        for height in heights:
            power = np.abs(np.fft.rfft(np.bincount(place, (left * height)[used], size))[: size // 2]) ** 2
            many = float(waves[np.argmax(np.where(asked, power / around(power), 0.0))])
            starts.append((_without(left, take_off, position, height, used, many)[0], many, height))
        gained, many, height = max(starts, key=lambda start: start[0])
        if 0.5 * gained <= needed * np.mean(left[used] ** 2):
            break
        for step in line * NEARER:
            tried = [_without(left, take_off, position, height, used, many + k * step)[0] for k in range(-4, 5)]
            many += (int(np.argmax(tried)) - 4) * step
        without = _without(left, take_off, position, height, used, many)[1]
        noise = noise or estimate(left, used, label)
        quieter = estimate(without, used, label)
        if len(quieter.rows) * np.log(noise.sigma / quieter.sigma) <= needed:
            break
        known = np.array([*ORDERS, *found])
        if np.abs(many - known * gear).min() > 0.5 * line:
            found.append(float(many / gear))
        left, noise = without, quieter
    return tuple(found)


def _without(
    left: np.ndarray, take_off: RidgeFit, position: np.ndarray, height: np.ndarray, used: np.ndarray, many: float
) -> tuple[float, np.ndarray]:
    """Return what a wave takes off the squares of a residual (N,), and what it leaves of it."""
    columns = take_off(np.stack([np.sin(many * position), np.cos(many * position)], axis=1) * height[:, None])
    gained, size = fitted(columns[used], left[used])
    return gained, left - columns @ size
