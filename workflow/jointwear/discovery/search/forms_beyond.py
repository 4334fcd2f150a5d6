"""Names whose form the data would have beyond the bounds of its parameters: whatever acts there has another form.

An exponent at the end of its range, and a curve that has to bend all the same, is a flexible basis with a name.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.estimates.refine import FIRST_STEP, evidence_at, free_parameters
from jointwear.discovery.linear import Fit
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.crossval import cross_validate
from jointwear.effects import get_effect


def nats_beyond(white: White, fit: Fit, candidate: Candidate) -> float:
    """Return the evidence that a candidate would gain by a step of a nonlinear parameter beyond its bounds, 0 if none.

    Where a bound is the limit of the form, as a straight line is of a curve over temperature, nothing is gained there.
    """
    if candidate.axis is None or candidate.effect == LINK_MASS or get_effect(candidate.effect).scaled:
        return 0.0
    here, most = evidence_at(white, fit, candidate), 0.0
    for p in free_parameters(candidate):
        for sign in (1.0, -1.0):
            value = float(candidate.nonlinear[p.name]) * np.exp(sign * FIRST_STEP)
            if not p.lower <= value <= p.upper:
                beyond = replace(candidate, nonlinear={**candidate.nonlinear, p.name: value})
                most = max(most, evidence_at(white, fit, beyond) - here)
    return most


def of_another_form(white: White, named: list[Named]) -> Iterator[tuple[Named, float]]:
    """Yield the names of another form, with the nats that they would gain beyond their bounds.

    Their own form has to bend too, as records left out say: without that the curve at its bound is what is there.
    """
    half = 0.5 * white.problem.settings.accept
    for one in named:
        if one.form is None:
            continue
        others = [t for n in named if n is not one for t in n.terms]
        nats = nats_beyond(white, white.fit(others), one.candidate)
        if nats <= half:
            continue
        bends = cross_validate(white, [*others, one.term], [one.form])
        if bends.nats > half and bends.gain_share > 0:
            yield one, nats
