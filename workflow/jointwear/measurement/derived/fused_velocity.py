"""Velocities made of both signals: of the positions at low frequencies, of the recorded velocity at high ones.

Differentiation multiplies the density S_q of the noise of positions by (2 pi f)^2. Below the frequency at which that
is the density S_v of the noise of the velocities, a tachometer or a coarse estimate knows less than the positions do.
With the weights of least variance, 1 / (1 + (f / f_x)^2) for the derivative of the positions, the difference of both
passes a zero-phase filter of first order (complementary filter; Brown and Hwang 2012, section 6).
"""

from __future__ import annotations

import numpy as np
from scipy.signal import butter, sosfiltfilt, welch

from jointwear.measurement.derived.filtering import HIGHEST, SHORTEST, derivatives, low_pass

#: A recorded velocity agrees with the positions where both differ by no more than their noise times this.
AGREES = 1.5
#: Share of the rate below which a crossing is of no use: a filter so slow has no room in a record.
SLOWEST = 2e-3
#: Share of the rate at which a noise floor is read: the middle of the upper third of the band.
FLOOR_AT = 5 / 12
#: A velocity is held against the positions between these multiples of the crossing, below this share of the rate.
TOLD, TOLD_BELOW = (2.0, 6.0), 0.2
#: It is one of its own where the difference has this much of the noise of both: more is another motion.
OWN = (0.5, 3.0)
#: Samples of a spectrum.
SEGMENT = 256
#: Samples at either end where the derivative of a spline is not used.
END = 3


def made_of_positions(
    time: np.ndarray, pieces: list[slice], position: np.ndarray, velocity: np.ndarray, floors: np.ndarray, rate: float
) -> np.ndarray:
    """Return the joints (n,) whose recorded velocity may have been made of the positions and know no more than they do.

    Its floor then lies below that of the derivative of the positions, because a filter took the noise away above its
    band; below that band it holds their noise, so that both differ by less than the noise of the positions. A velocity
    of its own differs by all of it. Where the frequencies between leave no room to tell, it may have been made.

    Parameters
    ----------
    As of :func:`fuse`.
    """
    made = floors[1] < (2 * np.pi * FLOOR_AT * rate) ** 2 * floors[0]
    used = [p for p in pieces if p.stop - p.start >= SEGMENT]
    for j in np.flatnonzero(made):
        crossing = _crossing(floors[:, j])
        low, high = TOLD[0] * crossing, min(TOLD[1] * crossing, TOLD_BELOW * rate)
        ratios = []
        for p in used:
            apart = _apart(time[p], position[p, j], velocity[p, j])
            frequency, density = welch(apart, rate, nperseg=SEGMENT)
            where = (frequency >= low) & (frequency <= high)
            expected = floors[0, j] * (2 * np.pi * frequency[where]) ** 2 + floors[1, j]
            ratios.append(density[where] / expected)
        ratio = float(np.mean(np.concatenate(ratios))) if ratios and ratios[0].size > 1 else 0.0
        made[j] = not OWN[0] < ratio < OWN[1]
    return made


def fuse(
    time: np.ndarray, pieces: list[slice], position: np.ndarray, velocity: np.ndarray, floors: np.ndarray, rate: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return velocities (m, n) [rad/s] made of both signals, and the joints (n,) whose velocities are.

    A velocity that disagrees with the positions comes from elsewhere and stays as it was recorded.

    Parameters
    ----------
    position, velocity : (m, n) [rad], [rad/s]. pieces : the records. rate : [Hz].
    floors : (2, n) densities of the noise of both [rad^2/Hz], [(rad/s)^2/Hz].
    """
    result, fused = np.array(velocity), np.zeros(velocity.shape[1], bool)
    used = [p for p in pieces if p.stop - p.start >= SHORTEST]
    for j in range(velocity.shape[1]):
        band = min(_crossing(floors[:, j]), HIGHEST * rate)
        if band < SLOWEST * rate or not used:
            continue
        low = [_smooth(_apart(time[p], position[p, j], velocity[p, j]), band, rate) for p in used]
        ends = max(END, min(len(x) for x in low) // 20)
        # White noise of the velocities below the crossing, and a third as much of the positions.
        if np.mean(np.concatenate([x[ends:-ends] for x in low]) ** 2) > AGREES**2 * 4 / 3 * floors[1, j] * band:
            continue
        for p, more in zip(used, low, strict=True):
            result[p, j] += more
        fused[j] = True
    return result, fused


def _crossing(floors: np.ndarray) -> float:
    """Return the frequency [Hz] at which the derivative of positions has the noise of velocities, floors (2,)."""
    return float(np.sqrt(floors[1] / max(floors[0], 1e-300))) / (2 * np.pi)


def _apart(time: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return the derivative of the positions less the velocities; a spline knows no derivative at its very ends."""
    apart = derivatives(time, position)[0] - velocity
    apart[:END], apart[-END:] = apart[END], apart[-END - 1]
    return apart


def _smooth(values: np.ndarray, band: float, rate: float) -> np.ndarray:
    if band >= HIGHEST * rate:
        return low_pass(values, 0.99 * HIGHEST * rate, rate)
    return sosfiltfilt(
        butter(1, band, fs=rate, output="sos"), values, padlen=min(len(values) - 1, int(3 * rate / band))
    )
