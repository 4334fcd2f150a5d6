"""Give axes of simulated robots a growing backlash, judge the month, and print when it is told and how pulses grew.

PYTHONPATH=workflow python -m jointwear.studies.shop_floor.gap_sample --robots 1 5 7 --axis 1 --gap 1.5
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from jointwear.monitor.judging.baseline import choose_baseline
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.judging.judge_settings import settings_of
from jointwear.monitor.watching.backlash import BACKLASH
from jointwear.studies.shop_floor.cell import SEEDS, draw_cell
from jointwear.studies.shop_floor.fast_path import nominal_robot, statistics_of
from jointwear.studies.shop_floor.gear import Wear
from jointwear.studies.shop_floor.kept import survey_cell
from jointwear.studies.shop_floor.plant_entry import STATED, entry_of
from jointwear.studies.shop_floor.sensing import START

#: Onset and time to the full gap [h]; time at the end over which the growth of the pulses is averaged [h].
ONSET, DURATION, AT_THE_END = 288.0, 300.0, 48.0


def gap_outcome(seed_set: str, index: int, axis: int, gap: float) -> dict[str, Any]:
    """Judge one robot whose 0-based `axis` gets `gap` [rad] of lost motion within :data:`DURATION`.

    Returns `delay` [h] of the first alarm of backlash on the axis and the gap `at` it [mrad], None where none came;
    `others`, 1-based axes with such an alarm; `pulses`, growth at the end [%], NaN where it is not judged; `reason`.
    """
    cell = draw_cell(seed_set, index)
    cell = replace(cell, wear=Wear(axis, "backlash", ONSET, DURATION, "straight", gap))
    statistics = statistics_of(cell, survey_cell(cell)[0])
    entry = entry_of(cell, STATED)
    first = choose_baseline(statistics, entry["baseline"]).mask
    found = judge(statistics, first, settings_of(nominal_robot(cell), entry))
    told = sorted(((a["time"] - START) / 3600, a["axis"]) for a in found.alarms if a["quantity"] == BACKLASH)
    mine = [hour for hour, j in told if j == axis + 1 and hour > ONSET]
    late = (statistics.end - START) / 3600 > ONSET + DURATION - AT_THE_END
    pulses = found.estimates[BACKLASH][late, axis]
    words = [f["words"] for f in found.findings if f["kind"] == "backlash" and axis + 1 in f["axes"]]
    return {
        "robot": cell.name,
        "arm": cell.arm.name,
        "delay": mine[0] - ONSET if mine else None,
        "at": 1e3 * float(cell.wear.growth(np.array(mine[0]))) if mine else None,
        "others": sorted({j for _, j in told} - {axis + 1}),
        "pulses": float(np.nanmean(pulses)) if np.isfinite(pulses).any() else float("nan"),
        "reason": words[0] if words else "",
    }


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, judge, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", choices=sorted(SEEDS), default="choose")
    parser.add_argument("--robots", type=int, nargs="+", default=[1, 5, 7])
    parser.add_argument("--axis", type=int, default=1, help="1-based")
    parser.add_argument("--gap", type=float, default=1.5, help="lost motion at the end [mrad]")
    given = parser.parse_args(arguments)
    for index in given.robots:
        row = gap_outcome(given.seeds, index, given.axis - 1, 1e-3 * given.gap)
        told = "not told" if row["delay"] is None else f"told after {row['delay']:.0f} h, at {row['at']:.2f} mrad"
        reason = f"; {row['reason']}" if row["reason"] else ""
        print(f"{row['robot']} ({row['arm']}): {told}; pulses {row['pulses']:+.0f} %; others {row['others']}{reason}")


if __name__ == "__main__":
    main()
