"""What effects of late torque are worth below the cut-off of rates of torque, where noise feigns nothing.

The columns of that band are an instrument for those of the whole one: a filter ends gradually, and where most of an
effect lies in its flank the coefficient that fits best is not one but what columns of the whole band have on them
(Soderstrom and Stoica 1983).
"""

from __future__ import annotations

import numpy as np

from jointwear.discovery.linear import Fit
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect


def where_noise_is_harmless(white: White, beside: Fit, candidate: Candidate) -> tuple[float, float]:
    """Return the nats of an effect below the cut-off of second derivatives, and their share in those at its best size.

    What changes when a torque acts is looked for in a wider band, where misfits beside reversals look like it too. It
    is the same at all frequencies: below, where less is seen and nothing is feigned, it has to be as large.
    """
    effect, axis = get_effect(candidate.effect), candidate.axis
    below = effect.columns(white.timing_state(axis), axis, candidate.source, candidate.nonlinear)
    columns = np.concatenate([below, raw_columns(white, candidate)], axis=1)
    b, gram = beside.gram({axis: white.columns(axis, columns)})
    if gram[0, 0] <= 0 or gram[0, 1] <= 0:
        return 0.0, 0.0
    size, best = float(gram[0, 1] / gram[0, 0]), 0.5 * float(b[0] ** 2 / gram[0, 0])
    nats = size * float(b[0]) - 0.5 * size**2 * float(gram[0, 0])
    return nats, nats / best if best > 0 else 0.0
