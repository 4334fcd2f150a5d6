"""One data set against its nominal model, as a linear problem: targets, base regression, priors, whitening."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property

import os
import numpy as np
from scipy.linalg import cho_factor, cho_solve

from jointwear.discovery.instruments import FREQUENCIES, band_limited, cutoff_of, torque_noise
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.noise import HIGHEST_ORDER, Whitener, corrected, estimate, whitenable
from jointwear.discovery.reversals import leave_out_reversals, resolved_motion
from jointwear.discovery.settings import Settings
from jointwear.discovery.structure import axis_bases
from jointwear.effects import Effect, State, effect_torque, library, make_state
from jointwear.measurement.motion import Measured, low_pass, measure, runs
from jointwear.measurement.recording import Recording
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import (
    gravity_regressor,
    inertial_regressor,
    mass_direction,
    prior_factor,
    to_joint_frame,
)
from jointwear.robots.robot import Robot

#: Fewest usable samples of an axis that a verdict is based on.
FEWEST_SAMPLES = 60
#: Poses over which the mass matrix is averaged.
POSES = 200
FRICTION = ("coulomb_positive", "coulomb_negative", "viscous", "motor_inertia")


@dataclass(frozen=True)
class Problem:
    """Training and test samples of one data set with everything that the search needs.

    Attributes
    ----------
    state : all samples, ordered. train, test : (N,) masks over them.
    discrepancy : (N, n) measured less nominal torque, effects of the robot file included [N m].
    inertial : (N, n, r) torque of each direction of the inertial prior at one standard deviation [N m].
    factor : (10 n, r) those directions.
    smear : (N, n, 3) what the filter behind the derivatives does to the rigid-body torque [N m], 0 if given.
    judged : 0-based axes with enough usable training samples.
    """

    robot: Robot
    dynamics: Dynamics
    settings: Settings
    measured: Measured
    state: State
    train: np.ndarray
    test: np.ndarray
    discrepancy: np.ndarray
    regressor: np.ndarray
    factor: np.ndarray
    inertial: np.ndarray
    smear: np.ndarray
    judged: tuple[int, ...]

    @cached_property
    def train_state(self) -> State:
        """The training samples, ordered within their records."""
        return self.state.part(self.train)

    @cached_property
    def fold_of_sample(self) -> np.ndarray:
        """(N_train,) fold of each training sample: its record, or one of four blocks of time if records are few."""
        record = np.asarray(self.train_state.record)
        labels, first = np.unique(record, return_index=True)
        labels = labels[np.argsort(first)]
        blocks = 1 if len(labels) >= 3 else int(np.ceil(4 / max(len(labels), 1)))
        fold = np.zeros(len(record), dtype=int)
        for i, label in enumerate(labels):
            index = np.flatnonzero(record == label)
            fold[index] = i * blocks + np.arange(len(index)) * blocks // len(index)
        return fold

    @cached_property
    def mass_squares(self) -> np.ndarray:
        """(n, n) mean square over the training poses of the derivative of torque j by acceleration k [kg2 m4]."""
        poses = self.state.position[self.train]
        return np.mean(self.dynamics.mass_matrix(poses[:: max(1, len(poses) // POSES)]) ** 2, axis=0)

    @cached_property
    def usable(self) -> np.ndarray:
        """(N_train, n) training samples that can be judged."""
        return self.measured.usable[self.train]

    @cached_property
    def scale(self) -> np.ndarray:
        """(n,) torque [N m] that stands for the friction of an axis when priors are set."""
        level = 0.5 * (self.robot.coulomb_positive - self.robot.coulomb_negative)
        torque = np.sqrt(np.mean(self.state.torque**2, axis=0))
        return np.maximum(np.maximum(level, 0.03 * torque), 1e-6)

    def friction_columns(self, state: State, axis: int) -> np.ndarray:
        """Return the columns of :data:`FRICTION`, (N, 4)."""
        v = state.velocity[:, axis]
        return np.stack([v > 0, v < 0, v, state.acceleration[:, axis]], axis=1).astype(float)

    def friction_prior(self, axis: int) -> np.ndarray:
        """Return the standard deviations (4,) of the corrections to :data:`FRICTION`: they are wide."""
        used = self.usable[:, axis]
        speed = np.sqrt(np.mean(self.train_state.velocity[used, axis] ** 2))
        acceleration = np.sqrt(np.mean(self.train_state.acceleration[used, axis] ** 2))
        level = 2.0 * self.scale[axis]
        return np.array(
            [level, level, level / speed, 0.5 * self.robot.armature[axis] + 0.3 * self.scale[axis] / acceleration]
        )


def build_problem(recording: Recording, robot: Robot, settings: Settings, measured: Measured | None = None) -> Problem:
    """Set up the comparison of a split recording with `robot`; `measured` are its samples if already at hand."""
    measured = leave_out_reversals(measured or measure(recording))
    dynamics = Dynamics(robot)
    q, v, a = measured.position, measured.velocity, measured.acceleration
    regressor = inertial_regressor(dynamics, q, v, a)
    # The tip is the frame in which a robot file gives the payload.
    tip = to_joint_frame(robot, robot.joints - 1)
    last = regressor[:, :, -10:] @ tip
    state = make_state(
        robot,
        q,
        v,
        a,
        np.array(dynamics.rigid_body_torque(q, v, a)) if len(q) else q,
        time=measured.time,
        temperature=measured.temperature,
        record=measured.trajectory,
        tip_regressor=lambda: last,
        gravity_regressor=cache(lambda: gravity_regressor(robot, q)),
    )
    nominal = state.torque + effect_torque(robot, state)
    train = np.isin(measured.trajectory, recording.train)
    factor = prior_factor(robot, settings.inertial_prior)
    inertial = regressor @ factor
    counts = np.sum(measured.usable[train], axis=0)
    return Problem(
        robot=robot,
        dynamics=dynamics,
        settings=settings,
        measured=measured,
        state=state,
        train=train,
        test=np.isin(measured.trajectory, recording.test),
        discrepancy=measured.torque - nominal,
        regressor=regressor,
        factor=factor,
        inertial=inertial,
        smear=_smear(measured, state),
        judged=tuple(int(j) for j in np.flatnonzero(counts >= FEWEST_SAMPLES)),
    )


#: Shares of the filter's cut-off at which its effect on the torque is offered to the base regression.
SMEAR = (1.0, 0.7, 0.5)


def _smear(measured: Measured, state: State) -> np.ndarray:
    """Return what low-pass filters near the one behind the derivatives do to the rigid-body torque, (N, n, 3).

    A zero-phase filter rounds the corners of the acceleration. To first order the rounding looks like that of a
    slightly lower cut-off, so the base regression can take it off before it is mistaken for a delay.
    """
    rigid = state.load + state.drive.armature * state.acceleration
    result = np.zeros((*rigid.shape, len(SMEAR)))
    if measured.fitted:
        # Knots were added to splines until they left no more than noise.
        return result
    for axis, cutoff in enumerate(measured.cutoff):
        if np.isfinite(cutoff):
            for piece in runs(measured.trajectory):
                for k, share in enumerate(SMEAR):
                    rounded = low_pass(rigid[piece, axis], share * cutoff, measured.rate)
                    result[piece, axis, k] = rounded - rigid[piece, axis]
    return result


def estimate_noise(problem: Problem, extra: dict[int, np.ndarray] | None = None) -> list[Whitener | None]:
    """Estimate the colour of the noise of every judged axis from a saturated fit.

    The fit holds the base regression, the coarse structure bases and `extra` columns (N_train, k) an axis, so that
    what is left is noise whether or not an effect is hidden. It is done twice, the second time whitened.
    """
    state, label = problem.train_state, problem.measured.trajectory[problem.train]
    result: list[Whitener | None] = []
    for axis in range(problem.robot.joints):
        if axis not in problem.judged:
            result.append(None)
            continue
        used = problem.usable[:, axis]
        y = problem.discrepancy[problem.train, axis]
        groups = [
            problem.friction_columns(state, axis),
            problem.inertial[problem.train, axis],
            problem.smear[problem.train, axis],
        ]
        if extra is not None and axis in extra:
            groups.append(extra[axis])
        groups += [b.columns for b in axis_bases(state, axis, used, coarse=True)]
        if used.sum() >= ROOM * sum(g.shape[1] for g in groups):
            groups += _sequential_columns(state, axis)
            groups.append(_beside_reversals(state, axis, label, problem.measured.rate))
        columns = np.concatenate(groups, axis=1)
        scale = np.sqrt(np.mean(columns[used] ** 2, axis=0))
        # A column that lives beside reversals, on samples without predecessors, is hardly seen by the whitened fit.
        seen = np.sum(columns[whitenable(used, label, HIGHEST_ORDER)] ** 2, axis=0)
        keep = (scale > 1e-9) & (seen > SEEN * scale**2 * used.sum())
        columns = columns[:, keep] / scale[keep]
        plain = _remover(columns, used, None)
        white = estimate(plain(y), used, label)
        take_off = _remover(columns, used, white)
        white = corrected(estimate(take_off(y), used, label), take_off, label, problem.measured.rate)
        result.append(white)
    return result


#: Samples for each column of the saturated fit from which it may hold still more columns.
ROOM = 15
#: Share of a column, by its square, that has to lie on samples whose predecessors are usable too.
SEEN = 0.5
#: Frequencies [Hz] above which a step at a reversal is kept.
SHARP = (4.0, 6.0, 9.0)


def _beside_reversals(state: State, axis: int, label: np.ndarray, rate: float) -> np.ndarray:
    """Return what is sharp in the sign of the velocity, (N, 3): misfits beside reversals are not noise."""
    sense = state.direction[:, axis]
    result = np.zeros((len(sense), len(SHARP)))
    for piece in runs(label):
        for k, frequency in enumerate(SHARP):
            result[piece, k] = sense[piece] - low_pass(sense[piece], frequency, rate)
    return result


def _sequential_columns(state: State, axis: int) -> list[np.ndarray]:
    """Return the columns of effects that depend on the order of samples: no basis over an argument follows them."""
    return [
        effect.columns(state, axis, None, nonlinear)
        for effect in library().values()
        if effect.identifiable and effect.sequential
        for nonlinear in effect.grid(state, axis)
    ]


def _remover(columns: np.ndarray, used: np.ndarray, white: Whitener | None) -> Callable[[np.ndarray], np.ndarray]:
    """Return the function that takes a ridge fit of `columns` off series (N,) or (N, k)."""
    x = columns[used] if white is None else white(columns)
    gram = x.T @ x
    ridge = 1e-4 * np.trace(gram) / len(gram)
    factor = cho_factor(gram + ridge * np.eye(len(gram)))

    def take_off(series: np.ndarray) -> np.ndarray:
        target = series[used] if white is None else white(series)
        return series - columns @ cho_solve(factor, x.T @ target)

    return take_off


@dataclass(frozen=True)
class White:
    """The problem after whitening: targets and base terms, for the training samples.

    `cutoffs` (n,) [Hz] of the instruments of each axis, infinite for none.
    """

    problem: Problem
    whiteners: list[Whitener | None]
    targets: list[np.ndarray]
    base: list[Term]
    directions: np.ndarray
    cutoffs: np.ndarray
    _limited: dict[int, State] = field(default_factory=dict, repr=False)

    def state_of(self, effect: Effect, axis: int | None) -> State:
        """Return the training samples that the columns of an effect are made from: instruments for one of timing."""
        if not effect.timing or axis is None:
            return self.problem.train_state
        if axis not in self._limited:
            problem = self.problem
            self._limited[axis] = band_limited(problem.train_state, axis, self.cutoffs[axis], problem.measured.rate)
        return self._limited[axis]

    def no_timing(self, axis: int) -> str:
        """Return in words why effects of timing cannot be tried on an axis; empty where they can."""
        if os.environ.get("ALLT") or resolved_motion(self.problem.measured):
            return ""
        return "the sampling does not resolve the accelerations at reversals"

    def fit(self, extra: list[Term] = ()) -> Fit:
        """Return the posterior of the base regression with `extra` terms."""
        return Fit(self.targets, [*self.base, *extra])

    def columns(self, axis: int, columns: np.ndarray) -> np.ndarray:
        """Whiten columns (N_train, k) of one axis."""
        return self.whiteners[axis](columns)

    def raw(self, axis: int, columns: np.ndarray) -> np.ndarray:
        """Return the rows of columns (N_train, k) that the whitened ones have."""
        return columns[self.whiteners[axis].rows]

    def raw_targets(self) -> list[np.ndarray]:
        """Return the discrepancy [N m] on the rows of the whitened targets."""
        train = self.problem.discrepancy[self.problem.train]
        return [np.zeros(0) if w is None else train[w.rows, axis] for axis, w in enumerate(self.whiteners)]

    def folds(self, axis: int) -> np.ndarray:
        """Return the fold of cross-validation of each whitened row of `axis`, in order of time.

        A fold is a record; fewer than three records are cut into contiguous blocks.
        """
        return self.problem.fold_of_sample[self.whiteners[axis].rows]


def whiten(problem: Problem, whiteners: list[Whitener | None]) -> White:
    """Whiten targets and base regression; inertial directions that the data cannot see are dropped."""
    state = problem.train_state
    targets, base, inertial, raw_inertial = [], [], {}, {}
    for axis in range(problem.robot.joints):
        white = whiteners[axis]
        if white is None:
            targets.append(np.zeros(0))
            continue
        targets.append(white(problem.discrepancy[problem.train, axis]))
        friction = problem.friction_columns(state, axis)
        base.append(
            Term(
                f"friction {axis}", {axis: white(friction)}, problem.friction_prior(axis), {axis: friction[white.rows]}
            )
        )
        smear = problem.smear[problem.train, axis]
        if np.any(smear):
            # What the filter does is no part of the robot: a prediction in N m has to do without it.
            nothing = np.zeros((len(white.rows), smear.shape[1]))
            base.append(Term(f"filter {axis}", {axis: white(smear)}, np.full(smear.shape[1], 3.0), {axis: nothing}))
        raw_inertial[axis] = problem.inertial[problem.train, axis][white.rows]
        inertial[axis] = white(problem.inertial[problem.train, axis])
    rank = problem.factor.shape[1]
    gram = sum((x.T @ x for x in inertial.values()), np.zeros((rank, rank)))
    values, vectors = np.linalg.eigh(gram)
    directions = vectors[:, values > 1e-2]
    if directions.shape[1]:
        blocks = {axis: x @ directions for axis, x in inertial.items()}
        raw = {axis: x @ directions for axis, x in raw_inertial.items()}
        base.append(Term("inertial", blocks, np.ones(directions.shape[1]), raw))
    return White(problem, whiteners, targets, base, directions, instrument_cutoffs(problem, whiteners))


def instrument_cutoffs(problem: Problem, whiteners: list[Whitener | None]) -> np.ndarray:
    """Return the cut-offs (n,) [Hz] of the instruments of all axes, infinite where none is needed."""
    result = np.full(problem.robot.joints, np.inf)
    measured = problem.measured
    if measured.noise is None:
        return result
    frequency = np.linspace(0.0, 0.5 * measured.rate, FREQUENCIES + 1)[1:]
    density = torque_noise(measured.noise, problem.mass_squares, frequency)
    for axis, white in enumerate(whiteners):
        if white is not None:
            result[axis] = cutoff_of(white, density[axis], frequency, measured.rate)
    return result


def link_mass_blocks(white: White, link: int) -> dict[int, np.ndarray]:
    """Return whitened columns for the mass and inertia of `link` growing by 100 %."""
    problem = white.problem
    direction = mass_direction(problem.robot, link)
    torque = problem.regressor[problem.train] @ direction
    return {axis: white.columns(axis, torque[:, [axis]]) for axis in problem.judged if np.any(torque[:, axis])}
