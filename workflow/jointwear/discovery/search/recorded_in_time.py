"""Whether the recorded torque, put where it would be without a delay, fits the model better.

A column of late torque is made of the model, and where positions do not resolve what follows a reversal the model is
wrong there in a way that a delay may follow. The recorded torque needs neither friction nor accelerations: put forward
by d, steps of friction as steps, it is compared with the model as it is. Its noise keeps its density at another time,
so that the likelihood of the data is that of d, in closed loop too (Ljung 1999, direct prediction-error method), as
long as its size is not fitted: of noise alone half would fit best.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.interpolate import CubicHermiteSpline
from scipy.ndimage import fourier_shift

from jointwear.discovery.linear import Fit, gain_of_one
from jointwear.discovery.problem.whitening import White
from jointwear.effects.order import continued, earlier_sense, level_between
from jointwear.effects.state import State
from jointwear.statistics.runs import runs

#: Shares of a delay that are tried: a lag is nearly a dead time of its own length, less where torque changes fast.
SHARES = (0.4, 0.6, 0.8, 1.0, 1.2)


def put_forward(values: np.ndarray, delay: float, rate: float) -> np.ndarray:
    """Return values (m,), evenly sampled at `rate` [Hz], as they are `delay` [s] later."""
    padded, inside = continued(values)
    # A line is shifted exactly: what is left ends as it begins, as a Fourier series does.
    time = np.arange(len(padded))
    slope = (padded[-1] - padded[0]) / max(len(padded) - 1, 1)
    spectrum = fourier_shift(np.fft.rfft(padded - slope * time), -delay * rate, n=len(padded))
    shifted = np.fft.irfft(spectrum, len(padded)) + slope * (time + delay * rate)
    return shifted[inside]


def nats_of_time(white: White, fit: Fit, axis: int, delay: float) -> float:
    """Return the nats that a fit gains if the recorded torque of an axis (0-based) is late by `delay` [s].

    Of the :data:`SHARES` of the delay the one that gains most counts. Below 0 it is early.
    """
    gains = []
    for share in SHARES:
        column = whitened_change(white, fit, axis, share * delay)[:, None]
        gains.append(gain_of_one(*fit.gram({axis: column})))
    return max(gains)


def whitened_change(white: White, fit: Fit, axis: int, delay: float) -> np.ndarray:
    """Return :func:`change_in_time` whitened, (m,), 0 in the rows to which a sample belongs that cannot be judged.

    A change that ends at such a sample jumps there, and where noise changes slowly a jump is worth more than all else.
    """
    change, known = change_in_time(white, fit, axis, delay)
    whitener = white.whiteners[axis]
    order = len(whitener.lags)
    judged = sliding_window_view(known, order + 1).all(axis=1)[whitener.rows - order]
    return np.where(judged, white.columns(axis, change[:, None])[:, 0], 0.0)


def change_in_time(white: White, fit: Fit, axis: int, delay: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the recorded torque of an axis (0-based) less what it is when put forward by `delay` [s], (m,) [N m],
    and where it can be judged, (m,).

    What a delay adds to a torque: less it, with a coefficient of one, the log is that of no delay. Friction turns
    between two samples, as :class:`Steps` has it. Below 0 it is early. 0 where what was recorded at the other time
    cannot be judged: a torque that is led over stops and reversals says nothing of a delay.
    """
    problem = white.problem
    torque, used = problem.measured.torque[problem.train, axis], problem.usable[:, axis]
    late, now = (_coulomb(problem.train_state, fit, axis, d) for d in (delay, 0.0))
    pieces = runs(np.asarray(problem.train_state.record))
    smooth = bridged(torque - late, used)
    parts = [put_forward(smooth[piece], delay, problem.measured.rate) for piece in pieces]
    known = np.concatenate([_known(used[piece], delay * problem.measured.rate) for piece in pieces])
    return np.where(known, torque - np.concatenate(parts) - now, 0.0), known


def _known(used: np.ndarray, later: float) -> np.ndarray:
    """Return which samples (m,) of a record have samples that are `used` (m,) on both sides of the time `later`
    samples after them."""
    place = np.arange(len(used)) + later
    sides = [np.clip(turn(place).astype(int), 0, len(used) - 1) for turn in (np.floor, np.ceil)]
    return used[sides[0]] & used[sides[1]]


@dataclass(frozen=True)
class Steps:
    """Coulomb friction (m, n) [N m] of all axes, `late` by a delay and `now`, and which samples are `used` (m, n)."""

    late: np.ndarray
    now: np.ndarray
    used: np.ndarray


def coulomb_steps(white: White, fit: Fit, delay: float) -> Steps:
    """Return the Coulomb friction of all samples `delay` [s] earlier and as it is, as the fit has it; 0 where no axis
    is judged."""
    problem = white.problem
    late, now = np.zeros((2, *problem.state.torque.shape))
    for axis in problem.judged:
        late[:, axis], now[:, axis] = (_coulomb(problem.state, fit, axis, d) for d in (delay, 0.0))
    return Steps(late, now, problem.measured.usable)


def bridged(values: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Return values (m,) with those that are not `used` (m,) led over by cubics that go on as the others end.

    What holds a joint at rest is unknown and jumps, and a series that is shifted rings beside a jump and beside a kink.
    """
    places = np.flatnonzero(used)
    if len(places) < 2:
        return values
    spline = CubicHermiteSpline(places, values[places], np.gradient(values[places], places))
    return np.where(used, values, spline(np.clip(np.arange(len(values)), places[0], places[-1])))


def _coulomb(state: State, fit: Fit, axis: int, delay: float) -> np.ndarray:
    """Return the Coulomb friction (m,) [N m] of an axis `delay` [s] earlier, as the fit has it.

    It jumps between two samples: a fraction of a sample late, friction of a hundred times the noise rings louder than
    all that a delay does.
    """
    sense, drive = earlier_sense(state, axis, delay), state.drive
    fitted = next(fit.theta[w] for t, w in zip(fit.terms, fit.slices, strict=True) if t.drive == (axis,))
    forward, backward = drive.coulomb_positive[axis] + fitted[0], drive.coulomb_negative[axis] + fitted[1]
    return level_between(sense, forward, backward)
