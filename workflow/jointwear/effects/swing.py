"""The link behind an elastic gear: how far the gear is wound up while the motor moves as recorded."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dtbtrs

from jointwear.effects.state import State, record_slices

#: Least inertia [kg m2] of a link; a robot file may be wrong.
LEAST = 1e-9
#: Samples at the start of a record whose load is taken from the next one: derivatives are not known there, and a link
#: that is struck rings for long.
STRUCK = 8
#: Least part of its stiffness that gravity leaves a gear: with less the link would topple.
SOFTEST = 0.1
#: Times of its damping after which a free swing, then a thousandth, says nothing more of the start of its record.
FADED = 7.0


class Twist(NamedTuple):
    """How far a gear is wound up: angle w [rad], speed w' [rad/s] and (J w')' / J [rad/s2], each (m,)."""

    angle: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray


def drag_of(stiffness: float, inertia: float, damping: float) -> float:
    """Return D [N m s/rad] of a `damping` over that at which a swing ends, of K [N m/rad] and an inertia [kg m2]."""
    return 2.0 * damping * np.sqrt(stiffness * inertia)


def wind_up(
    state: State,
    load: np.ndarray,
    inertia: np.ndarray,
    stiffness: float,
    drag: float,
    by_angle: np.ndarray | float = 0.0,
) -> Twist:
    """Return the wind-up of a gear, 0 without an order.

    (J w')' + D w' + (K + g') w = load, the equation of motion of the link made linear about a rigid gear: the inertia
    J changes with the pose of what is behind, and gravity pulls a link back or on that is wound up. Load is straight
    and inertia constant between samples, between which that is solved exactly. Of the place and speed with which a
    record starts nothing is known: what two free swings from there can explain is taken off, record by record.

    Parameters
    ----------
    load : (m,) torque that the gear would transmit if it were rigid [N m]. inertia : (m,) J of the link [kg m2].
    stiffness, drag : K [N m/rad] and D [N m s/rad]. by_angle : (m,) g', derivative of gravity by the angle of the link
    [N m/rad].
    """
    none = Twist(*np.zeros((3, len(load))))
    if state.record is None or stiffness <= 0:
        return none
    parts = record_slices(state)
    if all(part.stop - part.start < 2 for part in parts):
        return none
    mass, pull = np.maximum(inertia, LEAST), np.array(load, dtype=float)
    for part in parts:
        pull[part][:STRUCK] = pull[min(part.start + STRUCK, part.stop - 1)]
    back = np.maximum(stiffness + np.broadcast_to(by_angle, mass.shape), SOFTEST * stiffness)
    link = _Link(state.time, mass, back, drag, np.array([part.start for part in parts], dtype=int))
    place, speed = link.driven(pull)
    acceleration = (pull - back * place - drag * speed) / mass
    early = (link.since * drag < FADED * 2.0 * mass) | (link.place < STRUCK)
    first = link.part(early)
    swings = first.free()
    accelerations = [-(first.stiffness * p + drag * v) / first.mass for p, v in swings]

    def felt(place: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """What a gear carries less what it would carry if it were rigid."""
        return first.mass * acceleration + (first.stiffness - stiffness) * place

    free = [felt(p, a) for (p, _), a in zip(swings, accelerations, strict=True)]
    shares = _shares(felt(place[early], acceleration[early]), *free, first.starts)
    for share, (swing, pace), turn in zip(shares, swings, accelerations, strict=True):
        place[early] -= share * swing
        speed[early] -= share * pace
        acceleration[early] -= share * turn
    for part in parts:
        if part.stop - part.start < 2:
            place[part] = speed[part] = acceleration[part] = 0.0
    return Twist(place, speed, acceleration)


def torque_of(twist: Twist, slopes: tuple[np.ndarray, np.ndarray, np.ndarray], axis: int) -> np.ndarray:
    """Return the torques (m, n) [N m] of the joints by a twist behind one of them, that of its own drag left out.

    M w'' + (dtau/dv) w' + (dtau/dq) w, all of it of the link that turns. On its own axis the first two are (J w')'.

    Parameters
    ----------
    slopes : derivatives of the torques, each (m, n), by acceleration, velocity and angle of the link behind the axis.
    """
    by_acceleration, by_velocity, by_angle = slopes
    turning = twist.acceleration - by_velocity[:, axis] / np.maximum(by_acceleration[:, axis], LEAST) * twist.speed
    torque = by_acceleration * turning[:, None] + by_velocity * twist.speed[:, None] + by_angle * twist.angle[:, None]
    torque[:, axis] = torque_on_own(twist, slopes, axis)
    return torque


def torque_on_own(twist: Twist, slopes: tuple[np.ndarray, np.ndarray, np.ndarray], axis: int) -> np.ndarray:
    """Return the torque (m,) of the joint itself by a twist behind it, as of :func:`torque_of`."""
    by_acceleration, _, by_angle = slopes
    return by_acceleration[:, axis] * twist.acceleration + by_angle[:, axis] * twist.angle


def _shares(driven: np.ndarray, one: np.ndarray, other: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return how much (2, m) of two free swings of its record is in a driven one, all (m,), by least squares."""
    pairs = np.stack([one * one, one * other, other * other, one * driven, other * driven])
    xx, xy, yy, xd, yd = np.add.reduceat(pairs, starts, axis=1)
    both = np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-2)
    # Records of a sample or two do not hold both.
    found = np.linalg.pinv(both, rcond=1e-6, hermitian=True) @ np.stack([xd, yd], axis=-1)[..., None]
    return np.repeat(found[..., 0].T, np.diff(np.append(starts, len(driven))), axis=1)


@dataclass(frozen=True)
class _Link:
    """An oscillator along records that begin at `starts`; time, mass and stiffness are (m,).

    All records are one system: what takes one sample to the next is none where a record begins.
    """

    time: np.ndarray
    mass: np.ndarray
    stiffness: np.ndarray
    drag: float
    starts: np.ndarray

    @cached_property
    def _start(self) -> np.ndarray:
        """Row (m,) at which the record of a sample begins."""
        return np.repeat(self.starts, np.diff(np.append(self.starts, len(self.time))))

    @property
    def since(self) -> np.ndarray:
        """Time (m,) since the start of the record."""
        return self.time - self.time[self._start]

    @property
    def place(self) -> np.ndarray:
        """Samples (m,) since the start of the record."""
        return np.arange(len(self.time)) - self._start

    def part(self, early: np.ndarray) -> _Link:
        """Return the same with the first samples of each record, the start among them, (m,) of bool."""
        starts = np.flatnonzero(np.isin(np.flatnonzero(early), self.starts))
        return _Link(self.time[early], self.mass[early], self.stiffness[early], self.drag, starts)

    def driven(self, load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return place and speed (m,) under a load (m,) that is straight between samples; settled at the start."""
        step, between, stiff = self._between
        own, cross, back, held, unit = self._turn
        slope = np.append(np.diff(load) / step, 0.0)
        slope[self.starts[1:] - 1] = 0.0
        # About the motion that follows a straight load without swinging.
        straight = slope[:-1]
        start, rate = load[:-1] / stiff - straight * self.drag / stiff**2, straight / stiff
        known = np.zeros((2 * len(load), 1), order="F")
        known[2::2, 0] = start + rate * step - own * start - cross * rate
        known[3::2, 0] = (rate - back * start - held * rate) * between / unit
        known[2 * self.starts, 0] = load[self.starts] / self.stiffness[self.starts]
        known[2 * self.starts + 1, 0] = (slope / self.stiffness * self.mass)[self.starts] / unit
        return self._solved(known)[0]

    def free(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return place and speed (m,) of two swings without a load, from a place and from a speed at the start."""
        known = np.zeros((2 * len(self.time), 2), order="F")
        known[2 * self.starts, 0] = known[2 * self.starts + 1, 1] = 1.0
        return self._solved(known)

    @cached_property
    def _between(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Steps in time, inertia and stiffness (m - 1,) from sample to sample."""
        step = np.diff(self.time)
        step[self.starts[1:] - 1] = 1.0
        return step, 0.5 * (self.mass[1:] + self.mass[:-1]), 0.5 * (self.stiffness[1:] + self.stiffness[:-1])

    @cached_property
    def _turn(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, float]:
        """What place and speed become from sample to sample (m - 1,), and the unit of momentum.

        It is the momentum that goes on where the inertia changes, in units of the swing so that all are of one size.
        """
        step, between, stiff = self._between
        square, decay = stiff / between, self.drag / (2.0 * between)
        turn = np.sqrt(np.maximum(square - decay**2, 1e-9 * square))
        fade = np.exp(-decay * step)
        cosine, sine = fade * np.cos(turn * step), fade * np.sin(turn * step) / turn
        unit = float(np.sqrt(np.mean(square)) * np.mean(between))
        return cosine + decay * sine, sine, -square * sine, cosine - decay * sine, unit

    def _solved(self, known: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return place and speed of each column (2 m,) of what is known beside the sample before."""
        own, cross, back, held, unit = self._turn
        heavy = self._between[1] / unit
        goes_on = np.ones(len(own))
        goes_on[self.starts[1:] - 1] = 0.0
        # Every sample follows from the one before: a triangle of four diagonals.
        band = np.zeros((4, 2 * len(self.time)), order="F")
        band[0] = 1.0
        band[2, 0:-2:2], band[1, 1:-2:2] = -own * goes_on, -cross / heavy * goes_on
        band[3, 0:-2:2], band[2, 1:-2:2] = -back * heavy * goes_on, -held * goes_on
        solved, _ = dtbtrs(band, known, uplo="L", diag="U")
        return [(column[::2], column[1::2] * (unit / self.mass)) for column in solved.T]
