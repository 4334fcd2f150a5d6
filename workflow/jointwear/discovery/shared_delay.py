"""The time by which the torque of a log is late, or early, on all joints alike: how it is sampled, no actuator's delay.

A controller that reads positions at the start of a period and holds its torque until the end logs both with one time
stamp, so that the torque is half a period early (Franklin, Powell and Workman 1998, chapter 4, on the delay of a
zero-order hold). A log that asks for one after the other is late by as little. No joint is the cause of it, and no
robot file should hold it; left in, it would be named on every joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointwear.discovery.candidates import LINK_MASS
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.outcome import Named
from jointwear.discovery.whitening import White
from jointwear.effects import get_effect
from jointwear.effects.order import late_torque
from jointwear.measurement.recording import Recording

#: Largest delay, in sampling periods: half of one, and what it is not known to.
LARGEST = 0.6
#: Delays that are compared on either side of none.
STEPS = 60


def sampling_period(recording: Recording) -> float:
    """Return the usual time [s] between two samples of one trajectory, 0 without any."""
    step, same = np.diff(recording.time), np.diff(recording.trajectory) == 0
    return float(np.median(step[same])) if same.any() else 0.0


def shared_delay(white: White, period: float, beside: Sequence[Term] = ()) -> float:
    """Return the delay [s] of the torque that most joints have in common, negative where it is early; 0 for none.

    No joint counts for more than half of what a name needs, so that three have to agree, and one with a delay of its
    own speaks neither for nor against.

    Parameters
    ----------
    period : between two samples as they were logged [s].
    beside : terms of the model beside which it is asked.
    """
    fit = white.fit(list(beside))
    found = [of_joint for axis in white.problem.judged if (of_joint := _of_joint(white, fit, axis, period)) is not None]
    if not found:
        return 0.0
    delay, sigma = np.array(found).T
    settings = white.problem.settings
    shares = np.linspace(-LARGEST, LARGEST, 2 * STEPS + 1)
    against = np.minimum(0.5 * ((delay - shares[:, None]) / sigma) ** 2, 0.5 * settings.accept).sum(axis=1)
    best = int(np.argmin(against))
    return float(shares[best] * period) if against[STEPS] - against[best] > settings.accept else 0.0


def is_feigned(white: White, period: float, delay: float, named: Sequence[Named]) -> bool:
    """Return whether a delay that was taken out of a log is only what effects that were found since look like.

    What a load lacks follows its speed on several joints. Beside it the torque would then have to be read back again.

    Parameters
    ----------
    white : the log without the `delay` [s]. named : effects found in it, of which those of timing are not asked.
    """
    lasting = [n for n in named if n.candidate.effect == LINK_MASS or not get_effect(n.candidate.effect).timing]
    terms = [t for n in lasting for t in n.terms]
    return bool(terms) and abs(delay + shared_delay(white, period, terms)) < 0.5 * abs(delay)


def _of_joint(white: White, fit: Fit, axis: int, period: float) -> tuple[float, float] | None:
    """Return the delay of the torque of one joint and its standard deviation, both in sampling periods."""
    state = white.timing_state(axis)
    late = late_torque(state, axis, 0.5 * period) - state.torque[:, axis]
    b, gram = fit.gram({axis: white.columns(axis, late[:, None])})
    if not gram[0, 0] > 0:
        return None
    misfit = max(float(np.sqrt(np.mean(fit.residual[axis] ** 2))), 1.0)
    return 0.5 * float(b[0] / gram[0, 0]), 0.5 * misfit / float(np.sqrt(gram[0, 0]))


def without_delay(recording: Recording, delay: float) -> Recording:
    """Return a recording whose torque is read `delay` [s] later, straight between samples of one trajectory."""
    torque = np.array(recording.torque, dtype=float)
    for label in recording.labels:
        rows = recording.trajectory == label
        time = recording.time[rows]
        for axis in range(recording.joints):
            torque[rows, axis] = np.interp(time + delay, time, recording.torque[rows, axis])
    return replace(recording, torque=torque)


def delay_in_words(delay: float, period: float) -> str:
    """Return what is told of a delay [s] that all joints share."""
    way = "late" if delay > 0 else "early"
    share = abs(delay) / period
    return (
        f"the torque of all joints is recorded {1e3 * abs(delay):.2g} ms {way} ({share:.2f} of a sampling period): "
        "that is how the log is sampled, and it is read at the right time instead"
    )
