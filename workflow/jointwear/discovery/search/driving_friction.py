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
from jointwear.discovery.search.least_torque import least_square
from jointwear.files.wording import numbered

#: Argument of what friction would have to do.
DIRECTION = "direction"
#: Columns of the drive that are friction of a direction, and the sense in which it brakes there.
_BRAKES = ((0, 1.0), (1, -1.0))


def driving_friction(outcome: Outcome) -> list[Unexplained]:
    """Return the torque in a direction for which Coulomb friction would have to drive, of axes on which it matters.

    It counts from `noise_sigmas` standard deviations below zero, and as any structure from :func:`.least_square` on.
    Asked are the axes that do not stay unexplained already.
    """
    problem, fit = outcome.problem, outcome.fit
    if fit is None:
        return []
    nominal = np.stack([problem.robot.coulomb_positive, -problem.robot.coulomb_negative], axis=1)
    still, found = {u.axis for u in outcome.unexplained}, []
    for term, where in zip(fit.terms, fit.slices, strict=True):
        if not term.drive or term.drive[0] in still:
            continue
        axis = term.drive[0]
        std = np.sqrt(np.diag(fit.covariance)[where])
        speed = problem.train_state.velocity[problem.usable[:, axis], axis]
        for k, sense in _BRAKES:
            drives = -(nominal[axis, k] + sense * fit.theta[where][k])
            sigmas, share = drives / std[k], float(np.mean(sense * speed > 0))
            if sigmas > problem.settings.noise_sigmas and share * drives**2 > least_square(outcome, axis):
                p = max(float(norm.sf(sigmas)), np.finfo(float).tiny)
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
