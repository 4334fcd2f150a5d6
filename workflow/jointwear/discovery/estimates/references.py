"""Where the torque of an effect vanishes: the reference temperature where drive parameters need no correction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.base import pinned
from jointwear.discovery.estimates.refine import evidence_at, refine
from jointwear.discovery.estimates.refined_model import RefinedModel
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.candidates import Candidate, term_of
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect

#: Temperatures at which a search for a reference starts, the part of their range that its first step is, its last step
#: [K], and by how much a step shortens.
STARTS, PARTS, FINEST, SHORTER = 13, 16, 0.01, 0.4
#: Spans of the data beyond them up to which it is searched where an effect vanishes.
BEYOND = 0.25
#: Digits of a reference [degC].
DIGITS = 3


def reference_of(candidate: Candidate) -> str:
    """Return the nonlinear parameter at which the torque of a candidate vanishes, empty where it has none."""
    name = get_effect(candidate.effect).vanishes_at
    return name if name in candidate.nonlinear else ""


def with_references(white: White, base: list[Term], model: RefinedModel, error: float) -> RefinedModel:
    """Place the reference temperatures where the drive parameters, known to be right, need no correction.

    Parameters
    ----------
    error : share by which the parameters of the robot file are wrong.
    """
    result, beside = list(model.effects), model.mass_terms + model.bend_terms
    for i, effect in enumerate(model.effects):
        candidate = effect.candidate
        name = reference_of(candidate)
        if effect.bend is not None or not name:
            continue
        rest = [e.term for k, e in enumerate(result) if k != i] + beside
        fit = Fit(white.targets, [*pinned(white, base, candidate.axis, error), *rest])
        warm = white.problem.train_state.temperature[:, candidate.axis]
        low, high = float(np.nanmin(warm)), float(np.nanmax(warm))
        margin = BEYOND * (high - low)

        def at(temperature, candidate=candidate, fit=fit, name=name):
            moved = replace(candidate, nonlinear={**candidate.nonlinear, name: round(float(temperature), DIGITS)})
            return evidence_at(white, fit, moved), moved

        value, moved = max((at(t) for t in np.linspace(low - margin, high + margin, STARTS)), key=lambda x: x[0])
        step = (high - low) / PARTS
        while step > FINEST:
            around = [at(moved.nonlinear[name] + sign * step) for sign in (1, -1)]
            best = max(around, key=lambda x: x[0])
            if best[0] > value:
                value, moved = best
            else:
                step *= SHORTER
        moved = refine(white, fit, moved)
        value = evidence_at(white, fit, moved)
        if fit.evidence + value > Fit(white.targets, [*base, *rest, effect.term]).evidence:
            result[i] = replace(effect, candidate=moved, term=effect_term(white, moved, effect.term))
    return replace(model, effects=tuple(result))


def effect_term(white: White, candidate: Candidate, old: Term) -> Term:
    """Return the term of a candidate after a move of its nonlinear parameters; `old` for one on the whole arm."""
    return old if candidate.axis is None else term_of(white, candidate)
