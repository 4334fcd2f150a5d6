"""What an effect may depend on: the motion, the nominal torques, time, temperature and facts about the drives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np

from jointwear.effects.between import Between
from jointwear.effects.rests import Rest, rests
from jointwear.robots.robot import Robot
from jointwear.statistics.runs import runs

#: Axis -> derivatives (..., n) of the torques by the acceleration and by the angle of one link.
WindUp = Callable[[int], tuple[np.ndarray, np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Drive:
    """Facts that an effect may need: shape (n,), joint side; `gravity` (3,) [m/s2] in the base frame."""

    gear_ratio: np.ndarray
    armature: np.ndarray
    viscous: np.ndarray
    coulomb_positive: np.ndarray
    coulomb_negative: np.ndarray
    gravity: np.ndarray

    def coulomb(self, axis: int, velocity: np.ndarray) -> np.ndarray:
        """Return the Coulomb friction [N m] of one axis at velocities (...,), 0 at rest."""
        level = np.where(velocity > 0, self.coulomb_positive[axis], self.coulomb_negative[axis])
        return np.where(velocity == 0, 0.0, level)


@dataclass(frozen=True)
class State:
    """Samples of a robot with n joints; arrays have shape (..., n) unless stated.

    Attributes
    ----------
    position, velocity, acceleration : [rad], [rad/s], [rad/s2].
    load : rigid-body torque without motor inertia and friction [N m], the torque that the gear transmits.
    torque : torque of the nominal model with motor inertia and friction [N m].
    time : (...,) [s].
    temperature : [degC], NaN where unknown.
    record : (...,) integer label of the recording a sample belongs to, or None. Where it is given the samples of
        one record are in order of time along the first and only leading dimension; where it is None the samples
        are unordered and sequential effects act in their settled limit, that is with zero torque.
    tip_regressor : function without arguments that returns the derivative of the torque by the ten inertial
        parameters of a payload in the last link frame, shape (..., n, 10), or None.
    gravity_regressor : function without arguments that returns the derivative of the torque by the vector of gravity
        in the base frame, shape (..., n, 3), or None.
    wind_up_regressor : axis -> derivatives of the torques, each (..., n), by the acceleration of its link without
        motor inertia, by the velocity and by the angle of its link, on its own axis of gravity alone; or None.
    torque_kind : where the torque that is to be explained was taken: "motor", "command" or "link_sensor".
    passes : frequencies [Hz] (...,) -> share that a filter of the torque that is to be explained lets pass, as that of
        a recording at a high rate; None where all does.
    derives : (axis, frequencies [Hz] (...,)) -> share that is left of a shaking of the axis in its derived
        acceleration; None where all is.
    encoder_side : whether positions are those of the "motor" (or unknown), or of the "link".
    above : torque (..., n) [N m] of higher frequencies beside `torque`, of which noise hides the size of a wave: a lag
        turns it, and what it takes off does not count; None where there is none.
    gear_orders : of each axis, waves in one turn of its motor that are tried besides whole numbers.
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    load: np.ndarray
    torque: np.ndarray
    time: np.ndarray
    temperature: np.ndarray
    drive: Drive
    record: np.ndarray | None = None
    tip_regressor: Callable[[], np.ndarray] | None = None
    gravity_regressor: Callable[[], np.ndarray] | None = None
    wind_up_regressor: WindUp | None = None
    torque_kind: str = "motor"
    encoder_side: str = "motor"
    passes: Callable[[np.ndarray], np.ndarray] | None = None
    derives: Callable[[int, np.ndarray], np.ndarray] | None = None
    above: np.ndarray | None = None
    gear_orders: tuple[tuple[float, ...], ...] = ()
    #: Direction of motion, -1, 0 or 1; worked out once because nearly every effect needs it.
    direction: np.ndarray = field(init=False, repr=False)
    _between: dict[int, Between] = field(init=False, repr=False, default_factory=dict)
    #: What :meth:`once` has worked out.
    _known: dict[tuple, Any] = field(init=False, repr=False, default_factory=dict)
    #: Handed on to states of the same motion with other torques, on which what is here does not depend.
    _of_motion: dict[tuple, tuple[tuple[np.ndarray, ...], Any]] = field(repr=False, default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", np.sign(self.velocity))

    @property
    def has_temperature(self) -> bool:
        """Whether any temperature is known."""
        return bool(np.isfinite(self.temperature).any())

    def passed(self, axis: int, waves: float) -> np.ndarray | float:
        """Return the share (...,) that is left of a wave, `waves` in one radian of an axis, in the torque."""
        return 1.0 if self.passes is None else self.passes(self._frequency(axis, waves))

    def shaken(self, axis: int, waves: float) -> np.ndarray | float:
        """Return the share (...,) that is left of a wave of torque that acts on an axis, `waves` in one radian.

        No controller follows a wave above the band of derived accelerations: it shakes the joint, and what the filter
        takes off the acceleration is missing in torque less rigid-body torque.
        """
        share = self.passed(axis, waves)
        if self.derives is None:
            return share
        return share * self.derives(axis, self._frequency(axis, waves))

    def _frequency(self, axis: int, waves: float) -> np.ndarray:
        """Return the frequencies (...,) [Hz] at which a wave over the angle of an axis passes."""
        return waves * np.abs(self.velocity[..., axis]) / (2 * np.pi)

    def rests_of(self, axis: int, source: int | None = None, shares: tuple[float, float] = (1.0, 0.0)) -> list[Rest]:
        """Return the stops of an axis, or of a drive that turns with `shares` of it and of another; unordered: none."""
        if self.record is None:
            return []

        def stops() -> list[Rest]:
            velocity = shares[0] * self.velocity[..., axis]
            if source is not None:
                velocity = velocity + shares[1] * self.velocity[..., source]
            return rests(velocity, self.time, record_slices(self))

        return self.of_motion(("rests", axis, source, *shares), stops, self.velocity, self.time, self.record)

    def between(self, axis: int) -> Between:
        """Return nominal torque without Coulomb friction [N m] and velocity [rad/s] of one axis between the samples.

        Raises
        ------
        InputError : names a sample whose time does not rise in its record, or that is not finite.
        """
        if axis not in self._between:
            velocity = self.velocity[..., axis]
            smooth = self.torque[..., axis] - self.drive.coulomb(axis, velocity)
            values = np.stack([smooth, velocity], axis=-1)
            # Before a log began a torque went on as it was about to; the sense of friction is not guessed.
            self._between[axis] = Between(self.time, values, record_slices(self), turned=[0])
        return self._between[axis]

    def waves_of(self, axis: int, count: float) -> np.ndarray:
        """Return sine and cosine (..., 2) of `count` angles of an axis; worked out once for all states of a motion."""

        def waves() -> np.ndarray:
            turn = count * self.position[..., axis]
            return np.stack([np.sin(turn), np.cos(turn)], axis=-1)

        return self.of_motion(("waves", axis, count), waves, self.position)

    def of_motion(self, key: tuple, make: Callable[[], Any], *arrays: np.ndarray) -> Any:
        """Return what `make` makes of `arrays` of this state, once for all states that hold the same ones.

        Parameters
        ----------
        key : tells what is made from all else that is kept so. Nobody may change what is returned.
        """
        known = self._of_motion.get(key)
        if known is None or any(a is not b for a, b in zip(known[0], arrays, strict=True)):
            known = self._of_motion[key] = arrays, make()
        return known[1]

    def once(self, key: tuple, make: Callable[[], Any], keep: bool = True) -> Any:
        """Return what `make` makes of this state, worked out once: noise and search ask the same.

        Parameters
        ----------
        key : tells what is made, with its parameters. Nobody may change what is returned.
        keep : whether it will be asked again; what a search moves is asked once.
        """
        if key in self._known:
            return self._known[key]
        made = make()
        if keep:
            self._known[key] = made
        return made

    def orders_of_gears(self, axis: int) -> tuple[float, ...]:
        """Return the waves in one turn of the motor of an axis that are tried besides whole numbers."""
        return self.gear_orders[axis] if self.gear_orders else ()

    def part(self, chosen: np.ndarray) -> State:
        """Return the samples `chosen` (a mask or index over the leading dimension), order kept."""
        return replace(
            self,
            position=self.position[chosen],
            velocity=self.velocity[chosen],
            acceleration=self.acceleration[chosen],
            load=self.load[chosen],
            torque=self.torque[chosen],
            time=self.time[chosen],
            temperature=self.temperature[chosen],
            record=None if self.record is None else self.record[chosen],
            above=None if self.above is None else self.above[chosen],
            tip_regressor=_part_of(self.tip_regressor, chosen),
            gravity_regressor=_part_of(self.gravity_regressor, chosen),
            wind_up_regressor=_part_of_wind_up(self.wind_up_regressor, chosen),
            _of_motion={},
        )


def _part_of(regressor: Callable[[], np.ndarray] | None, chosen: np.ndarray) -> Callable[[], np.ndarray] | None:
    return None if regressor is None else lambda: regressor()[chosen]


def _part_of_wind_up(regressor: WindUp | None, chosen: np.ndarray) -> WindUp | None:
    if regressor is None:
        return None

    @cache
    def of_axis(axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        by_acceleration, by_velocity, by_angle = regressor(axis)
        return by_acceleration[chosen], by_velocity[chosen], by_angle[chosen]

    return of_axis


def drive_of(robot: Robot) -> Drive:
    """Return the drive facts of `robot`."""
    return Drive(
        robot.gear_ratio,
        robot.armature,
        robot.viscous,
        robot.coulomb_positive,
        robot.coulomb_negative,
        robot.gravity,
    )


def make_state(
    robot: Robot,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    rigid_torque: np.ndarray,
    time: np.ndarray | None = None,
    temperature: np.ndarray | None = None,
    record: np.ndarray | None = None,
    tip_regressor: Callable[[], np.ndarray] | None = None,
    gravity_regressor: Callable[[], np.ndarray] | None = None,
    wind_up_regressor: WindUp | None = None,
) -> State:
    """Build a :class:`State` for `robot`.

    Parameters
    ----------
    position, velocity, acceleration : (..., n).
    rigid_torque : (..., n) what ``Dynamics.rigid_body_torque`` returns, motor inertia included [N m].
    time : (...,) [s]; default 0.
    temperature : (...,) or (..., n) [degC]; default unknown.
    """
    position, velocity, acceleration, rigid_torque = np.broadcast_arrays(position, velocity, acceleration, rigid_torque)
    shape = position.shape
    if temperature is None:
        temperature = np.full(shape, np.nan)
    elif np.shape(temperature) != shape:
        temperature = np.asarray(temperature, dtype=float)
        temperature = np.broadcast_to(temperature[..., None] if temperature.ndim < len(shape) else temperature, shape)
    return State(
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        load=rigid_torque - robot.armature * acceleration,
        torque=rigid_torque + robot.viscous * velocity + robot.coulomb(velocity),
        time=np.zeros(shape[:-1]) if time is None else np.broadcast_to(np.asarray(time, dtype=float), shape[:-1]),
        temperature=np.asarray(temperature, dtype=float),
        drive=drive_of(robot),
        record=record,
        tip_regressor=tip_regressor,
        gravity_regressor=gravity_regressor,
        wind_up_regressor=wind_up_regressor,
    )


def record_slices(state: State) -> list[slice]:
    """Return the slices of the records of an ordered state; a record is a run of one label."""
    return runs(np.asarray(state.record))
