"""Friction of every axis, window by window, as the series that the normal state is regressed on.

`coulomb`: log of the Coulomb level over the nominal one. `friction`: log of Coulomb and viscous friction at the usual
speed of the axis, which a short window shows far better than either part; `viscous`: the viscous part at that speed,
over the friction of the baseline. Nuisances (offset, gravity, inertia) are estimated along as :mod:`.estimate` says.
`beside_bodies`: as `friction`, with gravity and inertia free in every window, whatever that costs. Windows that are
less sure than is usual have the larger variance, or none of the values (:mod:`.unsure`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jointwear.monitor.normal.estimate import (
    COLUMNS,
    Sums,
    change_columns,
    choose_free,
    column_change,
    column_estimate,
    contrast,
    pool_windows,
    prior_scale,
)
from jointwear.monitor.normal.unsure import beyond_usual, coloured_variance, not_of_program, odd_windows
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: A level below this share of the nominal one is no estimate.
LOWEST = 0.02
#: Noise (standard deviation over the median of the baseline) above which a window is no ordinary one: samples that do
#: not belong together, another robot, another unit.
LOUDEST = 4.0
#: Standard deviation of a log level above which a window shows nothing.
COARSEST = 0.25
#: Standard errors by which friction that is not known must lie nearer to none than to that of the baseline: where it is
#: only not seen, no sign is turned.
DRIVES = 5.0
_VISCOUS = COLUMNS.index("viscous")
_BODIES = [COLUMNS.index("gravity"), COLUMNS.index("inertial")]


@dataclass(frozen=True)
class Series:
    """Arrays (w, n): `value`, NaN where a window shows nothing, and `variance`, what the window's noise explains, and
    what it is less sure by than is usual.

    `unit` (n,): torque [N m] of one unit of the level; `share` (n,): of Coulomb friction in it, in the baseline.
    `driving` (w, n) bool, or None: nothing is left of the level, or it lies below zero, as friction never does.
    `unsure` (w, n) bool, or None: the value is not told because the window is far less sure of it than is usual.
    `added` (n,), or None: torque [N m] that viscous friction adds to the level while it grows by as much as all
    friction of the baseline at the usual speed.
    """

    value: np.ndarray
    variance: np.ndarray
    unit: np.ndarray
    share: np.ndarray
    driving: np.ndarray | None = None
    added: np.ndarray | None = None
    unsure: np.ndarray | None = None


def friction_series(
    statistics: WindowStatistics, coulomb: np.ndarray, viscous: np.ndarray, baseline: np.ndarray
) -> dict[str, Series]:
    """Return the series by name.

    Parameters
    ----------
    coulomb : (n, 2) nominal levels [N m], both positive. viscous : (n,) [N m s/rad]. baseline : (w,) bool.
    """
    sums, _ = sums_of(statistics, coulomb, baseline)
    score = _turned_matrix(statistics.score, column_change(coulomb))
    scale = prior_scale(coulomb, viscous)
    speed = usual_speed(statistics, baseline)
    known = coulomb.sum(axis=1) > 0
    level = np.where(known, coulomb.mean(axis=1), 1.0)
    nominal = np.where(known, 1.0, 0.0)
    first = _part(sums, baseline)
    plain = pool_windows(first, scale)
    value, variance = column_estimate(sums, plain.held, plain.free, plain.variance)
    more = beyond_usual(coloured_variance(sums.gram, score, plain.free), baseline)
    coulomb_level = _logs(nominal + value, variance, more, level, np.ones(len(level)))
    # Friction at the usual speed: the viscous column less the Coulomb column that it is like at that speed.
    turned = _turned(sums, speed / level)
    score = _turned_matrix(score, _at_speed(speed / level))
    turned_scale = scale.copy()
    turned_scale[:, 0] = np.hypot(scale[:, 0], scale[:, _VISCOUS] * speed / level)
    usual = pool_windows(_part(turned, baseline), turned_scale)
    free = usual.free.copy()
    free[:, _VISCOUS] = True
    seen = choose_free(np.where(first.usable[..., None, None], _part(turned, baseline).gram, 0.0).sum(axis=0))
    free &= seen | (np.arange(len(COLUMNS)) == _VISCOUS)
    value, variance = column_estimate(turned, usual.held, free, usual.variance)
    coloured = coloured_variance(turned.gram, score, free)
    at_speed = nominal + viscous * speed / level + value
    with np.errstate(all="ignore"):
        usual_level = known_median(np.where(baseline[:, None], at_speed, np.nan), axis=0)
    middle = np.where(np.nan_to_num(usual_level) > 0, usual_level, 1.0)
    every = np.ones_like(free)
    slope, slope_variance = column_estimate(turned, usual.held, every, usual.variance, _VISCOUS)
    slope_variance += beyond_usual(coloured_variance(turned.gram, score, every, _VISCOUS), baseline)
    part = (viscous + slope) * speed / level / middle
    with np.errstate(all="ignore"):
        of_coulomb = 1 - known_median(np.where(baseline[:, None], part, np.nan), axis=0)
        nominal_share = np.where(known, level / np.where(level > 0, level + viscous * speed, 1.0), of_coulomb)
    of_coulomb = np.where(np.isfinite(of_coulomb), of_coulomb, nominal_share)
    # A robot file without friction says nothing of its parts. Where the motion tells them no better, all of it counts.
    share = np.clip(np.nan_to_num(0.5 * (of_coulomb + nominal_share), nan=1.0), 0.1, 1.0)
    friction = _logs(at_speed, variance, beyond_usual(coloured, baseline), level, share)
    loose = free.copy()
    loose[:, _BODIES] = True
    value, beside_variance = column_estimate(turned, usual.held, loose, usual.variance)
    more = beyond_usual(coloured_variance(turned.gram, score, loose), baseline)
    beside = _logs(nominal + viscous * speed / level + value, beside_variance, more, level, share)
    with np.errstate(invalid="ignore"):
        none = at_speed + DRIVES * np.sqrt(np.maximum(variance, coloured)) < 0.5 * usual_level
    size = np.where(speed > 0, speed / level / middle, np.nan)
    of_slope = _known(slope_variance * size**2, slope_variance * size**2)
    return {
        "coulomb": replace(coulomb_level, added=_leak(first, plain.free, speed, level) * level * middle),
        "friction": replace(friction, driving=none & ~np.isfinite(friction.value), added=level * middle),
        "viscous": Series(_known(part, of_slope), of_slope, level * middle, share),
        "beside_bodies": beside,
    }


def by_programs(
    series: dict[str, Series],
    statistics: WindowStatistics,
    coulomb: np.ndarray,
    program: np.ndarray,
    baseline: np.ndarray,
) -> dict[str, Series]:
    """Return the series without the windows that are :func:`.unsure.odd_windows` of their `program` (w,) label.

    Friction that has come out below zero in a program ever since the baseline is only not seen there, and no news.

    The others are those of :func:`friction_series`.
    """
    sums, _ = sums_of(statistics, coulomb, baseline)
    first = _part(sums, baseline)
    free = choose_free(np.where(first.usable[..., None, None], first.gram, 0.0).sum(axis=0))
    variance = coloured_variance(sums.gram, _turned_matrix(statistics.score, column_change(coulomb)), free)
    # A window with few moves is less sure, but no odd one.
    variance *= contrast(sums.gram, free)[1]
    odd = odd_windows(np.where(sums.usable & (variance > 0), np.sqrt(variance), np.nan), program, baseline)
    result = {name: _without(one, odd) for name, one in series.items()}
    driving = not_of_program(series["friction"].driving, sums.usable, program, baseline)
    return {**result, "friction": replace(result["friction"], driving=driving)}


def _without(series: Series, odd: np.ndarray) -> Series:
    """Return a series that tells no value of the windows `odd` (w, n)."""
    unsure = odd & np.isfinite(series.value)
    value, variance = (np.where(odd, np.nan, x) for x in (series.value, series.variance))
    unsure = unsure if series.unsure is None else unsure | series.unsure
    return replace(series, value=value, variance=variance, unsure=unsure)


def _leak(first: Sums, free: np.ndarray, speed: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Return the torque (n,) that the Coulomb level takes for one of viscous friction at the usual speed (n,) [rad/s],
    where that is held: with the other `free` columns (n, 5) it looks like Coulomb friction in the motion of the
    baseline."""
    gram = np.where(first.usable[..., None, None], first.gram, 0.0).sum(axis=0)
    weights, _ = contrast(gram, free)
    like = np.einsum("nk,nk->n", weights, gram[:, :, _VISCOUS])
    return np.where(free[:, _VISCOUS] | (speed <= 0), 0.0, like * level / np.where(speed > 0, speed, 1.0))


