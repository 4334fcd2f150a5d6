"""Does a later piece of a log belong to the robot as its first log did.

Where the model leaves far more of the torque than in the first log, and as little as there once an axis is turned
around, two are exchanged or the torque is divided by a factor, the piece is refused. Where nothing of that kind
explains it, the piece is only marked: another load at the flange does the same. An axis whose torque the model hardly
explains at all, whatever the load, is not judged. A torque that stands still while its axis moves is told as that, and
the others are compared without it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from jointwear.files.wording import significant
from jointwear.measurement.checks.axes_check import explained
from jointwear.measurement.checks.axis_readings import Reading
from jointwear.measurement.checks.copied_columns import check_columns_differ
from jointwear.measurement.checks.derivative_checks import check_derivatives
from jointwear.measurement.checks.held_rows import check_rows_are_new, check_torques_are_new
from jointwear.measurement.checks.position_unit import check_position_unit
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
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.units import size_of
from jointwear.monitor.reading.decade_of_torque import Decade, decade_of
from jointwear.monitor.reading.derivation import Motion
from jointwear.monitor.reading.misreadings import without_load
from jointwear.monitor.reading.other_readings import MENDED, SAME_GROWTH, WORSE, OtherReadings, refusal_of
from jointwear.monitor.reading.other_time import OtherTime, off_by
from jointwear.monitor.reading.plausibility import busiest_piece, check_units, in_motion, measured_in
from jointwear.monitor.reading.standing_torque import standing
from jointwear.robots.dynamics import Dynamics

#: Share of the squared torque of an axis below which the model counts as right.
RIGHT = 0.02
#: Share of the squared torque of an axis that the model leaves where it no longer explains it, and growth of its log
#: since the first log: friction may be any size in that share, and twice the torque leaves a tenth of it.
HARDLY, FAR_WORSE = 0.3, 1.5
#: Share of the axes that move from which on none is judged.
MOST_LOST = 0.5
#: Share of the axes up to which a piece counts as one in which hardly anything moves, and of its samples in which an
#: axis that hardly moves is in motion: fast programs in radians read as degrees are, now and then.
SLOW, SELDOM = 0.5, 0.1
#: What mends a torque of one log that is another than that of the first.
OF_ONE_LOG = (
    "write the torque of this log as the first log has it: 'units', 'scale' and 'torque_constant' hold for all logs of "
    "a robot"
)


class LaterCheck:
    """Compares pieces of one log with the first log.

    Parameters
    ----------
    dynamics : of the robot. dead_band : (n,) [rad/s].
    usual : (n,) what :func:`.plausibility.check_first` returned. name : of the log.
    largest : (n,) torque [N m] of the first log, default unknown.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        dead_band: np.ndarray,
        usual: list[float | None],
        name: str,
        largest: np.ndarray | None = None,
    ) -> None:
        self._dynamics, self._dead_band, self._name = dynamics, dead_band, name
        self._largest = np.full(dynamics.robot.joints, np.nan) if largest is None else largest
        self._usual = np.maximum([np.nan if u is None else u for u in usual], RIGHT)
        self._known: np.ndarray | None = None
        self._last: np.ndarray | None = None
        self._scale = np.ones(dynamics.robot.joints)
        self._refusal: Refused | None = None
        self._reading: Reading | None = None
        self._held = self._everywhere = False
        self._delay = 0.0
        self._lost = np.zeros(dynamics.robot.joints, dtype=bool)

    def begin(self) -> None:
        """Begin another block: another scale, reading or time of the torque that was found, and one that is held, are
        looked for in its parts alone."""
        self._refusal, self._held, self._everywhere, self._delay = None, False, False, 0.0
        self._reading = None

    @property
    def everywhere(self) -> bool:
        """Whether all joints of the block are turned around: so are its parts in which too little moves to show it."""
        return self._everywhere

    def accept(self) -> None:
        """Take what the last piece left for granted, so that pieces like it are not examined again."""
        self._known = self._last

    def __call__(
        self,
        chunk: Chunk,
        stretch: np.ndarray,
        motion: Motion,
        whole: bool,
        relieved: Callable[[], np.ndarray | None] = lambda: None,
    ) -> np.ndarray:
        """Return flags (n,): where the model explains much less of the torque than in the first log, and of which axes
        next to nothing.

        Parameters
        ----------
        whole : it is a block and no part of one: parts are too short to tell a scale that all torques share.
        relieved : gives the torque (m, n) [N m] without the load that the whole block shows, None where it shows none:
            a part of a few seconds need not show what is carried in it. Asked only of what nothing else explains.

        Raises
        ------
        Refused : where turning an axis around, exchanging two, another time or scale of the torque, or another unit of
            the torque or of the positions, mends it.
        """
        measured = busiest_piece(chunk, stretch, motion, self._dead_band)
        if len(measured.time) < FEWEST_OF_JOINT:
            return np.zeros(self._dynamics.robot.joints, dtype=np.int64)
        stands = standing(chunk.torque, motion.velocity, self._dead_band)
        nothing = np.where(stands, int(Flag.TORQUE_FROZEN), 0)
        # One value looks like a current, a torque of the motor, or one of another joint.
        measured = replace(measured, usable=measured.usable & ~stands)
        moving = measured.usable.sum(axis=0)
        if np.mean(moving >= max(FEWEST_OF_JOINT, SELDOM * len(measured.time))) <= SLOW:
            self._check_slow(chunk, stretch, motion)
        check_units(measured, self._dynamics.robot, self._name, chunk.units)
        check_derivatives(chunk, stretch, self._name)
        check_rows_are_new(chunk, stretch, self._name)
        check_columns_differ(measured, self._dynamics.robot, self._name)
        try:
            check_torques_are_new(chunk, measured, stretch, self._name, part=self._held)
        except Refused:
            self._held = True
            raise
        samples = thinned(measured)
        parts, usable = samples.parts, samples.usable

        @cache
        def lightened() -> Measured | None:
            torque = relieved()
            if torque is None:
                return None
            lighter = busiest_piece(replace(chunk, torque=torque), stretch, motion, self._dead_band)
            return replace(lighter, usable=lighter.usable & ~stands)

        self._last = self._growth(parts, usable)
        plain, others = float(np.nansum(self._last)), OtherReadings(self._dynamics, self._grown, self._last)
        if self._delay:
            self._check_delay(measured, self._delay)
        elif self._reading is not None:
            # Each part of a log with one fault may be just below what is no chance.
            if others.left(self._reading, parts, usable) < plain:
                raise self._refusal
        elif self._refusal is not None and self._left_over(parts, usable, self._scale) <= plain:
            raise self._refusal
        # An axis that went wrong counts in full, though the model may fit the others better than in the first log.
        if float(np.nansum(np.maximum(self._last, 0.0))) < WORSE:
            return nothing
        if self._known is not None and np.nanmax(np.abs(self._last - self._known), initial=0.0) < SAME_GROWTH:
            return self._marks() | nothing
        # Read as degrees, radians of one joint alone may explain most of what all of them do to the torque.
        self._check_slow(chunk, stretch, motion)
        found = others.find(parts, usable)
        if found:
            self._everywhere |= whole and found[0].several
            self._reading, self._refusal = found[0], refusal_of(self._name, found)
            raise self._refusal
        decade = decade_of(largest_torque(measured), self._largest, chunk.units.get("torque") or "N m")
        if whole:
            self._check_delay(measured)
        self._check_scale(measured, samples, plain, lightened, decade)
        if whole:
            self._check_shared_scale(measured, parts, usable, plain, decade)
        if decade is not None:
            self._check_decade(decade, parts, usable, plain)
        self._lost = self._hardly(self._last, parts, usable)
        if self._lost.any() and (lighter := without_load(measured, self._dynamics.robot)) is not None:
            self._lost &= self._lost_in(lighter)
        if self._lost.any() and (lighter := lightened()) is not None:
            self._lost &= self._lost_in(lighter)
        # What befell most torques befell the others too, though they may resemble what they were.
        self._lost |= self._lost.sum() > MOST_LOST * np.isfinite(self._last).sum()
        return self._marks() | nothing

    def _check_slow(self, chunk: Chunk, stretch: np.ndarray, motion: Motion) -> None:
        """Check that positions are not radians, stated as a smaller unit: most radians read as degrees stay below every
        dead band.

        Raises
        ------
        Refused : with the unit that they look like.
        """
        unit = chunk.units.get("position") or "rad"
        slower = size_of("position", unit)
        if slower < 1.0:
            slow = busiest_piece(chunk, stretch, motion, slower * self._dead_band)
            check_position_unit(thinned(slow), self._dynamics.robot, self._name, unit)

    def relieve(self, chunk: Chunk, stretch: np.ndarray, motion: Motion) -> np.ndarray | None:
        """Return the torque (m, n) [N m] of a block without the load at the flange that it shows; None where it shows
        none."""
        usable = in_motion(chunk, stretch, motion, self._dead_band)
        lighter = without_load(measured_in(chunk, stretch, motion, usable, self._dead_band), self._dynamics.robot)
        return None if lighter is None else lighter.torque

    def _lost_in(self, measured: Measured) -> np.ndarray:
        """Return the axes (n,) of which the model explains next to nothing in a piece without a load."""
        thin = thinned(measured)
        return self._hardly(self._growth(thin.parts, thin.usable), thin.parts, thin.usable)

    def _marks(self) -> np.ndarray:
        return np.where(self._lost, int(Flag.UNEXPLAINED | Flag.CONTRADICTED), int(Flag.UNEXPLAINED))

    def _hardly(self, growth: np.ndarray, parts: np.ndarray, usable: np.ndarray) -> np.ndarray:
        """Return the axes (n,) whose torque the model hardly explains any more."""
        return (growth > FAR_WORSE) & (explained(self._dynamics, parts, usable) > HARDLY)

    def _check_delay(self, measured: Measured, found: float = 0.0) -> None:
        """Check that the torques are not those of another time.

        Parameters
        ----------
        found : delay [s] of the block that the samples are a part of, default not known.

        Raises
        ------
        Refused : with the delay.
        """
        other = OtherTime(self._dynamics, measured)
        delay = found or other.best()
        if not delay:
            return
        plain, moved = (float(np.nansum(self._grown(other.left_at(d)))) for d in (0.0, delay))
        if found and moved < plain:
            raise off_by(self._name, delay)
        if moved < MENDED and plain - moved > WORSE:
            self._delay = delay
            raise off_by(self._name, delay)

    def _check_scale(
        self,
        measured: Measured,
        samples: Measured,
        plain: float,
        lightened: Callable[[], Measured | None],
        decade: Decade | None,
    ) -> None:
        """Check that no other scale of the torque explains a piece as well as the first log.

        Parameters
        ----------
        samples : of `measured`, thinned. plain : growth of what the model leaves of them, summed over axes.
        lightened : gives the samples without the load that the whole block shows, None where it shows none.
        decade : power of ten of the first log's that all torques are, None for none.

        Raises
        ------
        Refused : with the factors, or with the unit that is that power of ten.
        """
        parts, usable, sized = samples.parts, samples.usable, self.off_scale_of(measured)
        scale, free = sized(samples), sized(samples, load_free=True)
        # Another load at the flange multiplies the bodies of the axes too, and leaves the factors beside it at one.
        if scale is None or free is None:
            return
        beyond = beyond_loads(free, scale, int(np.isfinite(self._last).sum()))
        if not self._explains(parts, usable, scale, plain):
            if not (beyond or self._explains_loaded(measured, free, plain)):
                return
            scale = free
        left = self._left_over(parts, usable, scale)
        if self._load_explains(measured, left, lambda thin: sized(thin) is not None):
            return
        # One move with a part is as well explained by factors; the part shows in the moves beside it. Its load has to
        # answer for the joints that are off: in so short a piece that of a wrist of light links may be anything.
        accused = (scale < 0) | (np.abs(np.log(np.abs(scale))) > np.log(FACTOR))
        if self._is_as_good(lightened(), left, lambda thin: sized(thin, asked=accused) is not None):
            return
        # Another product on an arm of light links: a short piece may be explained by factors as well as by its load.
        if not beyond and gained_by(np.abs(scale), self._dynamics, parts, usable) < LIKELIER:
            return
        self._prefer_decade(decade, parts, usable, left)
        known, self._scale = np.flatnonzero(scale != 1.0), scale
        told = ", ".join(f"{significant(scale[j])} on joint {j + 1}" for j in known)
        mended = ", ".join(f"{significant(1 / scale[j])} for joint {j + 1}" for j in known)
        self._refusal = Refused(
            f"{self._name}: the torque is another multiple of the model's than in the first log ({told}); it looks "
            "like another unit, a current, a share of a rating or a torque that counts the other way round; it would "
            f"fit times about {mended}",
            OF_ONE_LOG,
        )
        raise self._refusal

    def off_scale_of(self, measured: Measured) -> Callable[..., np.ndarray | None]:
        """Return :func:`.off_scale` of this robot, asked only of joints whose torque is as large as their factor says.

        What multiplies a torque multiplies that of friction too, which fills the torque of most joints. Where bodies
        ask next to nothing of a joint, and its friction is in no file, a part that the robot carries is explained by
        190 times these bodies beside a torque that is what it was.
        """
        times = largest_torque(measured) / self._largest

        def off(thin: Measured, load_free: bool = False, asked: np.ndarray | None = None) -> np.ndarray | None:
            factor, robot = factors(thin, self._dynamics.robot, load_free)[0], self._dynamics.robot
            with np.errstate(divide="ignore"):
                told = ~(np.abs(np.log(np.abs(factor) / times)) > np.log(OF_ONE))
            return off_scale(thin, robot, load_free, told if asked is None else told & asked)

        return off

    def _check_decade(self, decade: Decade, parts: np.ndarray, usable: np.ndarray, plain: float) -> None:
        """Check that the torques of all joints are not a power of ten of what the robot ever had.

        Raises
        ------
        Refused : with the factor, where the torque over it is explained far better too.
        """
        if plain - self._left_over(parts, usable, np.full_like(self._scale, decade.factor)) > WORSE:
            self._refuse_decade(decade)

    def _refuse_decade(self, decade: Decade) -> None:
        self._scale = np.full_like(self._scale, decade.factor)
        self._refusal = Refused(f"{self._name}: {decade.reason}", OF_ONE_LOG)
        raise self._refusal

    def _prefer_decade(self, decade: Decade | None, parts: np.ndarray, usable: np.ndarray, left: float) -> None:
        """Check that factors of joints, found beside the model, are not one unit: what a model lacks makes the factor
        of each another, and the robot's own torques before tell it.

        Parameters
        ----------
        left : growth that the factors leave.

        Raises
        ------
        Refused : with the unit, where it explains the torque about as well. Factors that explain it better than that of
            the first log was make up for what the model lacks.
        """
        if decade is None or not decade.close or not decade.unit:
            return
        if self._left_over(parts, usable, np.full_like(self._scale, decade.factor)) - max(left, 0.0) < WORSE:
            self._refuse_decade(decade)

    def _check_shared_scale(
        self, measured: Measured, parts: np.ndarray, usable: np.ndarray, plain: float, decade: Decade | None
    ) -> None:
        """Check that the torques of all joints together are no other multiple of the model's.

        Raises
        ------
        Refused : with the factor.
        """
        told = shared_scale(self._dynamics, parts, usable)
        if told is None:
            return
        # A load that is free takes a part of a factor; friction, where the file knows it, tells the whole.
        whole = shared_scale(self._dynamics, parts, usable, nominal_friction=True) or 1.0
        sizes = [told, whole] if (whole - 1.0) * (told - 1.0) > 0 else [told]
        factor = min(sizes, key=lambda size: self._left_over(parts, usable, np.full_like(self._scale, size)))
        scale = np.full_like(self._scale, factor)
        if not self._explains(parts, usable, scale, plain):
            return
        # A part that is carried on some moves is like a factor too: the likelihood has a load that is carried on all.
        left = self._left_over(parts, usable, scale)
        if self._load_explains(
            measured, left, lambda thin: shared_scale(self._dynamics, thin.parts, thin.usable) is not None
        ):
            return
        self._prefer_decade(decade, parts, usable, left)
        self._scale = scale
        self._refusal = Refused(
            f"{self._name}: gravity and inertial torques of all joints are about {significant(factor, 2)} times those "
            "of the model whatever their friction, unlike in the first log; it looks like another unit, another torque "
            f"constant or a share of a rating; the torque would fit times about {significant(1 / factor, 2)}",
            OF_ONE_LOG,
        )
        raise self._refusal

    def _load_explains(self, measured: Measured, left: float, off: Callable[[Measured], bool]) -> bool:
        """Return whether a load at the flange, carried on any moves, is as good a cause as a scale that leaves a growth
        `left`; `off`: whether thinned samples without the load are still of another scale.

        It is where the torque without it is explained as well: one of tons takes the bodies' part of a torque in mN m,
        and leaves that of friction.
        """
        return self._is_as_good(without_load(measured, self._dynamics.robot), left, off)

    def _is_as_good(self, lighter: Measured | None, left: float, off: Callable[[Measured], bool]) -> bool:
        """Return whether samples without a load, None where none shows, are explained as :meth:`_load_explains`
        asks."""
        if lighter is None:
            return False
        thin = thinned(lighter)
        if off(thin):
            return False
        return self._left_over(thin.parts, thin.usable, np.ones_like(self._scale)) - left < WORSE

    def _explains_loaded(self, measured: Measured, scale: np.ndarray, plain: float) -> bool:
        """Return :meth:`_explains` of a scale (n,) with the load taken off that then shows."""
        lighter = without_load(replace(measured, torque=measured.torque / scale), self._dynamics.robot)
        if lighter is None:
            return False
        thin = thinned(lighter)
        return self._explains(thin.parts, thin.usable, np.ones_like(scale), plain)

    def _explains(self, parts: np.ndarray, usable: np.ndarray, scale: np.ndarray, plain: float) -> bool:
        """Return whether the torque over a scale (n,) is explained as in the first log, unlike as it is."""
        left = self._left_over(parts, usable, scale)
        return left < MENDED and plain - left > WORSE - MENDED

    def _left_over(self, parts: np.ndarray, usable: np.ndarray, scale: np.ndarray) -> float:
        """Return the growth, summed over axes, once the torque is divided by a scale (n,)."""
        scaled = parts.copy()
        scaled[:, 3] /= scale
        return float(np.nansum(self._growth(scaled, usable)))

    def _growth(self, parts: np.ndarray, usable: np.ndarray) -> np.ndarray:
        """Log of what the model leaves of each axis over what it usually leaves, (n,); NaN where unknown."""
        return self._grown(explained(self._dynamics, parts, usable))

    def _grown(self, left: np.ndarray) -> np.ndarray:
        return np.log(np.maximum(left, RIGHT) / self._usual)


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
    axes : number of axes that are known.
    """
    right = (alone != 1.0) & (alone > 1 / FACTOR) & (alone < FACTOR)
    off = ~right & (np.abs(np.log(np.abs(scale))) > np.log(OF_ONE))
    return bool(off.sum() > MOST_LOST * axes)
