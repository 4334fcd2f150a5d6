"""Runs of the reproduction as sums of window statistics, for many replicates at once.

A log of the reproduction holds the same instants of the same commanded motion in every hour, so that regressors are
the same in all windows and only moments differ. Everything else that the study asks for (another size or shape of
wear, two axes at once, more noise) follows exactly from the moments, because wear adds a known multiple of a
regressor, and the disturbance, a share of the mean torque, grows by a known factor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointwear.files.storage import open_dataset, read_variable
from jointwear.monitor.normal.estimate import Sums, change_columns, prior_scale
from jointwear.monitor.reading.model import TorqueModel
from jointwear.reproduction.wear import Wear
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.robots.trajectory import Motion, Task
from jointwear.studies.monitor_study.nominal import coulomb_levels_of
from jointwear.studies.monitor_study.normal_period import Normal, learn_normal

#: Speed below which an axis counts as at rest [rad/s].
DEAD_BAND = 1e-3


@dataclass(frozen=True)
class Regression:
    """Regression of one task with one nominal model.

    `torque` (s, n) of the model [N m]; `columns` (s, n, 5) regressors of the window statistics; `used` (s, n) bool;
    `coulomb` (n, 2), `viscous` (n,) of the model.
    """

    torque: np.ndarray
    columns: np.ndarray
    used: np.ndarray
    coulomb: np.ndarray
    viscous: np.ndarray

    @property
    def gram(self) -> np.ndarray:
        """Gram matrices (n, 5, 5) of an hour."""
        return np.einsum("snp,snq->npq", self.columns, self.columns)


def regression_of(robot: Robot, motion: Motion) -> Regression:
    """Return the regression of samples of a motion with a nominal model."""
    model = TorqueModel(robot)(motion.position, motion.velocity, motion.acceleration)
    used = np.abs(motion.velocity) > DEAD_BAND
    columns = np.stack(
        [
            used & (motion.velocity > 0),
            -1.0 * (used & (motion.velocity < 0)),
            motion.velocity * used,
            model.gravity * used,
            model.inertial * used,
        ],
        axis=-1,
    )
    return Regression(model.total, columns.astype(float), used, coulomb_levels_of(robot), np.abs(robot.viscous))


def sums_of_torque(torque: np.ndarray, regression: Regression) -> Sums:
    """Return the sums of windows from torque (r, h, s, n) [N m]: `moment` (r, h, n, 5) and the rest."""
    residual = torque - regression.torque
    x, gram = regression.columns, regression.gram
    r, h, s, n = residual.shape
    moment = np.empty((r, h, n, 5))
    square = np.empty((r, h, n))
    for j in range(n):
        part = np.where(regression.used[:, j], residual[..., j], 0.0).reshape(-1, s)
        moment[:, :, j] = (part @ x[:, j]).reshape(r, h, 5)
        square[:, :, j] = np.einsum("ks,ks->k", part, part).reshape(r, h)
    scale = np.sqrt(np.einsum("nkk->nk", gram))
    inverse = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0)
    outer = inverse[:, :, None] * inverse[:, None, :]
    pseudo = np.linalg.pinv(gram * outer, rcond=1e-9, hermitian=True) * outer
    rank = np.linalg.matrix_rank(gram * outer, hermitian=True, tol=1e-9)
    left = np.maximum(square - np.einsum("rhnp,npq,rhnq->rhn", moment, pseudo, moment, optimize=True), 0.0)
    count = regression.used.sum(axis=0)
    freedom = np.broadcast_to(np.maximum(count - rank, 0), square.shape)
    usable = np.broadcast_to(count > 0, square.shape)
    return change_columns(gram[None, None], moment, left, freedom, usable, regression.coulomb)


def read_torque(path: str | Path, replicates: slice = slice(None)) -> np.ndarray:
    """Read the torque (r, h, s, n) of a run of the reproduction [N m]."""
    with open_dataset(path) as dataset:
        return read_variable(dataset, path, "torque", replicates).astype(float)


class TaskWear:
    """What wear does to the sums of one task under the true model.

    Parameters
    ----------
    robot, task : those of the simulation. regression : of the nominal model of the monitor.
    true : regression of the true model, whose Coulomb column is what wear multiplies.
    time_step : of the cycle over which the disturbance takes its mean [s].
    """

    _SHARES = np.linspace(0.0, 0.3, 31)

    def __init__(
        self, robot: Robot, task: Task, true: Regression, regression: Regression, time_step: float, hours: int
    ) -> None:
        self.hours = hours
        cycle = task.grid(time_step)
        dynamics = Dynamics(robot)
        torque = dynamics.inverse_dynamics(cycle.position, cycle.velocity, cycle.acceleration)
        positive, negative = cycle.velocity > 0, cycle.velocity < 0
        friction = positive * robot.coulomb_positive + negative * robot.coulomb_negative
        self._mean = np.stack([np.abs(torque + g * friction).mean(axis=0) for g in self._SHARES])
        rise = true.columns[..., 0] * true.coulomb[:, 0] + true.columns[..., 1] * true.coulomb[:, 1]
        moment = np.einsum("snp,sn->np", regression.columns, rise)
        blank = np.zeros((1, 1, len(moment)))
        self.moment = change_columns(
            regression.gram[None, None], moment[None, None], blank, blank, blank > 0, regression.coulomb
        ).moment[0, 0]

    def growth(self, increase_percent: float, shape: float) -> np.ndarray:
        """Return the growth (h,) of equation (7) at hours 1, 2, ..."""
        return Wear(increase_percent, shape, float(self.hours)).growth(np.arange(1, self.hours + 1))

    def size_of_noise(self, axis: int, growth: np.ndarray) -> np.ndarray:
        """Return the mean |torque| of a 0-based axis at `growth` over that of the healthy axis, (h,)."""
        return np.interp(growth, self._SHARES, self._mean[:, axis]) / self._mean[0, axis]

    def changed(self, sums: Sums, axis: int, before: np.ndarray, after: np.ndarray) -> Sums:
        """Return sums (r, h, n) whose 0-based `axis` has grown by `after` (h,) instead of `before` (h,)."""
        ratio = self.size_of_noise(axis, after) / self.size_of_noise(axis, before)
        moment, left = sums.moment.copy(), sums.residual_square.copy()
        rise = self.moment[axis]
        noise = moment[:, :, axis] - before[:, None] * rise
        moment[:, :, axis] = noise * ratio[:, None] + after[:, None] * rise
        left[:, :, axis] *= ratio**2
        return replace(sums, moment=moment, residual_square=left)


def louder(sums: Sums, factor: float, axis: int | None = None, rise: np.ndarray | None = None) -> Sums:
    """Return sums with all noise `factor` times as large; `rise` (h, 5) is the part of `axis` that is no noise."""
    moment = sums.moment * factor
    if axis is not None and rise is not None:
        moment[:, :, axis] += (1 - factor) * rise
    return replace(sums, moment=moment, residual_square=sums.residual_square * factor**2)


def with_axis(sums: Sums, other: Sums, axis: int) -> Sums:
    """Return sums whose 0-based `axis` is that of `other`: two worn axes in one run."""
    moment, left = sums.moment.copy(), sums.residual_square.copy()
    moment[:, :, axis], left[:, :, axis] = other.moment[:, :, axis], other.residual_square[:, :, axis]
    return replace(sums, moment=moment, residual_square=left)


def joined(parts: Sequence[Sums]) -> Sums:
    """Put the replicates of several nominal models together; each keeps its own Gram matrix."""

    def full(p: Sums) -> np.ndarray:
        r = p.moment.shape[0]
        return np.broadcast_to(p.gram, (r, *p.gram.shape[1:]))

    names = ("moment", "residual_square", "freedom", "usable")
    return Sums(
        np.concatenate([full(p) for p in parts]), *(np.concatenate([getattr(p, n) for p in parts]) for n in names)
    )


def learn(sums: Sums, regression: Regression) -> Normal:
    """Learn the normal period of all replicates."""
    return learn_normal(sums, prior_scale(regression.coulomb, regression.viscous))
