"""What the windows of a robot show before anything is learnt: quantities, conditions, shifts, programs, events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.events import event_windows
from jointwear.monitor.findings.thermometers import stuck
from jointwear.monitor.judging.judge_settings import JudgeSettings
from jointwear.monitor.normal.conditions import Conditions, operating_features
from jointwear.monitor.normal.override import path_speed, unseen_speed
from jointwear.monitor.normal.payload import gravity_share, of_load
from jointwear.monitor.normal.products import Product, with_products
from jointwear.monitor.normal.programs import labelled_regimes
from jointwear.monitor.normal.series import Series, by_programs, friction_series, known_coulomb, sums_of
from jointwear.monitor.normal.shifts import shift_labels
from jointwear.monitor.reading.regimes import find_regimes, programs_or_one, signatures, without_torque
from jointwear.monitor.reading.rounded import loud_by_rounding
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.backlash import hidden_because
from jointwear.monitor.watching.scale import scale_series


@dataclass(frozen=True)
class Observed:
    """Windows (w,) and axes (n,) of a robot.

    `baseline` (w,) bool; `series`: friction by name; `scale`: of the torque; `hidden`: per axis, why backlash cannot be
    seen, empty where it can; `coulomb` (n, 2) its levels [N m] in the baseline or of the file; `shift` (w,) labels;
    `regime` (w,) program of each window or None; `events`: per axis, windows at which the config says that something
    was done to it; `kept`: those of them that tell of another program alone, which repairs nothing; `products` that the
    baseline lacks, each a program of `conditions`; `offset`: (w, n) constant torque [N m] beside gravity, NaN where the
    motion does not show it.
    """

    baseline: np.ndarray
    series: Mapping[str, Series]
    scale: Series
    hidden: list[str]
    coulomb: np.ndarray
    conditions: Conditions
    shift: np.ndarray
    regime: np.ndarray | None
    events: list[list[int]]
    kept: list[list[int]]
    products: tuple[Product, ...]
    offset: np.ndarray


def observe(statistics: WindowStatistics, baseline: int | np.ndarray, settings: JudgeSettings) -> Observed:
    """Return what the windows show.

    Parameters
    ----------
    baseline : number of windows, from the first, that show the robot healthy, or which ones, (w,) bool.
    """
    first = np.arange(statistics.windows) < baseline if np.ndim(baseline) == 0 else np.asarray(baseline, dtype=bool)
    coulomb = np.asarray(settings.coulomb, dtype=float)
    series = friction_series(statistics, coulomb, settings.viscous, first)
    sums, noise = sums_of(statistics, coulomb, first)
    static, load = gravity_share(sums, noise)
    features, speed = operating_features(statistics, np.maximum(series["friction"].unit, 1e-9), of_load(static, sums))
    regime = labelled_regimes(statistics.labels, first)
    named = regime is not None
    if not named:
        regime = find_regimes(signatures(statistics), first, without_torque(statistics))
    steady = regime is None or len(np.unique(regime[first & (regime >= 0)])) <= 1
    start, end = statistics.start, statistics.end
    shift = shift_labels(start, end, first, steady)
    scale = scale_series(sums, noise)
    unseen = unseen_speed(path_speed(features), regime, first) != 0
    # What rounding adds to the noise is no part that is carried.
    unseen |= loud_by_rounding(statistics, first).any(axis=1)
    program, products = with_products(statistics, scale, regime, shift, first, unseen)
    series = by_programs(series, statistics, coulomb, programs_or_one(program, statistics.windows), first)
    temperature = np.where(stuck(statistics, first), np.nan, statistics.temperature)
    # What was done before the baseline is part of what is normal.
    begin = float(start[np.flatnonzero(first)[0]]) if first.any() else -np.inf
    told = [e for e in settings.events if e.time > begin]
    events = event_windows(told, start, statistics.axes)
    mended = event_windows([e for e in told if e.mends], start, statistics.axes)
    level = known_coulomb(coulomb, series["friction"], first)
    return Observed(
        baseline=first,
        series=series,
        scale=scale,
        hidden=hidden_because(statistics, level, first),
        coulomb=level,
        conditions=Conditions(start, end, temperature, features, speed, load, program, named),
        shift=shift,
        regime=regime,
        events=events,
        kept=[[k for k in every if k not in own] for every, own in zip(events, mended, strict=True)],
        products=products,
        offset=np.where(static.share != 0, static.constant, np.nan),
    )
