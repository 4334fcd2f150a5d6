"""The verdict: what a data set shows, in the layout of verdict.json."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jointwear.discovery.augment import augmented_robot, augmented_urdf, simulate
from jointwear.discovery.candidates import LINK_MASS, Candidate, scan
from jointwear.discovery.estimation import Estimate, Final
from jointwear.discovery.identifiability import NEEDED, Visible, identifiability
from jointwear.discovery.problem import FRICTION
from jointwear.effects import get_effect, library
from jointwear.files.json_values import six_digits
from jointwear.robots.inertia import bodies

_FRICTION_UNITS = ("N m", "N m", "N m s/rad", "kg m2")


@dataclass
class Verdict:
    """What discovery says about one data set.

    Attributes
    ----------
    data : the content of verdict.json.
    augmented_robot : the augmented robot in the layout of a robot file; `augmented_urdf` goes beside it, or None.
    torques : (m, n) torques of the nominal, retuned and augmented model at the samples used.
    sample_time, sample_trajectory : (m,) of those samples. moving : (m, n) where a joint can be judged.
    measured : (m, n) torque. map : the identifiability map. final : everything that the report draws from.
    """

    data: dict[str, Any]
    augmented_robot: dict[str, Any]
    augmented_urdf: str | None
    torques: dict[str, np.ndarray]
    sample_time: np.ndarray
    sample_trajectory: np.ndarray
    test: np.ndarray
    moving: np.ndarray
    measured: np.ndarray
    map: list[Visible]
    final: Final = field(repr=False)

    @property
    def verdict(self) -> str:
        """none, retuned, effects or unknown."""
        return self.data["verdict"]

    @property
    def effects(self) -> list[dict[str, Any]]:
        """The named effects, strongest evidence first."""
        return self.data["effects"]

    def to_json(self) -> str:
        """Return the text of verdict.json."""
        return json.dumps(self.data, indent=1, allow_nan=False) + "\n"


def make_verdict(name: str, final: Final, restrictions: list[str]) -> Verdict:
    """Put names, numbers, what is left and what cannot be told into one verdict."""
    outcome, problem = final.outcome, final.outcome.problem
    seen = identifiability(outcome.white, outcome.dictionary)
    torques = simulate(final)
    effects = [_effect_entry(final, e) for e in final.estimates]
    effects.sort(key=lambda e: -e["evidence_nats"])
    retuned = _retuned(final)
    left = [
        {
            "axis": u.axis + 1,
            "argument": u.argument,
            "range": [six_digits(u.low), six_digits(u.high)],
            "unit": u.unit,
            "p_value": six_digits(u.p_value),
        }
        for u in outcome.unexplained[:12]
    ]
    if left:
        word = "unknown"
    elif effects:
        word = "effects"
    else:
        word = "retuned" if retuned else "none"
    floor = [None if w is None else six_digits(w.marginal) for w in outcome.white.whiteners]
    usable, test = problem.measured.usable, problem.test
    data = {
        "dataset": name,
        "verdict": word,
        "effects": effects,
        "retuned": retuned,
        "unexplained": left,
        "gap": {
            "unit": "N m",
            "per": "axis, RMS over moving samples of the test trajectories",
            **{
                kind: [
                    _rms(problem.measured.torque[:, j] - torque[:, j], usable[:, j] & test)
                    for j in range(problem.robot.joints)
                ]
                for kind, torque in torques.items()
            },
            "noise_floor": floor,
        },
        "not_identifiable": _not_identifiable(effects, seen),
        "next_experiment": None,
        "restrictions": restrictions,
    }
    return Verdict(
        data=data,
        augmented_robot=augmented_robot(final),
        augmented_urdf=augmented_urdf(final),
        torques=torques,
        sample_time=problem.measured.time,
        sample_trajectory=problem.measured.trajectory,
        test=test,
        moving=usable,
        measured=problem.measured.torque,
        map=seen,
        final=final,
    )


def _rms(values: np.ndarray, chosen: np.ndarray) -> float | None:
    return six_digits(np.sqrt(np.mean(values[chosen] ** 2))) if chosen.any() else None


def _effect_entry(final: Final, e: Estimate) -> dict[str, Any]:
    candidate = e.named.candidate
    effect = get_effect(candidate.effect)
    units = {p.name: p.unit for p in effect.parameters}
    ties = [candidate.effect]
    for other in e.named.ties:
        if other.effect != LINK_MASS and other.effect not in ties:
            ties.append(other.effect)
    low, high, unit = _regime(final, e)
    return {
        "effect": candidate.effect,
        "axis": None if candidate.axis is None else candidate.axis + 1,
        "source_axis": None if candidate.source is None else candidate.source + 1,
        "tie_set": ties,
        "parameters": {
            name: {
                "value": six_digits(value),
                "std": six_digits(e.std[name]) if name in e.std else None,
                "unit": units[name],
            }
            for name, value in e.parameters.items()
        },
        "regime": {"argument": _argument(effect.argument, candidate), "range": [low, high], "unit": unit},
        "peak_torque": {
            "value": six_digits(e.peak),
            "low": six_digits(e.peak_low),
            "high": six_digits(e.peak_high),
            "unit": "N m",
            "confidence": 0.95,
        },
        "form_corrected": e.form is not None,
        "evidence_nats": six_digits(e.named.evidence),
        "cross_validated_gain": six_digits(e.named.cross_validated),
    }


def _argument(words: str, candidate: Candidate) -> str:
    return words if candidate.source is None else words.replace("the other axis", f"joint {candidate.source + 1}")


def _regime(final: Final, e: Estimate) -> tuple[float, float, str]:
    """Return the range of the effect's argument over the training samples that could be judged."""
    problem, candidate = final.outcome.problem, e.named.candidate
    effect, state = get_effect(candidate.effect), problem.train_state
    axis = candidate.axis if candidate.axis is not None else 0
    used = problem.usable[:, axis]
    if effect.needs_source:
        values = state.velocity[used, candidate.source]
    elif effect.argument == "torque":
        values = state.torque[used, axis]
    elif effect.argument == "load":
        values = state.load[used, axis]
    elif effect.argument == "velocity":
        values = state.velocity[used, axis]
    elif effect.shape is not None:
        values = effect.shape(state, axis, candidate.nonlinear)[1][used]
    else:
        values = state.position[used, axis]
    return (
        six_digits(values.min()),
        six_digits(values.max()),
        effect.argument_unit if effect.shape or effect.needs_source else "rad",
    )


