"""The page of the hidden-effect test: one file, no script, no outside resource."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jointwear.files.json_documents import read_json
from jointwear.files.text_files import replace_text
from jointwear.publishing.report.rendering import render_page
from jointwear.studies.challenge.arms import ARMS
from jointwear.studies.challenge.circumstances import CLOSED_LOOP, RATES
from jointwear.studies.challenge.plan import part_batches
from jointwear.studies.challenge.scores import SHARES, UPPER_LIMITS, reached
from jointwear.studies.challenge.separability import IDENTIFIABLE, SEPARABLE
from jointwear.studies.challenge.tiers import COUNTS, DRAWINGS, EFFECTS, FULL, TARGETS, TIERS
from jointwear.studies.world.page import limits_context, world_context

_WORDS = {
    "identifiable_share": "single effects that the motion can show (identifiable)",
    **{name: text for name, (_, _, text) in SHARES.items()},
    "false_names": "false names where nothing is hidden",
    "gap_median": "held-out gap closed, median",
    "gap_tenth": "held-out gap closed, 10th percentile",
    "not_worse": "not worse than retuning on held-out motion",
    "not_worse_named": "the same, only cases with a named effect",
    "worse": "augmented worse than given on an axis by > 5 %, held-out measurement",
    "calibration_error": "expected calibration error of the probability",
    "seconds": "processor seconds, median",
    "tie_size": "mean size of the tie set",
    "name_first_strict": "right name first, no two names counted as one",
    "exact_set_strict": "exact set, no two names counted as one",
    "right_parameter": "the wrong parameter itself is listed",
}
_ORDER = [*TARGETS, "name_first_strict", "exact_set_strict", "right_parameter", "not_worse_named"]
#: As the library of effects spells them, which the rooms that make and show the hidden effects know nothing of.
_SPELLED = {
    "stribeck": "Stribeck",
    "coulomb": "Coulomb",
    "temperature dependent": "temperature-dependent",
    "load dependent": "load-dependent",
    "position dependent": "position-dependent",
    "presliding": "pre-sliding",
}
#: Fewest cases of an effect, and fewest of them right and wrong, from which a curve over their sizes means anything.
FEWEST_CASES, FEWEST_OF_EACH = 12, 3


def in_words(name: str) -> str:
    """Return identifiers of effects in a text as words, spelled as on the other pages."""
    text = name.replace("_", " ")
    for plain, spelled in _SPELLED.items():
        text = text.replace(plain, spelled)
    return text


_NAMES = {
    **{name: in_words(name) for name in EFFECTS},
    **{answer: answer for answer in ("nothing", "none", "retuned", "unknown", "refused")},
    "outside": "outside the library",
}
_SET_WORDS = {
    "choose": "the seeds on which thresholds were chosen",
    "sample": "a sample of cases with seeds of their own",
    "report": "the seeds that are kept for the report",
}


def _target(name: str, tier: str) -> str:
    if name not in TARGETS:
        return ""
    value = TARGETS[name][list(TIERS).index(tier)]
    if isinstance(value, tuple):
        return f"{value[0]:.2f} to {value[1]:.2f}"
    return f"{'at most' if name in UPPER_LIMITS else 'at least'} {value:g}"


def _shown(score: Mapping[str, Any]) -> str:
    if score["value"] is None:
        return "no cases"
    interval = f" ({score['low']:.2f} to {score['high']:.2f})" if score["low"] is not None else ""
    return f"{score['value']:.3f}{interval}"


def score_of(content: Mapping[str, Any], name: str, which: str = "scores") -> Mapping[str, Any]:
    """Return a score of a tier; one that was not counted when the summary was made has no value."""
    return content[which].get(name, {"value": None, "count": 0, "low": None, "high": None})


def score_table(tiers: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the rows of the score table: words, and for every tier value, all cases, target and whether reached."""
    return [
        {
            "words": _WORDS[name],
            "cells": [
                {
                    "value": _shown(score_of(content, name)),
                    "all": _shown(score_of(content, name, "all_cases")),
                    "count": score_of(content, name)["count"],
                    "target": _target(name, tier),
                    "reached": reached(name, tier, score_of(content, name)),
                }
                for tier, content in tiers.items()
            ],
        }
        for name in _ORDER
    ]


#: What has to be answered to the kinds that hide no effect of the library.
RIGHT_ANSWER = {"nothing": ("none",), "outside": ("unknown",)}


def right_answers(truth: str, wrong_file: bool) -> tuple[str, ...]:
    """Return the answers that are right; `wrong_file`: the robot file of every case is off, so that it may be retuned
    where nothing is hidden.
    """
    answers = RIGHT_ANSWER.get(truth, (truth,))
    return (*answers, "retuned") if truth == "nothing" and wrong_file else answers


