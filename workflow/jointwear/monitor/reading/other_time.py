"""Torques of a later log that belong to another time than the motion beside them: by how much, and which way.

The change of a lag that :mod:`.torque_lag` finds is of first order: of half a second it says that there is one, at
most, and where the robot file lacks much not even that. Such rows look like another robot or another load. Whether they
are mended by one shift in time can be asked, as what the model then leaves is what it left in the first log.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.measurement.checks.axes_check import explained
from jointwear.measurement.checks.late_torque import DELAYS, REFUSED, read_later
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.even_steps import step_of
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import Refused
from jointwear.robots.dynamics import Dynamics

#: Steps [s] by which delays up to the longest of :data:`.DELAYS` are gone through either way, and those about the best
#: of each round: moves of half a second and more still resemble themselves a twentieth of a second later.
STEPS = (0.1, 0.02, 0.005)
#: Share of a squared torque below which nothing is left: that of an axis that does not move.
LEAST = 1e-9


def at_its_rate(measured: Measured) -> Measured:
    """Return samples of a log with the usual rate [Hz] at which they follow each other, as they are where none do."""
    step = step_of(measured.time, measured.trajectory)
    return replace(measured, rate=1.0 / step) if 0 < step < np.inf else measured


class OtherTime:
    """Reads the torques of a piece at other times.

    Parameters
    ----------
    dynamics : of the robot. measured : samples of the piece.
    """

    def __init__(self, dynamics: Dynamics, measured: Measured) -> None:
        self._measured = at_its_rate(measured)
        self._samples = thinned(self._measured)
        self._dynamics = dynamics
        motion = self._samples.position, self._samples.velocity, self._samples.acceleration
        self._rigid = dynamics.rigid_body_torque(*motion)

    def left_at(self, delay: float, loosely: bool = False) -> np.ndarray:
        """Return the share (n,) of the squared torque of each axis that the model leaves where the torque is read
        `delay` [s] later; `loosely` as of :func:`.explained`."""
        read = read_later(self._measured, self._samples, delay)
        return explained(self._dynamics, read.parts, read.usable, loosely, self._rigid)

    def best(self) -> float:
        """Return the delay [s] at which least is left, 0 where none beyond what a drive makes is better."""
        longest, best = DELAYS[-1], 0.0
        for step, reach in zip(STEPS, (longest, *STEPS), strict=False):
            tried = best + step * np.arange(-round(reach / step), round(reach / step) + 1)
            # The torque is read at whole samples.
            samples = np.unique(np.round(tried * self._measured.rate))
            best = float(min(samples / self._measured.rate, key=self._all_left))
        return best if abs(best) >= REFUSED else 0.0

    def _all_left(self, delay: float) -> float:
        """Return the log of what is left, summed over the axes, where the torque is read `delay` [s] later."""
        return float(np.nansum(np.log(np.maximum(self.left_at(delay, loosely=True), LEAST))))


def off_by(name: str, delay: float) -> Refused:
    """Return the refusal of a log whose torques of all joints are `delay` [s] late, negative early."""
    way = "late" if delay > 0 else "early"
    return Refused(
        f"{name}: the torque of all joints is about {1e3 * abs(delay):.0f} ms {way} against the motion, unlike in the "
        "first log; read at that time it fits the model as it did there, and no drive and no filter does that",
        "join torque and motion by one clock, or move the rows of the torque",
    )
