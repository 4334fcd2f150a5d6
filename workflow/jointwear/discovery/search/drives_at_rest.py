"""Samples at which a shared drive that has a name is slow enough to stick: there its friction is of any level."""

from __future__ import annotations

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.effects import get_effect


def at_rest(outcome: Outcome, axis: int) -> np.ndarray:
    """Return the used training samples (m,) of an axis, as a mask, at which a named drive that it shares may stick.

    Both joints move there, so that neither is at rest, and the friction of their drive lies anywhere between its two
    levels. What lies between them tells where: whitened, it is more than noise at the sample and shortly after it.
    """
    problem, whitener = outcome.problem, outcome.white.whiteners[axis]
    state, mask = problem.train_state, np.zeros(len(whitener.rows), dtype=bool)
    for named in outcome.named:
        one, size = named.candidate, outcome.fit.coefficients(named.term)
        if size is None or one.axis != axis or one.effect == LINK_MASS or not get_effect(one.effect).rubs:
            continue
        own, other = one.nonlinear["own"], one.nonlinear["other"]
        speed = own * state.velocity[:, axis] + other * state.velocity[:, one.source]
        between = 2.0 * float(size[0]) * (np.abs(speed) < assumed.STICKS)
        mask |= np.abs(whitener(between)) > problem.settings.noise_sigmas
    return mask