def known_coulomb(nominal: np.ndarray, friction: Series, baseline: np.ndarray) -> np.ndarray:
    """Return Coulomb friction (n, 2) [N m]: that of the robot file, of an axis without any what its baseline shows.

    Parameters
    ----------
    nominal : (n, 2) [N m], both positive. friction : of :func:`friction_series`. baseline : (w,) bool.
    """
    with np.errstate(all="ignore"):
        middle = known_median(np.where(baseline[:, None], friction.value, np.nan), axis=0)
    own = np.nan_to_num(friction.share * friction.unit * np.exp(middle))
    return np.where(nominal.sum(axis=1, keepdims=True) > 0, nominal, own[:, None])


def sums_of(statistics: WindowStatistics, coulomb: np.ndarray, baseline: np.ndarray) -> tuple[Sums, np.ndarray]:
    """Return the sums of all windows and the noise variance (n,) [N2 m2] of the baseline; `coulomb` (n, 2) [N m]."""
    usable = statistics.judgeable & (statistics.count > 0) & ~loud_windows(statistics, baseline)
    sums = change_columns(
        statistics.gram, statistics.moment, statistics.residual_square, statistics.freedom, usable, coulomb
    )
    first = _part(sums, baseline)
    square = np.where(first.usable, first.residual_square, 0.0).sum(axis=0)
    freedom = np.where(first.usable, first.freedom, 0).sum(axis=0)
    return sums, np.where(freedom > 0, square / np.maximum(freedom, 1), 1.0)


