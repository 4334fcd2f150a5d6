"""What a run says at its end: the pages that it built, the models that robots learnt and, for the report, its scores.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from jointwear.files.json_documents import read_json
from jointwear.files.wording import count

REPORT = Path("results/report/index.html")
#: Pages that other targets build.
PAGES = ("results/*/index.html", "results/*/*.html", "results/*/*/*.html")

#: Which model every robot learnt, which has no page.
LEARNED = "results/learned/*/learned.json"
#: Page and rows of the fleet, and the largest file of rows that is read for a line.
FLEET, ROWS, LARGEST_ROWS = Path("results/fleet/index.html"), Path("results/fleet/rows.json"), 5_000_000
#: Kinds of findings on an event before what is judged and on one to come, of `monitor.judging.early_events`.
EARLY_EVENT, PLANNED_EVENT = "early_event", "planned_event"
EVENTS = (EARLY_EVENT, PLANNED_EVENT)
#: Most lines of a kind.
MOST = 20


def learnt_line(learned: Path, root: Path) -> str:
    """Return which model a robot learnt and where that is written."""
    try:
        adopted = read_json(learned)["adopted"]
    except (ValueError, KeyError, TypeError):
        adopted = ""
    told = {"given": ", the given model stays", "": ""}.get(adopted, f", the {adopted} model is used from now on")
    return f"learnt: {learned.relative_to(root)}{told}"


def score_lines(summary: Path) -> list[str]:
    """Return one line per claim of the paper, from the results in a report; none where there is no such file."""
    try:
        statements = read_json(summary)["summary"]["statements"]
        return [f"{s['title']}: {s['verdict']}. {s['text'].split('. ')[0].rstrip('.')}." for s in statements[:5]]
    except (ValueError, KeyError, TypeError, AttributeError):
        return []


def _refusal_of(row: dict) -> list[str]:
    """Return why a robot is refused, or the newest of its logs, in a line; none where neither is."""
    if row["result"] == "refused":
        return [f"refused: {row['robot']}: {row['reason']}"]
    newest = row.get("refusals", [])[-1:] if row["urgency"] == "refused" else []
    return [f"refused: {row['robot']}: {told}" for told in newest]


def _early_of(row: dict) -> list[str]:
    """Return the events of a robot's entry that close nothing, in a line each."""
    return [f"event: {row['robot']}: {f['words']}" for f in row.get("findings", []) if f["kind"] in EVENTS]


def _kept_of(name: str, rows: Path) -> str:
    """Return in words what is kept of a robot that the configuration no longer names."""
    kept = [rows.parent / "robots" / name, rows.parents[1] / "learned" / name]
    root = rows.parents[2]
    there = [path.relative_to(root).as_posix() for path in kept if path.is_dir()]
    return f"what is known of it is kept in {' and '.join(there)}; delete that if the robot does not come back"


def fleet_lines(rows: Path) -> list[str]:
    """Return how many robots are to be looked at and for what, why any is refused, which events close nothing, and
    whose results are kept though no robot has them: nobody may open the pages of these. No lines where there is no such
    file, where it is damaged or where it is large.
    """
    try:
        if rows.stat().st_size > LARGEST_ROWS:
            return []
        content = read_json(rows)
        robots, left = content["robots"], content.get("left", [])
        kinds = Counter(row["urgency"] for row in robots)
        waiting = len(robots) - kinds.pop("healthy", 0)
        told = [line for row in robots for line in [*_refusal_of(row), *_early_of(row)]]
        told += [f"left: {name} is no longer in the configuration; {_kept_of(name, rows)}" for name in left]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return []
    # The rows are ranked: what is most urgent comes first.
    why = f": {', '.join(f'{number} {kind}' for kind, number in kinds.items())}" if kinds else ""
    return [f"fleet: {waiting} of {count(len(robots), 'robot')} to look at{why}", *told[:MOST]] if robots else []


def closing_lines(root: Path, since: float) -> list[str]:
    """Return what to print after a successful run.

    Parameters
    ----------
    root : working directory of the run.
    since : when the run began [s since 1970]; pages written before are not of this run.
    """
    written = sorted({p for pattern in PAGES for p in root.glob(pattern) if p.stat().st_mtime >= since})
    learnt = sorted(p for p in root.glob(LEARNED) if p.stat().st_mtime >= since)
    lines = []
    if root / REPORT in written:
        lines += score_lines(root / REPORT.with_name("summary.json"))
        written.remove(root / REPORT)
        lines.append(f"report: {REPORT}")
    if root / FLEET in written:
        lines += fleet_lines(root / ROWS)
    lines += [f"page: {page.relative_to(root)}" for page in written[:MOST]]
    return lines + [learnt_line(path, root) for path in learnt[:MOST]]
