"""A judge on one robot-month: what it told, beside what was true."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from jointwear.monitor.judging.baseline import choose_baseline
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.judging.judge_settings import settings_of
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.records import UNJUDGED
from jointwear.studies.shop_floor.cell import Cell
from jointwear.studies.shop_floor.fast_path import nominal_robot
from jointwear.studies.shop_floor.month import BASELINE_DAYS, DAY
from jointwear.studies.shop_floor.plant_entry import entry_of
from jointwear.studies.shop_floor.sensing import START

#: A judge: statistics, the robot's entry of the config -> alarms (records of alarms.csv, `time` in seconds) and status.
Judge = Callable[[WindowStatistics, dict[str, Any], Cell], tuple[list[dict[str, Any]], np.ndarray]]
#: Hours after the alarm at which the forecast is looked at again.
LATER = 24.0


def product_judge(
    statistics: WindowStatistics, entry: dict[str, Any], cell: Cell, known: dict[str, Any] | None = None
) -> tuple[list[dict[str, Any]], np.ndarray]:
    """The judge of the monitor as a user calls it; `known` is kept between calls that differ in the rate alone."""
    baseline = choose_baseline(statistics, entry["baseline"])
    judgement = judge(statistics, baseline.mask, settings_of(nominal_robot(cell), entry), known)
    return judgement.alarms, judgement.status


def outcomes(cell: Cell, statistics: WindowStatistics, rates: Sequence[float]) -> list[dict[str, Any]]:
    """Return the facts of one robot at several stated rates; what is normal is learnt once."""
    one = partial(product_judge, known={})
    return [outcome(cell, statistics, rate, one) for rate in rates]


def outcome(cell: Cell, statistics: WindowStatistics, rate: float, judged: Judge = product_judge) -> dict[str, Any]:
    """Judge one robot at a stated rate and return the facts that scores are made of, as plain data.

    An alarm is a record of the model-based detector that names a friction (Coulomb, viscous) or backlash.
    """
    alarms, status = judged(statistics, entry_of(cell, rate), cell)
    end = (statistics.end - START) / 3600
    onset = cell.wear.onset if cell.wear else float("inf")
    told = sorted(
        (float((a["time"] - START) / 3600), int(a["axis"] or 0), str(a["quantity"]), a)
        for a in alarms
        if a["detector"] == "model" and ("friction" in a["quantity"] or "backlash" in a["quantity"])
    ) if alarms else []  # fmt: skip
    quiet = (end > BASELINE_DAYS * DAY) & (end <= onset)
    late = end > BASELINE_DAYS * DAY
    facts: dict[str, Any] = {
        "robot": cell.name,
        "scenario": cell.scenario,
        "arm": cell.arm.name,
        "thermometer": cell.thermometer,
        "rate": rate,
        "quiet_hours": int(quiet.sum()),
        "unjudged": float(np.mean(status[late] == UNJUDGED)) if late.any() else 1.0,
        "false": [[hour, axis, word] for hour, axis, word, _ in told if hour <= onset],
        "worn": cell.wear is not None,
    }
    if cell.wear:
        facts |= _worn(cell, [a for a in told if a[0] > onset], status, end)
    return facts


def _worn(cell: Cell, after: list[tuple], status: np.ndarray, end: np.ndarray) -> dict[str, Any]:
    wear, axis = cell.wear, cell.wear.axis + 1
    mine = [a for a in after if a[1] == axis]
    facts: dict[str, Any] = {
        "axis": axis,
        "kind": wear.kind,
        "shape": wear.shape,
        "onset": wear.onset,
        "duration": wear.duration,
        "judgeable": float(np.mean(status[end > wear.onset, axis - 1] != UNJUDGED)),
        "observed": int(((end > wear.onset) & (end <= wear.onset + 336)).sum()),
        "first_axis": after[0][1] if after else None,
        "others": len({a[1] for a in after} - {axis}),
        "likeliest": None,
        "delay": None,
        "forecasts": [],
    }
    if mine:
        first = mine[0]
        facts["delay"] = first[0] - wear.onset
        facts["operating"] = int(((end > wear.onset) & (end <= first[0])).sum())
        facts["growth"] = float(wear.growth(np.array(first[0])))
        facts["quantity"] = first[2]
        facts["likeliest"] = _likeliest([a for a in after if a[0] <= first[0]]) == axis
        again = [a for a in mine if LATER <= a[0] - first[0] <= 4 * LATER]
        for later, alarm in ((0, first), (LATER, again[0] if again else None)):
            if alarm is not None:
                facts["forecasts"].append(_forecast(wear.onset + wear.duration - alarm[0], alarm[3], later))
    return facts


def _likeliest(told: list[tuple]) -> int:
    """Return the axis whose newest alarm states the largest probability; the later one where they are alike.

    Viscous friction alone states none, which counts as 0.
    """
    newest = {axis: (np.nan_to_num(alarm["probability_axis"] or 0.0), hour) for hour, axis, _, alarm in told}
    return max(newest, key=lambda axis: newest[axis])


def _forecast(true: float, alarm: dict[str, Any], later: float) -> dict[str, Any]:
    """Whether the interval of an alarm held the true hours to the limit; an end that is open stays None."""
    low, middle, high = (alarm[f"hours_to_limit{end}"] for end in ("_low", "", "_high"))

    def known(x: Any) -> bool:
        return x is not None and np.isfinite(x)

    given = known(low) or known(high) or known(middle)
    lower, upper = (low if known(low) else 0.0), (high if known(high) else np.inf)
    held = bool(given and lower - 1 <= max(true, 0.0) <= upper + 1)
    return {
        "later": later, "given": bool(given), "held": held, "true": true, "ahead": true > 0,
        "low": float(low) if known(low) else None, "high": float(high) if known(high) else None,
    }  # fmt: skip
