"""Run cases of the tier and print truth beside verdict: python -m jointwear.studies.world --cases 32."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.running.processes import single_threaded
from jointwear.studies.world.answers import is_right
from jointwear.studies.world.plan import KINDS, SETS, Case, cases
from jointwear.studies.world.scores import WORDS, score
from jointwear.studies.world.stages import solve_if_possible


def line(row: dict[str, Any]) -> str:
    """Return a judged row in words."""
    truth = " + ".join(
        f"{name}@{axis or 'arm'} ({form} {size:.3g}{'' if energy > 60 else ', not identifiable'}"
        f"{', also ' + ' '.join(rivals) if rivals else ''})"
        for name, axis, form, size, energy, rivals in row["hidden"]
    )
    if row["wrong_parameter"]:
        w = row["wrong_parameter"]
        truth = (
            f"{w['parameter']}@{w['axis']} x {1 + w['share']:.2f}{'' if row['identifiable'] else ' (not identifiable)'}"
        )
    given = " + ".join(
        f"{name}@{axis or 'arm'}" + ("" if n.get("probability") is None else f" p {n['probability']:.3f}")
        for (name, axis), n in zip(row["named"], row["names"], strict=True)
    )
    good = row["retuned"] if row["kind"] == "retuned" else is_right(row)
    extra = f" WORSE {row['worse']}" if row.get("worse") else ""
    gap = f" gap {row['gap_closed']:.2f}" if row.get("gap_closed") is not None else ""
    missed = [k for k, p in (row.get("parameters") or {}).items() if not p["covered"]]
    extra += f" interval misses {missed}" if missed else ""
    extra += f" refused: {row['refused']}" if row.get("refused") else ""
    where = (
        f"{row['arm']} {row['rate']} Hz {row['bits'] or 'exact'} bit {'link' if row['link_side'] else 'motor'} side, "
        f"{row['torque_kind']}, {row['controller']}, {row['motion']}, inertia +-{row['inertial_error']:g}"
        f"{', velocity' if row['velocity'] else ''}"
    )
    return (
        f"{'ok ' if good else '-- '} {row['case']} [{where}]\n      truth {row['kind']}: {truth or 'nothing'}\n"
        f"      said  {row['verdict']}: {given or 'no names'}"
        f"{'; suspects ' + str(row['suspects']) if row['suspects'] else ''}"
        f"{'; unexplained ' + str(row['unexplained']) if row['unexplained'] else ''}{gap}{extra} {row['seconds']:.1f} s"
    )


def _told(case: Case, row: dict[str, Any] | None) -> list[dict[str, Any]]:
    """Print the row of a case, or that it has none, and return it."""
    if row is None:
        why = "its plant cannot be integrated with its step, or its controller loses it"
        print(f"   {case.name} is no case: {why}", file=sys.stderr)
        return []
    print(line(row), flush=True)
    return [row]


def main(arguments: list[str] | None = None) -> int:
    """Parse arguments, run, print."""
    parser = argparse.ArgumentParser(prog="python -m jointwear.studies.world", description=__doc__)
    parser.add_argument("--seeds", choices=SETS, default="choose")
    parser.add_argument("--cases", type=int, default=32, help="how many, in the order of the plan (a fair mixture)")
    parser.add_argument("--skip", type=int, default=0, help="leave out the first so many")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--kind", choices=KINDS)
    parser.add_argument("--subject", help="only cases that hide this")
    parser.add_argument("--only", help="one case by name, such as world_0003")
    parser.add_argument("--save", type=Path, help="write the judged rows as JSON")
    given = parser.parse_args(arguments)
    chosen = [
        c
        for c in cases(given.seeds)
        if (not given.kind or c.kind == given.kind)
        and (not given.subject or c.subject == given.subject)
        and (not given.only or c.name == given.only)
    ][given.skip : given.skip + given.cases]
    rows = []
    try:
        if given.jobs > 1:
            with single_threaded(given.jobs) as pool:
                for case, row in zip(chosen, pool.map(solve_if_possible, chosen), strict=True):
                    rows += _told(case, row)
        else:
            for case in chosen:
                rows += _told(case, solve_if_possible(case))
    except InputError as error:
        print(error, file=sys.stderr)
        return 1
    for name, s in score(rows).items():
        if s["value"] is not None:
            width = f" [{s['low']:.2f}, {s['high']:.2f}]" if s["low"] is not None else ""
            goal = "" if s["target"] is None else f"  target {s['target']}: {'reached' if s['reached'] else 'missed'}"
            print(f"{WORDS[name]:75s} {s['value']:.3f}{width} n {s['count']}{goal}")
    if given.save:
        given.save.write_text(json.dumps({"cases": rows}, indent=1, default=str), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
