"""One data set against its nominal model, as a linear problem: discrepancy, base regression and its priors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.linear import least_squares, posterior_mean
from jointwear.discovery.noise.gear_waves import gear_orders
from jointwear.discovery.noise.motion_in_torque import motion_ends, noise_in_torque
from jointwear.discovery.noise.noise import order_in_runs
from jointwear.discovery.noise.noise_spectrum import drives
from jointwear.discovery.noise.ridge_fit import RidgeFit
from jointwear.discovery.noise.shaken import shaken_shares
from jointwear.discovery.noise.spectra import frequencies
from jointwear.discovery.problem.building_up import BuiltUp
from jointwear.discovery.problem.folds import blocks_of, folds_of
from jointwear.discovery.settings import Settings
from jointwear.discovery.structure import axis_bases
from jointwear.effects import State
from jointwear.measurement.derived.encoder_step import encoder_step
from jointwear.measurement.derived.filtering import zero_phase_gain
from jointwear.measurement.derived.motion import Measured
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.inertia import mass_direction
from jointwear.robots.robot import Robot

#: Poses over which the mass matrix is averaged.
POSES = 200
#: Prior of a parameter of the motor that a torque sensor behind the gear cannot feel, over that of others.
ABSENT = 1e-4
#: Shares of the filter's cut-off at which its effect on the torque is offered to the base regression.
SMEAR = (1.0, 0.7, 0.5)
FRICTION = ("coulomb_positive", "coulomb_negative", "viscous", "motor_inertia")
#: Sense in which a torque fitted to each of :data:`FRICTION` adds to it: friction of negative motion pulls back.
SENSE = np.array([1.0, -1.0, 1.0, 1.0])


@dataclass(frozen=True)
class FoundMotors:
    """Motors that data show and the robot file does not know: `inertia` (n,) on the joint side [kg m2], 0 of those that
    it knows, with the standard deviation `std` (n,)."""

    inertia: np.ndarray
    std: np.ndarray


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
    moving : (N, n) samples in motion: those that can be judged, and those beside reversals and in shared stops too.
    judged : 0-based axes with enough usable training samples.
    built_up : how the friction of each axis builds up with its speed, None of one that turns over with the sign of the
        velocity. In `measured` its torque is whole, but for samples that are not usable.
    positions : positions [rad] of the log as they came, one array for each joint.
    encoder_step : resolution of the positions [rad] that the user gave, None where it is told from them.
    body_prior : identifier -> prior standard deviations of an effect on the whole arm, where they are not the usual.
    still : that nothing which shakes the arm is noise.
    motors : what `robot` has of motors that its file does not know; None where it knows all.
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
    moving: np.ndarray
    judged: tuple[int, ...]
    built_up: tuple[BuiltUp | None, ...]
    positions: tuple[np.ndarray, ...] = ()
    encoder_step: float | None = None
    body_prior: Mapping[str, np.ndarray] = field(default_factory=dict)
    still: bool = False
    motors: FoundMotors | None = None
    #: (axis, cut-off [Hz]) -> training samples; see :func:`jointwear.discovery.problem.instruments.limited_state`.
    limited_states: dict[tuple[int, float], State] = field(init=False, repr=False, default_factory=dict)

    @cached_property
    def given_discrepancy(self) -> np.ndarray:
        """(N, n) measured less the torque of the robot as its file has it, without motors that were found [N m]."""
        if self.motors is None:
            return self.discrepancy
        return self.discrepancy + self.motors.inertia * self.state.acceleration

    @cached_property
    def given_torque(self) -> np.ndarray:
        """(N, n) torque of the robot as its file has it, without motors that were found [N m]."""
        return self.measured.torque - self.given_discrepancy

    @cached_property
    def drive_parameters(self) -> np.ndarray:
        """(n, 4) :data:`FRICTION` of the drives of `robot`, each as a size, joint side."""
        robot = self.robot
        given = (robot.coulomb_positive, robot.coulomb_negative, robot.viscous, robot.armature)
        return np.stack(given, axis=1) * SENSE

    @cached_property
    def as_given(self) -> np.ndarray:
        """(n, 4) what makes of the drives of `robot` those of its file: corrections to :data:`FRICTION`."""
        corrections = np.zeros((self.robot.joints, len(FRICTION)))
        if self.motors is not None:
            corrections[:, FRICTION.index("motor_inertia")] = -self.motors.inertia
        return corrections

    @cached_property
    def train_state(self) -> State:
        """The training samples, ordered within their records."""
        state = replace(self.state.part(self.train), gear_orders=self._gear_orders)
        if state.derives is None or not self.smear.any():
            return state
        # What the base regression takes off accelerations it takes off a shaking of the joint too.
        return replace(state, derives=lambda axis, f: state.derives(axis, f) * self._left_of_shaking(axis, f))

    @cached_property
    def _gear_orders(self) -> tuple[tuple[float, ...], ...]:
        """Waves in one turn of each motor that the discrepancy shows and that are no whole numbers."""
        state, label = self.state.part(self.train), self.measured.trajectory[self.train]
        result: list[tuple[float, ...]] = [()] * self.robot.joints
        for axis in self.judged:
            used, torque = self.usable[:, axis], state.torque[:, axis]
            columns = [
                self.friction_columns(state, axis),
                self.inertial[self.train, axis],
                self.smear[self.train, axis],
            ]
            columns += [basis.columns for basis in axis_bases(state, axis, used, coarse=True)]
            series = np.concatenate([x.T for x in columns])
            held = np.sqrt(np.square(series) @ used)
            # Each column in one piece.
            columns = (series[held > 1e-9] / held[held > 1e-9, None]).T
            speed = float(np.median(np.abs(state.velocity[used, axis])))
            fastest = 2 * np.pi * self.measured.band / max(speed, 1e-9)
            result[axis] = gear_orders(
                residual=self.discrepancy[self.train, axis],
                take_off=RidgeFit(columns, used, None),
                position=state.position[:, axis],
                torque=torque,
                used=used,
                label=label,
                gear_ratio=self.robot.gear_ratio[axis],
                fastest=fastest,
                accept=self.settings.accept,
                encoder_step=float(self.encoder_steps[axis]),
            )
        return tuple(result)

    def _left_of_shaking(self, axis: int, frequency: np.ndarray) -> np.ndarray:
        """Return the share (...,) of a wave in the acceleration of an axis that the base regression leaves there."""
        cutoff, rate = self.measured.cutoff[axis], self.measured.rate
        if not np.isfinite(cutoff):
            return np.ones(np.shape(frequency))
        taken = 1.0 - zero_phase_gain(frequency, cutoff * np.array(SMEAR)[:, None], rate)
        return np.clip(1.0 - self._rounded[axis] @ taken, 0.0, 1.0)

    @cached_property
    def _rounded(self) -> np.ndarray:
        """(n, 3) coefficients of what the filter behind the derivatives does, as the base regression has them.

        Where it takes noise of derived accelerations off the residual it takes off what shakes the joint as well: in
        that band the discrepancy says nothing of either.
        """
        found = np.zeros((self.robot.joints, len(SMEAR)))
        for axis in self.judged:
            used = self.usable[:, axis]
            friction = self.friction_columns(self.train_state, axis)[used]
            series = np.column_stack([self.rounding(axis), self.discrepancy[self.train, axis]])[used]
            series = series - friction @ np.linalg.lstsq(friction, series, rcond=None)[0]
            rounding, lacking = series[:, :-1], series[:, -1]
            gram, b = rounding.T @ rounding, rounding.T @ lacking
            noise = max(float(np.mean((lacking - rounding @ least_squares(b, gram, gram)) ** 2)), 1e-300)
            found[axis] = posterior_mean(b / noise, gram / noise, np.ones(len(SMEAR)))
        return found

    @property
    def building_up(self) -> dict[int, BuiltUp]:
        """The judged axes, 0-based, whose friction builds up with their speed, and how."""
        return {axis: way for axis in self.judged if (way := self.built_up[axis]) is not None}

    @cached_property
    def noise_drives(self) -> Callable[[int], list[np.ndarray]]:
        """Order of a noise model -> what its drawn noise is made of, (N_train,) each, the same for all axes."""
        return drives(self.measured.trajectory[self.train])

    @cached_property
    def felt(self) -> list[np.ndarray]:
        """Indices (k,), for each axis, of the directions of the inertial prior that change its torque: of links behind
        it."""
        return [np.flatnonzero(np.any(columns, axis=0)) for columns in self.inertial.transpose(1, 0, 2)]

    def link_mass_torque(self, link: int) -> np.ndarray:
        """Return the torque (N_train, n) [N m] by which mass and inertia of `link` act: growing, they add 100 %."""
        own = slice(10 * link, 10 * link + 10)
        return (self.regressor[:, :, own] @ mass_direction(self.robot, link)[own])[self.train]

    @cached_property
    def flange_pull(self) -> np.ndarray:
        """(N_train, n, 3) derivative of the torques by a force at the flange, in the base frame."""
        return FlangeLoad(self.robot).pull(self.train_state.position)

    @cached_property
    def flange_path(self) -> np.ndarray:
        """(N_train, 3) place of the flange in the base frame [m], less its mean."""
        place, _ = self.dynamics.forward_kinematics(self.train_state.position)
        return place - place.mean(axis=0)

    @cached_property
    def encoder_steps(self) -> np.ndarray:
        """(n,) step of the encoder of every joint [rad], nan where there is none that can be told."""
        if self.encoder_step is not None:
            return np.full(self.robot.joints, self.encoder_step)
        found = [encoder_step(values) for values in self.positions]
        return np.array([np.nan if step is None else step for step in found] or [np.nan] * self.robot.joints)

    @cached_property
    def middle_speed(self) -> dict[int, float]:
        """Median speed [rad/s] of the usable training samples of every judged axis."""
        speed = np.abs(self.train_state.velocity)
        return {axis: float(np.median(speed[self.usable[:, axis], axis])) for axis in self.judged}

    @cached_property
    def fold_of_sample(self) -> np.ndarray:
        """(N_train,) fold of each training sample: its record, or one of four blocks of time if records are few."""
        return folds_of(np.asarray(self.train_state.record), fewest=3)

    @cached_property
    def part_of_sample(self) -> np.ndarray:
        """(N_train,) part of each training sample that a name has to predict: there are at least four.

        Out of three records the other two have to extrapolate: what changes with time, or over a position that only one
        of them visits, would fail for that alone. A written model is asked to extrapolate: its folds are the records.
        """
        return folds_of(np.asarray(self.train_state.record), fewest=4)

    @cached_property
    def half_of_sample(self) -> np.ndarray:
        """(N_train,) half of its record that each training sample is in; a quarter or less where records are few."""
        return folds_of(np.asarray(self.train_state.record), fewest=4, pieces=2)

    @cached_property
    def block_of_sample(self) -> np.ndarray:
        """(N_train,) block of time of each training sample, `assumed.BLOCK` long within its record, in order."""
        return blocks_of(self.train_state.time, np.asarray(self.train_state.record))

    @cached_property
    def mass_squares(self) -> np.ndarray:
        """(n, n) mean square over the training poses of the derivative of torque j by acceleration k [kg2 m4]."""
        return np.mean(self._mass_matrices**2, axis=0)

    @cached_property
    def load_squares(self) -> np.ndarray:
        """(n, n) mean square over the training poses of the derivative of load j by acceleration k [kg2 m4]."""
        return np.mean((self._mass_matrices - np.diag(self.robot.armature)) ** 2, axis=0)

    @cached_property
    def _mass_matrices(self) -> np.ndarray:
        """(k, n, n) mass matrices, motor inertia included, over the training poses [kg m2]."""
        poses = self.state.position[self.train]
        return self.dynamics.mass_matrix(poses[:: max(1, len(poses) // POSES)])

    @cached_property
    def shaken(self) -> np.ndarray:
        """(n,) share of the noise of the torque of each axis that moves the arm, 0 where the problem is `still`."""
        if self.still:
            return np.zeros(self.robot.joints)
        return shaken_shares(
            self.discrepancy[self.train], self._without_steps, *self._in_frequency, self.settings.noise_sigmas
        )

    @cached_property
    def motion_ends(self) -> np.ndarray:
        """(n,) frequency [Hz] from which most of the nominal torque of each axis is noise of derived accelerations."""
        *samples, _ = self._in_frequency
        return motion_ends(self._without_steps, *samples, self.noise_in_torque)

    @cached_property
    def noise_in_torque(self) -> np.ndarray:
        """(n, k) density [(N m)^2/Hz] of noise in the nominal torque, at :func:`.spectra.frequencies`."""
        return noise_in_torque(self.discrepancy[self.train], *self._in_frequency)

    @cached_property
    def _without_steps(self) -> np.ndarray:
        """(N_train, n) nominal torque without Coulomb friction [N m]."""
        return self.train_state.torque - self.robot.coulomb(self.train_state.velocity)

    @cached_property
    def _in_frequency(self) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """Usable samples, records, rate [Hz], and the density of the noise of derived accelerations in the torques."""
        rate = self.measured.rate
        frequency = frequencies(rate)
        derived = np.zeros((self.robot.joints, len(frequency)))
        if self.measured.noise is not None:
            derived[:, 1:] = self.mass_squares @ self.measured.noise.acceleration(frequency[1:])
        return self.usable, np.asarray(self.train_state.record), rate, derived

    def rounding(self, axis: int) -> np.ndarray:
        """Return what the filter behind the derivatives may do to the torque of one axis, (N_train, 3) [N m].

        Nothing where noise moves the arm: all of it is in these columns, and a fit would take it off the residual.
        """
        columns = self.smear[self.train, axis]
        return np.zeros_like(columns) if self.shaken[axis] else columns

    @cached_property
    def usable(self) -> np.ndarray:
        """(N_train, n) training samples that can be judged."""
        return self.measured.usable[self.train]

    @cached_property
    def rows_used(self) -> list[np.ndarray]:
        """Indices (k,), for each axis, of the training samples that can be judged: rows are taken several times as fast
        by them as by a mask."""
        return [np.flatnonzero(used) for used in self.usable.T]

    @cached_property
    def too_coarse(self) -> tuple[int, ...]:
        """The judged axes, 0-based, of which few samples lie in runs so short that noise is not told from motion.

        The fit behind the noise holds next to nothing there: all that the model lacks counts as noise.
        """
        label = self.measured.trajectory[self.train]
        return tuple(axis for axis in self.judged if order_in_runs(self.usable[:, axis], label) is None)

    @cached_property
    def lacking(self) -> np.ndarray:
        """(n,) RMS of the discrepancy [N m] of the training samples that can be judged."""
        square = np.where(self.usable, self.discrepancy[self.train] ** 2, 0.0).sum(axis=0)
        return np.sqrt(square / np.maximum(self.usable.sum(axis=0), 1))

    @cached_property
    def widest(self) -> np.ndarray:
        """(n,) torque [N m] that a correction of friction, or a basis of structure in the model, may be worth.

        It is the friction of its axis, or all that the model lacks if that is more.
        """
        return np.maximum(self.scale, self.lacking)

    @cached_property
    def scale(self) -> np.ndarray:
        """(n,) torque [N m] that stands for the friction of an axis when priors are set.

        Where the robot file knows no friction, it is a share of what the model lacks.
        """
        level = 0.5 * (self.robot.coulomb_positive - self.robot.coulomb_negative)
        level = np.where(level > 0, level, self.settings.usual * self.lacking)
        torque = np.sqrt(np.mean(self.state.torque**2, axis=0))
        return np.maximum(np.maximum(level, assumed.LEAST_FRICTION * torque), 1e-6)

    def friction_columns(self, state: State, axis: int, velocity: np.ndarray | None = None) -> np.ndarray:
        """Return the columns of :data:`FRICTION`, (N, 4); viscous friction of `velocity` (N, n) if it is given."""
        v = state.velocity[:, axis]
        viscous = v if velocity is None else velocity[:, axis]
        return np.stack([v > 0, v < 0, viscous, state.acceleration[:, axis]], axis=1).astype(float)

    def friction_prior(self, axis: int) -> np.ndarray:
        """Return the standard deviations (4,) of the corrections to :data:`FRICTION`: they are wide."""
        used = self.usable[:, axis]
        speed = np.sqrt(np.mean(self.train_state.velocity[used, axis] ** 2))
        acceleration = np.sqrt(np.mean(self.train_state.acceleration[used, axis] ** 2))
        level = self.widest[axis]
        inertia = self.settings.usual * self.scale[axis] / acceleration
        inertia += self.settings.usual * self.robot.armature[axis]
        wide = np.array([level, level, level / speed, inertia])
        if self.state.torque_kind != "link_sensor":
            return wide
        # Behind the gear neither friction nor inertia of the motor are felt: what the file does not have is not there.
        return np.where(self.drive_parameters[axis] != 0, wide, ABSENT * wide)
