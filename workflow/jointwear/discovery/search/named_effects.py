"""The effect that a family comes to: its best point, and its evidence with what its form may lack."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.forms import form_term
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.estimates.refine import evidence_at, free_parameters, refine
from jointwear.discovery.estimates.scan import Scored
from jointwear.discovery.linear import Fit, Term, gain
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, raw_blocks, term_of
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.crossval import CrossValidated
from jointwear.effects import get_effect


def off_grid(white: White, fit: Fit, scored: Scored) -> Scored:
    """Return a family at the largest evidence near its best point.

    A bend makes up for a step of the grid as for a form that is a little off, and grids are not equally fine.
    """
    candidate = scored.candidate
    if candidate.effect == LINK_MASS or get_effect(candidate.effect).scaled or not free_parameters(candidate):
        return scored
    moved = refine(white, fit, candidate)
    nats = evidence_at(white, fit, moved) - evidence_at(white, fit, candidate)
    term = term_of(white, moved)
    return replace(scored, candidate=moved, evidence=scored.evidence + nats, blocks=term.blocks, std=term.std)


def with_form(white: White, fit: Fit, scored: Scored) -> float:
    """Return the evidence of a candidate off the grid when its form may bend, half the prior weight on either."""
    scored = off_grid(white, fit, scored)
    form = form_term(white, fit, scored.candidate, scored.blocks, scored.std)
    if form is None:
        return scored.evidence
    axis = scored.candidate.axis
    joint = {axis: np.concatenate([scored.blocks[axis], form.blocks[axis]], axis=1)}
    b, gram = fit.gram(joint)
    k = len(scored.std)
    plain = gain(b[:k], gram[:k, :k], scored.std)
    bent = gain(b, gram, np.concatenate([scored.std, form.std]))
    return scored.evidence - plain + float(np.logaddexp(plain, bent) - np.log(2))


def named_effect(white: White, fit: Fit, scored: Scored) -> Named:
    if scored.candidate.axis is not None and scored.candidate.effect != LINK_MASS:
        candidate = refine(white, fit, scored.candidate)
        misfit = _stuck(scored.candidate, candidate)
        term = term_of(white, candidate)
        scored = Scored(candidate, scored.evidence, term.blocks, term.std)
    else:
        misfit = ""
        label = f"{scored.candidate.effect} {scored.candidate.axis}"
        term = Term(label, scored.blocks, scored.std, raw_blocks(white, scored.candidate), effect=True)
    form = form_term(white, fit, scored.candidate, scored.blocks, scored.std)
    return Named(scored.candidate, term, form, scored.evidence, misfit=misfit)


def _stuck(start: Candidate, end: Candidate) -> str:
    """Say that a search ended where it began: its steps are finer than any grid."""
    free = [p.name for p in free_parameters(start)]
    if not free or any(start.nonlinear[name] != end.nonlinear[name] for name in free):
        return ""
    return f"the search for {', '.join(free)} of {start.effect} on joint {start.axis + 1} ended at its start"


def with_prediction(one: Named, found: CrossValidated) -> Named:
    """Return an effect with what it does on records left out."""
    return replace(one, cross_validated=found.share, lowers_error=found.lowers_error, gain_share=found.gain_share)
