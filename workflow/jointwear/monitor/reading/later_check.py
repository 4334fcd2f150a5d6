"""Does a later piece of a log belong to the robot as its first log did.

Where the model leaves far more of the torque than in the first log, and as little as there once an axis is turned
around, two are exchanged or the torque is divided by a factor, the piece is refused. Where nothing of that kind
explains it, the piece is only marked: another load at the flange does the same. An axis whose torque the model hardly
explains at all, whatever the load, is not judged. A torque that stands still while its axis moves is told as that, and
the others are compared without it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from jointwear.measurement.checks.axes_check import explained
from jointwear.measurement.checks.axis_readings import Reading
from jointwear.measurement.checks.copied_columns import check_columns_differ
from jointwear.measurement.checks.derivative_checks import check_derivatives
from jointwear.measurement.checks.held_rows import check_rows_are_new, check_torques_are_new
from jointwear.measurement.checks.position_unit import check_position_unit
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.units import size_of
from jointwear.monitor.reading.derivation import Motion
from jointwear.monitor.reading.misreadings import without_load
from jointwear.monitor.reading.other_readings import MENDED, SAME_GROWTH, WORSE, OtherReadings, refusal_of
from jointwear.monitor.reading.other_scales import OtherScales
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


@dataclass
class _OfBlock:
    """What was found wrong with the torque of a block; its parts are asked for that before anything else.

    Attributes
    ----------
    refusal : what the block was refused with. reading, scale, delay : what mends it; scale (n,) or of all, delay [s].
    held : torques repeat those of rows before. everywhere : all joints are turned around.
    """

    refusal: Refused | None = None
    reading: Reading | None = None
    scale: np.ndarray | float = 1.0
    delay: float = 0.0
    held: bool = False
    everywhere: bool = False


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
        self._block = _OfBlock()
        #: Growth of what the model leaves (n,) of the last piece, and of the last that was taken for granted.
        self._last: np.ndarray | None = None
        self._known: np.ndarray | None = None
        self._lost = np.zeros(dynamics.robot.joints, dtype=bool)

    def begin(self) -> None:
        """Begin another block: another scale, reading or time of the torque that was found, and one that is held, are
        looked for in its parts alone."""
        self._block = _OfBlock()

    @property
    def everywhere(self) -> bool:
        """Whether all joints of the block are turned around: so are its parts in which too little moves to show it."""
        return self._block.everywhere

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
            check_torques_are_new(chunk, measured, stretch, self._name, part=self._block.held)
        except Refused:
            self._block.held = True
            raise
        unit = chunk.units.get("torque") or "N m"
        scales = OtherScales(self._dynamics, self._name, self._largest, self._growth, measured, unit)
        parts, usable = scales.samples.parts, scales.samples.usable

        @cache
        def lightened() -> Measured | None:
            torque = relieved()
            if torque is None:
                return None
            lighter = busiest_piece(replace(chunk, torque=torque), stretch, motion, self._dead_band)
            return replace(lighter, usable=lighter.usable & ~stands)

        self._last = scales.plain
        plain, others = float(np.nansum(self._last)), OtherReadings(self._dynamics, self._grown, self._last)
        block = self._block
        if block.delay:
            self._check_delay(measured, block.delay)
        elif block.reading is not None:
            # Each part of a log with one fault may be just below what is no chance.
            if others.left(block.reading, parts, usable) < plain:
                raise block.refusal
        elif block.refusal is not None and scales.left_over(block.scale) <= plain:
            raise block.refusal
        # An axis that went wrong counts in full, though the model may fit the others better than in the first log.
        if float(np.nansum(np.maximum(self._last, 0.0))) < WORSE:
            return nothing
        if self._known is not None and np.nanmax(np.abs(self._last - self._known), initial=0.0) < SAME_GROWTH:
            return self._marks() | nothing
        # Read as degrees, radians of one joint alone may explain most of what all of them do to the torque.
        self._check_slow(chunk, stretch, motion)
        found = others.find(parts, usable)
        if found:
            block.everywhere |= whole and found[0].several
            block.reading, block.refusal = found[0], refusal_of(self._name, found)
            raise block.refusal
        if whole:
            self._check_delay(measured)
        if (scale := scales.find(lightened, whole)) is not None:
            block.scale, block.refusal = scale
            raise block.refusal
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
            self._block.delay = delay
            raise off_by(self._name, delay)

    def _growth(self, parts: np.ndarray, usable: np.ndarray) -> np.ndarray:
        """Log of what the model leaves of each axis over what it usually leaves, (n,); NaN where unknown."""
        return self._grown(explained(self._dynamics, parts, usable))

    def _grown(self, left: np.ndarray) -> np.ndarray:
        return np.log(np.maximum(left, RIGHT) / self._usual)
