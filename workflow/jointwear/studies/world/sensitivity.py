"""What 30 % more or less of every limit of discovery does: python -m jointwear.studies.world.sensitivity --cases 24.

The noise of a case does not depend on the limits, and the dictionary on the widths of priors only: they are made once,
and only the decision is taken again. Verdicts are judged by their names; what the written model predicts is not asked.
With `--assumed` it is the limits of :mod:`jointwear.discovery.assumed` that are moved, with what only the written model
asks, and everything is asked again.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.problem.candidates import LINK_MASS, Dictionary, build_dictionary
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.unknown_inertia import build_with_motors
from jointwear.discovery.problem.whitening import White, whiten
from jointwear.discovery.search.decide import decide
from jointwear.discovery.settings import REPORTED, USERS, Settings
from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.measurement.recording import split
from jointwear.running.processes import single_threaded
from jointwear.studies.challenge.judge import judge
from jointwear.studies.challenge.solve import with_words
from jointwear.studies.world import assumptions
from jointwear.studies.world.answers import RIGHT, is_right, unknown_only
from jointwear.studies.world.case import WorldCase, generate
from jointwear.studies.world.plan import Case, cases
from jointwear.studies.world.setting import INERTIAL_PRIOR
from jointwear.studies.world.stages import sources_digest

#: Each limit is multiplied by these.
FACTORS = (0.7, 1.3)
#: Limits that are in the columns of the problem and of the dictionary.
PRIORS = ("usual",)


def variants(settings: Settings) -> dict[tuple[str, float], Settings]:
    """Return the settings with each limit moved: (field, factor) -> settings; whole numbers move by one at least."""
    result = {}
    for name, value in asdict(settings).items():
        if name in (*USERS, *REPORTED, *assumptions.WRITTEN) or not isinstance(value, (int, float)):
            continue
        for factor in FACTORS:
            moved = factor * value
            if isinstance(value, int):
                moved = min(value - 1, round(moved)) if factor < 1 else max(value + 1, round(moved))
            elif name in ("certainty", "nearly_all"):
                # Of a probability or share the distance to one is what a limit is about.
                moved = 1.0 - (1.0 - value) / factor
            result[name, factor] = replace(settings, **{name: moved})
    return result


#: Limits that are a gate: the words by which a refusal tells it, and the factor by which it asks for less.
GATES = {
    "certainty": ("probability of a smaller error on records left out", 0.7),
    "smallest_share": ("drop of the squared error over the noise variance", 0.7),
}


def can_matter(outcome: Outcome, name: str, factor: float, settings: Settings) -> bool:
    """Return False where a moved limit provably leaves a decision as it is, so that it need not be taken again.

    A gate that asks for less changes nothing where it refused nothing; one that asks for more nothing where no name, no
    suspect and no link mass ever passed.
    """
    if name in GATES:
        words, less = GATES[name]
        if factor == less:
            return any(r.gate.startswith(words) for r in outcome.refusals)
        passed = outcome.named or outcome.suspects or any(r.gate in _LATE for r in outcome.refusals)
        return bool(passed)
    if name == "most_on_axis":
        axes = [n.candidate.axis for n in [*outcome.named, *(n for n, _ in outcome.suspects)]]
        return any(axes.count(a) >= settings.most_on_axis for a in axes)
    if name == "nearly_all":
        return bool(outcome.suspects) or any(n.structure_left for n in outcome.named)
    if name == "form_error":
        # It bounds weak names too, beside which slow noise is asked.
        return bool(outcome.named or outcome.suspects)
    return True


#: Gates that are asked after a name was accepted.
_LATE = ("nats beside the other effects", "probability, given the data and the library")


def answers(case: Case, wanted: Mapping[tuple[str, float], Settings]) -> dict[str, Any]:
    """Return what a case is and, for the limits as they are and each variant, the names and whether they are right."""
    with tempfile.TemporaryDirectory() as folder:
        world = generate(case, folder)
        base = Settings(inertial_prior=INERTIAL_PRIOR)
        problem = build_with_motors(split(with_words(world.recording, world.told)), world.robot, base)
        white = whiten(problem, estimate_noise(problem))
        return decisions(world, white, build_dictionary(white), wanted)


def decisions(
    world: WorldCase, white: White, dictionary: Dictionary, wanted: Mapping[tuple[str, float], Settings]
) -> dict[str, Any]:
    """Return what :func:`answers` does, of a case whose noise and dictionary are at hand."""
    base = white.problem.settings
    plain = decide(white, dictionary)
    found = {" 1": judged(world, plain)}
    for (name, factor), settings in wanted.items():
        key = f"{name} {factor:g}"
        if can_matter(plain, name, factor, base):
            moved: White = replace(white, problem=replace(white.problem, settings=settings))
            again = dictionary
            if name in PRIORS:
                moved = whiten(moved.problem, white.whiteners)
                again = build_dictionary(moved)
            found[key] = judged(world, decide(moved, again))
        else:
            found[key] = found[" 1"]
    kind = world.facts["kind"]
    return {"case": world.facts["case"], "kind": kind, "identifiable": _identifiable(world), "found": found}


def _identifiable(world: WorldCase) -> bool:
    nothing = {"verdict": "none", "effects": []}
    return judge(world.facts, nothing, None, None)["identifiable"] is not False


def judged(world: WorldCase, outcome: Outcome) -> dict[str, Any]:
    """Return the names of an outcome and whether they are right, None where the question does not apply."""
    effects = [
        {
            "effect": n.candidate.effect,
            "axis": None if n.candidate.axis is None else n.candidate.axis + 1,
            "source_axis": None if n.candidate.source is None else n.candidate.source + 1,
        }
        for n in outcome.named
        if n.candidate.effect != LINK_MASS
    ]
    word = "unknown" if outcome.unexplained else "effects" if effects else "none"
    row = judge(world.facts, {"verdict": word, "effects": effects}, None, None)
    if row["kind"] == "outside":
        row["unknown_only"] = unknown_only(world, word, effects)
    return {"names": sorted(map(str, row["named"])), "right": is_right(row)}


def moves(settings: Settings) -> dict[tuple[str, float], tuple[float, float]]:
    """Return every limit of the settings with each factor: (name, factor) -> value, and what it is moved to."""
    return {
        (name, factor): (getattr(settings, name), round(getattr(moved, name), 12))
        for (name, factor), moved in variants(settings).items()
    }


def table(
    rows: Sequence[Mapping[str, Any]], moved: Mapping[tuple[str, float], tuple[float, float]]
) -> list[dict[str, Any]]:
    """Return one entry per limit and factor: cases whose names change, and right answers more or less, by kind.

    Where rows tell axes on which the written model is worse than the given robot, `worse` are cases with such axes,
    more or less.

    Parameters
    ----------
    rows : of :func:`answers` or :func:`jointwear.studies.world.assumptions.answers`. moved : of `moves` beside it.
    """
    result = []
    for (name, factor), (value, moved_to) in moved.items():
        key = f"{name} {factor:g}"
        changed, worse, difference = 0, 0, dict.fromkeys(RIGHT, 0)
        for row in rows:
            before, after = row["found"][" 1"], row["found"][key]
            changed += before["names"] != after["names"]
            worse += bool(after.get("worse")) - bool(before.get("worse"))
            if before["right"] is not None and row["identifiable"]:
                difference[row["kind"]] += int(after["right"]) - int(before["right"])
        entry = {"limit": name, "value": value, "moved_to": moved_to, "names_change": changed, "right": difference}
        result.append(entry | ({"worse": worse} if any("worse" in row["found"][key] for row in rows) else {}))
    return result


def summary(
    rows: Sequence[Mapping[str, Any]], moved: Mapping[tuple[str, float], tuple[float, float]], command: str
) -> dict[str, Any]:
    """Return what is stored: the table with what it was made from; arguments as of :func:`table`."""
    counts = {kind: [r for r in rows if r["kind"] == kind and r["identifiable"]] for kind in RIGHT}
    return {
        "seeds": "choose",
        "cases": len(rows),
        "which": [r["case"] for r in rows],
        "judged": {kind: len(mine) for kind, mine in counts.items()},
        "right": {kind: sum(bool(r["found"][" 1"]["right"]) for r in mine) for kind, mine in counts.items()},
        "command": command,
        "sources": sources_digest(),
        "limits": table(rows, moved),
    }


def lines(stored: Mapping[str, Any]) -> Iterable[str]:
    """Yield the table in words."""
    judged_cases = ", ".join(f"{kind} {stored['right'][kind]} of {n}" for kind, n in stored["judged"].items())
    yield f"{stored['cases']} choosing cases; right as the limits stand: {judged_cases}"
    yield f"{'limit':18s} {'value':>9s} {'moved to':>9s} {'names change':>13s}  right answers more or less"
    for entry in stored["limits"]:
        moved = ", ".join(f"{kind} {n:+d}" for kind, n in entry["right"].items() if n) or "none"
        moved += f"; worse than given {entry['worse']:+d}" if entry.get("worse") else ""
        limit = f"{entry['limit']:18s} {entry['value']:9.4g} {entry['moved_to']:9.4g}"
        yield f"{limit} {entry['names_change']:13d}  {moved}"


def main(arguments: list[str] | None = None) -> int:
    """Parse arguments, run, print, store."""
    parser = argparse.ArgumentParser(prog="python -m jointwear.studies.world.sensitivity", description=__doc__)
    parser.add_argument("--cases", type=int, default=24, help="how many choosing cases, in the order of the plan")
    parser.add_argument("--skip", type=int, default=0, help="leave out the first so many")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--assumed", action="store_true", help="move the limits of discovery/assumed.py")
    parser.add_argument("--save", type=Path, help="write the table as JSON; the other of the two tables in it is kept")
    parser.add_argument("--rows", type=Path, help="write the answers as JSON, to be put together later")
    parser.add_argument("--of", type=Path, nargs="+", help="make the table of kept answers, no case is run")
    given = parser.parse_args(arguments)
    chosen = [] if given.of else cases("choose")[given.skip : given.skip + given.cases]
    kept = [row for path in given.of or [] for row in read_json(path)["answers"]]
    settings = Settings(inertial_prior=INERTIAL_PRIOR)
    one = partial(answers, wanted=variants(settings))
    moved = moves(settings)
    if given.assumed:
        one, moved = partial(assumptions.answers, factors=FACTORS), assumptions.moves(FACTORS)
    try:
        if given.jobs > 1:
            with single_threaded(given.jobs) as pool:
                rows = list(pool.map(one, chosen))
        else:
            rows = [one(case) for case in chosen]
    except InputError as error:
        print(error, file=sys.stderr)
        return 1
    what = f"--of {len(given.of)} files" if given.of else f"--cases {given.cases} --skip {given.skip}"
    command = f"python -m jointwear.studies.world.sensitivity {'--assumed ' if given.assumed else ''}{what}"
    if given.rows:
        write_json(given.rows, {"answers": rows})
    stored = summary([*kept, *rows], moved, command)
    print(*lines(stored), sep="\n")
    if given.save:
        earlier = read_json(given.save) if given.save.exists() else {}
        if given.assumed:
            write_json(given.save, {**earlier, "assumed": stored})
        else:
            write_json(given.save, stored | {key: earlier[key] for key in ("assumed",) if key in earlier})
    return 0


if __name__ == "__main__":
    sys.exit(main())
