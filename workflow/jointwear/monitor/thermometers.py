"""Later temperatures in another unit than those of the baseline."""

from __future__ import annotations

from typing import Any

import numpy as np

from jointwear.files.wording import count
from jointwear.measurement.units import UNITS
from jointwear.monitor.windows import WindowStatistics

#: Kind of the finding.
UNIT = "temperature_unit"
#: Distance [K] from the temperatures of the baseline up to which weather and work may bring those of later windows.
NEAR = 15.0
#: Windows in another unit that are told: one is a reading gone wrong.
FEWEST = 2


def other_unit(statistics: WindowStatistics, baseline: np.ndarray) -> list[dict[str, Any]]:
    """Return a finding where later temperatures lie far from those of the baseline, and near them in another unit.

    Parameters
    ----------
    baseline : (w,) bool.
    """
    given = statistics.temperature
    known = given[baseline]
    if not np.isfinite(known).any():
        return []
    low, high = np.nanmin(known) - NEAR, np.nanmax(known) + NEAR
    with np.errstate(invalid="ignore"):
        far = (given < low) | (given > high)
        for unit, (size, offset) in UNITS["temperature"].items():
            value = given * size + offset
            there = (far & (value > low) & (value < high)).any(axis=1) & ~baseline
            if unit == "degC" or there.sum() < FEWEST:
                continue
            seen, many = given[there][far[there]], count(int(there.sum()), "window")
            words = (
                f"Temperatures of {many}, read as {seen.min():.3g} to {seen.max():.3g} degC, lie far from those of the "
                f"baseline ({low + NEAR:.3g} to {high - NEAR:.3g} degC), and near them if they are in {unit}: then "
                "convert these logs, or state 'units' where all logs have it. Else the joints are warmer or colder "
                "than ever, and are judged once shifts have taught what that does."
            )
            axes = sorted(int(j) + 1 for j in np.flatnonzero(far[there].any(axis=0)))
            return [{"time": float(statistics.start[there][0]), "axes": axes, "kind": UNIT, "words": words}]
    return []
