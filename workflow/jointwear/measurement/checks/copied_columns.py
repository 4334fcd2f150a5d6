"""Columns of one joint that stand under the name of another: a logger or an export wrote one of them twice."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from jointwear.files.wording import significant
from jointwear.measurement.checks.axes_check import explained
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.statistics.runs import runs

#: Share of the moving samples in which two columns agree from which one is a copy of the other, and that in which they
#: may agree at other times: coarse columns, and those that mostly keep one value, agree by chance.
COPIED, BY_CHANCE = 0.5, 0.1
#: Parts of the samples by which one column is moved on to ask how often they agree by chance, as a median: one of them
#: may be whole cycles of a motion.
MOVED = (0.29, 0.47, 0.71)
#: Samples of a piece that are looked at.
LOOK = 2000
#: What rounding leaves of a factor: steps of the digits that a column has, and a share of its values.
DIGITS, ROUNDED = 1.5, 1e-6
#: Steps of its digits that the values of a column spread over (standard deviation), at least, where it may be the other
#: one times a factor: coarser ones agree too easily.
FINE = 100.0
#: Share of the squared torque that the model leaves of one of the two joints, at least: simulated joints without noise
#: that are moved alike may have the same positions, and torques in proportion, and the model explains both.
UNEXPLAINED = 0.1


def check_columns_differ(measured: Measured, robot: Robot, name: str, records: bool = False) -> None:
    """Check that no joint has the torque or the position of another one, as it is or times a factor (torques alone).

    A velocity of another joint is told by the position that it belongs to.

    Parameters
    ----------
    name : of the data set or the log, for messages. records : each trajectory is asked as well.

    Raises
    ------
    Refused : with both joints, and the trajectory where it is one of several.
    """
    pieces = runs(measured.trajectory) if records else []
    labels = [int(measured.trajectory[piece.start]) for piece in pieces]
    _check(measured, robot, name)
    for label, piece in zip(labels, pieces, strict=True) if len(pieces) > 1 else ():
        _check(measured.part(piece), robot, name, label)


def _check(measured: Measured, robot: Robot, name: str, label: int | None = None) -> None:
    """Check one trajectory, or with no `label` all of them; see :func:`check_columns_differ`."""
    left: np.ndarray | None = None
    for role, values in (("torque", measured.torque), ("position", measured.position)):
        for i, j in combinations(range(robot.joints), 2):
            moving = measured.usable[:, i] | measured.usable[:, j]
            factor = _factor(values[:, i], values[:, j], moving, role == "torque")
            if factor is None:
                continue
            if left is None:
                thin = thinned(measured)
                left = np.nan_to_num(explained(Dynamics(robot), thin.parts, thin.usable))
            if not max(left[i], left[j]) > UNEXPLAINED:
                continue
            # The copy is the one that does not fit.
            copy, origin, times = (j, i, factor) if left[j] >= left[i] else (i, j, 1 / factor)
            multiple = "" if abs(times - 1.0) < ROUNDED else f"{significant(times)} times "
            where = "" if label is None else f"of trajectory {label} "
            otherwise = "" if label is None else "; or leave it out: name the others under 'train' and 'test'"
            raise Refused(
                f"{name}: the {role} of joint {copy + 1} is {multiple}that of joint {origin + 1} in most samples "
                f"{where}in which one of them moves; it looks like one column that was written twice",
                f"each joint needs a {role} of its own: name the right columns under 'variables', or export the log "
                f"again{otherwise}",
            )


def _factor(one: np.ndarray, other: np.ndarray, moving: np.ndarray, any_factor: bool) -> float | None:
    """Return the factor by which `other` (m,) is a copy of `one` (m,) in most of the `moving` (m,) samples; None where
    it is no copy."""
    rows = np.flatnonzero(moving & np.isfinite(one) & np.isfinite(other) & ((one != 0.0) | (other != 0.0)))
    if len(rows) < FEWEST_OF_JOINT:
        return None
    rows = rows[:: max(1, len(rows) // LOOK)]
    a, b = one[rows], other[rows]
    factor, within = 1.0, ROUNDED * np.abs(b)
    if not np.mean(np.abs(b - a) <= within) > COPIED:
        if not any_factor:
            return None
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = float(np.median(np.divide(b, a, where=a != 0.0, out=np.full(len(a), np.inf))))
        if not np.isfinite(factor) or factor == 0.0:
            return None
        # Nearly all pairs are told apart without a look at their digits.
        if not np.mean(np.abs(b - factor * a) <= within + 2 * DIGITS * np.std(b) / FINE) > COPIED:
            return None
        digits = _digits(b) + abs(factor) * _digits(a)
        if np.std(b) < FINE * digits:
            return None
        within = within + DIGITS * digits
        if not np.mean(np.abs(b - factor * a) <= within) > COPIED:
            return None
    chance = [np.mean(np.abs(b - factor * np.roll(a, int(part * len(a)))) <= within) for part in MOVED]
    return factor if np.median(chance) < BY_CHANCE else None


def _digits(values: np.ndarray) -> float:
    """Return the smallest step between the values of a column, 0 where it has one value alone."""
    steps = np.diff(np.unique(values))
    return float(steps.min(initial=np.inf)) if len(steps) else 0.0
