"""Whether an effect has one size throughout the recordings, as its parameters say."""

from __future__ import annotations

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import chance, chi_square, least_squares
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.discovery.search.acceptance import follows_time, of_late_torque, of_timing
from jointwear.discovery.structure import TIME_BIN, time_bins
from jointwear.effects import get_effect

#: Spread of its size over time, beside its mean, from which an effect is not the same throughout: half, as of what is
#: there for four fifths of the time.
CHANGING = 0.5


def changing(outcome: Outcome, one: Named) -> float | None:
    """Return the spread of the size of an effect over time as a share of its mean, None where it may be constant.

    The parameters of an effect are constants: a part that a gripper lets go, or a brake that drags at times, is half of
    itself on average and of no name. The torque that the fit gives the effect is asked anew in every `TIME_BIN` of each
    record; what noise moves those sizes by is taken off their spread, each bin counts by the square of that torque. And
    the change has to be worth more than the effect is, as of what is there for half of the time: bins of time take up
    some of whatever else a model lacks. An effect that follows the time, or a temperature as it changes with time, may
    change; an elastic gear is asked for by its shape, not by its size.

    Most of what a delay changes looks like friction and inertia, which take its mean over but not what varies about it.
    There the spread is told by what it is worth in nats, beside the delay itself.
    """
    candidate, white, fit = one.candidate, outcome.white, outcome.fit
    late = of_late_torque(candidate)
    if candidate.effect == LINK_MASS or follows_time(candidate) or (of_timing(candidate) and not late):
        return None
    if get_effect(candidate.effect).follows_temperature:
        return None
    size = fit.coefficients(one.term)
    bins = time_bins(outcome.problem.train_state, TIME_BIN)
    torques = {axis: columns @ size for axis, columns in one.term.blocks.items()}
    blocks = {axis: torque[:, None] * bins[white.whiteners[axis].rows] for axis, torque in torques.items()}
    held = sum(np.sum(x**2, axis=0) for x in blocks.values()) > 0
    blocks = {axis: x[:, held] for axis, x in blocks.items()}
    full = sum(x.T @ x for x in blocks.values())
    b, gram = fit.gram(blocks)
    statistic, freedom = chi_square(b, gram, full)
    if not freedom:
        return None
    settings = outcome.problem.settings
    p, nats = chance(statistic, freedom, sum(len(x) for x in blocks.values()))
    if p >= settings.unexplained_p or nats <= (settings.accept if late else max(settings.accept, one.evidence)):
        return None
    if late:
        spread = float(np.sqrt(nats / one.evidence))
    else:
        moved = least_squares(b, gram, full)
        share = np.diag(full) / np.trace(full)
        by_noise = freedom / np.trace(full)
        spread = float(np.sqrt(max(share @ moved**2 - by_noise, 0.0)))
    return spread if spread > CHANGING else None
