"""What effects of late torque are worth below the cut-off of rates of torque, where noise feigns nothing."""

from __future__ import annotations

from jointwear.discovery.candidates import Candidate
from jointwear.discovery.linear import Fit, gain_of_one
from jointwear.discovery.whitening import White
from jointwear.effects import get_effect


def where_noise_is_harmless(white: White, beside: Fit, candidate: Candidate) -> tuple[float, float]:
    """Return the nats of an effect below the cut-off of second derivatives, and their share in those at its best size.

    What changes when a torque acts is looked for in a wider band, where misfits beside reversals look like it too. It
    is the same at all frequencies: below, where less is seen and nothing is feigned, it has to be as large.
    """
    effect, axis = get_effect(candidate.effect), candidate.axis
    columns = effect.columns(white.timing_state(axis), axis, candidate.source, candidate.nonlinear)
    b, gram = beside.gram({axis: white.columns(axis, columns)})
    nats, best = gain_of_one(b, gram), 0.5 * float(b[0] ** 2 / gram[0, 0]) if gram[0, 0] > 0 else 0.0
    return nats, nats / best if best > 0 else 0.0
