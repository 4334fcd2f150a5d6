"""Give a case to discovery and judge what it says. The only place of the tier where truth and verdict meet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointwear.discovery import Settings
from jointwear.studies.challenge.judge import accepted_names, error_norm, judge, worse_axes
from jointwear.studies.challenge.scoring import peak_covered
from jointwear.studies.challenge.solve import MODELS, solve, with_words
from jointwear.studies.world.case import WorldCase
from jointwear.studies.world.setting import INERTIAL_PRIOR

#: What a row keeps of the circumstances of a case.
CIRCUMSTANCES = (
    "arm",
    "rate",
    "bits",
    "bits_read",
    "link_side",
    "torque_kind",
    "motors_in_file",
    "controller",
    "motion",
    "velocity",
    "velocity_lag",
    "inertial_error",
)
#: Half width of a 95 % interval in standard deviations.
_TWO_SIDED = 1.96
#: Names that a disturbance outside the library may rightly get: a soft obstacle and a bent tooth are springs in q.
TOLERATED = {"wall": {"joint_spring"}, "bump": {"joint_spring"}}
#: Kind of case -> field of a judged row that says whether the answer is right; a wrong parameter has no name.
RIGHT = {"single": "exact_set", "two": "two_exact", "nothing": "no_name", "outside": "unknown_only"}


def answer(case: WorldCase, settings: Settings | None = None) -> dict[str, Any]:
    """Return one row of the score table; fields as of :func:`jointwear.studies.challenge.judge.judge`, and more.

    More are: `worse` and `worse_than_truth` (1-based axes on which the augmented model is worse than the given one,
    against the held-out measurement and against the torque without noise), `names` with their probability,
    `parameters` (true value, given value and standard deviation, covered), `unknown_only`, and the circumstances.
    """
    settings = settings or Settings(inertial_prior=INERTIAL_PRIOR)
    recording = with_words(case.recording, case.told)
    verdict, torque, seconds = solve(recording, case.robot, settings)
    return judged(case, verdict, torque, seconds)


def judged(case: WorldCase, verdict: Mapping[str, Any], predicted: np.ndarray, seconds: float | None) -> dict[str, Any]:
    """Judge a verdict; `predicted` (3, k, n) is the torque of nominal, retuned and augmented model [N m]."""
    facts, errors = case.facts, None
    if np.isfinite(predicted).any():
        errors = {m: error_norm(p, case.torque) for m, p in zip(MODELS, predicted, strict=True)}
        errors["floor"] = error_norm(predicted[0], case.given)
    row = judge(facts, verdict, errors, seconds)
    if errors:
        row["worse"] = worse_axes(predicted, case.measured)
        row["worse_than_truth"] = worse_axes(predicted, case.torque)
    for key in CIRCUMSTANCES:
        row[key] = facts[key]
    named = verdict.get("effects", [])
    row["refused"] = verdict.get("refused")
    if facts["kind"] == "single" and row.get("name_first_strict") and row["axis_right"]:
        row["covered"] = peak_covered(facts["effects"][0], named[0])
        row["parameters"] = _parameters(facts["effects"][0]["parameters"], named[0].get("parameters", {}))
    if facts["kind"] == "outside":
        row["unknown_only"] = unknown_only(case, row["verdict"], named)
    row["hidden"] = [
        [e["effect"], e["axis"], e["form"], e["size"], e["energy"], sorted(accepted_names(e) - {e["effect"]})]
        for e in facts["effects"]
    ]
    row["wrong_parameter"] = facts["wrong_parameter"]
    row["unexplained"] = [u.get("axis") for u in verdict.get("unexplained", [])]
    row["suspects"] = [[s.get("effect"), s.get("axis")] for s in verdict.get("suspects", [])]
    return row


def unknown_only(case: WorldCase, word: str, named: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether a disturbance outside the library got no name but one that it may rightly have."""
    tolerated = TOLERATED.get(str(case.facts["subject"]), set())
    return all(e["effect"] in tolerated for e in named) and (word == "unknown" or bool(named))


def is_right(row: Mapping[str, Any]) -> bool | None:
    """Return whether a judged row is right, None where the question does not apply to its kind or its case."""
    field = RIGHT.get(row["kind"])
    if field is None:
        return None
    found = not row["named"] if field == "no_name" else row.get(field)
    return None if found is None else bool(found)


def _parameters(true: Mapping[str, float], given: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    result = {}
    for name, value in true.items():
        entry = given.get(name)
        if entry is None or entry.get("std") is None:
            continue
        inside = abs(entry["value"] - value) <= _TWO_SIDED * entry["std"]
        result[name] = {"true": value, "value": entry["value"], "std": entry["std"], "covered": bool(inside)}
    return result
