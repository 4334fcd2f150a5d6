"""Scales of the torque under which a later piece of a log is explained as its first log was: another unit, a current, a
share of a rating. A load at the flange that explains the piece as well is the likelier cause.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from jointwear.files.wording import significant
from jointwear.measurement.checks.torque_scale import (
    FACTOR,
    LIKELIER,
    OF_ONE,
    factors,
    gained_by,
    off_scale,
    shared_scale,
    thinned,
)
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import Refused
from jointwear.monitor.reading.decade_of_torque import Decade, decade_of
from jointwear.monitor.reading.misreadings import without_load
from jointwear.monitor.reading.other_readings import MENDED, WORSE
from jointwear.robots.dynamics import Dynamics

#: Share of the axes that have to be off by more than their errors for a scale beside a load to be one.
MOST = 0.5
#: What mends a torque of one log that is another than that of the first.
OF_ONE_LOG = (
    "write the torque of this log as the first log has it: 'units', 'scale' and 'torque_constant' hold for all logs of "
    "a robot"
)


class OtherScale(NamedTuple):
    """Factors (n,) of the torque over that of the first log, and the refusal of a piece that has them."""

    factors: np.ndarray
    refusal: Refused


@dataclass(frozen=True)
class OtherScales:
    """Looks for another scale of the torque of one piece of a log.

    Attributes
    ----------
    name : of the log. largest : (n,) torque [N m] of its first log, NaN where unknown.
    growth : of samples (m, 4, n) and which of them count (m, n), gives the log of what the model leaves of each axis
        over what it left in the first log, (n,), NaN where unknown.
    measured : the piece. unit : of its torques, as they are read.
    """

    dynamics: Dynamics
    name: str
    largest: np.ndarray
    growth: Callable[[np.ndarray, np.ndarray], np.ndarray]
    measured: Measured
    unit: str

    @cached_property
    def samples(self) -> Measured:
        """The piece, thinned: of these the scales are made."""
        return thinned(self.measured)

    @cached_property
    def plain(self) -> np.ndarray:
        """Growth (n,) of the piece as it is read."""
        return self.growth(self.samples.parts, self.samples.usable)

    @cached_property
    def _decade(self) -> Decade | None:
        return decade_of(largest_torque(self.measured), self.largest, self.unit)

    def left_over(self, scale: np.ndarray | float) -> float:
        """Return the growth, summed over axes, once the torque is divided by a scale, (n,) or one of all."""
        scaled = self.samples.parts.copy()
        scaled[:, 3] /= scale
        return float(np.nansum(self.growth(scaled, self.samples.usable)))

    def find(self, lightened: Callable[[], Measured | None], whole: bool) -> OtherScale | None:
        """Return the scale under which the piece is explained as the first log was; None where none is needed.

        Parameters
        ----------
        lightened : gives the samples without the load that the whole block shows, None where it shows none.
        whole : the piece is a block and no part of one: parts are too short to tell a scale that all torques share.
        """
        return self._of_joints(lightened) or (self._of_all() if whole else None) or self._of_unit()

    def _of_joints(self, lightened: Callable[[], Measured | None]) -> OtherScale | None:
        """Return factors that differ from joint to joint."""
        sized = self.off_scale
        scale, free = sized(self.samples), sized(self.samples, load_free=True)
        # Another load at the flange multiplies the bodies of the axes too, and leaves the factors beside it at one.
        if scale is None or free is None:
            return None
        beyond = beyond_loads(free, scale, int(np.isfinite(self.plain).sum()))
        if not self._explains(scale):
            if not (beyond or self._explains_loaded(free)):
                return None
            scale = free
        left = self.left_over(scale)
        if self._load_explains(left, lambda thin: sized(thin) is not None):
            return None
        # One move with a part is as well explained by factors; the part shows in the moves beside it. Its load has to
        # answer for the joints that are off: in so short a piece that of a wrist of light links may be anything.
        accused = (scale < 0) | (np.abs(np.log(np.abs(scale))) > np.log(FACTOR))
        if self._is_as_good(lightened(), left, lambda thin: sized(thin, asked=accused) is not None):
            return None
        # Another product on an arm of light links: a short piece may be explained by factors as well as by its load.
        gained = gained_by(np.abs(scale), self.dynamics, self.samples.parts, self.samples.usable)
        if not beyond and gained < LIKELIER:
            return None
        return self._rather_of_unit(left) or self._told_by_joint(scale)

    def _told_by_joint(self, scale: np.ndarray) -> OtherScale:
        known = np.flatnonzero(scale != 1.0)
        told = ", ".join(f"{significant(scale[j])} on joint {j + 1}" for j in known)
        mended = ", ".join(f"{significant(1 / scale[j])} for joint {j + 1}" for j in known)
        reason = (
            f"{self.name}: the torque is another multiple of the model's than in the first log ({told}); it looks "
            "like another unit, a current, a share of a rating or a torque that counts the other way round; it would "
            f"fit times about {mended}"
        )
        return OtherScale(scale, Refused(reason, OF_ONE_LOG))

    def off_scale(self, thin: Measured, load_free: bool = False, asked: np.ndarray | None = None) -> np.ndarray | None:
        """Return :func:`.off_scale` of this robot, asked only of joints whose torque is as large as their factor says.

        What multiplies a torque multiplies that of friction too, which fills the torque of most joints. Where bodies
        ask next to nothing of a joint, and its friction is in no file, a part that the robot carries is explained by
        190 times these bodies beside a torque that is what it was.
        """
        times = largest_torque(self.measured) / self.largest
        factor, robot = factors(thin, self.dynamics.robot, load_free)[0], self.dynamics.robot
        with np.errstate(divide="ignore"):
            told = ~(np.abs(np.log(np.abs(factor) / times)) > np.log(OF_ONE))
        return off_scale(thin, robot, load_free, told if asked is None else told & asked)

    def _of_all(self) -> OtherScale | None:
        """Return one factor of the torques of all joints together."""
        parts, usable = self.samples.parts, self.samples.usable
        told = shared_scale(self.dynamics, parts, usable)
        if told is None:
            return None
        # A load that is free takes a part of a factor; friction, where the file knows it, tells the whole.
        whole = shared_scale(self.dynamics, parts, usable, nominal_friction=True) or 1.0
        factor = min([told, whole] if (whole - 1.0) * (told - 1.0) > 0 else [told], key=self.left_over)
        if not self._explains(factor):
            return None
        # A part that is carried on some moves is like a factor too: the likelihood has a load that is carried on all.
        left = self.left_over(factor)
        if self._load_explains(left, lambda thin: shared_scale(self.dynamics, thin.parts, thin.usable) is not None):
            return None
        return self._rather_of_unit(left) or self._told_of_all(factor)

    def _told_of_all(self, factor: float) -> OtherScale:
        reason = (
            f"{self.name}: gravity and inertial torques of all joints are about {significant(factor, 2)} times those "
            "of the model whatever their friction, unlike in the first log; it looks like another unit, another torque "
            f"constant or a share of a rating; the torque would fit times about {significant(1 / factor, 2)}"
        )
        return OtherScale(np.full_like(self.plain, factor), Refused(reason, OF_ONE_LOG))

    def _of_unit(self) -> OtherScale | None:
        """Return a power of ten of what the robot ever had, where the torque over it is explained far better too."""
        decade = self._decade
        if decade is None or not float(np.nansum(self.plain)) - self.left_over(decade.factor) > WORSE:
            return None
        return self._told_as_unit(decade)

    def _told_as_unit(self, decade: Decade) -> OtherScale:
        refusal = Refused(f"{self.name}: {decade.reason}", OF_ONE_LOG)
        return OtherScale(np.full_like(self.plain, decade.factor), refusal)

    def _rather_of_unit(self, left: float) -> OtherScale | None:
        """Return one unit of all joints where factors, found beside the model, are about as good: what a model lacks
        makes the factor of each another, and the robot's own torques before tell it.

        Factors that explain the torque better than that of the first log was make up for what the model lacks.

        Parameters
        ----------
        left : growth that the factors leave.
        """
        decade = self._decade
        if decade is None or not decade.close or not decade.unit:
            return None
        return self._told_as_unit(decade) if self.left_over(decade.factor) - max(left, 0.0) < WORSE else None

    def _load_explains(self, left: float, off: Callable[[Measured], bool]) -> bool:
        """Return whether a load at the flange, carried on any moves, is as good a cause as a scale that leaves a growth
        `left`; `off`: whether thinned samples without the load are still of another scale.

        It is where the torque without it is explained as well: one of tons takes the bodies' part of a torque in mN m,
        and leaves that of friction.
        """
        return self._is_as_good(without_load(self.measured, self.dynamics.robot), left, off)

    def _is_as_good(self, lighter: Measured | None, left: float, off: Callable[[Measured], bool]) -> bool:
        """Return whether samples without a load, None where none shows, are explained as :meth:`_load_explains`
        asks."""
        if lighter is None:
            return False
        thin = thinned(lighter)
        return not off(thin) and self._grown_in(thin) - left < WORSE

    def _explains(self, scale: np.ndarray | float) -> bool:
        """Return whether the torque over a scale is explained as in the first log, unlike as it is."""
        return self._mends(self.left_over(scale))

    def _explains_loaded(self, scale: np.ndarray) -> bool:
        """Return :meth:`_explains` of a scale (n,) with the load taken off that then shows."""
        scaled = replace(self.measured, torque=self.measured.torque / scale)
        lighter = without_load(scaled, self.dynamics.robot)
        return lighter is not None and self._mends(self._grown_in(thinned(lighter)))

    def _mends(self, left: float) -> bool:
        return left < MENDED and float(np.nansum(self.plain)) - left > WORSE - MENDED

    def _grown_in(self, thin: Measured) -> float:
        """Return the growth, summed over axes, of thinned samples as they are."""
        return float(np.nansum(self.growth(thin.parts, thin.usable)))


def largest_torque(measured: Measured) -> np.ndarray:
    """Return the largest torque (n,) [N m] of each joint among the samples that count, 0 where none does."""
    return np.max(np.where(measured.usable, np.abs(np.nan_to_num(measured.torque)), 0.0), axis=0, initial=0.0)


def beyond_loads(scale: np.ndarray, alone: np.ndarray, axes: int) -> bool:
    """Return whether a scale, found beside a load, is off by more than its errors can be on most axes.

    Beside a load that is left free the bodies of a few seconds of a slow arm may have any factor: it is none where that
    without a load is clearly about one.

    Parameters
    ----------
    scale, alone : (n,) factors beside a load and without one; exactly one where a factor is not clear.
    axes : how many axes are known.
    """
    right = (alone != 1.0) & (alone > 1 / FACTOR) & (alone < FACTOR)
    off = ~right & (np.abs(np.log(np.abs(scale))) > np.log(OF_ONE))
    return bool(off.sum() > MOST * axes)
