"""Numbers that an arm can have: what lies beyond them counts as missing, in every reader."""

from __future__ import annotations

import numpy as np

#: Sizes beyond which a number is none that an arm can have.
ABSURD = {"position": 1e6, "velocity": 1e5, "acceleration": 1e8, "torque": 1e8, "temperature": 1e4}
#: Largest label of a trajectory: netCDF as CF 1.8 has it stores 32 bits.
LARGEST_LABEL = 2**31 - 1
#: [degC]
ABSOLUTE_ZERO = -273.15


def possible(values: np.ndarray, role: str) -> np.ndarray:
    """Return values of a role, in the unit of the project, with NaN in place of those that no arm can have."""
    with np.errstate(invalid="ignore"):
        absurd = np.abs(values) > ABSURD[role]
        if role == "temperature":
            absurd |= values < ABSOLUTE_ZERO
    return np.where(absurd, np.nan, values) if absurd.any() else values


#: Numbers that loggers write where they know none.
SENTINELS = (-999.0, -9999.0, -99999.0, 9999.0, 99999.0, -32768.0)


def without_sentinels(array: np.ndarray) -> np.ndarray:
    """Return values, as they are logged, with NaN in place of numbers that stand for a missing one."""
    missing = np.isin(array, SENTINELS)
    return np.where(missing, np.nan, array) if missing.any() else array
