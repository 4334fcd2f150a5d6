"""How a load at the flange is found in a window: moments and switch in turn; see :mod:`.carried`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from jointwear.measurement.derived.even_steps import steps_in

#: Rounds of finding switch and moments in turn; a few suffice, as each is a least-squares step.
ROUNDS = 12
#: Time [s] over which the switch is told from the residuals, and what is left out around it: a gripper needs as long.
SMOOTH, EDGE = 0.5, 0.3
#: Factor by which the variance left by the model must fall (geometric mean over the axes) for a load to be accepted,
#: and for one that waits for what other windows show (:mod:`.settled_loads`): half of what the model leaves.
VARIANCE_FALLS, HALVES = 4.0, 2.0
#: Fewest samples that show a load.
FEWEST_FOR_LOAD = 60
#: Time [s] over which a switch that is any number keeps its value, rounds of finding it, and what is added to its
#: normal equations, of their mean diagonal: the nuisances hardly tell a load that is carried throughout from none.
SEGMENT, RELAXED_ROUNDS, RELAXED_RIDGE = 1.0, 4, 1e-3
#: Time [s] of a window in which such a switch is looked for: the work grows with the square of the number of segments.
LONGEST = 60.0
#: Quantiles of the shares of the segments half way between which a load counts as carried.
OUTER = (0.1, 0.9)
#: Share of the residual (root mean square) below which gravity or inertia of the model could not matter even if all
#: wrong, and share of the largest torque of a unit load below which one of its moments is not seen: an axis on which
#: gravity does not act has nothing but round-off there.
NEGLIGIBLE, HIDDEN = 1e-3, 1e-4
#: What is added to the normal equations of the moments, their diagonal being one: moments that the motion hardly tells
#: apart stay small instead of turning on round-off.
RIDGE = 1e-8
#: Share of the largest gain of a switch that is round-off: where nothing moves, it must not say which way it turns.
ROUND_OFF = 1e-9
#: Rows of the regressors that are torques of the model.
_TORQUES = slice(3, 5)


@dataclass(frozen=True)
class Load:
    """A load that samples show.

    Attributes
    ----------
    moments : (4,) mass [kg] and first moments [kg m] in the frame of the flange. carried : (m,) bool.
    fall : log of the factor by which the variance falls, a mean over the samples of all axes.
    information : (4, 4) by how much less it falls for other moments, d: by d' information d.
    """

    moments: np.ndarray
    carried: np.ndarray
    fall: float
    information: np.ndarray

    @property
    def clear(self) -> bool:
        """Whether it explains most of what the model leaves."""
        return self.fall > np.log(VARIANCE_FALLS)


def find_load(
    residual: np.ndarray,
    columns: np.ndarray,
    unit: np.ndarray,
    used: np.ndarray,
    step: float,
    least: float = 0.0,
    falls: float = VARIANCE_FALLS,
) -> Load | None:
    """Return the load of one window, None where none explains the residual.

    Parameters
    ----------
    residual : (m, n) torque less that of the model. columns : (n, p, m) regressors of the nuisances.
    unit : (m, 4, n) torque of unit loads. used : (m, n) samples that count. step : [s] between samples.
    least : smallest mass [kg]. falls : factor by which the variance must fall.
    """
    rows = used.any(axis=1)
    axes = np.flatnonzero(used.sum(axis=0) >= FEWEST_FOR_LOAD)
    if rows.sum() < FEWEST_FOR_LOAD or not len(axes):
        return None
    on = used[:, axes].T.astype(float)
    raw = np.where(used, residual, 0.0)[:, axes].T
    bases = _bases([_that_matter(columns[j] * on[k], raw[k]) for k, j in enumerate(axes)])
    plain = _without(bases, raw[..., None])[..., 0]
    count = on.sum(axis=1)
    before = np.maximum((plain**2).sum(axis=1) / count, 1e-12)
    loads = unit[:, :, axes].transpose(2, 0, 1) * on[..., None]
    width = max(round(SMOOTH / step), 1)
    near = partial(_nearest, plain, loads, bases, count, before, width, least)
    found = near(_starts(plain, loads, before, width))
    if found is None or not found.clear:
        longest = round(LONGEST / step)
        if len(used) <= longest:
            starts = _relaxed_starts(plain, loads, bases, count, before, step)
        else:
            start = _start_from_stretch(residual, columns, unit, used, step, least, longest)
            starts = [] if start is None else [start]
        found = max((x for x in (found, near(starts)) if x is not None), key=lambda x: x.fall, default=None)
    return found if found is not None and found.fall > np.log(falls) else None


def _nearest(
    plain: np.ndarray,
    loads: np.ndarray,
    bases: np.ndarray,
    count: np.ndarray,
    before: np.ndarray,
    width: int,
    least: float,
    starts: Iterable[np.ndarray],
) -> Load | None:
    """Return the best load that is found from any of the switches (m,) of `starts`, None where none explains anything.

    Parameters
    ----------
    plain : (n, m) residual [N m] without the nuisances. loads : (n, m, 4) torque of unit loads. bases : (n, m, p) of
        the nuisances. count : (n,) samples. before : (n,) mean square of `plain`. width : of smoothing, in samples.
    """
    best = None
    for start in starts:
        carried, weight = start, 1.0 / before
        for _ in range(ROUNDS):
            shown = _without(bases, loads * carried[None, :, None])
            moments = _least_squares(shown, plain, weight)
            error = plain - shown @ moments
            after = np.maximum((error**2).sum(axis=1) / count, 1e-12)
            torque = loads @ moments
            fresh = _switch(torque, error + carried * torque, after, width)
            done = np.array_equal(fresh, carried)
            carried, weight = fresh, 1.0 / after
            if done or not carried.any():
                break
        fall = float(count @ np.log(before / after) / count.sum())
        if carried.any() and moments[0] > least and fall > (0.0 if best is None else best.fall):
            turned = shown.transpose(0, 2, 1) * weight[:, None, None]
            best = Load(moments, carried, fall, (turned @ shown).sum(axis=0) / count.sum())
    return best


def _least_squares(shown: np.ndarray, plain: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the moments (4,) that explain `plain` (n, m) by `shown` (n, m, 4); `weight` (n,) of the axes."""
    turned = shown.transpose(0, 2, 1) * weight[:, None, None]
    return _moments((turned @ shown).sum(axis=0), (turned @ plain[..., None]).sum(axis=0)[:, 0])


