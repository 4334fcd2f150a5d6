"""What of the growth of an axis is viscous: one name for an episode, from all of its shifts that are known.

An episode is what follows the first alarm of the level up to the next start (an event, a proposed service). Of each of
its shifts the growth t of the level and the viscous part p of the same windows are known, both over the friction of
the baseline. The viscous share of the growth is the slope of p over t through the origin. How far p of a shift is to
be trusted is told by what it did in the shifts before the episode, when nothing wore.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.dispersion import inflated
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.watching.watching import Watch

#: Viscous friction is named where it makes up at least this share of the growth, this many standard deviations clear.
VISCOUS_PART, VISCOUS_CLEAR = 0.5, 2.0
#: Fewest shifts before an episode that tell how far the viscous part wanders by itself.
FEWEST_BEFORE = 3
#: Smallest share of viscous friction in the baseline that its growth is told against: of less, percents say nothing.
LEAST_VISCOUS = 0.05


@dataclass(frozen=True)
class ShiftMeans:
    """Means of shifts of one axis, arrays (s,): `shift` label, `time` [s] middle of their ends, `value` and `variance`
    of the residual, the latter without the error of the normal state, which all shifts share."""

    shift: np.ndarray
    time: np.ndarray
    value: np.ndarray
    variance: np.ndarray


def shift_means(watched: Watch, j: int, rows: np.ndarray, shift: np.ndarray, end: np.ndarray) -> ShiftMeans:
    """Return the means of the shifts of axis `j` over windows `rows` (w,) bool; `end` (w,) [s] of the windows."""
    axis = watched.axes[j]
    rows = rows & np.isfinite(watched.residual[:, j])
    names = np.unique(shift[rows])
    found = np.full((len(names), 3), np.nan)
    for k, s in enumerate(names):
        own = rows & (shift == s)
        weight = 1.0 / watched.noise[own, j]
        noise = float(inflated(own.sum(), axis.dispersion.memory)) / weight.sum()
        mean = float(weight @ watched.residual[own, j] / weight.sum())
        found[k] = np.mean(end[own]), mean, noise + axis.dispersion.between**2
    return ShiftMeans(names, *found.T)


def normal_error(watched: Watch, j: int) -> float:
    """Return the standard deviation of the normal state of axis `j`, which all of its shifts share."""
    left = watched.axes[j].fit.left_out_variance
    return float(np.sqrt(np.nanmedian(left))) if np.isfinite(left).any() else 0.0


def episode_parts(level: Watch, j: int, shift: np.ndarray) -> list[tuple[slice, slice]]:
    """Return the episodes of the 0-based axis `j`, each with the windows since the start before it.

    An episode begins with the first shift that its first alarm rests on. `shift` (w,) labels.
    """
    result = []
    for a, b in itertools.pairwise([0, *sorted({s.window for s in level.starts[j] if s.grown is None}), len(shift)]):
        hits = a + np.flatnonzero(level.alarm[a:b, j])
        if len(hits):
            names = np.unique(shift[a : hits[0] + 1])
            first = names[max(len(names) - max(int(level.shifts[hits[0], j]), 1), 0)]
            begin = a + int(np.argmax(shift[a:b] == first))
            result.append((slice(begin, b), slice(a, begin)))
    return result


def viscous_scale(share: float) -> float:
    """Return the growth of viscous friction over its baseline for one unit over all friction of the baseline.

    `share` : of Coulomb friction in that. At least :data:`LEAST_VISCOUS` counts as viscous.
    """
    return 1.0 / max(1.0 - share, LEAST_VISCOUS)


def wander(before: ShiftMeans) -> float:
    """Return the variance of the viscous part of a shift of an axis that is not worn, 0 where few shifts tell."""
    return float(np.mean(before.value**2)) if len(before.value) >= FEWEST_BEFORE else 0.0


def viscous_share(growth: ShiftMeans, part: ShiftMeans, before: ShiftMeans, shared: float) -> tuple[float, float]:
    """Return the viscous share of the growth over the shifts of an episode, and its standard error; NaN where unknown.

    Parameters
    ----------
    growth : of the level, over the friction of the baseline. part : viscous, of the episode; before : ahead of it.
    shared : standard deviation of the error that the viscous part has in all shifts.
    """
    _, a, b = np.intersect1d(growth.shift, part.shift, return_indices=True)
    t, p, variance = growth.value[a], part.value[b], np.maximum(part.variance[b], wander(before))
    size = float(np.sum(t**2 / variance))
    if not size > 0:
        return np.nan, np.nan
    common = float(np.sum(t / variance)) / size * shared
    slope = float(np.sum(t * p / variance)) / size
    # Shifts that differ by more than they should make the slope less sure (Birge 1932).
    scatter = float(np.sum((p - slope * t) ** 2 / variance)) / max(len(t) - 1, 1)
    return slope, float(np.hypot(np.sqrt(max(scatter, 1.0) / size), common))


@dataclass(frozen=True)
class ViscousGrowth:
    """What of the growth of an axis is viscous, arrays (w,): `named`, in episodes of viscous friction; `taken` and
    `error`, the share of the growth of the level in other episodes and its standard error, 0 where none is known."""

    named: np.ndarray
    taken: np.ndarray
    error: np.ndarray


def viscous_growth(level: Watch, viscous: Watch, j: int, shift: np.ndarray, share: float) -> ViscousGrowth:
    """Return what of the growth of axis `j` is viscous, episode by episode.

    Parameters
    ----------
    share : of Coulomb friction in the friction of the baseline.
    """
    w = len(shift)
    named, taken, uncertain = np.zeros(w, dtype=bool), np.zeros(w), np.zeros(w)
    axis = level.axes[j]
    if axis is None or viscous.axes[j] is None:
        return ViscousGrowth(named, taken, uncertain)
    scale = 1.0 if axis.source == "friction" else share
    place, after = np.arange(w), after_baseline(level.baseline)
    for episode, before in episode_parts(level, j, shift):
        inside, ahead = ((place >= s.start) & (place < s.stop) & after for s in (episode, before))
        means = shift_means(level, j, inside, shift, place)
        growth = ShiftMeans(means.shift, means.time, scale * np.expm1(means.value), means.variance)
        parts = [shift_means(viscous, j, rows, shift, place) for rows in (inside, ahead)]
        found, error = viscous_share(growth, *parts, normal_error(viscous, j))
        named[episode] = found > max(VISCOUS_PART, VISCOUS_CLEAR * error)
        if not named[episode.start] and found > VISCOUS_CLEAR * error:
            # Of a share that is hardly known less is taken than found (James and Stein 1961).
            in_level = scale * axis.of_viscous
            taken[episode] = min(in_level * (found - (VISCOUS_CLEAR * error) ** 2 / found), 1.0)
            uncertain[episode] = in_level * error
    return ViscousGrowth(named, taken, uncertain)


def viscous_part(
    level: Watch, viscous: Watch, j: int, shift: np.ndarray, grown: ViscousGrowth
) -> tuple[np.ndarray, np.ndarray]:
    """Return the part (w,) of the growth of the level of axis `j` that is viscous, and its error, both 0 without any.

    What a level holds of viscous friction, or takes of it, is no growth of Coulomb friction: in episodes of viscous
    friction what the same window shows of it is told apart (its shift, where the window shows none; else the shift
    before), in others the share that the whole episode shows. A level that leaves viscous friction out as it was is not
    known in episodes of viscous friction, as what it takes would be most of its growth: NaN.

    Parameters
    ----------
    grown : of the axis, of :func:`viscous_growth`.
    """
    growth, named = np.expm1(level.residual[:, j]), grown.named
    shared, doubt = (np.where(grown.taken > 0, x * growth, 0.0) for x in (grown.taken, grown.error))
    if not named.any():
        return shared, np.abs(doubt)
    if level.axes[j].source != "friction":
        return np.where(named, np.nan, shared), np.abs(doubt)
    part, spread = (np.array(x[:, j], dtype=float) for x in (viscous.residual, viscous.std))
    known = np.isfinite(part) & np.isfinite(spread)
    last = (np.nan, np.nan)
    for s in np.unique(shift[named]):
        rows = named & (shift == s)
        own = rows & known
        if own.any():
            weight = 1.0 / spread[own] ** 2
            last = float(weight @ part[own] / weight.sum()), float(np.mean(spread[own]))
        part[rows & ~known], spread[rows & ~known] = last
    return np.where(named, part, shared), np.where(named, spread, np.abs(doubt))
