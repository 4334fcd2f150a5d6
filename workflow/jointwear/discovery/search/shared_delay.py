"""The time by which the torque of a log is late, or early, on all joints alike: how it is sampled, no actuator's delay.

A controller that reads positions at the start of a period and holds its torque until the end logs both with one time
stamp, so that the torque is half a period early (Franklin, Powell and Workman 1998, chapter 4, on the delay of a
zero-order hold). A log that asks for one after the other is late by as little. No joint is the cause of it, and no
robot file should hold it; left in, it would be named on every joint.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from scipy.interpolate import CubicSpline

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.acceptance import of_late_torque, of_timing
from jointwear.discovery.search.recorded_in_time import Steps, bridged, put_forward, whitened_change
from jointwear.effects import State, get_effect
from jointwear.effects.order import change_by_delay
from jointwear.measurement.recording import Recording

#: Sampling periods by which a torque that is held from one sample to the next is early at most: half of one, to which a
#: zero-order hold delays, and two times of which each is known so well.
HELD = 0.5 + 2.0 * assumed.CLOCK
#: Delays that are compared on either side of none.
STEPS = 60
#: Delays of one joint that are computed; what lies between is led over.
ASKED = 17


def sampling_period(recording: Recording) -> float:
    """Return the usual time [s] between two samples of one trajectory, 0 without any."""
    step, same = np.diff(recording.time), np.diff(recording.trajectory) == 0
    return float(np.median(step[same])) if same.any() else 0.0


def shared_delay(
    white: White,
    period: float,
    beside: Sequence[Term] = (),
    read: float = 0.0,
    named: Mapping[int, float] = MappingProxyType({}),
) -> float:
    """Return the delay [s] of the torque of a log that most joints have in common, negative where it is early.

    It is 0, or the delay that has been taken out already, where no other is clearly likelier. No joint counts for more
    than half of what a name needs, so that three have to agree, and one with a delay of its own speaks neither for nor
    against. Where noise leaves the model of most joints no band to tell it, but one of them has a name for a delay, the
    others may agree with that by the recorded torque. Where most joints have names for one delay it is that of the log.
    Where the recorded torque of most joints is late alike, and early torque far worse, it is late for all of them.
    Where three have names for delays that undo what was read, none was to be read; nor where the delay that is left
    ends beyond those that are asked, on the other side.

    Parameters
    ----------
    white : of the log with its torque read `read` [s] later. period : between two samples as they were logged [s].
    beside : terms of the model beside which it is asked. named : axis -> delay [s] that has a name there.
    """
    fit = white.fit(list(beside))
    settings = white.problem.settings
    # Two times of which each is known so well. Of a high rate the period of the samples that are kept counts: a loop of
    # current is slower than the log.
    agree = 2.0 * assumed.CLOCK
    if read and sum(abs(read + delay) <= agree * period for delay in named.values()) > 2:
        return 0.0
    kept = 1.0 / white.problem.measured.rate
    largest = max(HELD, agree * kept / period + agree)
    shares = np.append(np.linspace(-largest, largest, 2 * STEPS + 1), read / period)
    lost = _of_joints(white, fit, period, shares - read / period)
    if not lost:
        return read
    against = _against(lost, settings.accept)
    best = int(np.argmin(against))
    open_still = against[-1] - against[best] <= settings.accept
    if not open_still and against[STEPS] - against[best] <= settings.accept:
        return 0.0
    recorded = _of_joints(white, fit, period, shares - read / period, recorded=True)
    if open_still:
        wanted = {axis: (read + delay) / period for axis, delay in named.items()}
        agreed = _agreed_on(wanted, lost, recorded, shares, settings.accept)
        if agreed is None:
            agreed = _named_alike(wanted, len(lost), shares)
        if agreed is None:
            agreed = _late_alike(lost, recorded, shares, settings.accept)
        if agreed is None:
            return read
        best = agreed
    # Which delay it is, those joints tell that have it, each by all that it knows. The recorded torque tells it more
    # sharply, without accelerations, but decides nothing: a controller answers to the noise of its encoder, and that
    # torque runs ahead of the same noise in the accelerations. Asked are all delays that the model does not exclude: a
    # low cut-off leaves it as flat as to end at the largest.
    near = np.abs(shares - shares[best]) <= agree
    if not open_still:
        near |= against - against[best] <= settings.accept
    for told in (lost, recorded):
        having = [of_joint for of_joint in told.values() if near[np.argmin(of_joint)]]
        best = int(np.argmin(np.sum(having, axis=0))) if having else best
    if abs(shares[best]) < largest:
        return float(shares[best] * period)
    # What is later still is no matter of sampling. What was read the other way is none of it either.
    return 0.0 if shares[best] * read < 0 else read


def of_others_against(white: White, fit: Fit, axis: int, delay: float) -> float:
    """Return the nats with which the other axes speak against a delay [s] of all that one (0-based) has, over none.

    No axis counts for more than half of what a name needs, for or against.
    """
    period, most = 1.0 / white.problem.measured.logged_rate, 0.5 * white.problem.settings.accept
    shares = np.array([-HELD, delay / period, 0.0, HELD])
    lost = (told for other, told in _of_joints(white, fit, period, shares).items() if other != axis)
    return float(sum(np.clip(told[1] - told[2], -most, most) for told in lost))


def lasting_terms(named: Sequence[Named]) -> list[Term]:
    """Return the terms of what was named that has nothing to do with time."""
    return [t for n in named if not of_timing(n.candidate) for t in n.terms]


def named_delays(named: Sequence[Named]) -> dict[int, float]:
    """Return axis -> delay [s] of what was named that is the torque at another time, a dead time or a lag."""
    late = [n.candidate for n in named if of_late_torque(n.candidate)]
    return {c.axis: float(c.nonlinear[get_effect(c.effect).scaled]) for c in late}


def _against(lost: Mapping[int, np.ndarray], accept: float) -> np.ndarray:
    """Return what speaks against each delay (k,) in nats, no joint by more than half of what a name needs."""
    return np.minimum(list(lost.values()), 0.5 * accept).sum(axis=0)


def _agreed_on(
    named: Mapping[int, float],
    lost: Mapping[int, np.ndarray],
    recorded: Mapping[int, np.ndarray],
    shares: np.ndarray,
    accept: float,
) -> int | None:
    """Return the index of a delay with a name on which the other joints agree by their recorded torque, or None.

    Three of them have to, with a name or without, as of the model, which must not speak against it.

    Parameters
    ----------
    named : axis -> delay that has a name there, in sampling periods.
    """
    for own, share in named.items():
        others = [{a: told[a] for a in told if a != own} for told in (lost, recorded)]
        if abs(share) > shares[-2] or not all(others):
            continue
        place = int(np.argmin(np.abs(shares[:-1] - share)))
        by_model, by_torque = (_against(told, accept) for told in others)
        near = np.abs(shares - share) <= 2.0 * assumed.CLOCK
        there = float(by_torque[near].min())
        if by_torque[-1] - there > accept and by_torque[STEPS] - there > accept and by_model[place] < by_model[-1]:
            return place
    return None


def _late_alike(
    lost: Mapping[int, np.ndarray], recorded: Mapping[int, np.ndarray], shares: np.ndarray, accept: float
) -> int | None:
    """Return the index of the delay by which the recorded torque of most joints is late alike, or None.

    None that tells a delay may tell another one. Only a late torque is told so, of a log that is read as it came: to
    the noise of an encoder a controller answers with a torque that seems early. As early a torque must be far worse, by
    four times as much as none where the loss is a square; what only averages two neighbouring samples is as good either
    way. The model must not speak against it.
    """
    if shares[-1]:
        return None
    by_model, by_torque = (_against(told, accept) for told in (lost, recorded))
    late = shares[:-1] > 2.0 * assumed.CLOCK
    place = int(np.argmin(np.where(late, by_torque[:-1], np.inf)))
    near = np.abs(shares - shares[place]) <= 2.0 * assumed.CLOCK
    sure = np.array([told for told in recorded.values() if told[-1] > accept])
    if len(sure) <= 2 or 2 * len(sure) <= len(recorded) or by_model[place] - by_model[-1] > accept:
        return None
    none, early = sure[:, -1].sum(), sure[:, 2 * STEPS - place].sum()
    return place if (sure[:, near].min(axis=1) <= accept).all() and early > 2.0 * none else None


def _named_alike(named: Mapping[int, float], joints: int, shares: np.ndarray) -> int | None:
    """Return the index of the delay that most of so many joints have in their names, or None.

    No joint is the cause of what most have alike. Neither model nor recorded torque need show it: an elastic joint
    moves the one, and the torque of light joints is what their controller answers to noise.

    Parameters
    ----------
    named : axis -> delay that has a name there, in sampling periods.
    """
    delays = np.array(list(named.values()))
    middle = float(np.median(delays)) if len(delays) else 0.0
    alike = np.abs(delays - middle) <= 2.0 * assumed.CLOCK
    if alike.sum() <= 2 or 2 * alike.sum() <= joints or abs(middle) > shares[-2]:
        return None
    return int(np.argmin(np.abs(shares[:-1] - middle)))


def _of_joints(
    white: White, fit: Fit, period: float, shares: np.ndarray, recorded: bool = False
) -> dict[int, np.ndarray]:
    """Return for every axis that tells the nats that each delay (k,), in sampling periods, costs against its best.

    Each delay is compared as it is, not as a share of another: within half a period waves near the end of the band turn
    by up to a quarter, and friction turns between two samples.

    Parameters
    ----------
    recorded : of the recorded torque, in all of its band, in place of that of the model, where the noise of derived
        accelerations does no harm.
    """
    asked, found = np.linspace(shares.min(), shares.max(), ASKED), {}
    for axis in white.problem.judged:
        if recorded:
            late = np.stack([whitened_change(white, fit, axis, share * period) for share in asked], axis=1)
        else:
            late = white.columns(axis, _changes(white.timing_state(axis), axis, period * asked))
        b, gram = fit.gram({axis: late})
        if not np.diag(gram).any():
            continue
        misfit = max(float(np.mean(fit.residual[axis] ** 2)), 1.0)
        nats = CubicSpline(asked, (0.5 * np.diag(gram) - b) / misfit)(shares)
        found[axis] = nats - nats.min()
    return found


def _changes(state: State, axis: int, delays: np.ndarray) -> np.ndarray:
    """Return what delays (k,) [s] change of the torque of an axis, (N_train, k); asked again after each search."""
    return state.once(
        ("changes by delay", axis, *delays),
        lambda: np.stack([change_by_delay(state, axis, delay) for delay in delays], axis=1),
    )


def without_delay(recording: Recording, delay: float, steps: Steps | None = None) -> Recording:
    """Return a recording whose torque is read `delay` [s] later within each trajectory.

    It keeps its whole band: the mean of two neighbours would lack the highest frequencies, which the noise model then
    makes much of. Where samples are missing or not even it is read straight between them.

    Parameters
    ----------
    steps : of this delay. What is put forward is the torque without its friction, led over rests, so that it does not
        ring beside a reversal. None, or of other samples than those of the recording: as it is.
    """
    torque = np.array(recording.torque, dtype=float)
    if steps is not None and steps.used.shape != torque.shape:
        steps = None
    for label in recording.labels:
        rows = recording.trajectory == label
        time = recording.time[rows]
        step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
        even = step > 0 and np.ptp(np.diff(time)) < assumed.CLOCK * step
        for axis, values in enumerate(recording.torque[rows].T):
            if not (even and np.isfinite(values).all()):
                torque[rows, axis] = np.interp(time + delay, time, values)
                continue
            torque[rows, axis] = put_forward(values, delay, 1.0 / step)
            if steps is None or not steps.used[rows, axis].any():
                continue
            used = steps.used[rows, axis]
            smooth = put_forward(bridged(values - steps.late[rows, axis], used), delay, 1.0 / step)
            torque[rows, axis] = np.where(used, smooth + steps.now[rows, axis], torque[rows, axis])
    return replace(recording, torque=torque)


def delay_in_words(delay: float, period: float, unexplained: bool = False, named: bool = False) -> str:
    """Return what is told of a delay [s] that all joints share; of how well it is known nothing is.

    `unexplained` : whether structure without a name is left: a shaking floor may look like a delay of all joints.
    `named` : whether effects have names, which take over some of a delay or give it some of theirs.
    """
    way = "late" if delay > 0 else "early"
    found = f"about {1e3 * abs(delay):.2g} ms {way} ({abs(delay) / period:.2f} of a sampling period)"
    if unexplained:
        return (
            f"the torque of all joints fits best as recorded {found}, and is read so: that may be how the log is "
            "sampled, or come of what stays unexplained"
        )
    if named:
        return (
            f"the torque of all joints is recorded {found}, as far as that can be told beside the effects that have a "
            "name: that is most likely how the log is sampled, and it is read so"
        )
    return (
        f"the torque of all joints is recorded {found}: that is how the log is sampled, and it is read at the right "
        "time instead"
    )
