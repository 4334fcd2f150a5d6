"""When to alarm: the growth of one axis over its last shifts against what shifts of normal operation do.

At every window, for the last K = 1 ... 6 shifts (the running one as far as it goes), z_K is the generalised
least-squares mean of the residuals of these shifts less :data:`TOLERATED`, over its standard error. The covariance
holds the windows' noise, the variance between shifts, and the error of the normal state, which all shifts share; each
shift counts by how far off the other axes are in it (:mod:`.shift_scale`). An axis alarms where

- the largest z_K over K >= 2 exceeds the threshold, the last two shifts both exceed :data:`TOLERATED` and the newest
  lies nearer to the mean than to what is normal, or
- they do, and the last K shifts less those before them exceed a threshold of their own (friction that fell since the
  baseline, by running in, hides wear that begins from there; what is not known of the normal state they share) while
  their mean lies above normal by more than its error (friction that dipped and came back is as it was), or
- z_1 does in a shift of at least :data:`STEP_WINDOWS` windows that exceeds :data:`STEP`: a large step is told at once,
  unless all axes move together in that shift: what one of them has beyond the others is then weather too.

Growth that asks nobody to act yet (:data:`LEAST` of the limit) has to be clearer: its z counts by :data:`DOUBT` less.

A fall is the same with the sign turned; as nothing wears that falls, it waits for :data:`FALLEN` shifts, the newest of
them with as many windows as a large step takes, or as the shift before had. The threshold is that of
:mod:`.null_runs`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointwear.monitor.normal.normal_state import Posterior
from jointwear.monitor.normal.recent_shifts import BACK, AxisWindows, RecentShifts, recent_shifts

#: Shifts looked back at; growth that is tolerated; growth and windows of a large step.
SHIFTS, TOLERATED, STEP, STEP_WINDOWS = 6, 0.001, 0.025, 6
#: Share of the limit below which growth asks nobody to act, as the friction of healthy axes wanders by as much over
#: days, and what z is divided by there.
LEAST, DOUBT = 0.1, 1.5
#: Growth up to which friction that had alarmed counts as back to normal.
NORMAL = 0.002
#: Fewest shifts before the last ones that these are held against, and standard errors by which the last ones lie above
#: normal themselves: by fewer it may be the shifts before that were off, in the cold or under another load. More would
#: hide wear on an axis whose normal state is hardly known, which the shifts before and the last ones share.
FEWEST_BEFORE, ABOVE = 3, 1.0
#: Last shifts that must all lie below for a fall.
FALLEN = 3


@dataclass(frozen=True)
class Evidence:
    """Of one axis, (w,): `growth` and `fall`, the largest admitted z (-inf where none is); `step`, the same of the last
    shifts less those before; `mean`, `std` of the generalised least-squares mean that `growth` (or, where larger,
    `fall`) comes from; `shifts` of that mean."""

    growth: np.ndarray
    fall: np.ndarray
    step: np.ndarray
    mean: np.ndarray
    std: np.ndarray
    shifts: np.ndarray

    def at_most(self, other: Evidence, rows: np.ndarray) -> Evidence:
        """Return it with what speaks for growth in windows `rows` (w,) bool no larger than that of another one."""
        growth, step = (
            np.where(rows, np.minimum(own, of), own)
            for own, of in ((self.growth, other.growth), (self.step, other.step))
        )
        return replace(self, growth=growth, step=step)

    def without_steps(self, rows: np.ndarray) -> Evidence:
        """Return it with nothing that the last shifts less those before speak for in windows `rows` (w,) bool."""
        return replace(self, step=np.where(rows, -np.inf, self.step))

    def with_falls(self, other: Evidence) -> Evidence:
        """Return it with the falls of another one, and the mean that these come from where they are the larger."""
        lower = other.fall > self.growth
        rest = {name: np.where(lower, getattr(other, name), getattr(self, name)) for name in ("mean", "std", "shifts")}
        return replace(self, fall=other.fall, **rest)


def shift_evidence(windows: AxisWindows, normal: Sequence[Posterior], memory: float, least: float = 0.0) -> Evidence:
    """Return the evidence at every window.

    Parameters
    ----------
    windows : a fall counts in shifts that mostly are `inside`; one shift is no large step where it is not `calm`.
    normal : normal states. memory : lag-1 correlation of windows within a shift. least : growth from which on somebody
    has to act, as a log.
    """
    recent = recent_shifts(windows, normal, memory)
    told = recent.judged[:, None] & recent.known[:, :SHIFTS]
    mean, std = _common_means(recent, told)
    up, down = _admitted(recent, mean, windows.calm)
    growth = np.where(told & up, _counted(mean, std, least), -np.inf)
    fall = np.where(told & down, (-mean - TOLERATED) / std, -np.inf)
    either = np.maximum(growth, fall)
    # Where neither is admitted, the mean of most shifts is told.
    best = np.where(np.isfinite(either.max(axis=1)), either.argmax(axis=1), told.sum(axis=1) - 1)
    row = np.arange(len(best))
    return Evidence(
        growth.max(axis=1),
        fall.max(axis=1),
        np.where(mean > ABOVE * std, _steps(recent, least), -np.inf).max(axis=1),
        np.where(best < 0, 0.0, mean[row, best]),
        np.where(best < 0, np.inf, std[row, best]),
        best + 1,
    )


def _common_means(recent: RecentShifts, told: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the generalised least-squares means (w, SHIFTS) of the last K shifts where `told` (w, SHIFTS), and errors.

    Elsewhere they are 0 and infinite.
    """
    mean, std = np.zeros(told.shape), np.full(told.shape, np.inf)
    covariance = recent.covariance(np.arange(len(told)), SHIFTS)
    for k in range(1, SHIFTS + 1):
        rows = np.flatnonzero(told[:, k - 1])
        solved = np.linalg.solve(covariance[rows, :k, :k], np.ones((len(rows), k, 1)))[..., 0]
        information = solved.sum(axis=1)
        mean[rows, k - 1] = np.einsum("wk,wk->w", solved, recent.residual[rows, :k]) / information
        std[rows, k - 1] = 1.0 / np.sqrt(information)
    return mean, std