def _that_matter(columns: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Return the columns (p, m) of one axis, torques of the model that cannot matter set to zero."""
    kept = columns.copy()
    small = (columns[_TORQUES] ** 2).sum(axis=1) < NEGLIGIBLE**2 * (residual**2).sum()
    kept[_TORQUES][small] = 0.0
    return kept


def _moments(gram: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Return the moments (4,) of the normal equations; one that no axis shows is zero."""
    size = np.sqrt(gram.diagonal())
    seen = size > HIDDEN * size.max(initial=0.0)
    whole = seen.all()
    if not (whole or seen.any()):
        return np.zeros(len(size))
    scale = size if whole else np.where(seen, size, 1.0)
    inner = gram / (scale[:, None] * scale)
    aim = moment / scale
    if not whole:
        inner[~(seen[:, None] & seen)] = 0.0
        aim[~seen] = 0.0
    inner.flat[:: len(size) + 1] = 1.0 + RIDGE
    return np.linalg.solve(inner, aim) / scale


def _starts(plain: np.ndarray, loads: np.ndarray, variance: np.ndarray, width: int) -> list[np.ndarray]:
    """Switches (m,) to begin with: carried throughout, and where the residual looks like a mass."""
    inner = _positive(np.einsum("jm,jm->m", plain / variance[:, None], loads[..., 0]), width)
    return [np.ones(plain.shape[1], dtype=bool), inner]


def _relaxed_starts(
    plain: np.ndarray, loads: np.ndarray, bases: np.ndarray, count: np.ndarray, before: np.ndarray, step: float
) -> list[np.ndarray]:
    """Switches (m,) to begin with, one the other turned round: of a load carried by any share in each segment.

    Moments and shares are found in turn, either with the nuisances free; arrays as of :func:`_nearest`.
    """
    m = plain.shape[1]
    segments = max(round(m * step / SEGMENT), 2)
    segment = np.arange(m) * segments // m
    inside = np.eye(segments)[segment]
    share, weight = np.ones(segments), 1.0 / before
    for _ in range(RELAXED_ROUNDS):
        moments = _least_squares(_without(bases, loads * share[segment][None, :, None]), plain, weight)
        shown = _without(bases, (loads @ moments)[..., None] * inside)
        turned = shown.transpose(0, 2, 1) * weight[:, None, None]
        gram = (turned @ shown).sum(axis=0)
        mean = gram.trace() / segments
        if not mean > 0:
            return []
        gram.flat[:: segments + 1] += RELAXED_RIDGE * mean
        share = np.linalg.solve(gram, (turned @ plain[..., None]).sum(axis=0)[:, 0])
        weight = 1.0 / np.maximum(((plain - shown @ share) ** 2).sum(axis=1) / count, 1e-12)
    low, high = np.quantile(share, OUTER)
    carried = share[segment] > 0.5 * (low + high)
    return [carried, ~carried]


def _start_from_stretch(
    residual: np.ndarray,
    columns: np.ndarray,
    unit: np.ndarray,
    used: np.ndarray,
    step: float,
    least: float,
    longest: int,
) -> np.ndarray | None:
    """Return the switch (m,) that the load and the nuisances of the busiest stretch of a window speak for in all of it.

    None where the stretch shows no load. `longest` : its samples; the other arguments are those of :func:`find_load`.
    """
    begin = max(range(0, len(used), longest), key=lambda k: int(used[k : k + longest].sum()))
    own = slice(begin, begin + longest)
    load = find_load(residual[own], columns[:, :, own], unit[own], used[own], step, least)
    if load is None:
        return None
    torque = np.where(used, np.einsum("mkn,k->mn", unit, load.moments), 0.0)
    axes = np.flatnonzero(used[own].sum(axis=0) >= FEWEST_FOR_LOAD)
    torque, without = torque[:, axes].T, np.where(used, residual, 0.0)[:, axes].T
    for k, j in enumerate(axes):
        rest = without[k, own] - load.carried * torque[k, own]
        without[k] -= np.linalg.lstsq(columns[j][:, own].T, rest, rcond=1e-6)[0] @ columns[j]
    left = without[:, own] - load.carried * torque[:, own]
    variance = np.maximum((left**2).sum(axis=1) / used[own][:, axes].sum(axis=0), 1e-12)
    return _switch(torque, without, variance, max(round(SMOOTH / step), 1))


def _bases(columns: Sequence[np.ndarray]) -> np.ndarray:
    """Return orthonormal bases (n, m, p) of the spaces of columns (p, m), filled up with zeros."""
    stacked = np.stack(columns)
    size = np.sqrt((stacked**2).sum(axis=2, keepdims=True))
    shown = np.divide(stacked, size, out=np.zeros_like(stacked), where=size > 0).transpose(0, 2, 1)
    left, values, _ = np.linalg.svd(shown, full_matrices=False)
    return left * (values > 1e-6)[:, None, :]


def _without(bases: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values (n, m, k) less their part in the spaces of `bases` (n, m, p)."""
    return values - bases @ (bases.transpose(0, 2, 1) @ values)


def _switch(torque: np.ndarray, without: np.ndarray, variance: np.ndarray, width: int) -> np.ndarray:
    """Return where (m,) a load is likelier carried than not, over `width` samples and all axes together.

    Parameters
    ----------
    torque : (n, m) of the load [N m]. without : (n, m) what is left where none is carried [N m]. variance : (n,) of it.
    """
    return _positive((torque * (2 * without - torque) / variance[:, None]).sum(axis=0), width)


def _positive(gain: np.ndarray, width: int) -> np.ndarray:
    """Return where a gain (m,), smoothed, speaks for the load: nothing but round-off speaks for neither."""
    smooth = _smooth(gain, width)
    return smooth > ROUND_OFF * np.abs(smooth).max(initial=0.0)


def _smooth(values: np.ndarray, width: int) -> np.ndarray:
    # A piece beside a hole may be shorter than what is smoothed over: `same` would return the longer of the two.
    begin = (width - 1) // 2
    return np.convolve(values, np.ones(width))[begin : begin + len(values)]


def near_switch(carried: np.ndarray, step: float) -> np.ndarray:
    """Return the samples (m,) within :data:`EDGE` of picking up or putting down."""
    turn = np.concatenate([[False], carried[1:] != carried[:-1]])
    return _smooth(turn.astype(float), 2 * steps_in(EDGE, step) + 1) > 0.5
