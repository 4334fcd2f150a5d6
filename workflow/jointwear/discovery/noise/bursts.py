"""What was taken for noise although no sensor makes it: it comes in bursts and is as large as the torque itself.

A gear with lost motion, or a drive that resonates, rings each time something excites it. Between two turns of the load
it is quiet. Behind the encoder of the motor no effect of the library describes that, the saturated fit leaves it, and
an autoregressive model of what is left calls it coloured noise. Noise of a sensor is there all the time: what its size
is depends on load and speed at most. Sensors with heavy tails are loud now and then too, but each by itself: what
strikes the arm strikes several joints at the same instants.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from itertools import combinations

import numpy as np
from scipy.stats import hypergeom

from jointwear.discovery.settings import Settings

#: Share of the changes from sample to sample that are the loudest: one in twenty.
LOUDEST = 0.05
#: Changes from sample to sample of which the loudest say something.
FEWEST_CHANGES = 200
#: Times what a torque varies by from which noise hides it: half.
HIDES = 0.5


def loudest_share(residual: np.ndarray, usable: np.ndarray, record: np.ndarray) -> float:
    """Return the share of the power of all changes from sample to sample that the loudest of them hold, 0 to 1.

    Of normal noise of one size it is 0.28, whatever its colour. It is 0 where fewer than :data:`FEWEST_CHANGES`
    are known.

    Parameters
    ----------
    residual : (N,) [N m] what a model leaves of the torque of one axis. usable : (N,) samples that can be judged.
        record : (N,) label of each sample.
    """
    return _share_of(np.diff(residual)[_follow(usable, record)] ** 2)


def _follow(usable: np.ndarray, record: np.ndarray) -> np.ndarray:
    """Return which samples (N - 1,) but the first follow one of their record, both of which can be judged."""
    return usable[1:] & usable[:-1] & (np.diff(record) == 0)


def _share_of(power: np.ndarray) -> float:
    if len(power) < FEWEST_CHANGES or power.max() <= 0.0:
        return 0.0
    return float(np.sort(power)[-round(LOUDEST * len(power)) :].sum() / power.sum())


def heaviest_noise() -> float:
    """Return that share of noise with the tails of a Laplace distribution, 0.42.

    They are heavier than those of normal noise whose size follows a speed that swings.
    """
    beyond = -math.log(LOUDEST)
    return LOUDEST * (0.5 * beyond**2 + beyond + 1.0)


def rings(floor: float, residual: np.ndarray, torque: np.ndarray, usable: np.ndarray, record: np.ndarray) -> bool:
    """Return whether what was taken for noise of one axis hides its torque and comes in bursts.

    Either alone says nothing: the torque of a light wrist may be no larger than the noise of its sensor, and small
    noise of derived accelerations changes with the speed.

    Parameters
    ----------
    floor : standard deviation of that noise [N m]. residual, torque : (N,) [N m] what a model leaves of the recorded
        torque, and that itself: along a motion that rings a model rings too. usable : (N,) samples that can be judged.
        record : (N,) label of each sample.
    """
    if not usable.any() or floor <= HIDES * float(np.std(torque[usable])):
        return False
    return loudest_share(residual, usable, record) > heaviest_noise()


def struck_together(
    residual: np.ndarray,
    usable: np.ndarray,
    record: np.ndarray,
    sizes: np.ndarray,
    axes: Collection[int],
    settings: Settings,
) -> dict[int, tuple[int, ...]]:
    """Return the axes whose noise comes in bursts at the same instants, each with the others that it shares them with.

    The loudest twentieth of the changes of each holds more of their power than heavy noise has there, over the size
    that speed, acceleration, torque and record make of them; and more of the loudest of two axes are the same than
    chance allows (`Settings.unexplained_p`). Noise of derived accelerations is shared by joints and has no such tails.

    Parameters
    ----------
    residual : (N, n) [N m] what a model leaves of the torques. usable : (N, n) samples that can be judged. record :
        (N,) label of each sample. sizes : (N, n, k) on which the size of noise may depend. axes : those that are asked.
    """
    bursts = {}
    for axis in axes:
        rows = _follow(usable[:, axis], record)
        power = np.full(len(rows), np.nan)
        power[rows] = _of_one_size(np.diff(residual[:, axis])[rows], record[1:][rows], sizes[1:, axis][rows])
        if _share_of(power[rows]) > heaviest_noise():
            bursts[axis] = power
    found: dict[int, tuple[int, ...]] = {}
    for one, other in combinations(bursts, 2):
        if _coincide(np.stack([bursts[one], bursts[other]], axis=1), settings):
            found[one] = (*found.get(one, ()), other)
            found[other] = (*found.get(other, ()), one)
    return found


def _of_one_size(changes: np.ndarray, record: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Return the power (m,) of changes (m,) over the size that their record and `sizes` (m, k) make of it."""
    if len(changes) < FEWEST_CHANGES:
        return np.zeros(len(changes))
    records = record[:, None] == np.unique(record)
    design = np.concatenate([records, sizes / np.maximum(sizes.std(axis=0), 1e-300)], axis=1)
    square = changes**2
    # A change of nothing, as of values that repeat, has no logarithm.
    logarithm = np.log(square + 1e-12 * np.max(square, initial=1e-300))
    return square / np.exp(design @ np.linalg.lstsq(design, logarithm, rcond=None)[0])


def _coincide(power: np.ndarray, settings: Settings) -> bool:
    """Return whether more of the loudest changes of two axes (m, 2), NaN unknown, are the same than chance allows."""
    both = power[np.isfinite(power).all(axis=1)]
    count = round(LOUDEST * len(both))
    loud = [set(np.argsort(column)[len(both) - count :].tolist()) for column in both.T]
    same = len(loud[0] & loud[1])
    return bool(hypergeom.sf(same - 1, len(both), count, count) < settings.unexplained_p)