def _counted(growth: np.ndarray, error: np.ndarray, least: float) -> np.ndarray:
    """Return what z of growth counts, of arrays of one shape: less up to `least`."""
    return (growth - TOLERATED) / (error * np.where(growth > least, 1.0, DOUBT))


def _admitted(recent: RecentShifts, mean: np.ndarray, calm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which means (w, SHIFTS) may speak for growth, and which for a fall.

    Parameters
    ----------
    calm : (w,) bool, where one shift may be a large step.
    """
    up = np.repeat(_both_up(recent)[:, None], SHIFTS, axis=1)
    # Growth lasts too: its newest shift lies nearer to it than to what is normal.
    up &= 2 * recent.residual[:, :1] >= mean
    up[:, 0] = (recent.count[:, 0] >= STEP_WINDOWS) & calm & (mean[:, 0] > STEP)
    low = recent.residual[:, :FALLEN]
    lie_below = (recent.known[:, :FALLEN] & recent.usual[:, :FALLEN] & (low < -TOLERATED)).all(axis=1)
    # A fall lasts: each of its shifts lies nearer to it than to what is normal, the newest by more than a few windows.
    lie_below &= recent.count[:, 0] >= np.minimum(STEP_WINDOWS, recent.count[:, 1])
    down = lie_below[:, None] & (2 * low[:, None, :] < mean[:, :, None]).all(axis=2)
    down[:, 0] = False
    return up, down


def _both_up(recent: RecentShifts) -> np.ndarray:
    """Return whether the last two shifts (w,) both exceed :data:`TOLERATED`."""
    return (recent.known & (recent.residual > TOLERATED))[:, :2].all(axis=1)


def _steps(recent: RecentShifts, least: float) -> np.ndarray:
    """Return z (w, SHIFTS) of the last K shifts less those before them; -inf where the last two are not both up.

    `least` : as of :func:`shift_evidence`.
    """
    result = np.full((len(recent.count), SHIFTS), -np.inf)
    enough = recent.known.sum(axis=1) >= 2 + FEWEST_BEFORE
    rows = np.flatnonzero(recent.judged & _both_up(recent) & enough)
    if not len(rows):
        return result
    known = recent.known[rows]
    precision = np.linalg.inv(recent.covariance(rows, BACK))
    moment = np.einsum("wij,wj->wi", precision, np.where(known, recent.residual[rows], 0.0))
    for k in range(2, SHIFTS + 1):
        old = known[:, k:].sum(axis=1) >= FEWEST_BEFORE
        a, b, d = (precision[:, i, j].sum(axis=(1, 2)) for i, j in _blocks(k))
        p, q = moment[:, :k].sum(axis=1), moment[:, k:].sum(axis=1)
        determinant = a * d - b**2
        difference = (d * p - b * q - a * q + b * p) / determinant
        error = np.sqrt((a + 2 * b + d) / determinant)
        result[rows, k - 1] = np.where(old, _counted(difference, error, least), -np.inf)
    return result


def _blocks(k: int) -> tuple[tuple[slice, slice], ...]:
    """Return the blocks of the last `k` shifts, of these and those before, and of those before."""
    new, old = slice(0, k), slice(k, None)
    return (new, new), (new, old), (old, old)
