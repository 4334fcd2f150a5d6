"""Samples at which a shared drive that has a name is slow enough to stick: there its friction is of any level."""

from __future__ import annotations

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect


def at_rest(outcome: Outcome, axis: int) -> np.ndarray:
    """Return the used training samples (m,) of an axis, as a mask, at which a named drive that it shares may stick.

    Both joints move there, so that neither is at rest, and the friction of their drive lies anywhere between its two
    levels.
    """
    mask = np.zeros(len(outcome.white.whiteners[axis].rows), dtype=bool)
    for named in outcome.named:
        size = outcome.fit.coefficients(named.term)
        one = next((half for half in named.candidate.halves if half.axis == axis), None)
        if size is None or one is None or one.effect == LINK_MASS or not get_effect(one.effect).rubs:
            continue
        mask |= unknown_at_rest(outcome.white, one, float(size[0]))
    return mask


def unknown_at_rest(white: White, drive: Candidate, level: float) -> np.ndarray:
    """Return the used training samples (m,) of its axis, as a mask, at which a shared drive may stick.

    What lies between the two levels of its Coulomb friction `level` [N m] tells where: whitened, it is more than noise
    at the sample and shortly after it.
    """
    problem, state, own = white.problem, white.problem.train_state, drive.nonlinear
    speed = own["own"] * state.velocity[:, drive.axis] + own["other"] * state.velocity[:, drive.source]
    between = 2.0 * level * (np.abs(speed) < assumed.STICKS)
    return np.abs(white.whiteners[drive.axis](between)) > problem.settings.noise_sigmas
