"""Later temperatures in another unit than those of the baseline, and thermometers that show none."""

from __future__ import annotations

from typing import Any

import numpy as np

from jointwear.files.wording import count, name_axes
from jointwear.measurement.units import UNITS
from jointwear.monitor.normal.conditions import SAME
from jointwear.monitor.normal.shifts import PAUSE_HOURS, running_sums
from jointwear.monitor.reading.after_baseline import after_baseline, before_baseline
from jointwear.monitor.reading.windows import WindowStatistics

#: Kinds of the findings.
UNIT, BROKEN = "temperature_unit", "thermometer"
#: Distance [K] from the temperatures of the baseline up to which weather and work may bring those of later windows.
NEAR = 15.0
#: Windows in another unit that are told: one is a reading gone wrong.
FEWEST_WINDOWS = 2
#: Windows in a row in which a thermometer shows one value, and pauses among them from which it came back as it was,
#: until it counts as stuck: a joint that works around the clock may keep its temperature within a degree for a week, so
#: that there more is asked.
STUCK, PAUSES = 8, 2
#: Multiple of the longest such run of the baseline: a coarse thermometer stays where it is for hours.
LONGER = 3
#: Without pauses: hours [h] of operation in a row at one value, and the multiple of the longest such run of the
#: baseline. A day brings all that hall and work do to a joint, if another thermometer of the robot has changed at this
#: share of its usual rate or more; where none has, a second day tells as a second pause does.
WHOLE_DAY, MANY_TIMES, AS_USUAL = 24.0, 10, 0.5


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
            there = (far & (value > low) & (value < high)).any(axis=1) & after_baseline(baseline)
            if unit == "degC" or there.sum() < FEWEST_WINDOWS:
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


def stuck(statistics: WindowStatistics, baseline: np.ndarray) -> np.ndarray:
    """Return the windows (w, n) of each axis by which its thermometer is known to have stopped at one value.

    One that shows one value throughout the baseline tells nothing from the start, and is no part of this.

    Parameters
    ----------
    baseline : (w,) bool.
    """
    result = np.zeros(statistics.temperature.shape, dtype=bool)
    hours = (statistics.end - statistics.start) / 3600.0
    for j in range(statistics.axes):
        rows = np.flatnonzero(np.isfinite(statistics.temperature[:, j]))
        if not len(rows):
            continue
        first, pauses = _begins(statistics.temperature[rows, j]), _pauses(statistics, rows)
        long = np.arange(len(rows)) - first + 1
        usual = long[baseline[rows]].max(initial=0)
        if usual < baseline[rows].sum():
            known = (long >= max(STUCK, LONGER * usual)) & (pauses - pauses[first] >= PAUSES)
            still, whole = running_sums(hours[rows], long == 1), _others_changed(statistics, baseline, rows, first, j)
            known |= (long >= MANY_TIMES * usual) & (still >= np.where(whole, 1, PAUSES) * WHOLE_DAY)
            result[rows[known], j] = True
    return result & after_baseline(baseline)[:, None]


def _others_changed(
    statistics: WindowStatistics, baseline: np.ndarray, rows: np.ndarray, first: np.ndarray, axis: int
) -> np.ndarray:
    """Return for each of the windows `rows` of `axis` whether, since the one at the place `first`, the thermometer of
    another axis has changed as it does in the baseline."""
    given = np.delete(statistics.temperature, axis, axis=1)[rows]
    with np.errstate(invalid="ignore"):
        new = np.abs(np.diff(given, axis=0, prepend=given[:1])) > SAME
    usual = new[baseline[rows]].mean(axis=0)
    changes, places = np.cumsum(new, axis=0), np.arange(len(rows))
    rate = (changes - changes[first]) / np.maximum(places - first, 1)[:, None]
    return ((usual > 0) & (rate >= AS_USUAL * usual)).any(axis=1)


def _pauses(statistics: WindowStatistics, rows: np.ndarray) -> np.ndarray:
    """Return for each of the windows `rows` how many pauses of the robot came before it."""
    pause = statistics.start[1:] - statistics.end[:-1] > PAUSE_HOURS * 3600.0
    return np.concatenate([[0], np.cumsum(pause)])[rows]


