"""Compare one verdict with the truth of its case. Nothing here knows how the verdict was found."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from jointwear.studies.challenge.separability import IDENTIFIABLE, SEPARABLE
from jointwear.studies.challenge.tiers import WHOLE_ARM

#: The augmented model counts as not worse where its error exceeds that of the retuned one by no more than this share.
NOT_WORSE = 1e-3
#: The augmented model is worse than the given one where its error on an axis is larger by more than this share.
WORSE = 0.05
#: A gap is judged where the given model's error exceeds the floor by this share.
CLOSABLE = 0.02


def accepted_names(effect: Mapping[str, Any]) -> set[str]:
    """Return the true name and those that the motion cannot tell from it."""
    return {effect["effect"], *(k for k, left in effect.get("rivals", {}).items() if left < SEPARABLE)}


def _axes(effect: Mapping[str, Any]) -> set[int | None]:
    return {effect["axis"], *effect.get("also", [])}


def _matches(named: Mapping[str, Any], effect: Mapping[str, Any], strict: bool = False) -> bool:
    names = {effect["effect"]} if strict else accepted_names(effect)
    # A payload has no axis; a rival name given in its place has one.
    place = effect["axis"] is None or named["axis"] is None or named["axis"] in _axes(effect)
    return named["effect"] in names and place


def error_norm(predicted: np.ndarray, truth: np.ndarray) -> float:
    """Return the root sum of squares over axes of the RMS error [N m]; arrays (k, n), the truth NaN at rest."""
    square = np.where(np.isfinite(truth), (predicted - truth) ** 2, np.nan)
    moving = np.isfinite(square).any(axis=0)
    return float(np.sqrt(np.sum(np.nanmean(square[:, moving], axis=0))))


def gap_closed(errors: Mapping[str, float], floor: float) -> float | None:
    """Return 1 - (augmented - floor) / (nominal - floor); None where the given model is as good as the motion allows.

    The floor is what derived velocities and accelerations cost: the error of the given model on the logged motion
    against itself on the true motion. No model that is fed with the logged motion gets below it.
    """
    if errors["nominal"] < floor * (1 + CLOSABLE):
        return None
    return 1 - (errors["augmented"] - floor) / (errors["nominal"] - floor)


def worse_axes(predicted: np.ndarray, target: np.ndarray) -> list[int]:
    """Return the 1-based axes on which the augmented model is worse than the given one by more than `WORSE`.

    Parameters
    ----------
    predicted : (3, k, n) torque of nominal, retuned and augmented model. target : (k, n), NaN where not judged [N m].
    """
    seen = np.isfinite(target).any(axis=0)
    square = np.where(np.isfinite(target), (predicted[[0, 2]] - target) ** 2, np.nan)[:, :, seen]
    given, augmented = np.sqrt(np.nanmean(square, axis=1))
    return [int(k) + 1 for k in np.flatnonzero(seen)[augmented > given * (1 + WORSE)]]


def judge(
    facts: Mapping[str, Any], verdict: Mapping[str, Any], errors: Mapping[str, float] | None, seconds: float | None
) -> dict[str, Any]:
    """Return one row of the score table.

    Parameters
    ----------
    facts : truth of the case. verdict : content of verdict.json, or {"refused": reason}.
    errors : error norm of the models "nominal", "retuned" and "augmented" against the noise-free held-out torque, and
        "floor", what derived motion costs (see :func:`gap_closed`).

    Returns
    -------
    dict : None stands where a question does not apply to the case.
    """
    kind = facts["kind"]
    truth = facts["effects"]
    named = verdict.get("effects", [])
    first = named[0] if named else None
    weakest = min((e["energy"] for e in truth), default=None)
    row: dict[str, Any] = {
        "case": facts["case"],
        "tier": facts["tier"],
        "kind": kind,
        "subject": facts["subject"],
        "closed_loop": facts["closed_loop"],
        "axis": truth[0]["axis"] if truth else (facts["wrong_parameter"] or {}).get("axis"),
        "form": truth[0]["form"] if truth else None,
        "size": truth[0]["size"] if truth else (facts["wrong_parameter"] or {}).get("share"),
        "energy": weakest if truth else (facts["wrong_parameter"] or {}).get("energy"),
        "verdict": verdict.get("verdict", "refused"),
        "first_name": first["effect"] if first else None,
        "first_axis": first["axis"] if first else None,
        "named": [[e["effect"], e["axis"]] for e in named],
        "evidence": first.get("evidence_nats") if first else None,
        "seconds": seconds,
    }
    row["identifiable"] = None if row["energy"] is None else row["energy"] > IDENTIFIABLE
    hidden = truth if kind in ("single", "two") else []
    row["names"] = [
        {
            "evidence": e.get("evidence_nats"),
            "probability": e.get("probability"),
            "log_odds": e.get("log_odds"),
            "share": e.get("cross_validated_gain"),
            "left": e.get("structure_left"),
            "right": any(_matches(e, t) for t in hidden),
        }
        for e in named
    ]
    if kind == "single":
        row |= _judge_single(truth[0], named)
    elif kind == "two":
        found = [any(_matches(e, t) for e in named) for t in truth]
        row["both_found"] = all(found)
        row["two_exact"] = all(found) and all(any(_matches(e, t) for t in truth) for e in named)
    elif kind == "nothing":
        row["false_name"] = bool(named)
    elif kind == "retuned":
        row["retuned"] = row["verdict"] == "retuned" and not named
        row["right_parameter"] = _parameter_listed(facts["wrong_parameter"], verdict)
    elif kind == "outside":
        row["unknown"] = row["verdict"] == "unknown"
        row["unknown_only"] = row["unknown"] and not named
    if errors:
        row["errors"] = dict(errors)
        row["not_worse"] = errors["augmented"] <= errors["retuned"] * (1 + NOT_WORSE)
        if kind in ("single", "two"):
            row["gap_closed"] = gap_closed(errors, errors.get("floor", 0.0))
    return row


def _judge_single(effect: Mapping[str, Any], named: list[Mapping[str, Any]]) -> dict[str, Any]:
    first = named[0] if named else None
    exact = bool(named) and all(_matches(e, effect) for e in named) and len({e["effect"] for e in named}) == 1
    ties = first.get("tie_set", [first["effect"]]) if first else []
    return {
        "name_first": bool(first) and first["effect"] in accepted_names(effect),
        "name_first_strict": bool(first) and first["effect"] == effect["effect"],
        "axis_right": bool(first)
        and first["axis"] in (_axes(effect) | ({None} if first["effect"] in WHOLE_ARM else set())),
        "exact_set": exact,
        "exact_set_strict": exact and all(_matches(e, effect, strict=True) for e in named),
        "tie_holds": bool(accepted_names(effect) & set(ties)) if first else None,
        "tie_holds_strict": effect["effect"] in ties if first else None,
        "tie_size": len(ties) if first else None,
    }


def _parameter_listed(wrong: Mapping[str, Any], verdict: Mapping[str, Any]) -> bool:
    """Whether the verdict's list of wrong parameters holds the right parameter on the right axis or link."""
    words = {"coulomb_friction": "coulomb", "viscous_friction": "viscous", "motor_inertia": "motor_inertia"}
    for entry in verdict.get("retuned", []):
        name = str(entry["parameter"])
        if wrong["parameter"] == "link_inertia":
            if name.startswith(("mass", "link", "com", "inertia", "first_moment")):
                return True
        elif name.startswith(words[wrong["parameter"]]) and entry["axis"] == wrong["axis"]:
            return True
    return False
