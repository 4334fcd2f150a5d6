"""What a first log that was not refused still has against its robot file: a joint of which most is left, another zero.

It is not asked as a refusal: a spring that the file lacks leaves most of a joint too, and the log is right.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from jointwear.measurement.checks.axes_check import RIGHT
from jointwear.measurement.checks.left_over import left_over, most_left
from jointwear.measurement.checks.other_zero import other_zero
from jointwear.measurement.derived.motion import Measured
from jointwear.monitor.reading.misreadings import without_load
from jointwear.robots.robot import Robot


@dataclass(frozen=True)
class Misfit:
    """`left_over`: for each axis the share of its squared torque that the model leaves, beyond noise and without the
    load that the log shows, None where unknown; of no axis where the list is empty. `zero`: in words from where the
    joint `zero_axis` (0-based) seems to count, and what mends it, empty where none does."""

    left_over: list[float | None] = field(default_factory=list)
    zero: str = ""
    zero_axis: int | None = None


def misfit_of(measured: Measured, robot: Robot, left: np.ndarray) -> Misfit:
    """Return what samples have against a robot file.

    Parameters
    ----------
    left : (n,) share of the squared torque that the model leaves; where it is that of a right file nothing is asked.
    """
    if not np.nanmax(left, initial=0.0) > RIGHT:
        return Misfit()
    over = left_over(measured, robot)
    if most_left(over):
        lighter = without_load(measured, robot)
        # A load moves what is left between axes; none is blamed for what goes with it.
        over = over if lighter is None else np.fmin(over, left_over(lighter, robot))
    reading = other_zero(measured, robot, RIGHT)
    return Misfit(
        left_over=[float(x) if np.isfinite(x) else None for x in over],
        zero="" if reading is None else f"{reading.reason}: {reading.remedy}",
        zero_axis=None if reading is None else reading.axes[0],
    )
