"""Time derivatives and delays along ordered samples; zero for unordered ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from jointwear.effects.rests import SLOW
from jointwear.effects.state import State, record_slices
from jointwear.statistics.ends import turned_about_ends

#: Samples by which a record is continued before its waves are changed.
CONTINUED = 64


def first_derivative(state: State, values: np.ndarray) -> np.ndarray:
    """Return the time derivative of `values` (m,) within each record, 0 without an order."""
    result = np.zeros(np.shape(values))
    if state.record is None:
        return result
    for part in record_slices(state):
        if part.stop - part.start >= 2:
            result[part] = np.gradient(values[part], state.time[part])
    return result


def second_derivative(state: State, values: np.ndarray) -> np.ndarray:
    """Return the second time derivative of `values` (m,) within each record, 0 without an order."""
    result = np.zeros(np.shape(values))
    if state.record is None:
        return result
    for part in record_slices(state):
        t, x = state.time[part], values[part]
        if len(t) >= 3:
            before, after = np.diff(t)[:-1], np.diff(t)[1:]
            slope = np.diff(x) / np.diff(t)
            result[part.start + 1 : part.stop - 1] = 2 * (slope[1:] - slope[:-1]) / (before + after)
    return result


def lagged(state: State, values: np.ndarray, lag: float, velocity: np.ndarray | None = None) -> np.ndarray:
    """Return `values` (m,) behind a first-order lag of time constant `lag` [s]; unchanged without an order.

    The lag is exact for values that are straight between samples or, where `velocity` (m,) is given, for values that
    stay constant until the velocity, straight between samples, changes its sign. A record starts settled. A negative
    lag is that of the record played backwards.
    """
    if state.record is None or lag == 0:
        return values
    result = np.array(values, dtype=float)
    for part, step, usual in _steps(state):
        x, v = result[part], None if velocity is None else velocity[part]
        if lag > 0:
            result[part] = _lagged(step, usual, x, lag, v)
        else:
            result[part] = _lagged(step[::-1], usual, x[::-1], -lag, None if v is None else v[::-1])[::-1]
    return result


def _steps(state: State) -> list[tuple[slice, np.ndarray, float]]:
    """Return the records of at least two samples, with the steps (m - 1,) of their times [s] and the median of these.

    Samples are evenly spaced but for jitter.
    """

    def steps() -> list[tuple[slice, np.ndarray, float]]:
        found = [(part, np.diff(state.time[part])) for part in record_slices(state)]
        return [(part, step, float(np.median(step))) for part, step in found if len(step)]

    return state.of_motion(("steps",), steps, state.time, state.record)


def _lagged(step: np.ndarray, usual: float, x: np.ndarray, lag: float, v: np.ndarray | None) -> np.ndarray:
    """Return one record (m,) behind a lag [s]; its times rise by `step` (m - 1,), by and large by `usual`."""
    keep = float(np.exp(-usual / lag))
    if v is None:
        share = (1 - keep) * lag / usual
        drive = (share - keep) * x[:-1] + (1 - share) * x[1:]
        start = x[0] - lag * (x[1] - x[0]) / step[0]
    else:
        turn = v[:-1] * v[1:] < 0
        after = np.where(turn, np.abs(v[1:]) / np.maximum(np.abs(v[1:]) + np.abs(v[:-1]), 1e-300), 1.0) * step
        rest = np.where(turn, np.exp(-after / lag), keep)
        drive = (rest - keep) * x[:-1] + (1 - rest) * np.where(turn, x[1:], x[:-1])
        start = x[0]
    return np.concatenate([[start], lfilter([1.0], [1.0, -keep], drive, zi=[keep * start])[0]])


def turn_by_lag(state: State, values: np.ndarray, lag: float) -> np.ndarray:
    """Return what a first-order lag [s] changes of `values` (m,) as far as that lies along turning them in time.

    With f the angle by which the lag turns a wave it is (1 + cos f) / 2 of what turning it alone changes. What a lag
    takes off a wave a filter takes off noise too; noise that is turned hardly gains. A negative lag turns the other way
    and adds: 1 / cos f as much. 0 without an order. Samples are evenly spaced but for jitter.
    """
    result = np.zeros(np.shape(values))
    if state.record is None or lag == 0:
        return result

    def turned(frequency: np.ndarray) -> np.ndarray:
        angle = np.arctan(2 * np.pi * frequency * lag)
        along = 0.5 * (1.0 + np.cos(angle)) / (np.cos(angle) if lag < 0 else 1.0)
        return along * (np.exp(-1j * angle) - 1.0)

    for part, _, usual in _steps(state):
        result[part] = shaped(values[part], usual, turned)
    return result


def shaped(values: np.ndarray, step: float, gain: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Return a record of values (m,), sampled every `step` [s], with its waves multiplied by their `gain`.

    Parameters
    ----------
    gain : frequencies [Hz] (k,) -> factor (k,), complex where it turns a wave.
    """
    padded, inside = continued(values)
    spectrum = np.fft.rfft(padded) * gain(np.fft.rfftfreq(len(padded), step))
    return np.fft.irfft(spectrum, len(padded))[inside]


