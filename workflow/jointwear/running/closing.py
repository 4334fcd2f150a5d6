"""What a run says at its end: the pages that it built, the models that robots learnt and, for the report, its scores.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from pathlib import Path

from jointwear.files.json_documents import read_json

REPORT = Path("results/report/index.html")
#: Pages that other targets build.
PAGES = ("results/*/index.html", "results/*/*.html", "results/*/*/*.html")

#: Which model every robot learnt, which has no page.
LEARNED = "results/learned/*/learned.json"
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
    lines += [f"page: {page.relative_to(root)}" for page in written[:MOST]]
    return lines + [learnt_line(path, root) for path in learnt[:MOST]]
