"""Score the monitor's judge on simulated robots and print a table.

    PYTHONPATH=workflow python -m jointwear.studies.shop_floor.sample --seeds choose --robots 8

Window statistics are kept under `--keep` and simulated only where they are missing.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from typing import Any

from jointwear.files.text_files import replace_text
from jointwear.studies.shop_floor.cell import SEEDS
from jointwear.studies.shop_floor.judging import outcomes
from jointwear.studies.shop_floor.kept import kept_robot
from jointwear.studies.shop_floor.plan import RATES
from jointwear.studies.shop_floor.scores import summary


def _rate(r: dict[str, Any]) -> str:
    if r["per_1000_h"] is None:
        return "-"
    return f"{r['per_1000_h']:6.2f} ({r['low']:.2f} to {r['high']:.2f}); {r['count']} in {r['hours']} h"


def _share(s: dict[str, Any]) -> str:
    return f"{s['count']} of {s['of']}" + (
        f" = {s['share']:.2f} ({s['low']:.2f} to {s['high']:.2f})" if s["of"] else ""
    )


def _range(q: dict[str, Any], unit: str) -> str:
    return "-" if q["median"] is None else f"{q['median']:.1f} {unit} ({q['low']:.1f} to {q['high']:.1f})"


def table(s: dict[str, Any]) -> str:
    """Return the scores at one stated rate as lines of text."""
    lines = [
        f"stated rate {s['rate']:g} per 1,000 h, {s['robots']} robots, {s['unjudged']:.0%} of axis-windows unjudged"
    ]
    lines.append(
        f"  false alarms before wear   {_rate(s['false'])}; {s['false']['alarmed']} robots, {s['false']['axes']} axes"
    )
    for key in ("by_scenario", "by_thermometer", "by_arm"):
        for name, value in s[key].items():
            lines.append(
                f"    {name:22s}   {_rate(value)}; {value['alarmed']} of {value['robots']} robots, "
                f"{value['unjudged']:.0%} unjudged"
            )
    for key in ("coulomb_in_two_weeks", "coulomb", "together", "viscous"):
        d = s[key]
        lines.append(
            f"  {key.replace('_', ' '):24s} found {_share(d['found'])}; axis right first {_share(d['right'])}, "
            f"when found {_share(d['named'])}"
        )
        lines.append(
            f"{'':27s}delay {_range(d['delay'], 'h')}; in operation {_range(d['operating'], 'h')}; "
            f"at growth {_range(d['growth'], '%')}; {d['unjudgeable']} hardly judged"
        )
    for key in ("forecast", "forecast_later"):
        f = s[key]
        lines.append(
            f"  {key.replace('_', ' '):24s} held {_share(f['held'])}; {f['open']} open, {f['missing']} not given, "
            f"{f['early']} came earlier"
        )
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate what is missing, judge, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", choices=sorted(SEEDS), default="choose")
    parser.add_argument("--robots", type=int, default=8)
    parser.add_argument("--first", type=int, default=0, help="index of the first robot")
    parser.add_argument("--rates", type=float, nargs="+", default=list(RATES))
    parser.add_argument("--keep", default="results/shop_floor", help="folder of the window statistics")
    parser.add_argument("--alarms", action="store_true", help="list every alarm")
    parser.add_argument("--json", help="file for the outcomes of every robot")
    parser.add_argument("--summary", help="file for the scores at every rate")
    given = parser.parse_args(arguments)
    facts, begin, spent = [], time.process_time(), 0.0
    for index in range(given.first, given.first + given.robots):
        cell, statistics, refused = kept_robot(given.seeds, index, given.keep)
        before = time.process_time()
        for fact in outcomes(cell, statistics, given.rates):
            facts.append(fact | {"refused": refused})
            rate = fact["rate"]
            if given.alarms:
                f = facts[-1]
                print(
                    f"{cell.name} {cell.scenario} {rate:g}: {cell.thermometer}, wear {cell.wear}, events {cell.events}"
                )
                print(f"   refused '{refused}'; false {f['false']}; delay {f.get('delay')}")
        spent += time.process_time() - before
    refused = [f for f in facts if f["refused"] and f["rate"] == given.rates[0]]
    for rate in given.rates:
        print(table(summary([f for f in facts if f["rate"] == rate])))
    print(f"first log refused by the monitor's own check: {len(refused)} of {given.robots} robots")
    for f in refused[:5]:
        print(f"  {f['robot']} {f['scenario']}: {f['refused']}")
    print(f"{time.process_time() - begin:.0f} s of processor time, {spent:.0f} s of them judging")
    for path, content in (
        (given.json, facts),
        (given.summary, [summary([f for f in facts if f["rate"] == rate]) for rate in given.rates]),
    ):
        if path:
            replace_text(path, json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
