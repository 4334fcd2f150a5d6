"""Low-pass filter with zero phase, forward and backward, and derivatives of what it leaves."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, sosfilt, sosfilt_zi

from jointwear.statistics.ends import turned_about_ends
from jointwear.statistics.runs import runs

#: Fewest samples that are filtered.
SHORTEST = 24
#: Share of the rate from which on nothing is left to filter.
HIGHEST = 0.45
#: The same where a rate was reduced, or where it is not known up to where a signal reaches.
SAFELY = 0.4
#: Share of a step that a filter has to have forgotten: a signal is continued by so many samples beyond its ends. Near
#: Nyquist that takes many, however short the period: continued by less, a joint that moves at an end of its record gets
#: an acceleration there that is wrong by ten times itself.
FORGOTTEN = 1e-5
#: Samples at an end through which a motion is continued by a cubic: through fewer, noise at the very end is blown up.
LAST = 8


@lru_cache(maxsize=512)
def _butterworth(cutoff: float, rate: float) -> tuple[np.ndarray, np.ndarray, int]:
    """Sections (2, 6) of a Butterworth filter of order 4, their states (2, 2) after a long row of ones, and the samples
    after which all but :data:`FORGOTTEN` of a step is gone."""
    sections = butter(4, cutoff, fs=rate, output="sos")
    # The last coefficient of a section is the square of the radius of its two poles.
    slowest = 0.5 * np.log(sections[:, 5].max())
    return sections, sosfilt_zi(sections), math.ceil(np.log(FORGOTTEN) / slowest)


def low_pass(values: np.ndarray, cutoff: float, rate: float, motion: bool = False) -> np.ndarray:
    """Filter (k, ...) with zero phase along the first axis; nothing happens where the cut-off is near Nyquist.

    Parameters
    ----------
    motion : whether accelerations are derived from what is left. A signal is continued beyond its ends turned about
        them, which turns its acceleration round at once; a motion by a cubic through its last samples.
    """
    if cutoff >= HIGHEST * rate or len(values) < SHORTEST:
        return values
    # As scipy.signal.sosfiltfilt does, which works out the settled states anew at every call: a third of its time.
    # Rates that were found from stamps differ in their last digits from stretch to stretch.
    sections, settled, rings = _butterworth(float(f"{cutoff:.9g}"), float(f"{rate:.9g}"))
    pad = min(len(values) - 1, rings)
    settled = settled.reshape(2, 2, *[1] * (values.ndim - 1))
    longer = _continued(values, pad) if motion else turned_about_ends(values, pad)
    forward, _ = sosfilt(sections, longer, axis=0, zi=settled * longer[0])
    backward, _ = sosfilt(sections, forward[pad:][::-1], axis=0, zi=settled * forward[-1])
    return backward[::-1][: len(values)]


def limit(columns: np.ndarray, record: np.ndarray, cutoff: float, rate: float) -> np.ndarray:
    """Return columns (m, k) filtered with zero phase at `cutoff` [Hz] within each record, as they are for infinity."""
    if not np.isfinite(cutoff):
        return columns
    pieces = runs(record)
    length, count = (pieces[0].stop, len(pieces)) if pieces else (0, 0)
    if count < 2 or any(piece.stop - piece.start != length for piece in pieces):
        return np.concatenate([low_pass(columns[piece], cutoff, rate) for piece in pieces])
    # Records of one length side by side are filtered in one go.
    beside = columns.reshape(count, length, -1).transpose(1, 0, 2).reshape(length, -1)
    limited = low_pass(beside, cutoff, rate).reshape(length, count, -1)
    return limited.transpose(1, 0, 2).reshape(columns.shape)


def _continued(values: np.ndarray, more: int) -> np.ndarray:
    """Return values (k, ...) continued on both sides by `more` samples of the cubic that fits the :data:`LAST` ones."""
    steps = np.linspace(-1.0, 0.0, LAST)
    beyond = np.arange(1, more + 1) * (steps[1] - steps[0])
    weights = np.vander(beyond, 4) @ np.linalg.pinv(np.vander(steps, 4))
    before = np.tensordot(weights[::-1, ::-1], values[:LAST], axes=1)
    return np.concatenate([before, values, np.tensordot(weights, values[-LAST:], axes=1)])


def zero_phase_gain(frequency: np.ndarray, cutoff: float | np.ndarray, rate: float) -> np.ndarray:
    """Return the gain (...,) of :func:`low_pass` at frequencies (...,) [Hz]; 0 from half the rate on.

    The bilinear transform bends frequencies, so that the digital filter ends more sharply than the analogue one.
    Cut-offs (k, 1) are answered together, (k, ...).
    """
    none = np.asarray(cutoff) >= HIGHEST * rate
    if none.all():
        return np.ones(np.broadcast_shapes(np.shape(frequency), none.shape))
    bent = np.tan(np.pi * np.minimum(frequency / rate, 0.5)) / np.tan(np.pi * cutoff / rate)
    return np.where(none, 1.0, 1.0 / (1.0 + ((bent**2) ** 2) ** 2))


def derivatives(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first and second derivative of values (k, ...) at their times (k,), by a spline through them."""
    spline = make_interp_spline(time, values, k=5 if len(time) > 6 else 1)
    return spline(time, 1), spline(time, 2)
