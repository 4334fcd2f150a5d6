"""Lines over time that are louder than the noise, for the fit behind it: they are not the noise of a sensor.

What shakes an arm at a frequency of its own is structure without a name. Left in the residual it is taken for noise:
the noise model has learnt it, and whitened by that next to nothing of the line is left to be found.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.special import gammaincc

from jointwear.discovery import assumed
from jointwear.discovery.linear import fitted
from jointwear.discovery.noise.noise import Whitener, estimate
from jointwear.discovery.noise.noise_spectrum import FEWEST_OF_RECORD
from jointwear.discovery.noise.spectra import around
from jointwear.discovery.problem.problem import Problem
from jointwear.statistics.runs import runs

#: Lines of one axis at most, a bound on time: what beats has two, and each has neighbours in short records.
MOST = 6


def loud_lines(
    problem: Problem,
    axis: int,
    noise: Whitener,
    take_off: Callable[[np.ndarray], np.ndarray],
    left: np.ndarray,
    highest: int,
) -> np.ndarray:
    """Return the columns (N_train, k) of the lines over time that are louder than the noise, k = 0 for none.

    A line has to stand out of its surroundings in the spectra of all records by less than `unexplained_p`, and the
    noise beside it has to be smaller by the nats that a name needs. Its phase is another in each record.

    Parameters
    ----------
    noise : the noise model of what the fit leaves. take_off : what a fit that knows no noise leaves of series
        (N_train, k). left : (N_train,) what it leaves [N m]. highest : order that a noise model may have.
    """
    used, label = problem.usable[:, axis], problem.measured.trajectory[problem.train]
    rate, settings = problem.measured.rate, problem.settings
    shown = [np.zeros((len(used), 0))]
    for _ in range(MOST):
        frequency, chance, cells = loudest(left, used, label, rate)
        if chance >= settings.unexplained_p:
            break
        columns = _waves(frequency, label, rate)
        beside = take_off(columns)
        without = left - beside @ fitted(beside[used], left[used])[1]
        quieter = estimate(without, used, label, highest)
        if len(quieter.rows) * np.log(noise.sigma / quieter.sigma) <= settings.accept + np.log(cells):
            break
        shown.append(columns)
        left, noise = without, quieter
    return np.concatenate(shown, axis=1)


def loudest(series: np.ndarray, used: np.ndarray, label: np.ndarray, rate: float) -> tuple[float, float, int]:
    """Return the frequency [Hz] that stands out most of a series (N,), how likely by chance, and the cells searched.

    Slower than `assumed.slow` is slow structure. The chance is 1 where no record is long enough. Records of one length
    are asked together, `used` (N,) says which samples count.
    """
    together: dict[int, list[np.ndarray]] = {}
    for piece in runs(label):
        count = int(used[piece].sum())
        if count < FEWEST_OF_RECORD:
            continue
        held = np.where(used[piece], series[piece], 0.0)
        size = 2 ** int(np.ceil(np.log2(len(held))))
        power = np.abs(np.fft.rfft(held, size)[: size // 2]) ** 2
        together.setdefault(size, []).append(power / around(power))
    best = (0.0, 1.0, 1)
    for size, records in together.items():
        frequency = np.arange(size // 2) * rate / size
        power = np.where(frequency >= assumed.slow(), np.sum(records, axis=0), 0.0)
        where = int(np.argmax(power))
        chance = min(1.0, len(power) * float(gammaincc(len(records), power[where])))
        if chance < best[1]:
            best = (float(frequency[where]), chance, len(power))
    return best


def _waves(frequency: float, label: np.ndarray, rate: float) -> np.ndarray:
    """Return sine and cosine of a frequency [Hz] in each record, (N, 2 records)."""
    columns = []
    for piece in runs(label):
        angle = 2 * np.pi * frequency * np.arange(len(label[piece])) / rate
        for wave in (np.sin(angle), np.cos(angle)):
            column = np.zeros(len(label))
            column[piece] = wave
            columns.append(column)
    return np.stack(columns, axis=1)