def _begins(values: np.ndarray) -> np.ndarray:
    """Return for each value (w,) where the run of equal ones begins that it is in."""
    new = np.abs(np.diff(values, prepend=np.nan)) > SAME
    return np.maximum.accumulate(np.where(new, np.arange(len(values)), 0))


def broken(statistics: WindowStatistics, baseline: np.ndarray) -> list[dict[str, Any]]:
    """Return findings on thermometers that show no temperature: one value for days, or one that no joint has.

    Parameters
    ----------
    baseline : (w,) bool.
    """
    given, stopped = statistics.temperature, stuck(statistics, baseline)
    known = np.isfinite(given) & ~before_baseline(baseline)[:, None]
    with np.errstate(invalid="ignore"):
        spread = np.array([np.ptp(t[k & baseline]) if _enough(statistics, k & baseline) else np.inf
                           for t, k in zip(given.T, known.T, strict=True)])  # fmt: skip
        usual = np.array([[np.min(t[k & baseline], initial=np.inf), np.max(t[k & baseline], initial=-np.inf)]
                          for t, k in zip(given.T, known.T, strict=True)])  # fmt: skip
        far = known & ((given < usual[:, 0] - NEAR) | (given > usual[:, 1] + NEAR)) & np.isfinite(usual).all(axis=1)
    constant = np.isfinite(spread) & (spread <= SAME)
    result = []
    if constant.any():
        same = np.where(known & constant & baseline[:, None], given, np.nan)
        words = (
            f"The thermometer of {{axes}} shows {_values(same)} degC throughout the normal period: not connected, "
            "or stuck. These axes are judged as if no temperature were logged, also once it is mended, until a normal "
            "period with it is stated; mend it, or leave its column out."
        )
        result.append(_told(statistics, known & constant, words))
    stopped &= ~constant
    if stopped.any():
        words = (
            f"The thermometer of {{axes}} has stopped at {_values(np.where(stopped, given, np.nan))} degC, day after "
            "day, unlike before: it is stuck or lost. Without it friction of these axes cannot be told from warming, "
            "and is not judged there; mend it."
        )
        result.append(_told(statistics, stopped, words))
    far &= ~stopped & ~constant
    if far.any(axis=1).sum() >= FEWEST_WINDOWS and not other_unit(statistics, baseline):
        words = (
            f"The thermometer of {{axes}} shows {_values(np.where(far, given, np.nan))} degC, more than {NEAR:.0f} K "
            "from all that it showed in the normal period: not connected, a fault, or another sensor. If it is right, "
            "these axes are judged once shifts have taught what that does; else mend it, or leave these values out."
        )
        result.append(_told(statistics, far, words))
    return result


def _enough(statistics: WindowStatistics, where: np.ndarray) -> bool:
    """Return whether a working thermometer would have changed in the windows `where` (w,)."""
    rows = np.flatnonzero(where)
    return len(rows) >= STUCK and bool(np.ptp(_pauses(statistics, rows)) >= PAUSES)


def _values(given: np.ndarray) -> str:
    """Return the range of finite temperatures in words."""
    low, high = np.nanmin(given), np.nanmax(given)
    return f"{low:.3g}" if high - low <= SAME else f"{low:.3g} to {high:.3g}"


def _told(statistics: WindowStatistics, where: np.ndarray, words: str) -> dict[str, Any]:
    """Return a finding on the windows and axes `where` (w, n); `words` with a place for the axes."""
    rows, axes = np.flatnonzero(where.any(axis=1)), (np.flatnonzero(where.any(axis=0)) + 1).tolist()
    told = "all axes" if len(axes) == statistics.axes else name_axes(axes)
    begin, end = float(statistics.start[rows[0]]), float(statistics.end[rows[-1]])
    return {"time": begin, "end": end, "axes": axes, "kind": BROKEN, "words": words.format(axes=told)}