def loud_windows(statistics: WindowStatistics, baseline: np.ndarray) -> np.ndarray:
    """Return where (w, n) the noise of an axis is :data:`LOUDEST` times the usual one of the baseline or more."""
    noise = np.sqrt(statistics.noise_variance)
    usual = known_median(np.where(baseline[:, None], noise, np.nan), axis=0)
    with np.errstate(invalid="ignore"):
        return noise > LOUDEST * usual


def usual_speed(statistics: WindowStatistics, baseline: np.ndarray) -> np.ndarray:
    """Return the root mean square speed (n,) [rad/s] of the moving axes in the baseline, of all windows where none."""

    def of(rows: np.ndarray) -> np.ndarray:
        square, count = statistics.gram[rows, :, 2, 2].sum(axis=0), statistics.count[rows].sum(axis=0)
        return np.sqrt(square / np.maximum(count, 1))

    first = of(baseline)
    return np.where(first > 0, first, of(np.ones(len(baseline), dtype=bool)))


def _part(sums: Sums, rows: np.ndarray) -> Sums:
    return Sums(**{name: getattr(sums, name)[rows] for name in Sums.__dataclass_fields__})


def _turned(sums: Sums, at: np.ndarray) -> Sums:
    """Return sums whose first coefficient is friction at a speed: column viscous becomes x_v - at x_coulomb."""
    change = _at_speed(at)
    gram = _turned_matrix(sums.gram, change)
    moment = np.einsum("nji,wnj->wni", change, sums.moment)
    return Sums(gram, moment, sums.residual_square, sums.freedom, sums.usable)


def _at_speed(at: np.ndarray) -> np.ndarray:
    """Return the matrices (n, 5, 5) that take `at` (n,) of the Coulomb column off the viscous one."""
    change = np.broadcast_to(np.eye(5), (len(at), 5, 5)).copy()
    change[:, 0, _VISCOUS] = -at
    return change


def _turned_matrix(matrix: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Return sums of products (w, n, 5, 5) for the columns that `change` (n, 5, 5) makes."""
    return np.einsum("nji,wnjk,nkl->wnil", change, matrix, change)


def _logs(level: np.ndarray, variance: np.ndarray, more: np.ndarray, unit: np.ndarray, share: np.ndarray) -> Series:
    """Return the log of a level (w, n) with a `variance` (w, n), and `more` of it beyond what is usual."""
    with np.errstate(all="ignore"):
        positive = level > LOWEST
        value = np.where(positive, np.log(np.where(positive, level, 1.0)), np.nan)
        told, relative = (np.where(positive, v / level**2, np.nan) for v in (variance, variance + more))
    result = Series(_known(value, relative), _known(relative, relative), unit, share)
    return replace(result, unsure=np.isfinite(_known(value, told)) & ~np.isfinite(result.value))


def _known(values: np.ndarray, variance: np.ndarray) -> np.ndarray:
    with np.errstate(invalid="ignore"):
        return np.where((variance > 0) & (variance < COARSEST**2), values, np.nan)