def confusion_table(confusion: Mapping[str, Mapping[str, int]], wrong_file: bool = False) -> dict[str, Any]:
    """Return columns and rows of a confusion matrix; every cell has the count and its share of the row."""
    given = {answer for answers in confusion.values() for answer in answers}
    columns = [n for n in EFFECTS if n in given or confusion.get(n)]
    columns += [n for n in ("none", "retuned", "unknown", "refused") if n in given]
    columns += sorted(given - set(columns))
    rows = []
    for truth, answers in confusion.items():
        total = sum(answers.values())
        if total:
            cells = [
                {
                    "answer": c,
                    "count": answers.get(c, 0),
                    "share": answers.get(c, 0) / total,
                    "right": c in right_answers(truth, wrong_file),
                }
                for c in columns
            ]
            rows.append({"truth": truth, "total": total, "cells": cells})
    return {"columns": columns, "rows": rows}


def _told(limit: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is known of the sizes of an effect, its curve only where there are cases enough for one."""
    enough = limit["cases"] >= FEWEST_CASES and min(limit["right"], limit["cases"] - limit["right"]) >= FEWEST_OF_EACH
    return dict(limit) if enough else {**limit, "half": None, "ninety": None, "grows_with_size": None}


def calibration_points(bins: list[Mapping[str, Any]]) -> list[dict[str, float]]:
    """Return the filled bins as points of a drawing 600 wide and 160 high, with 95 % intervals."""
    filled = [b for b in bins if b["names"]]
    step = 560 / max(len(filled), 1)

    def height(share: float) -> float:
        return round(150 - 140 * share, 1)

    return [
        {
            "x": round(40 + step * (k + 0.5), 1),
            "y": height(b["right"] / b["names"]),
            "top": height(b["share_high"]),
            "bottom": height(b["share_low"]),
            "label": f"{b['low']:g}+" if b["high"] > 1e9 else f"{b['low']:g} to {b['high']:g}",
            "names": b["names"],
        }
        for k, b in enumerate(filled)
    ]


def set_words(part: str, cases: int, drawing: int) -> str:
    """Return in words which cases a page shows; `part` as in :func:`jointwear.studies.challenge.plan.part_batches`."""
    seed_set, counts = part_batches(part)
    whole = len(TIERS) * sum(COUNTS[seed_set].values())
    words = _SET_WORDS[seed_set]
    if drawing > 1:
        words += f" (drawing {drawing}: results on earlier ones had been seen before discovery was last changed)"
    if cases >= whole:
        return words
    count = max(counts.values())
    return (
        f"{words}: the first {count} batches of every tier, each a like mixture of all kinds, "
        f"{cases} of {whole} cases. The share was fixed before any result was looked at"
    )


def write_page(
    scores_path: str,
    peers_path: str | None,
    output: str,
    part: str,
    seed: int,
    command: str | None = None,
    drawing: int | None = None,
    world_path: str | None = None,
    limits_path: str | None = None,
) -> None:
    """Write the page from the scores (and, where they were run, those of the peers).

    Parameters
    ----------
    part : a seed set or its first batches. command : what makes the scores, where they were not made just now.
    drawing : of the seed set that was run; default the present one.
    world_path, limits_path : summary of the tier "world", and what moving the limits does there, where they are kept.

    Raises
    ------
    InputError : if the scores are missing or broken.
    """
    scores = read_json(scores_path)
    tiers = scores["tiers"]
    drawing = DRAWINGS[part_batches(part)[0]] if drawing is None else drawing
    missed = {
        tier: [_WORDS[name] for name in TARGETS if reached(name, tier, score_of(content, name)) is False]
        for tier, content in tiers.items()
    }
    judged = sum(
        reached(name, tier, score_of(content, name)) is not None for tier, content in tiers.items() for name in TARGETS
    )
    context = {
        "names": _NAMES,
        "set_words": set_words(part, scores["cases"], drawing),
        "older": drawing if drawing < DRAWINGS[part_batches(part)[0]] else None,
        "is_sample": COUNTS[part_batches(part)[0]] is not FULL,
        "command": command,
        "seed": seed,
        "cases": scores["cases"],
        "tiers": tiers,
        "settings": {name: TIERS[name] for name in tiers},
        "table": score_table(tiers),
        "missed": missed,
        "judged": judged,
        "confusion": {
            name: confusion_table(content["confusion"], TIERS[name].inertial_error > 0)
            for name, content in tiers.items()
        },
        "curves": {name: [_told(limit) for limit in content["limits"]] for name, content in tiers.items()},
        "fewest": (FEWEST_CASES, FEWEST_OF_EACH),
        "in_words": in_words,
        "calibration": {name: calibration_points(content["calibration"]) for name, content in tiers.items()},
        "world": world_context(read_json(world_path)) if world_path else None,
        "limits": limits_context(read_json(limits_path)) if limits_path else None,
        "peers": read_json(peers_path) if peers_path else None,
        "identifiable": IDENTIFIABLE,
        "separable": SEPARABLE,
        "closed_loop": CLOSED_LOOP,
        "arms": len(ARMS),
        "rates": (min(RATES), max(RATES)),
    }
    replace_text(output, render_page("challenge.html.j2", context))
