"""Numbers that an arm can have: what lies beyond them counts as missing, in every reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.timestamps import LATEST
from jointwear.measurement.units import size_of, sizes_of

#: Sizes beyond which a number is none that an arm can have.
ABSURD = {"position": 1e6, "velocity": 1e5, "acceleration": 1e8, "torque": 1e8, "temperature": 1e4}
#: Largest label of a trajectory: netCDF as CF 1.8 has it stores 32 bits.
LARGEST_LABEL = 2**31 - 1
#: Time from sample to sample [s]: no drive closes its loop in a microsecond, and in a minute an arm has done its work.
SHORTEST_STEP, LONGEST_STEP = 1e-6, 60.0
#: Share of the steps in time that go back where rows lie in no order: half of them do, of trajectories few.
FALLING = 0.25
#: Share of them that go back where rows run from the newest to the oldest.
BACKWARDS = 0.9
#: Steps [s] of usual logs, a unit of time apart from each other.
USUAL = (5e-4, 0.5)
#: [degC]
ABSOLUTE_ZERO = -273.15


def possible(values: np.ndarray, role: str) -> np.ndarray:
    """Return values (m, ...) of a role, in the unit of the project, with NaN in place of those that no arm can have."""
    with np.errstate(invalid="ignore"):
        absurd = np.abs(values) > ABSURD[role]
        if role == "temperature":
            absurd |= values < ABSOLUTE_ZERO
    return np.where(absurd, np.nan, values) if absurd.any() else values


#: Numbers that loggers write where they know none.
SENTINELS = (-999.0, -9999.0, -99999.0, 9999.0, 99999.0, -32768.0)
#: Largest numbers of 16 bits, signed or not, which stand for none too where no value lies beyond them and none beside
#: them: a torque that is cut off there rises up to it, and counts go on in it.
LARGEST_OF_BITS = (32767.0, 65535.0)


#: Quantile of the changes from sample to sample by which such a number may lie from those before and after and still be
#: a value.
USUAL_CHANGE = 0.99


def without_sentinels(array: np.ndarray) -> tuple[np.ndarray, tuple[float, ...]]:
    """Return values (m,) or (m, n), as they are logged, with NaN in place of numbers that stand for a missing one, and
    which numbers these are.

    One that lies among the values before and after is a value as they are, as -999 N m of a heavy arm, unless it recurs
    more often than any other number of its column. The largest number of 16 bits is a value beside its like,
    however often it recurs, and wherever others lie beyond it.
    """
    marks = np.isin(array, (*SENTINELS, *LARGEST_OF_BITS))
    if not marks.any():
        return array, ()
    missing, columns = marks.reshape(len(array), -1), array.reshape(len(array), -1)
    for j in np.flatnonzero(missing.any(axis=0)):
        missing[:, j] &= ~_below_others(columns[:, j], missing[:, j])
        missing[:, j] &= ~_among_others(columns[:, j], missing[:, j])
    found = tuple(np.unique(array[marks]).tolist())
    return np.where(marks, np.nan, array), found


def _below_others(values: np.ndarray, marks: np.ndarray) -> np.ndarray:
    """Return which of the numbers `marks` (m,) are of :data:`LARGEST_OF_BITS` and no end of the values (m,)."""
    largest = np.max(values, where=np.isfinite(values) & ~marks, initial=-np.inf)
    return marks & np.isin(values, LARGEST_OF_BITS) & (values < largest)


def _among_others(values: np.ndarray, marks: np.ndarray) -> np.ndarray:
    """Return which of the numbers `marks` (m,) lie among the other values (m,) around them."""
    others = np.flatnonzero(np.isfinite(values) & ~marks)
    near = np.zeros(len(values), dtype=bool)
    if len(others) < 2:
        return near
    usual = np.quantile(np.abs(np.diff(values[others])), USUAL_CHANGE)
    place = np.flatnonzero(marks)
    after = np.searchsorted(others, place)
    before = values[others[np.maximum(after - 1, 0)]]
    following = values[others[np.minimum(after, len(others) - 1)]]
    near[place] = np.maximum(np.abs(before - values[place]), np.abs(following - values[place])) <= usual
    if not near.any():
        return near
    commonest = np.unique(values[others], return_counts=True)[1].max()
    for number in np.setdiff1d(values[near], LARGEST_OF_BITS):
        same = near & (values == number)
        if same.sum() > commonest:
            near &= ~same
    return near


def likely_unit(step: float | None, stated: str = "s") -> str:
    """Return the unit of time, another than the stated one, that a step would be that of a controller in.

    Where none is likely it is ms, or s.

    Parameters
    ----------
    step : [s] as read in the unit `stated`, None where it is not known.
    """
    sizes = sizes_of("time")
    counted = None if step is None else step / size_of("time", stated)
    # Spreadsheets count days.
    for unit in ("s", "ms", "us", "ns", "d", "h", "min"):
        if unit != stated and counted is not None and USUAL[0] <= counted * sizes[unit] <= USUAL[1]:
            return unit
    return "s" if stated == "ms" else "ms"


def _in_no_order(time: np.ndarray) -> bool:
    """Return whether times (m,) [s] lie in no order and would follow each other as samples do once they are sorted."""
    if np.mean(np.diff(time) < 0) < FALLING:
        return False
    steps = np.diff(np.unique(time))
    return len(steps) > 0 and bool(SHORTEST_STEP <= np.median(steps) <= LONGEST_STEP)


def check_clock(path: str | Path, time: np.ndarray, stated: str = "s") -> None:
    """Check that samples follow each other as those of a controller can, and that they are of one life of an arm.

    Parameters
    ----------
    time : (m,) [s]. stated : unit that the times were read in.

    Raises
    ------
    InputError : naming the file and the step or the time that is impossible.
    """
    known = time[np.isfinite(time)]
    steps = np.diff(known)
    step = float(np.median(steps[steps > 0])) if (steps > 0).any() else None
    if len(steps) and np.mean(steps < 0) > BACKWARDS:
        raise InputError(
            f"{path}: its rows run from the newest to the oldest; turn them round, as pandas does by "
            "table.sort_values(the column of the times)"
        )
    if step is not None and not SHORTEST_STEP <= step <= LONGEST_STEP:
        if _in_no_order(known):
            raise InputError(
                f"{path}: {np.mean(steps < 0):.0%} of its rows have an earlier time than the row before: they are out "
                "of order; sort them by time"
            )
        raise InputError(
            f"{path}: the time rises by {step:.3g} s from sample to sample (allowed: {SHORTEST_STEP:g} to "
            f"{LONGEST_STEP:g} s); state its unit, as units: {{time: {likely_unit(step, stated)}}}"
        )
    if len(known) and np.abs(known).max() > LATEST:
        raise InputError(
            f"{path}: the time reaches {known[np.argmax(np.abs(known))]:.3g} s (allowed: at most {LATEST:.0g} in "
            f"size); state its unit, as units: {{time: {likely_unit(step, stated)}}}"
        )
