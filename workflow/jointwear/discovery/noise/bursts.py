"""What was taken for noise although no sensor makes it: it comes in bursts and is as large as the torque itself.

A gear with lost motion, or a drive that resonates, rings each time something excites it. Between two turns of the load
it is quiet. Behind the encoder of the motor no effect of the library describes that, the saturated fit leaves it, and
an autoregressive model of what is left calls it coloured noise. Noise of a sensor is there all the time: what its size
is depends on load and speed at most.
"""

from __future__ import annotations

import math

import numpy as np

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
    both = usable[1:] & usable[:-1] & (np.diff(record) == 0)
    power = np.sort(np.diff(residual)[both] ** 2)
    if len(power) < FEWEST_CHANGES or power[-1] <= 0.0:
        return 0.0
    return float(power[-round(LOUDEST * len(power)) :].sum() / power.sum())


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
