"""Torques of all joints that are a power of ten of what the robot ever had: another unit.

Its own torques tell that whatever the model lacks; no motion, load or wear does it to every joint alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.files.wording import significant
from jointwear.measurement.checks.torque_scale import FEWEST_SHARING
from jointwear.measurement.units import CURRENTS, is_known, size_of, sizes_of

#: Factor for each power of ten by which the largest torque of a joint may lie off that power of the one in the first
#: log: a wrist that a new program turns faster had 4.7 times the others'.
AROUND = 2.5


@dataclass(frozen=True)
class Decade:
    """Torques are about 10 to the `power` times those of the first log, which were in unit `stated`. `close`: those of
    each joint are within one :data:`AROUND` of it, whatever the power."""

    power: int
    close: bool
    stated: str

    @property
    def factor(self) -> float:
        """Torque over that of the first log."""
        return 10.0**self.power

    @property
    def unit(self) -> str:
        """The unit that such torques are in, empty where none is of that size."""
        if self.stated in CURRENTS:
            sizes, size = CURRENTS, CURRENTS[self.stated]
        else:
            sizes = sizes_of("torque")
            size = size_of("torque", self.stated) if is_known("torque", self.stated) else np.nan
        return next((unit for unit, known in sizes.items() if np.isclose(size / known, self.factor)), "")

    @property
    def reason(self) -> str:
        """What such torques look like, in words."""
        looks = f"it looks like {self.unit}, read as {self.stated}" if self.unit else "it looks like another unit"
        return f"the torques of all joints are about {significant(self.factor)} times those of the first log; {looks}"


def decade_of(largest: np.ndarray, usual: np.ndarray, stated: str) -> Decade | None:
    """Return the power of ten that the torques of all joints are off by; None where they are off by none.

    Parameters
    ----------
    largest, usual : (n,) largest torques [N m] of a piece and of the first log. stated : unit, as it is read.
    """
    known = (largest > 0) & np.isfinite(usual)
    if known.sum() < FEWEST_SHARING:
        return None
    size = np.log10(largest[known] / usual[known])
    power = int(np.rint(np.median(size)))
    off = np.abs(size - power).max()
    if power == 0 or off > abs(power) * np.log10(AROUND):
        return None
    return Decade(power, bool(off <= np.log10(AROUND)), stated)
