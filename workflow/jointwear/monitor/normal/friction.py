"""Friction of every axis in every window at its usual speed: a value that needs no normal period.

Coulomb and viscous friction are hard to tell apart in a short window; their sum at the speed at which the axis usually
moves is not. The regression of :mod:`.windows` is solved with weak priors that hold what the motion does not show:

    friction = (C+ + C-)/2 + fv v0 + (d_positive + d_negative)/2 + d_velocity v0,

C+, C- and fv of the model, v0 the root mean square of the speed in motion. The standard deviation is the larger of
two: samples counted as first-order autoregressive noise leaves them independent, and the sandwich over blocks. What
the model lacks altogether (see discovery) is in neither; what the effects of an augmented robot explain, such as
temperature, is taken out of the friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.series import usual_speed
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.robots.robot import Robot

#: Prior standard deviations: of Coulomb, offset and viscous friction over the friction of the model, of the relative
#: errors of gravity and inertia.
PRIOR = {"coulomb": 3.0, "offset": 0.2, "viscous": 3.0, "gravity": 0.3, "inertial": 0.3}
#: An estimate hardly narrower than its prior shows nothing.
SHOWN = 0.3
#: Friction that stands for that of an axis without any in the robot file, over its largest torque; and the least share
#: of its samples that count as independent.
STANDS_FOR, INDEPENDENT = 0.1, 1e-3


@dataclass(frozen=True)
class WindowFriction:
    """`value`, `std` (w, n) [N m], NaN where nothing is seen; `speed` (n,) [rad/s] that they are for."""

    value: np.ndarray
    std: np.ndarray
    speed: np.ndarray


def window_friction(statistics: WindowStatistics, robot: Robot, baseline: np.ndarray) -> WindowFriction:
    """Return the friction at the usual speed of the windows of the `baseline` (w,) bool."""
    speed = usual_speed(statistics, baseline)
    level = (np.abs(robot.coulomb_positive) + np.abs(robot.coulomb_negative)) / 2
    nominal = level + np.abs(robot.viscous) * speed
    size = np.where(nominal > 0, nominal, STANDS_FOR * statistics.torque_reference)
    per_speed = size / np.where(speed > 0, speed, 1.0)
    # Columns become Coulomb (the sum of both directions), offset (their difference), and the rest.
    turn = np.eye(5)
    turn[:2, :2] = [[1.0, 1.0], [1.0, -1.0]]
    gram = np.einsum("ip,wnpq,qk->wnik", turn.T, statistics.gram, turn)
    score = np.einsum("ip,wnpq,qk->wnik", turn.T, statistics.score, turn)
    moment = np.einsum("ip,wnp->wni", turn.T, statistics.moment)
    prior = np.stack(
        [
            PRIOR["coulomb"] * size,
            PRIOR["offset"] * size,
            PRIOR["viscous"] * per_speed,
            np.full_like(size, PRIOR["gravity"]),
            np.full_like(size, PRIOR["inertial"]),
        ],
        axis=1,
    )
    wanted = np.zeros((len(speed), 5))
    wanted[:, 0], wanted[:, 2] = 1.0, speed
    before = np.sqrt(np.einsum("nk,nk->n", wanted**2, prior**2))
    value, std = np.full(statistics.count.shape, np.nan), np.full(statistics.count.shape, np.nan)
    independent = statistics.effective_count / np.maximum(statistics.count, 1)
    seen = (statistics.freedom > 0) & (statistics.residual_square > 0) & statistics.judgeable
    w, j = np.nonzero(seen)
    weight = (np.maximum(independent, INDEPENDENT)[w, j] / statistics.noise_variance[w, j])[:, None]
    own, aim = prior[j], wanted[j]
    known = np.eye(5) / own[:, None] ** 2
    precision = weight[..., None] * gram[w, j] + known
    # Scaled to a unit diagonal: the columns have different units.
    scale = 1.0 / np.sqrt(np.diagonal(precision, axis1=1, axis2=2))
    outer = scale[:, :, None] * scale[:, None, :]
    covariance = np.linalg.inv(precision * outer) * outer
    ahead = np.einsum("kpq,kq->kp", covariance, aim)
    robust = np.einsum("kp,kpq,kq->k", ahead, weight[..., None] ** 2 * score[w, j] + known, ahead)
    error = np.sqrt(np.maximum((aim * ahead).sum(axis=1), robust))
    shown = error < SHOWN * before[j]
    growth = np.einsum("kp,kpq,kq->k", aim, covariance, weight * moment[w, j])
    value[w, j] = np.where(shown, nominal[j] + growth, np.nan)
    std[w, j] = np.where(shown, error, np.nan)
    return WindowFriction(value, std, speed)
