"""A changed scale of the measured torque: gain of a current sensor, a unit, a torque constant.

Wear leaves the torque that moves the rigid bodies as it is; a changed scale multiplies it by the same factor as the
friction. The share by which gravity and inertial torque together differ from the model's is held against its own
normal state, as friction is; where friction steps and this share steps with it, the scale has changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.estimate import COLUMNS, Sums, column_estimate
from jointwear.monitor.series import Series
from jointwear.monitor.watching import Watch

#: A scale explains growth where the growth is likelier as its step than as no step of it by this log likelihood ratio;
#: smallest step. Of a second axis the factors are alike within this share, a third contradicts that many errors off.
CLEAR, LEAST, ALIKE, AGAINST = 1.0, 0.01, 0.5, 2.5
_GRAVITY, _INERTIAL = COLUMNS.index("gravity"), COLUMNS.index("inertial")
#: Standard deviation of a window's scale above which it shows nothing.
COARSEST = 0.25


@dataclass(frozen=True)
class ScaleStep:
    """The scale of a 0-based `axis` changed by `factor` at `window`."""

    axis: int
    window: int
    factor: float


def scale_series(sums: Sums, pooled: np.ndarray) -> Series:
    """Return the log of the scale of the rigid-body torque, window by window; `pooled` (n,) noise variance [N2 m2]."""
    n = sums.gram.shape[-3]
    change = np.broadcast_to(np.eye(5), (n, 5, 5)).copy()
    change[:, _INERTIAL, _GRAVITY] = 1.0
    joined = Sums(
        np.einsum("nji,wnjk,nkl->wnil", change, sums.gram, change),
        np.einsum("nji,wnj->wni", change, sums.moment),
        sums.residual_square,
        sums.freedom,
        sums.usable,
    )
    free = np.ones((n, len(COLUMNS)), dtype=bool)
    free[:, _INERTIAL] = False
    value, variance = column_estimate(joined, np.zeros((n, len(COLUMNS))), free, pooled, _GRAVITY)
    with np.errstate(invalid="ignore"):
        known = (variance > 0) & (variance < COARSEST**2) & (value > -0.9)
        logs = np.where(known, np.log1p(np.where(known, value, 0.0)), np.nan)
    spread = np.where(known, variance / (1 + np.where(known, value, 0.0)) ** 2, np.nan)
    return Series(logs, spread, np.ones(n), np.ones(n))


def scale_steps(level: Watch, scale: Watch, shift: np.ndarray) -> list[ScaleStep]:
    """Return the first alarm or proposed service of each axis that a step of its scale explains.

    Where the scale of two axes steps at once, or the friction of another axis by as much, a common cause (unit, supply,
    cabinet) is likely: axes whose own scale says nothing against the same factor take it over.
    """
    found = []
    for j, axis in enumerate(level.axes):
        if axis is None or scale.axes[j] is None:
            continue
        hits = [(int(k), 1.0) for k in np.flatnonzero(level.alarm[:, j])[:1]]
        hits += [(s.window, -1.0) for s in level.starts[j] if s.proposed][:1]
        for k, sign in sorted(hits):
            begin = k if sign < 0 else _begin(k, int(level.shifts[k, j]), shift)
            rows = slice(begin, k + 1) if sign > 0 else slice(k, _end(k, shift))
            step, error = _mean(scale, rows, j)
            size = float(level.mean[k, j]) if sign > 0 else step
            if np.isfinite(step) and sign * step > LEAST and _evidence(step, size, error) > CLEAR:
                found.append(ScaleStep(j, begin, float(np.exp(step))))
                break
    return found + _joined(found, level, scale, shift)


def _evidence(step: float, size: float, error: float) -> float:
    """Return the log likelihood ratio of a scale that stepped by `size` over one that stayed."""
    return (step**2 - (step - size) ** 2) / (2 * error**2)


def _joined(found: Sequence[ScaleStep], level: Watch, scale: Watch, shift: np.ndarray) -> list[ScaleStep]:
    more = []
    for one in found:
        near = [s for s in found if abs(int(shift[s.window]) - int(shift[one.window])) <= 1]
        near = [s for s in near if abs(np.log(s.factor / one.factor)) < ALIKE * abs(np.log(one.factor))]
        if one is not near[0]:
            continue
        size = float(np.mean([np.log(s.factor) for s in near]))
        for j, axis in enumerate(level.axes):
            if axis is None or any(s.axis == j for s in near):
                continue
            rows = slice(one.window, _end(one.window, shift))
            steps = [_mean(w, rows, j) for w in (scale, level) if w.axes[j] is not None]
            # One axis alone is no common cause, unless the friction of another steps with it by as much.
            if len(near) < 2 and not abs(steps[-1][0] - size) < ALIKE * abs(size):
                continue
            if all(not np.isfinite(step) or abs(step - size) < AGAINST * error for step, error in steps):
                more.append(ScaleStep(j, one.window, float(np.exp(size))))
    return more


def _begin(k: int, shifts: int, shift: np.ndarray) -> int:
    names = np.unique(shift[: k + 1])
    return int(np.argmax(shift == names[max(len(names) - max(shifts, 1), 0)]))


def _end(k: int, shift: np.ndarray) -> int:
    names = np.unique(shift[k:])[:3]
    return int(np.flatnonzero(shift == names[-1])[-1]) + 1


def _mean(scale: Watch, rows: slice, j: int) -> tuple[float, float]:
    """Return the mean of the scale over windows and its standard error, shifts counting as a whole."""
    value, variance = scale.residual[rows, j], scale.noise[rows, j]
    good = np.isfinite(value)
    if good.sum() < 2:
        return np.nan, np.inf
    weight = 1.0 / variance[good]
    axis = scale.axes[j]
    normal = float(np.nanmedian(axis.fit.left_out_variance))
    error = np.sqrt(1.0 / weight.sum() + axis.dispersion.between**2 / 2 + normal)
    return float(weight @ value[good] / weight.sum()), float(error)
