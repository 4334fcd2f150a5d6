"""Published tables as a least-squares problem over trajectories, wear shape and the parameters of a candidate."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np

from jointwear.reproduction.wear import Wear
from jointwear.robots.robot import Robot
from jointwear.studies.recovery.candidates import Explanation
from jointwear.studies.recovery.sample_statistics import coefficient_of_variation, expected_maximum
from jointwear.studies.recovery.sampled_motion import INSTANTS, SEGMENT, progress, states
from jointwear.studies.recovery.sampled_torque import RigidBodyParts
from jointwear.studies.recovery.tables import Tables

_SPAN_WEIGHT = 5.0
_STEP = 1e-6  # of the finite differences, rad, s or a share


@dataclass(frozen=True)
class TableSettings:
    """How tables are compared with a prediction.

    `torque_weight`: a difference of this share of the published maximum counts one; `variation_weight`: a
    difference of this in the coefficient of variation counts one. `disturbance_share` of the mean |torque|,
    `encoder` [rad] and `time_step` [s] size the noise. `repeats`: samples of every instant in an hour. `ddof` of the
    standard deviation. `shape_range` of equation (7). `torque_floor`: a difference of this many N m counts one where
    the published maximum is smaller than it is worth by its share; by default the rounding of Table V. `least_span`
    [deg]: a moving axis that turns by less counts as misfit, since the sign of a motion too small to see would be a
    free choice of the direction of friction.
    """

    torque_weight: float = 0.01
    variation_weight: float = 0.01
    disturbance_share: float = 0.01
    encoder: float = 1e-4
    time_step: float = 0.5
    repeats: int = 10
    ddof: int = 1
    shape_range: tuple[float, float] = (0.1, 5.0)
    torque_floor: float = 5e-4
    least_span: float = 5.0


@dataclass(frozen=True)
class Prediction:
    """Expected maximum [N m] and coefficient of variation, each (S, t, n, c), and commanded torque (S, t, k, n, c)."""

    maximum: np.ndarray
    variation: np.ndarray
    torque: np.ndarray


class TableProblem:
    """Residuals of the tables for S parameter vectors at once.

    Parameters
    ----------
    robot : the arm; its payload is left out.
    tables : what is to be reproduced.
    candidate : what may be missing.
    settings : weights and noise.
    frozen : parameters of the candidate that are held at these values, and with them the wear shape: (p + 1,).
    growth : (t, n, c) share by which friction has grown, in place of the published hours and the shape.
    growth_spread : (t, n, c) standard deviation of that share, which widens the weights.

    outward : (t,) duration of the motion from start to stop [s]; default half a cycle.

    Notes
    -----
    The free vector u is without bounds: every free parameter is middle + half range x sin(u), so positions stay
    within the limits of the joints and parameters within those of the candidate. Its order: start and stop
    positions, phase, task by task; then wear shape; then the candidate's parameters. An axis at rest, printed
    as 0.000, counts with its signed torque at every instant: the largest |torque| has a kink where it is to vanish.
    """

    def __init__(
        self,
        robot: Robot,
        tables: Tables,
        candidate: Explanation,
        settings: TableSettings,
        frozen: np.ndarray | None = None,
        growth: np.ndarray | None = None,
        growth_spread: np.ndarray | None = None,
        outward: np.ndarray | None = None,
    ) -> None:
        self.robot, self.tables, self.candidate, self.settings = robot, tables, candidate, settings
        known = None if frozen is None else candidate.coefficients(np.asarray(frozen, dtype=float)[None, 1:])
        self.parts = RigidBodyParts(robot, candidate, known)
        self.frozen, self.growth, self.growth_spread = frozen, growth, growth_spread
        self.outward = np.full(len(tables.tasks), SEGMENT) if outward is None else np.asarray(outward, dtype=float)
        t, n = len(tables.tasks), robot.joints
        self.pauses = pauses_at_instants(tables)
        self._layout(t, n)
        # Noise of the acceleration moves the torque by the inertia; the share of an axis is its motor inertia.
        self._noise_floor = settings.encoder / settings.time_step**2 * robot.armature + 1e-6
        coulomb = np.maximum(robot.coulomb_positive, -robot.coulomb_negative)[None, :, None]
        # An axis at rest shows no friction, whatever the hour.
        spread = 0.0 if growth_spread is None else growth_spread * coulomb * ~tables.at_rest[..., None]
        scale = np.maximum(settings.torque_weight * tables.maximum, settings.torque_floor)
        self.maximum_scale = np.sqrt(scale**2 + np.square(spread))
        relative = np.divide(spread, tables.maximum, out=np.zeros_like(tables.maximum), where=tables.maximum > 0)
        self.variation_scale = np.sqrt(settings.variation_weight**2 + (relative * tables.variation) ** 2)
        self._used = np.ones(tables.maximum.shape, dtype=bool)
        self._used[tables.at_rest] = False
        task_of = np.nonzero(self._used)[0]
        resting_task = np.repeat(np.nonzero(tables.at_rest)[0], INSTANTS)
        task_of = np.concatenate([task_of, task_of, resting_task])
        self._rows_by_task = [np.flatnonzero(task_of == k) for k in range(t)]
        self._moving = np.argwhere(~tables.at_rest)
        self._rows_by_task = [
            np.concatenate([rows, len(task_of) + np.flatnonzero(self._moving[:, 0] == k)])
            for k, rows in enumerate(self._rows_by_task)
        ]
        self._resting = np.argwhere(tables.at_rest)
        self.data_count = int(2 * self._used.sum() + 2 * len(self._resting))

    def softened(self, torque_floor: float) -> TableProblem:
        """Return the same problem with another floor of the torque's weight."""
        result = copy(self)
        result.maximum_scale = np.maximum(self.maximum_scale, torque_floor)
        return result

    def with_outward(self, outward: np.ndarray) -> TableProblem:
        """Return the same problem with other durations of the way out, (t,) [s]."""
        result = copy(self)
        result.outward = np.asarray(outward, dtype=float)
        return result

    def task_alone(self, task: int, point: np.ndarray) -> TableProblem:
        """Return the problem of one task, wear shape and candidate held at those of the free vector `point` (p,)."""
        shape, effect = self.split(self.physical(point[None]))[3:]
        part = slice(task, task + 1)
        return TableProblem(
            self.robot,
            self.tables.task_subset([task]),
            self.candidate,
            self.settings,
            frozen=np.concatenate([shape, effect[0]]),
            growth=None if self.growth is None else self.growth[part],
            growth_spread=None if self.growth_spread is None else self.growth_spread[part],
            outward=self.outward[part],
        )

    def _layout(self, t: int, n: int) -> None:
        """Decide which parameters are free and between which bounds."""
        fixed_axis = self.tables.at_rest
        lower = np.empty((t, 2 * n + 1))
        upper = np.empty((t, 2 * n + 1))
        lower[:, :n] = lower[:, n : 2 * n] = self.robot.lower
        upper[:, :n] = upper[:, n : 2 * n] = self.robot.upper
        lower[:, -1], upper[:, -1] = 0.3, 9.7
        free = np.ones((t, 2 * n + 1), dtype=bool)
        free[:, n : 2 * n] = ~fixed_axis
        free[:, -1] = ~self.pauses
        self._trajectory_free = free.ravel()
        low, high = self.settings.shape_range
        effect = [] if self.frozen is not None else self.candidate.parameters
        shape = [] if self.frozen is not None or self.growth is not None else [(low, high)]
        self.lower = np.concatenate(
            [lower.ravel()[self._trajectory_free], [s[0] for s in shape], [p.lower for p in effect]]
        )
        self.upper = np.concatenate(
            [upper.ravel()[self._trajectory_free], [s[1] for s in shape], [p.upper for p in effect]]
        )
        self.trajectory_count = int(self._trajectory_free.sum())
        task_of = np.repeat(np.arange(t), 2 * n + 1)[self._trajectory_free]
        place = np.cumsum(self._trajectory_free).reshape(t, -1) - 1
        # Columns of the start and stop of each joint; of an axis at rest the start twice.
        self.pairs_by_task = [
            np.array([(place[k, j], place[k, j if fixed_axis[k, j] else n + j]) for j in range(n)]) for k in range(t)
        ]
        self.columns_by_task = [np.flatnonzero(task_of == k) for k in range(t)]
        self.free_shape = bool(shape)
        self.free_effect = len(effect)

    @property
    def widened(self) -> tuple[np.ndarray, np.ndarray]:
        """Factors (t, n, c) >= 1 by which unknown hours widen the weights of both tables."""
        published = np.maximum(self.settings.torque_weight * self.tables.maximum, self.settings.torque_floor)
        return self.maximum_scale / published, self.variation_scale / self.settings.variation_weight

    @property
    def size(self) -> int:
        """Number of free parameters."""
        return len(self.lower)

    def physical(self, u: np.ndarray) -> np.ndarray:
        """Return the parameters in their own units, (S, p), of free vectors u (S, p)."""
        return (self.upper + self.lower) / 2 + (self.upper - self.lower) / 2 * np.sin(u)

    def free(self, theta: np.ndarray) -> np.ndarray:
        """Return a free vector for parameters in their own units; values at a bound are moved inside."""
        share = (2 * theta - self.upper - self.lower) / (self.upper - self.lower)
        return np.arcsin(np.clip(share, -0.9999, 0.9999))

    def random_start(self, random: np.random.Generator, count: int) -> np.ndarray:
        """Return `count` free vectors: independent poses over the whole range, candidate near its nominal value."""
        theta = random.uniform(self.lower, self.upper, size=(count, self.size))
        if self.free_effect:
            effect = self.candidate.parameters
            nominal = np.array([p.nominal for p in effect])
            reach = np.array([min(p.upper - p.nominal, 1.0) for p in effect])
            drawn = nominal + 0.5 * reach * random.uniform(-1, 1, size=(count, len(effect)))
            low = np.array([p.lower for p in effect])
            high = np.array([p.upper for p in effect])
            theta[:, -len(effect) :] = np.clip(drawn, low + 0.02 * (high - low), high - 0.02 * (high - low))
        return self.free(theta)

    def split(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return start, stop (S, t, n), phase (S, t), wear shape (S,) and candidate parameters (S, p)."""
        count, t, n = len(theta), len(self.tables.tasks), self.robot.joints
        trajectory = np.zeros((count, t * (2 * n + 1)))
        trajectory[:, self._trajectory_free] = theta[:, : self.trajectory_count]
        trajectory = trajectory.reshape(count, t, 2 * n + 1)
        start, stop, phase = trajectory[..., :n], trajectory[..., n : 2 * n].copy(), trajectory[..., -1]
        stop = np.where(self.tables.at_rest, start, stop)
        rest = theta[:, self.trajectory_count :]
        if self.frozen is not None:
            rest = np.broadcast_to(self.frozen, (count, len(self.frozen)))
        elif self.growth is not None:
            rest = np.concatenate([np.zeros((count, 1)), rest], axis=1)
        return start, stop, phase, rest[:, 0], rest[:, 1:]

    def join(self, start, stop, phase, shape: float, effect: np.ndarray) -> np.ndarray:
        """Return the free vector (p,) of one solution: the inverse of `split`; arguments as it returns them."""
        trajectory = np.concatenate([start, stop, phase[:, None]], axis=1).ravel()[self._trajectory_free]
        rest = [shape] if self.free_shape else []
        return self.free(np.concatenate([trajectory, rest, effect[: self.free_effect]]))

    def worn(self, shape: np.ndarray) -> np.ndarray:
        """Return the share by which friction has grown in each cell's run, (S, t, n, c)."""
        if self.growth is not None:
            return np.broadcast_to(self.growth, (len(shape), *self.growth.shape))
        grown = Wear(1.0, shape[:, None, None, None], self.tables.run_hours).growth(self.tables.reading_hours)
        return grown * self.tables.increase_percent

    def predict(self, u: np.ndarray) -> Prediction:
        """Return what the tables would hold for free vectors u (S, p)."""
        start, stop, phase, shape, effect = self.split(self.physical(u))
        coefficients = self.candidate.coefficients(effect)
        moved = states(start, stop, phase, self.outward, coefficients.speed[:, None])
        parts = self.parts.parts(moved)
        rigid = self.parts.combine(parts, moved.acceleration, coefficients)
        torque = self._with_friction(rigid, moved.velocity, coefficients, self.worn(shape))
        maximum, variation, _ = self._statistics(torque, slopes=False)
        return Prediction(maximum.value, variation.value, torque)

    def _with_friction(self, rigid, velocity, c, worn) -> np.ndarray:
        """(S, t, k, n) -> (S, t, k, n, c): friction, wear and gain added."""
        level = self.robot.coulomb(velocity) * c.coulomb[:, None, None, :]
        base = rigid + velocity * self.robot.viscous * c.viscous[:, None, None, :] + level
        torque = base[..., None] + level[..., None] * worn[:, :, None]
        return torque * c.gain[:, None, None, :, None]

    def _statistics(self, torque, slopes: bool = True):
        """Expected maximum and coefficient of variation of (S, t, k, n, c), and the levels' signs (S, t, n, c, k)."""
        torque = np.moveaxis(torque, 2, -1)
        level = np.abs(torque)
        # The mean over the whole cycle: instants at rest stand for no part of it, since rest lasts for an instant only.
        pause = self.pauses[:, None] & (progress(np.zeros(len(self.outward)), self.outward)[1] == 0)
        weight = (~pause / (~pause).sum(axis=1, keepdims=True))[None, :, None, None, :]
        disturbance = self.settings.disturbance_share * (level * weight).sum(axis=-1)
        floor = self._noise_floor[:, None]
        noise = np.sqrt(disturbance**2 + floor**2)
        maximum = expected_maximum(level, noise, self.settings.repeats, slopes)
        variation = coefficient_of_variation(level, noise, self.settings.repeats, self.settings.ddof)
        slope = self.settings.disturbance_share * weight * (disturbance / noise)[..., None]
        sign = np.sign(torque)
        by_torque = [(s.by_level + s.by_noise[..., None] * slope) * sign for s in (maximum, variation)]
        return maximum, variation, by_torque

    def residuals(self, u: np.ndarray) -> np.ndarray:
        """Return the weighted differences (S, m) between prediction and tables."""
        predicted = self.predict(u)
        data = self._weighted(
            predicted.maximum - self.tables.maximum, predicted.variation - self.tables.variation, predicted.torque
        )
        start, stop = self.split(self.physical(u))[:2]
        return np.concatenate([data, self._too_small(start, stop)[0]], axis=1)

    def _too_small(self, start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (S, j) of moving joints that hardly move, and their derivatives by the span."""
        least = np.radians(self.settings.least_span)
        task, axis = self._moving.T
        span = (stop - start)[:, task, axis]
        lack = np.maximum(1 - np.abs(span) / least, 0.0)
        return _SPAN_WEIGHT * lack, np.where(lack > 0, -_SPAN_WEIGHT * np.sign(span) / least, 0.0)

    def cost_by_task(self, u: np.ndarray, batch: int = 500) -> np.ndarray:
        """Return half the sum of squared residuals of each task, (S, t); `batch` bounds the memory."""
        if len(u) > batch:
            return np.concatenate([self.cost_by_task(u[i : i + batch], batch) for i in range(0, len(u), batch)])
        residual = self.residuals(u)
        return np.stack([0.5 * (residual[:, rows] ** 2).sum(axis=1) for rows in self._rows_by_task], axis=1)

    def _weighted(self, maximum, variation, torque) -> np.ndarray:
        """(S, t, n, c) twice and (S, t, k, n, c) -> (S, m); a trailing axis of all three stays."""
        extra = (None,) * (maximum.ndim - 4)
        used = self._used
        parts = [
            (maximum / self.maximum_scale[(..., *extra)])[:, used],
            (variation / self.variation_scale[(..., *extra)])[:, used],
        ]
        for task, axis in self._resting:
            parts.append(torque[:, task, :, axis, 0] / self.maximum_scale[task, axis, 0])
        return np.concatenate(parts, axis=1)

    def residuals_and_jacobian(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return residuals (S, m) and their derivative by u (S, m, p)."""
        theta = self.physical(u)
        start, stop, phase, shape, effect = self.split(theta)
        count, t, n = start.shape
        # Direction 0 is the state itself; then start and stop of each joint, phase, speed.
        directions = 2 * n + 3
        eye = np.zeros((directions, n))
        moved_start = start[:, None] + _STEP * _rows(eye, 1, n)[None, :, None]
        moved_stop = stop[:, None] + _STEP * _rows(eye, 1 + n, n)[None, :, None]
        # An axis at rest moves with its start.
        moved_stop = np.where(self.tables.at_rest, moved_start, moved_stop)
        moved_phase = np.repeat(phase[:, None], directions, axis=1)
        moved_phase[:, 2 * n + 1] += _STEP
        c = self.candidate.coefficients(effect)
        speed = np.repeat(c.speed[:, None, None], directions, axis=1)
        speed[:, -1] += _STEP
        moved = states(moved_start, moved_stop, moved_phase, self.outward, speed)
        parts = self.parts.parts(moved)
        rigid = self.parts.combine(parts, moved.acceleration, c)
        viscous = moved.velocity * self.robot.viscous * c.viscous[:, None, None, None, :]
        smooth = (rigid + viscous) * c.gain[:, None, None, None, :]
        by_state = (smooth[:, 1:] - smooth[:, :1]) / _STEP  # (S, 2n+2, t, k, n)
        velocity, acceleration = moved.velocity[:, 0], moved.acceleration[:, 0]
        base = [part[:, 0] for part in parts]
        worn = self.worn(shape)
        torque = self._with_friction(rigid[:, 0], velocity, c, worn)
        maximum, variation, slopes = self._statistics(torque)
        residual = self._weighted(maximum.value - self.tables.maximum, variation.value - self.tables.variation, torque)
        lack, by_span = self._too_small(start, stop)
        data = residual.shape[1]
        residual = np.concatenate([residual, lack], axis=1)
        jacobian = np.zeros((count, residual.shape[1], self.size))
        rows = data + np.arange(len(self._moving))
        task, axis = self._moving.T
        pairs = np.array(self.pairs_by_task)[task, axis]
        jacobian[:, rows, pairs[:, 0]] = -by_span
        jacobian[:, rows, pairs[:, 1]] = by_span

        by_trajectory = [np.einsum("stnck,sptkn->stncp", s, by_state[:, :-1]) for s in slopes]
        # The torque itself counts for axes at rest alone, whose columns of increase are alike.
        by_trajectory.append(np.moveaxis(by_state[:, :-1], 1, -1)[..., None, :])
        blocks = []
        for value in by_trajectory:
            block = np.zeros((*value.shape[:-1], t, 2 * n + 1))
            for task in range(t):
                block[:, task, ..., task, :] = value[:, task]
            blocks.append(block.reshape(*value.shape[:-1], -1)[..., self._trajectory_free])
        jacobian[:, :data, : self.trajectory_count] = self._weighted(*blocks)

        def column(by_parameter: np.ndarray) -> np.ndarray:
            """(S, t, k, n, c) derivative of the torque -> (S, m)."""
            values = [np.einsum("stnck,stknc->stnc", s, by_parameter) for s in slopes]
            return self._weighted(*values, by_parameter)

        place = self.trajectory_count
        if self.free_shape:
            nearby = self._with_friction(rigid[:, 0], velocity, c, self.worn(shape + _STEP))
            jacobian[:, :data, place] = column((nearby - torque) / _STEP)
            place += 1
        for k in range(self.free_effect):
            changed = effect.copy()
            changed[:, k] += _STEP
            nearby = self.candidate.coefficients(changed)
            value = self._with_friction(self.parts.combine(base, acceleration, nearby), velocity, nearby, worn)
            by_parameter = (value - torque) / _STEP
            faster = (nearby.speed - c.speed) / _STEP
            by_parameter = by_parameter + (faster[:, None, None, None] * by_state[:, -1])[..., None]
            jacobian[:, :data, place + k] = column(by_parameter)
        jacobian *= ((self.upper - self.lower) / 2 * np.cos(u))[:, None, :]
        return residual, jacobian


def _rows(template: np.ndarray, first: int, n: int) -> np.ndarray:
    result = template.copy()
    result[first : first + n] = np.eye(n)
    return result


def pauses_at_instants(tables: Tables) -> np.ndarray:
    """Return (t,) True where the task rests at two of its six instants, told from axis 1.

    Axis 1 bears no gravity, so that its |torque| is nearly one Coulomb level while it moves and nothing at rest: two
    rests among six give a coefficient of variation near sqrt(1/2), none near 0.05. The middle decides.
    """
    return tables.variation[:, 0].mean(axis=1) > np.sqrt(0.5) / 2
