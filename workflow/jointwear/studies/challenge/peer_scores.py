"""Score the peers by the rules that discovery is scored by, each at the setting that did best on the choosing seeds."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jointwear.files.json_documents import read_json, write_json
from jointwear.studies.challenge.judge import judge
from jointwear.studies.challenge.tiers import TIERS

Answers = dict[tuple[str, float], list[dict[str, Any]]]


def judged_answers(files: Sequence[tuple[str, str]]) -> Answers:
    """Return the judged rows of every (method, setting) from (truth, answers) JSON files."""
    rows: Answers = {}
    for truth_path, answer_path in files:
        said = {entry["case"]: entry["answers"] for entry in read_json(answer_path)["cases"]}
        for facts in read_json(truth_path)["cases"]:
            for answer in said[facts["case"]]:
                named = [
                    {"effect": name, "axis": axis, "evidence_nats": energy / 2}
                    for name, axis, energy in answer["named"]
                ]
                verdict = {"verdict": "effects" if named else "none", "effects": named}
                row = judge(facts, verdict, None, answer["seconds"])
                rows.setdefault((answer["method"], answer["setting"]), []).append(row)
    return rows


def _summary(method: str, setting: float, rows: list[dict[str, Any]]) -> dict[str, Any]:
    singles = [r for r in rows if r["kind"] == "single" and r["identifiable"]]
    nothing = [r for r in rows if r["kind"] == "nothing"]

    def share(field: str) -> float:
        return sum(bool(r[field]) for r in singles) / max(len(singles), 1)

    return {
        "method": method,
        "setting": setting,
        "singles": len(singles),
        "name_first": share("name_first"),
        "exact_set": share("exact_set"),
        "nothing": len(nothing),
        "false_cases": sum(r["false_name"] for r in nothing),
        "names": sum(len(r["named"]) for r in singles) / max(len(singles), 1),
        "seconds": sum(r["seconds"] for r in rows) / max(len(rows), 1),
    }


def _merit(summary: dict[str, Any]) -> float:
    """Exact answers on one effect and on none weigh the same; the right first name breaks ties."""
    clean = 1 - summary["false_cases"] / max(summary["nothing"], 1)
    return summary["exact_set"] + clean + 0.01 * summary["name_first"]


def best_settings(rows: Answers) -> dict[tuple[str, str], float]:
    """Return the best setting by (tier, method)."""
    best = {}
    for tier in TIERS:
        for method in dict.fromkeys(m for m, _ in rows):
            tried = {
                setting: _merit(_summary(m, setting, [r for r in mine if r["tier"] == tier]))
                for (m, setting), mine in rows.items()
                if m == method
            }
            best[tier, method] = max(tried, key=tried.__getitem__)
    return best


def write_peer_scores(
    chosen: Sequence[tuple[str, str]], files: Sequence[tuple[str, str]], rows_path: str, output: str | Path
) -> None:
    """Choose settings on `chosen`, score `files` with them beside discovery's own rows, and write the table.

    Parameters
    ----------
    chosen, files : (truth, answers) JSON files. rows_path : judged rows of discovery on the same cases.
    """
    best = best_settings(judged_answers(chosen))
    rows = judged_answers(files)
    own = read_json(rows_path)["cases"]
    tiers: dict[str, list] = {}
    for tier in TIERS:
        entries = []
        for (of_tier, method), setting in best.items():
            mine = [r for r in rows[method, setting] if r["tier"] == tier]
            if of_tier == tier and mine:
                entries.append(_summary(method, setting, mine))
        if entries:
            tiers[tier] = [
                *entries,
                _summary("jointwear discover", "as shipped", [r for r in own if r["tier"] == tier]),
            ]
    write_json(output, {"tiers": tiers})
