"""How well Figures 1 to 3 reproduce what the paper's plots show.

The paper prints no values for its figures. A plot whose axis was chosen by the plotting program fills most of
it, which is what its drawn range tells about the data.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from jointwear.publishing.figures.curves import DivergenceCurves, FrictionCurve, ResidualCurves
from jointwear.reproduction.published import Published
from jointwear.reproduction.verdicts import AGREES, CLOSE, DIFFERS, NOT_COMPARABLE, TORQUE_TOLERANCE, detection_verdict
from jointwear.statistics.intervals import spread_over_replicates


def score_friction(curves: list[FrictionCurve], printed: Published, is_published_run: bool) -> dict[str, Any]:
    """Compare the friction torque with the range of Figure 1.

    *agrees*: a direction fills the drawn range to within one of its 0.5 N m ticks at both ends; *close*: both
    ends within 5 %, the tolerance of torques.
    """
    low, high = printed.data["figures"]["fig_1"]["y_range_nm"]
    best = min(curves, key=lambda c: abs(c.friction[0] - low) + abs(c.friction[-1] - high))
    first, last = float(best.friction[0]), float(best.friction[-1])
    if not is_published_run:
        verdict = NOT_COMPARABLE
    elif low <= first <= low + 0.5 and high - 0.5 <= last <= high:
        verdict = AGREES
    else:
        near = abs(first - low) <= TORQUE_TOLERANCE * low and abs(last - high) <= TORQUE_TOLERANCE * high
        verdict = CLOSE if near else DIFFERS
    directions = [
        {
            "direction": c.direction,
            "velocity_rad_s": c.velocity,
            "first_nm": float(c.friction[0]),
            "last_nm": float(c.friction[-1]),
        }
        for c in curves
    ]
    return {"published": [low, high], "nearest": [first, last], "directions": directions, "verdict": verdict}


def score_divergence(curves: DivergenceCurves, printed: Published, is_published_run: bool) -> dict[str, Any]:
    """Compare the largest KL divergence with the range of Figure 2.

    An axis of 0 to 10 in steps of 2 is drawn for a largest value above 8 and up to 10. *agrees*: the median over
    replicates lies there; *close*: the range over replicates reaches it.
    """
    low, high = printed.data["figures"]["fig_2"]["y_range_nat"]
    floor = 0.8 * high
    median, least, most = spread_over_replicates(curves.peak)
    verdict = AGREES if floor < median <= high else CLOSE if least <= high and most > floor else DIFFERS
    worn = curves.cell.axis - 1
    return {
        "published": [low, high],
        "peak_nat": median,
        "peak_low": least,
        "peak_high": most,
        "worn_axis_end_nat": float(curves.divergence.median[-1, worn]),
        "worn_axis_leads": float(curves.worn_leads.mean()),
        "verdict": verdict if is_published_run else NOT_COMPARABLE,
    }


def score_onset(curves: ResidualCurves, printed: Published, is_published_run: bool) -> dict[str, Any]:
    """Compare the onset of Figure 3 with the paper's 72 h, by the rule of Table IV."""
    hour = printed.data["figures"]["fig_3"]["onset_hours_after_start_of_wear"]
    probability = float(np.isfinite(curves.onset).mean())
    median, low, high = spread_over_replicates(curves.onset)
    return {
        "published": hour,
        "detection_probability": probability,
        "hour_median": median,
        "hour_low": low,
        "hour_high": high,
        "verdict": detection_verdict(is_published_run, hour, probability, median, low, high),
    }


def score_residual_range(curves: ResidualCurves, printed: Published, is_published_run: bool) -> dict[str, Any]:
    """Compare the residuals of the named replicate with the range of Figure 3.

    *agrees*: all of them inside; *close*: within one decade of either end.
    """
    low, high = (float(v) for v in printed.data["figures"]["fig_3"]["y_range"])
    single = np.concatenate([curves.training.single, curves.run.single])
    middle = np.concatenate([curves.training.median, curves.run.median])
    least, most = float(single.min()), float(single.max())
    verdict = AGREES if least >= low and most <= high else CLOSE if least >= low / 10 and most <= 10 * high else DIFFERS
    return {
        "published": [low, high],
        "single": [least, most],
        "median": [float(middle.min()), float(middle.max())],
        "verdict": verdict if is_published_run else NOT_COMPARABLE,
    }


def score_components(kept: dict[str, np.ndarray], printed: Published) -> dict[str, Any]:
    """Compare the number of principal components, `kept` by task (r,), with the paper's 3 to 4.

    *agrees*: at least half of the models keep 3 or 4; *close*: at least one in twenty; the rest *differs*.
    """
    low, high = printed.data["text_claims"]["principal_components"]
    everything = np.concatenate(list(kept.values()))
    inside = float(((everything >= low) & (everything <= high)).mean())
    verdict = AGREES if inside >= 0.5 else CLOSE if inside >= 0.05 else DIFFERS
    counts = {
        task: {int(k): int(c) for k, c in zip(*np.unique(v, return_counts=True), strict=True)}
        for task, v in kept.items()
    }
    return {
        "published": [low, high],
        "share_inside": inside,
        "counts": counts,
        "verdict": verdict if set(kept) & set(printed.data["table_iii_design"]["tasks"]) else NOT_COMPARABLE,
    }
