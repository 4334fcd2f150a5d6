"""Friction that would have to drive: data that ask for it lack something else on that joint.

The search leaves the friction of the drives free, in each direction by itself. So it takes up any torque that is the
same throughout a motion: a zero of a sensor that is off, a dead zone that gravity holds on one side. As long as that
friction brakes it may be the joint's own. No file can hold one that drives, and what it would have explained is left.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import norm

from jointwear.discovery.estimates.outcome import Outcome, Unexplained
from jointwear.discovery.problem.problem import FRICTION, SENSE
from jointwear.discovery.search.least_torque import least_square
from jointwear.discovery.search.leftovers import LEAST_P
from jointwear.files.wording import numbered

#: Argument of what friction would have to do.
DIRECTION = "direction"
_OF_DIRECTIONS = (FRICTION.index("coulomb_positive"), FRICTION.index("coulomb_negative"))


def driving_friction(outcome: Outcome) -> list[Unexplained]:
    """Return the torque in a direction for which Coulomb friction would have to drive, of axes on which it matters.

    It counts from `noise_sigmas` standard deviations below zero, and as any structure from :func:`.least_square` on.
    Asked are the axes that do not stay unexplained already.
    """
    problem, fit = outcome.problem, outcome.fit
    if fit is None:
        return []
    still, found = {u.axis for u in outcome.unexplained}, []
    spread = np.sqrt(np.diag(fit.covariance))
    for term, where in zip(fit.terms, fit.slices, strict=True):
        if not term.drive or term.drive[0] in still:
            continue
        axis = term.drive[0]
        friction = problem.drive_parameters[axis] + SENSE * fit.theta[where]
        speed = problem.train_state.velocity[problem.usable[:, axis], axis]
        for k in _OF_DIRECTIONS:
            drives, sense = -float(friction[k]), float(SENSE[k])
            sigmas, share = drives / spread[where][k], float(np.mean(sense * speed > 0))
            if sigmas > problem.settings.noise_sigmas and share * drives**2 > least_square(outcome, axis):
                p = max(float(norm.sf(sigmas)), LEAST_P)
                found.append(Unexplained(axis, DIRECTION, "1", sense, sense, p, 0.5 * sigmas**2, 0.5))
    return found


def driving_in_words(found: Sequence[Unexplained]) -> list[str]:
    """Say of which joints friction would have to drive, in one sentence or none."""
    if not found:
        return []
    where = numbered("joint", sorted({u.axis + 1 for u in found}))
    words = (
        f"{where}: a torque that is always there is larger than the friction, which would have to drive in one "
        "direction: look at the zero and at a dead zone of that torque, and for a spring, a load or a weight that the "
        "robot file lacks"
    )
    return [words]