def _retuned(final: Final) -> list[dict[str, Any]]:
    """Return the numbers of the model that the data contradict, by the evidence that moving each is worth."""
    problem = final.outcome.problem
    robot, need = problem.robot, problem.settings.retuned_nats
    nominal = np.stack([robot.coulomb_positive, -robot.coulomb_negative, robot.viscous, robot.armature], axis=1)
    delta = final.delta_friction * np.array([1, -1, 1, 1])
    found = []
    for axis in problem.judged:
        prior = problem.friction_prior(axis)
        for k, name in enumerate(FRICTION):
            std = final.std_friction[axis, k]
            if std <= 0:
                continue
            nats = 0.5 * (delta[axis, k] / std) ** 2 - np.log(max(prior[k] / std, 1.0))
            if nats > need and abs(delta[axis, k]) > 0.02 * nominal[axis, k]:
                gear = abs(robot.gear_ratio[axis])
                # The numbers of a robot file: motor side.
                side = gear if k < 2 else gear**2
                sign = -1.0 if name == "coulomb_negative" else 1.0
                found.append(
                    {
                        "parameter": name,
                        "axis": axis + 1,
                        "nominal": six_digits(sign * nominal[axis, k] / side),
                        "value": six_digits(sign * (nominal[axis, k] + delta[axis, k]) / side),
                        "std": six_digits(std / side),
                        "unit": _FRICTION_UNITS[k],
                    }
                )
    return found + _wrong_mass(final)


def _wrong_mass(final: Final) -> list[dict[str, Any]]:
    """Return the link whose mass best explains that inertial parameters are not nominal, if they are not."""
    outcome, problem = final.outcome, final.outcome.problem
    white = outcome.white
    named = [n for n in outcome.named if n.candidate.effect == LINK_MASS]
    fixed = [t for t in white.base if t.label != "inertial"]
    effects = [t for n in outcome.named if n.candidate.effect != LINK_MASS for t in n.terms]
    from jointwear.discovery.linear import Fit, gain

    fit = Fit(white.targets, [*fixed, *effects])
    full = white.fit([*effects])
    if not named and full.evidence - fit.evidence < problem.settings.retuned_nats:
        return []
    keys = {(LINK_MASS, link, None) for link in range(problem.robot.joints)}
    found = scan(white, outcome.dictionary, fit, keys)
    best = next((s for s in found if np.isfinite(s.evidence)), None)
    if named:
        best = next((s for s in found if s.candidate.key == named[0].candidate.key), best)
    if best is None:
        return []
    b, gram = fit.gram(best.blocks)
    if gain(b, gram, best.std) < problem.settings.retuned_nats and not named:
        return []
    share = float(b[0] / (gram[0, 0] + 1 / best.std[0] ** 2))
    mass = bodies(problem.robot)[best.candidate.axis][0]
    return [
        {
            "parameter": "link_mass",
            "axis": best.candidate.axis + 1,
            "nominal": six_digits(mass),
            "value": six_digits(mass * (1 + share)),
            "std": six_digits(mass / np.sqrt(gram[0, 0] + 1 / best.std[0] ** 2)),
            "unit": "kg",
        }
    ]


def _not_identifiable(effects: list[dict[str, Any]], seen: list[Visible]) -> list[dict[str, Any]]:
    found = []
    for e in effects:
        for other in e["tie_set"][1:]:
            found.append(
                {
                    "effects": [e["effect"], other],
                    "axis": e["axis"],
                    "reason": "the data explain both equally well: this motion does not tell them apart",
                }
            )
    best: dict[tuple, Visible] = {}
    for v in seen:
        key = (v.effect, v.axis)
        if key not in best or v.energy > best[key].energy:
            best[key] = v
    for (effect, axis), v in best.items():
        if v.energy < NEEDED:
            found.append(
                {
                    "effects": [effect],
                    "axis": None if axis is None else axis + 1,
                    "reason": f"at 30 % of the friction it would leave {v.energy:.3g} times the noise variance, "
                    f"less than {NEEDED:.0f}",
                }
            )
        elif v.left < NEEDED:
            found.append(
                {
                    "effects": [effect, v.rival],
                    "axis": None if axis is None else axis + 1,
                    "reason": f"after {v.rival} only {v.left:.3g} times the noise variance is left of it",
                }
            )
    for effect in library().values():
        if not effect.identifiable:
            found.append({"effects": [effect.identifier], "axis": None, "reason": effect.reason})
    return found
