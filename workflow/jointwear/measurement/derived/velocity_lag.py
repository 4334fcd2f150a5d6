"""A logged velocity that lags its position, as the filters of controllers leave it, and its way back in time.

A velocity late by tau is v = q' - tau q'' for what is slow against 1 / tau. Left alone it moves the steps of friction
in time, which is what a delay of the drive does as well. Moved back, what is fast is still too small, by
the share (2 pi f)^2 c with c up to tau^2 / 2, that of a filter of first order: accelerations made of it lack what an
elastic gear would take. Both hold for what is slow against 1 / tau; velocities of a longer lag are not used.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import make_interp_spline

from jointwear.measurement.derived.filtering import SHORTEST, derivatives, low_pass

#: Periods of the filter that are left out at the ends of a record.
ENDS = 3.0
#: A lag below this share of the sampling interval, or of this many standard deviations, is none.
SMALLEST, SIGMAS = 0.05, 5.0
#: Longest lag that is put right [sampling intervals]: positions are dense against a longer one, and tell more.
LONGEST = 5.0
#: Longest lag of a filter [s]: more is another clock than that of the positions.
LATEST = 0.05
#: Highest share of the rate at which velocities and positions are compared.
BAND = 0.2
#: A lag is found to first order of what is left of it; this often.
ROUNDS = 3


def put_in_time(
    time: np.ndarray,
    pieces: list[slice],
    position: np.ndarray,
    velocity: np.ndarray,
    reach: np.ndarray,
    rate: float,
) -> tuple[np.ndarray | None, np.ndarray]:
    """Return velocities [rad/s] (m, n) at the instants of their positions, and the lags (n,) [s] that were taken out.

    None where a lag is too long to be put right and no other clock's, with the lags that were found.

    Parameters
    ----------
    time : (m,) [s]. pieces : records. position, velocity : (m, n), finite [rad, rad/s].
    reach : (n,) [Hz] up to which the positions hold a signal. rate : of sampling [Hz].
    """
    moved, lags = velocity.copy(), np.zeros(velocity.shape[1])
    latest = max(LATEST, LONGEST / rate)
    for j in range(velocity.shape[1]):
        band = min(float(reach[j]), BAND * rate)
        edge = int(np.ceil(ENDS / band * rate))
        used = [p for p in pieces if p.stop - p.start >= max(2 * edge + 10, SHORTEST)]
        if not used:
            continue
        derived = [derivatives(time[p], low_pass(position[p, j], band, rate, motion=True)) for p in used]
        first, second = (np.concatenate([d[order][edge:-edge] for d in derived]) for order in (0, 1))
        third = np.concatenate([np.gradient(d[1], time[p])[edge:-edge] for d, p in zip(derived, used, strict=True)])
        power = float(second @ second)
        if power == 0.0:
            continue
        lag, error = 0.0, np.inf
        for _ in range(ROUNDS):
            late = np.concatenate(
                [low_pass(_earlier(time[p], velocity[p, j], lag), band, rate)[edge:-edge] for p in used]
            )
            more = -float((late - first) @ second) / power
            lag += more
            left = late - first + more * second
            # Samples of a band-limited signal are as many as twice its band per second.
            error = np.sqrt(float(left @ left) / len(left) / power * rate / (2 * band))
            if abs(lag) > latest:
                break
        if max(SIGMAS * error, SMALLEST / rate) < abs(lag) <= latest:
            lags[j] = lag
            if abs(lag) > LONGEST / rate:
                continue
            for p in pieces:
                moved[p, j] = _earlier(time[p], velocity[p, j], lag)
            lost = float(np.clip(left @ third / max(float(third @ third), 1e-300), 0.0, 0.5 * lag**2))
            for p in pieces:
                moved[p, j] -= lost * _curvature(time[p], moved[p, j])
    return None if np.any(np.abs(lags) > LONGEST / rate) else moved, lags


def _earlier(time: np.ndarray, values: np.ndarray, lag: float) -> np.ndarray:
    """Return what was logged `lag` [s] later; the last values of the record stay where there is nothing later."""
    if lag == 0.0 or len(time) < 4:
        return values
    return make_interp_spline(time, values, k=3)(np.clip(time + lag, time[0], time[-1]))


def _curvature(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the second derivative of values (m,) over time; zero for fewer than four."""
    return make_interp_spline(time, values, k=3)(time, nu=2) if len(time) >= 4 else np.zeros(len(time))
