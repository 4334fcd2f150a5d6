"""The torque that no effect explains from which it matters."""

from __future__ import annotations

import numpy as np

from jointwear.discovery.estimates.outcome import Outcome


def least_square(outcome: Outcome, axis: int) -> float:
    """Return the mean square [N m^2] from which torque that no effect explains matters on one axis."""
    problem, share = outcome.problem, outcome.problem.settings.smallest_share
    torque = rms(problem.train_state.torque[:, axis], problem.usable[:, axis])
    return max(share * outcome.white.whiteners[axis].marginal ** 2, (share * torque) ** 2)


def rms(values: np.ndarray, where: np.ndarray) -> float:
    """Return the RMS of values (m,) over some of them, 0 where there is none."""
    return float(np.sqrt(np.mean(values[where] ** 2))) if where.any() else 0.0
