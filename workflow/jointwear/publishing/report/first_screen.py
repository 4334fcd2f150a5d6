"""The first screen of the report: every claim of the paper and every thing that it leaves out, one line each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from jointwear.files.shown_numbers import fixed, number, percent
from jointwear.files.wording import count
from jointwear.publishing.report.wording import FIGURE_SCORES
from jointwear.reproduction.verdicts import AGREES, CLOSE, NOT_COMPARABLE

Line = dict[str, str]
#: Where the report explains a statement; the anchor of a heading.
ANCHORS = {
    "table_iv": "table-iv",
    "table_v": "table-v",
    "table_vi": "table-vi",
    "table_ii": "location",
    "location": "location",
    "figures": "figure-2",
    "claim": "claim",
}


def _findings(data: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Claim of the paper and what became of it, by key of the statement."""
    scores, location = data["scores"], data["location"]["pooled"]["chosen"]
    four, five, six, two = (scores[f"table_{n}"] for n in ("iv", "v", "vi", "ii"))
    idle = data["location"]["without_wear"]["chosen"]["share"]
    hours, peak = four["median_error_h"], data["figures"]["divergence"]
    divergence = f"{number(peak['peak_nat'], 2)} nat, the paper's plot ends at {number(peak['published'][1])}"
    drawn = [v for part in FIGURE_SCORES if (v := data["figures"][part]["verdict"]) != NOT_COMPARABLE]
    apart = f", hours {number(hours, 2)} h apart in the median" if hours is not None else ""
    findings = {
        "table_iv": (
            f"Wear shows in {data['paper']['detected_total']} of {scores['table_iii']['published_runs']} runs",
            f"same outcome in {four['same_pattern']} of {four['compared']} runs{apart}",
        ),
        "location": (
            "The lags name the worn axis in every detected run, or all but one",
            f"right in {percent(location['share'])}; but an axis is also named in {percent(idle)} of healthy periods"
            if location["total"]
            else "nothing was detected",
        ),
        "table_ii": (
            "The lags of Table II",
            f"{two['same_sign']} of {count(two['pairs'], 'pair')} of axes have the paper's sign",
        ),
        "figures": (
            "Figures 1 to 3",
            f"{drawn.count(AGREES)} of {count(len(drawn), 'comparison')} agree, {drawn.count(CLOSE)} come close"
            + (f"; KL divergence up to {divergence}" if peak["verdict"] != NOT_COMPARABLE else ""),
        ),
    }
    if five["median_error"] is not None:
        off = f"{percent(five['median_error_at_published_hour'], 1)} off in the median"
        most = f"{percent(five['largest_error_at_published_hour'], 1)} at most"
        findings["table_v"] = ("The largest torques of Table V", f"{off}, {most}, at the paper's hours")
    if six["median_error"] is not None:
        findings["table_vi"] = (
            "The variation of the torque in Table VI",
            f"{number(six['median_error_at_published_hour'], 2)} off in the median at the paper's hours",
        )
    return findings


def _within_a_sentence(text: str) -> str:
    """Return a sentence as it stands after a colon: small at the beginning, but for abbreviations."""
    return text[:1].lower() + text[1:] if text[1:2].islower() else text


def claims(data: Mapping[str, Any], statements: Sequence[Mapping[str, str]]) -> list[Line]:
    """Return one line per claim of the paper: `verdict`, `claim`, `finding`, `anchor`.

    Parameters
    ----------
    data : of the report.
    statements : the long form, with the verdict of each; what cannot be compared keeps its short reason.
    """
    findings, lines = _findings(data), []
    for statement in statements:
        key = statement["key"]
        if key not in ANCHORS:
            continue
        claim, finding = findings.get(key, (statement["title"], statement.get("conclusion", statement["text"])))
        if statement["verdict"] == NOT_COMPARABLE:
            finding = statement["text"].split(". ")[0].rstrip(".")
        lines.append(
            {
                "verdict": statement["verdict"],
                "claim": claim,
                "finding": _within_a_sentence(finding.split(". ")[0].rstrip(".")),
                "anchor": ANCHORS[key],
            }
        )
    return lines


def _one_experiment(fit: Mapping[str, Any] | None) -> list[Line]:
    """Return the line of the one experiment that explains most of what is printed, nothing where it was not fitted."""
    if fit is None:
        return []
    found = {check["name"]: check for check in fit["checks"]}
    cells, hours, torque = (found[name]["value"] for name in ("cells", "hour_error", "torque_median"))
    return [
        {
            "claim": "One experiment for all tables",
            "finding": f"one arm, one payload and one reading give the outcome of {cells} of 36 runs and Table V "
            f"within {percent(torque, 1)} in the median; on new random numbers their hours stay "
            f"{fixed(hours, 1)} h apart",
            "anchor": "joint_fit",
        }
    ]


def left_out(data: Mapping[str, Any], chapters: Mapping[str, Any]) -> list[Line]:
    """Return one line per thing that the paper does not say, with what was found: `claim`, `finding`, `anchor`.

    Parameters
    ----------
    chapters : content of the further chapters by name; a line links to one only where it is there.
    """
    payload = data["robot"]["payload"]
    mass = payload["mass"] if payload else 0.0
    recovery, readings = "recovery" in chapters, "multiverse" in chapters
    alarms = data["detection"]["normal_mean"]["q"]["alarms_per_week"]
    periods, hours = data["scores"]["table_iii"]["replicates"], data["config"]["normal"]["test_hours"]
    return [
        *_one_experiment(chapters.get("joint_fit")),
        {
            "claim": "A payload",
            "finding": "no pose of the unloaded arm reaches the printed torques; "
            + (f"{number(mass, 2)} kg does" if mass else "this run carries none"),
            "anchor": "recovery" if recovery else "experiment",
        },
        {
            "claim": "The poses of the tasks and the constant of the wear law",
            "finding": "recovered from Tables V and VI; many sets of poses fit",
            "anchor": "recovery-poses" if recovery else "experiment",
        },
        {
            "claim": f"{count(len(data['assumptions']), 'choice')} of the signal processing",
            "finding": "each is a named option; the outcome of many runs depends on them",
            "anchor": "multiverse" if readings else "assumptions",
        },
        {
            "claim": "False alarms",
            "finding": f"{number(alarms, 2)} a week, from {periods} × {hours} h of normal operation of each task",
            "anchor": "false-alarms",
        },
    ]
