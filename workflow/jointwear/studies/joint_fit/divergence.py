"""KL divergence of the hourly histograms of one task, counted edge by edge.

One reading of normalisation, range, floor and direction, the one that Figure 2 asks for: |torque| over the maximum
of the training, values beyond it dropped, machine epsilon in empty bins, D(first hour || hour).
"""

from __future__ import annotations

import numpy as np

from jointwear.reproduction.readings.empty_bin_floor import machine_epsilon
from jointwear.studies.joint_fit.levels import Levels
from jointwear.studies.joint_fit.noise_bank import NoiseBank

_FAR = 5.5  # standard deviations beyond which none of the samples of a search lies

HISTOGRAM_READING = {
    "torque_normalisation": "training_maximum",
    "torque_sign": "absolute",
    "out_of_range": "dropped",
    "empty_bin_floor": "machine_epsilon",
    "kl_direction": "reference_from_hour",
    "reference_distribution": "first_training_hour",
}


def cumulative_counts(
    level: np.ndarray, spread: np.ndarray, maximum: np.ndarray, bins: int, samples: np.ndarray
) -> np.ndarray:
    """Return how many samples of an hour are below each edge of the bins, (bins + 1, r, h).

    Parameters
    ----------
    level : (k, h or 1) [N m]; spread : (h or 1,) [N m]; maximum : (r,) of the training [N m].
    samples : (k, repeats, r, h) standard normal deviates.
    """
    repeats = samples.shape[1]
    count = np.zeros((bins + 1, *samples.shape[2:]), dtype=np.uint8)
    share = np.arange(1, bins + 1) / bins
    far = _FAR * spread.max()
    lowest, highest = level.min(axis=1)[:, None] - far, level.max(axis=1)[:, None] + far
    first, last = share * maximum.min(), share * maximum.max()
    # An edge above all samples of an instant, and its mirror image below them, needs no counting.
    whole = (first > highest) & (-first < lowest)
    partly = ~whole & ((last > lowest) & (-last < highest))
    count[1:] = (repeats * whole.sum(axis=0)).astype(np.uint8)[:, None, None]
    for k, b in np.argwhere(partly):
        edge = (share[b] * maximum)[:, None]
        below = None
        if first[b] <= highest[k, 0]:
            below = samples[k] < ((edge - level[k]) / spread).astype(np.float32)
        if -first[b] >= lowest[k, 0]:
            above = samples[k] > ((-edge - level[k]) / spread).astype(np.float32)
            below = above if below is None else below & above
        if below is None:
            count[b + 1] += np.uint8(repeats)
        else:
            count[b + 1] += below.sum(axis=0, dtype=np.uint8)
    return count


class Divergence:
    """Divergence of one axis from the first hour of its training.

    Parameters
    ----------
    levels, axis : the task and the 0-based axis.
    bank : random numbers.
    bins : number of bins.

    Attributes
    ----------
    maximum : (r,) largest |torque| of the training [N m]; training, normal : (r, h) [nat].
    """

    def __init__(self, levels: Levels, axis: int, bank: NoiseBank, bins: int) -> None:
        self._level, self._spread = levels.torque[axis], levels.spread[axis]
        self._friction, self._rise = levels.friction[axis], levels.spread_rise[axis]
        self._samples, self._bins = bank.normal[axis], bins
        top = self._level[:, None] + self._spread * bank.top[axis]
        bottom = self._level[:, None] + self._spread * bank.bottom[axis]
        self.maximum = np.maximum(top, -bottom).max(axis=0)
        spread = np.array([self._spread])
        training = np.diff(
            cumulative_counts(self._level[:, None], spread, self.maximum, bins, bank.training[axis]), axis=0
        )
        reference = training[:, :, 0].astype(float)
        # An hour of which nothing is left counts as evenly spread.
        total = reference.sum(axis=0)
        self._reference = np.where(total > 0, reference, 1.0) / np.where(total > 0, total, bins)
        self._used = np.flatnonzero((self._reference > 0).any(axis=1))
        self.training = self._divergence(training)
        self.normal = self._divergence(
            np.diff(cumulative_counts(self._level[:, None], spread, self.maximum, bins, self._samples), axis=0)
        )

    def worn(self, growth: np.ndarray, hours: np.ndarray) -> np.ndarray:
        """Return the divergence (r, h) of a run with friction grown by `growth` (h,) and the noise of `hours`."""
        level = self._level[:, None] + self._friction[:, None] * growth
        spread = self._spread + self._rise * growth
        samples = self._samples[..., hours]
        return self._divergence(np.diff(cumulative_counts(level, spread, self.maximum, self._bins, samples), axis=0))

    def _divergence(self, counts: np.ndarray) -> np.ndarray:
        total = counts.sum(axis=0, dtype=np.int64)
        result = np.zeros(counts.shape[1:])
        floor = np.log(machine_epsilon())
        logarithm = _LOGARITHM.copy()
        logarithm[0] = floor
        empty = total == 0
        log_total = np.log(np.where(empty, 1, total))
        for b in self._used:
            reference = self._reference[b][:, None]
            c = counts[b]
            hour = np.where(empty, -np.log(self._bins), logarithm[c] - log_total * (c > 0))
            with np.errstate(divide="ignore", invalid="ignore"):
                own = np.where(reference > 0, reference * np.log(reference), 0.0)
            result += own - reference * hour
        return np.maximum(result, 0.0)


_LOGARITHM = np.log(np.maximum(np.arange(256), 1).astype(float))