def continued(values: np.ndarray) -> tuple[np.ndarray, slice]:
    """Return the samples (m,) of a record continued beyond both ends, and where they are in that.

    Turned about the ends: what begins with a step would ring when its spectrum is changed.
    """
    more = min(len(values) - 1, CONTINUED)
    return turned_about_ends(values, more), slice(more, more + len(values))


def up_to(state: State, values: np.ndarray, band: float) -> np.ndarray:
    """Return what `values` (m,) hold up to `band` [Hz] within each record, without a shift in time.

    The filter is a Butterworth of fourth order, forward and backward. Samples are evenly spaced but for jitter; without
    an order the values stay as they are.
    """
    if state.record is None:
        return values
    result = np.array(values, dtype=float)
    for part, _, usual in _steps(state):
        result[part] = shaped(values[part], usual, lambda frequency: 1.0 / (1.0 + (frequency / band) ** 8))
    return result


def late_torque(state: State, axis: int, delay: float) -> np.ndarray:
    """Return the nominal torque (m,) of one axis as it was `delay` [s] earlier; negative: as it will be.

    Of unordered samples it is the torque as it is.

    Coulomb friction jumps between two samples: the instant of reversal comes from the velocity, which does not. In a
    stop it is what holds the joint, and does not jump.
    """
    if state.record is None:
        return state.torque[..., axis]

    def torque() -> np.ndarray:
        smooth, velocity = state.between(axis).earlier(delay).T
        return smooth + level_of(state, axis, _sense(state, axis, velocity, delay))

    return state.once(("late torque", axis, delay), torque, keep=delay == 0)


def change_by_delay(state: State, axis: int, delay: float) -> np.ndarray:
    """Return what a delay [s] changes of the nominal torque (m,) of one axis.

    Against the torque as it is at the same time, in a stop too: there friction holds the joint, whatever the sign of
    the velocity, and that is no matter of time.
    """
    return late_torque(state, axis, delay) - late_torque(state, axis, 0.0)


def change_by_lag(state: State, axis: int, lag: float) -> np.ndarray:
    """Return what a first-order lag [s] changes of the nominal torque (m,) of one axis; see :func:`change_by_delay`.

    Of torque of which noise hides the size it is :func:`turn_by_lag`.
    """
    change = smoothed_torque(state, axis, lag) - late_torque(state, axis, 0.0)
    return change if state.above is None else change + turn_by_lag(state, state.above[..., axis], lag)


def earlier_sense(state: State, axis: int, delay: float) -> np.ndarray:
    """Return the share (m,), -1 to 1, of its Coulomb friction that an axis had `delay` [s] earlier."""
    return _sense(state, axis, state.between(axis).earlier(delay)[:, 1], delay)


def _sense(state: State, axis: int, velocity: np.ndarray, delay: float) -> np.ndarray:
    """Return :func:`earlier_sense` from the velocity (m,) [rad/s] at that time."""
    sense = np.sign(velocity)
    time = state.time - delay
    for rest in state.rests_of(axis):
        part = rest.found_in(time)
        sense[part] = rest.sense(time[part])
    return sense


def smoothed_torque(state: State, axis: int, lag: float) -> np.ndarray:
    """Return the nominal torque (m,) of one axis behind a first-order lag [s]; negative: before one.

    Before a lag stands what is asked of a drive that follows it late: tau + T dtau/dt, with the derivative over twice
    the lag, which is exact to the third power of the frequency and hardly adds noise.
    """
    velocity, torque = state.velocity[..., axis], state.torque[..., axis]
    if lag < 0:
        before, now, after = (late_torque(state, axis, d) for d in (-lag, 0.0, lag))
        return now + 0.5 * (after - before)
    ramp, turning = np.sign(velocity), np.array(velocity, dtype=float)
    for rest in state.rests_of(axis):
        time = state.time[rest.samples]
        ramp[rest.samples], turning[rest.samples] = rest.sense(time), SLOW * rest.held(time)
    sharp = level_of(state, axis, np.sign(turning))
    smooth = torque - state.drive.coulomb(axis, velocity) + level_of(state, axis, ramp) - sharp
    return lagged(state, smooth, lag) + lagged(state, sharp, lag, turning)


def level_of(state: State, axis: int, sense: np.ndarray) -> np.ndarray:
    """Return the share `sense` (m,), -1 to 1, of the Coulomb friction [N m] of one axis."""
    return level_between(sense, state.drive.coulomb_positive[axis], state.drive.coulomb_negative[axis])


def level_between(sense: np.ndarray, forward: float, backward: float) -> np.ndarray:
    """Return the share `sense` (m,), -1 to 1, of the friction [N m] of either direction; `backward` is negative."""
    return np.maximum(sense, 0.0) * forward - np.minimum(sense, 0.0) * backward
