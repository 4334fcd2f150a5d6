"""Rows that were not measured: a logger wrote once more what it had written before while the robot moved on, or values
on the straight line to the next that it had."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused

#: Encoder steps that a joint makes in each row, at least, where a row that repeats the one before is none of motion.
STEPS = 2.0
#: Share of the usual step of a column by which steps of a straight line may differ: what rounding leaves of them.
ROUNDED = 1e-4
#: Share of the changes of a torque that follow on repeated values from which the torque is held, and up to which those
#: of the other joints are not: measured torques of fine digits have next to none.
HELD, OTHERS = 0.5, 0.1
#: Values of its own that a held torque passes over from one value to the next, in the median: it stood still meanwhile.
#: One that repeats because its digits are coarse goes to the next value, or the one after.
PASSED = 3.0
#: Share of its changes from which a torque takes new values, and least step between two of them, as a share of the
#: usual one, from which they lie on a grid.
NEW, GRID = 0.8, 0.1
#: Changes of a torque that tell whether it is held in a part of samples in which it is.
FEWEST_OF_PART = 4


def check_rows_are_new(samples: Chunk | Recording, stretch: np.ndarray, name: str) -> None:
    """Check that rows of fast motion are measured anew: one that repeats position and torque of all joints, or goes on
    with the steps of all of them, is not; nor is one that repeats the torques of all joints, or the position of one
    whose velocity is derived from it.

    A joint that has made many of its smallest steps from one change to the next has passed some in every row between.
    No torque is so smooth, nor its noise so small, that the torques of all joints change by the same as in the row
    before.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to.

    Raises
    ------
    Refused : where rows repeat, or go on, before more than half of the changes, with the time from one to the next.
    """
    if len(samples.time) < FEWEST_OF_JOINT:
        return
    with np.errstate(invalid="ignore"):
        steps = _steps(samples)
        drawn = _goes_on(steps, samples.torque.shape[1], stretch)
    n = samples.position.shape[1]
    told = "rows repeat the positions and torques of all joints or lie on a straight line"
    _check(samples, stretch, name, steps, n, drawn, told)
    _check(samples, stretch, name, steps[:, n:], n, None, "rows repeat the torques of all joints")
    if samples.velocity is None:
        for j in range(n):
            _check(samples, stretch, name, steps[:, j : j + 1], 1, None, f"rows repeat the position of joint {j + 1}")


def _check(
    samples: Chunk | Recording,
    stretch: np.ndarray,
    name: str,
    steps: np.ndarray,
    moving: int,
    drawn: np.ndarray | None,
    words: str,
) -> None:
    """Check the `steps` (m - 1, k) of some columns, of which the first `moving` tell fast motion; `drawn` (m - 1,) is
    where a row goes on by the steps of the row before."""
    same = np.diff(stretch) == 0
    changed = np.any(steps != 0.0, axis=1) | ~same
    if drawn is not None:
        first = np.argmax(changed) + 1
        changed[first:] &= ~drawn[first:]
    # Row k + 1 against row k: rows since the change before, the change itself included.
    places = np.flatnonzero(changed)
    if len(places) < 2:
        return
    rows = np.diff(places, prepend=places[0] - 1)
    if 2 * (rows > 1).sum() <= FEWEST_OF_JOINT:
        return  # too few rows repeat to be half of those that are looked at
    inside, moved = same[places], np.abs(steps[:, :moving])
    smallest = np.where(moved > 0.0, moved, np.inf).min(axis=0)
    since = np.diff(np.cumsum(np.nan_to_num(moved), axis=0)[places], axis=0, prepend=np.nan_to_num(moved[places[:1]]))
    fast = inside & (np.nanmax(since / smallest, axis=1) > STEPS * rows)
    if fast.sum() < FEWEST_OF_JOINT:
        return
    repeated = float(np.mean(rows[fast] > 1))
    if repeated > 0.5:
        held = float(np.median(np.diff(samples.time))) * float(np.median(rows[fast]))
        raise Refused(
            f"{name}: while joints move fast, {words}, before {100 * repeated:.0f} % of the rows with new values; the "
            f"logger holds or interpolates them, for about {held:.2g} s",
            "write each value once, at the time at which it was measured, and not on a faster grid",
        )


def check_torques_are_new(
    samples: Chunk | Recording,
    measured: Measured,
    stretch: np.ndarray,
    name: str,
    records: bool = False,
    part: bool = False,
) -> None:
    """Check that no single joint has a torque from a slower source, or one that was logged at large changes alone,
    while the torques of most others are measured anew in each row.

    Parameters
    ----------
    measured : motion along the samples, or a part of them. stretch : (m,) label of the uninterrupted run that each
        sample belongs to. records : each run is asked as well. part : the samples are a part of others that were
        refused for it: few changes are enough.

    Raises
    ------
    Refused : with the joint, and the run where it is one of several.
    """
    if not records:
        _check_torques(samples.torque, samples.time, _moving(samples.time, measured), stretch, name, "", part)
        return
    # Each trajectory may have a time of its own.
    labels, moving = np.unique(stretch), np.zeros(samples.torque.shape, bool)
    for label in labels:
        there, known = stretch == label, measured.trajectory == label
        record = replace(measured, time=measured.time[known], usable=measured.usable[known])
        moving[there] = _moving(samples.time[there], record)
    _check_torques(samples.torque, samples.time, moving, stretch, name, "")
    for label in labels if len(labels) > 1 else ():
        there, where = stretch == label, f" of trajectory {label}"
        _check_torques(samples.torque[there], samples.time[there], moving[there], stretch[there], name, where)


def _moving(time: np.ndarray, measured: Measured) -> np.ndarray:
    """Return where joints move (m, n) at times (m,), of which `measured` may hold some alone."""
    if not len(measured.time):
        return np.zeros((len(time), measured.usable.shape[1]), bool)
    at = np.clip(np.searchsorted(measured.time, time, side="right") - 1, 0, len(measured.time) - 1)
    within = (time >= measured.time[0]) & (time <= measured.time[-1])
    return measured.usable[at] & within[:, None]


def _check_torques(
    torque: np.ndarray,
    time: np.ndarray,
    moving: np.ndarray,
    stretch: np.ndarray,
    name: str,
    where: str,
    part: bool = False,
) -> None:
    """Check torques (m, n) in samples in which their joints are `moving` (m, n); see :func:`check_torques_are_new`."""
    held = np.full(torque.shape[1], np.nan)
    lasts, fine = held.copy(), np.zeros(len(held), bool)
    same = np.diff(stretch) == 0
    for j, values in enumerate(torque.T):
        with np.errstate(invalid="ignore"):
            places = np.flatnonzero((np.diff(values) != 0.0) | ~same)
        rows = np.diff(places, prepend=-1)
        kept = (moving[:-1, j] & moving[1:, j] & same & np.isfinite(values[:-1]) & np.isfinite(values[1:]))[places]
        if kept.sum() < (FEWEST_OF_PART if part else FEWEST_OF_JOINT):
            continue
        held[j], lasts[j] = np.mean(rows[kept] > 1), np.median(rows[kept])
        if held[j] > HELD:
            fine[j] = part or _has_fine_digits(values, places[kept])
    for j in np.flatnonzero((held > HELD) & fine):
        others = np.delete(held, j)
        if not np.isfinite(others).any() or np.nanmedian(others) > OTHERS:
            continue
        seconds = float(np.median(np.diff(time))) * lasts[j]
        raise Refused(
            f"{name}: rows repeat the torque of joint {j + 1}{where} before {100 * held[j]:.0f} % of its changes in "
            "motion, and the torques of the other joints are new in each row; it comes from a slower source, or was "
            f"logged at large changes alone, and is held for about {seconds:.2g} s",
            f"log the torque of joint {j + 1} as often as those of the others, and as it is measured",
        )


def _has_fine_digits(values: np.ndarray, places: np.ndarray) -> bool:
    """Return whether a torque (m,) repeats though its digits are fine: at the changes (k,) after `places` it passes
    over others of its values, or mostly takes new ones, which lie on no grid."""
    known = np.isfinite(values)
    own, order = np.unique(values[known], return_inverse=True)
    rank = np.zeros(len(values))
    rank[known] = order
    if np.median(np.abs(np.diff(rank))[places]) >= PASSED:
        return True
    gaps = np.diff(own)
    return bool(len(np.unique(values[places + 1])) > NEW * len(places) and gaps.min() < GRID * np.median(gaps))


def without_lines(samples: Chunk, stretch: np.ndarray) -> Chunk:
    """Return samples without the positions of rows on straight lines, which somebody drew through a hole of the log.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to.
    """
    if len(samples.time) < FEWEST_OF_JOINT:
        return samples
    with np.errstate(invalid="ignore"):
        drawn = np.concatenate([_goes_on(_steps(samples), samples.torque.shape[1], stretch), [False]])
    # Row k lies between two like steps, the one to it and the one from it.
    return replace(samples, position=np.where(drawn[:, None], np.nan, samples.position)) if drawn.any() else samples


def _steps(samples: Chunk | Recording) -> np.ndarray:
    """Return the steps of positions and torques from row to row, (m - 1, 2 n), each column in one piece: what is asked
    of all columns of a row is then several times as fast."""
    return np.diff(np.concatenate([samples.position.T, samples.torque.T]), axis=1).T


def _goes_on(steps: np.ndarray, joints: int, stretch: np.ndarray) -> np.ndarray:
    """Return where a row (m - 1,) goes on by the `steps` (m - 1, 2 n) of the row before, in all positions and torques.

    Parameters
    ----------
    joints : columns of torques, the last ones; half of them have to change, as coarse ones seldom do. stretch : (m,).
    """
    on = np.diff(stretch) == 0
    on[:1] = False
    on &= (steps[:, -joints:] != 0).sum(axis=1) >= max(joints / 2, 1)
    # Mostly the largest step, which takes less time than the usual one, tells that there is no such row.
    for usual_of in (_largest, _usual):
        for column in steps.T[::-1]:
            if not on.any():
                return on
            on[1:] &= np.abs(np.diff(column)) <= ROUNDED * usual_of(np.abs(column))
    return on


def _largest(size: np.ndarray) -> float:
    return float(size.max(where=size > 0, initial=0.0))


def _usual(size: np.ndarray) -> float:
    return float(np.median(size[size > 0])) if (size > 0).any() else 0.0
