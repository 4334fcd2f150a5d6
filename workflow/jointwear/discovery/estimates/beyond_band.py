"""What elastic gears do above the band that their columns end at, as terms beside them.

Columns of a gear are low-passed, because above their cut-off they would feed on the noise of derived accelerations. The
gear itself swings on there. A filter ends gradually: where a column has lost half of a swing, twice its coefficient
fits best, and what no column has is taken by the motor inertia. The octave above the cut-off is therefore a term of its
own with a free coefficient. It carries no evidence for the effect and no torque of the model.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, on_its_axis_alone, raw_columns
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect

#: First words of the label of such a term.
LABEL = "beyond the band of"


def beyond_band(white: White, candidates: Iterable[Candidate]) -> list[Term]:
    """Return a term for each elastic gear that acts on its own axis alone and whose columns end below its torque."""
    return [term for one in candidates if (term := _beyond(white, one)) is not None]


def within_band(terms: Iterable[Term]) -> list[Term]:
    """Return the terms that are not of :func:`beyond_band`."""
    return [t for t in terms if not t.label.startswith(LABEL)]


def _is_gear(candidate: Candidate) -> bool:
    return on_its_axis_alone(candidate) and get_effect(candidate.effect).of_load


def _beyond(white: White, candidate: Candidate) -> Term | None:
    if not _is_gear(candidate):
        return None
    axis = candidate.axis
    columns = raw_columns(white, candidate, assumed.OCTAVE) - raw_columns(white, candidate)
    if not np.isfinite(columns).all() or not np.any(columns):
        return None
    nothing = np.zeros((len(white.whiteners[axis].rows), columns.shape[1]))
    # As large as the effect itself, give or take as much.
    std = np.ones(columns.shape[1])
    return Term(f"{LABEL} {candidate.effect} {axis}", {axis: white.columns(axis, columns)}, std, {axis: nothing})


def with_gears(white: White, candidates: Iterable[Candidate]) -> White:
    """Return the problem in which a load that is fused of model and torque knows the elastic gears."""
    gears = {}
    for one in filter(_is_gear, candidates):
        scaled = get_effect(one.effect).scaled
        if scaled and not one.nonlinear.get("side"):
            gears[one.axis] = float(one.nonlinear[scaled])
    return white.beside_gears(gears)
