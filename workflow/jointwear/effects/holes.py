"""Arguments between those that were seen: what a corrected form says there is its weakest part.

The textbook form of an effect that a table corrects is no law. Where no sample lies, between recordings here and there
on a travel, form and table only happen to meet on either side: a wall that was told as a spring pulled with 1.4 N m
in the middle of nowhere.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from jointwear.effects.effect import Parameters

#: (parameters, argument (k,)) -> value (k,) of a form at any argument.
Law = Callable[[Parameters, np.ndarray], np.ndarray]
#: Straight pieces of a table across one hole: of rounding only.
PIECES = 32


def stretches_of(values: np.ndarray, knots: np.ndarray) -> tuple[tuple[float, float], ...]:
    """Return the stretches of an argument (m,) that were seen, in order; between them lie holes.

    A hole is wider than the table with these `knots` resolves: than their mean distance.
    """
    ordered = np.sort(values)
    wide = (knots[-1] - knots[0]) / (len(knots) - 1)
    ends = np.flatnonzero(np.diff(ordered) > wide)
    first, last = ordered[np.append(0, ends + 1)], ordered[np.append(ends, len(ordered) - 1)]
    return tuple(zip(first.tolist(), last.tolist(), strict=True))


def weakest_in_holes(parameters: Parameters, law: Law, stretches: tuple[tuple[float, float], ...]) -> Parameters:
    """Return parameters whose `correction` says no more in a hole than all that is known of its two sides.

    Of the curve as it was fitted, the straight line from side to side, and the course of either side straight on to
    where it is nothing, the smallest is taken where all have one sign, and nothing where they do not.

    Parameters
    ----------
    parameters : with the table `correction`, which goes beyond all stretches. stretches : as of :func:`stretches_of`.
    """
    table = parameters["correction"]
    knots, values = np.asarray(table["knots"]), np.asarray(table["values"])

    def curve(x: np.ndarray) -> np.ndarray:
        return law(parameters, x) + np.interp(x, knots, values)

    for (before, low), (high, after) in pairwise(stretches):
        x = np.linspace(low, high, PIECES + 1)
        share, sides = (x - low) / (high - low), curve(np.array([low, high]))
        line = sides[0] + share * (sides[1] - sides[0])
        left = _straight_on(curve, low, max(before, 2.0 * low - high), x)
        right = _straight_on(curve, high, min(after, 2.0 * high - low), x)
        torque = _smallest(curve(x), line, (1.0 - share) * left + share * right)
        torque[[0, -1]] = sides
        below, above = knots < low, knots > high
        values = np.concatenate([values[below], torque - law(parameters, x), values[above]])
        knots = np.concatenate([knots[below], x, knots[above]])
    return {**parameters, "correction": {"knots": knots, "values": values}}


def _straight_on(curve: Callable[[np.ndarray], np.ndarray], side: float, back: float, x: np.ndarray) -> np.ndarray:
    """Return the course (k,) at `x` of a curve that goes on as it came from `back` to a side, to where it is 0."""
    here, there = curve(np.array([side, back]))
    slope = (here - there) / (side - back) if side != back else 0.0
    course = here + slope * (x - side)
    return np.where(course * here > 0.0, course, 0.0)


def _smallest(*curves: np.ndarray) -> np.ndarray:
    """Return the smallest (k,) of some curves where they have one sign, 0 where they have not."""
    stacked = np.stack(curves)
    alike = np.abs(np.sign(stacked).sum(axis=0)) == len(curves)
    return np.where(alike, np.sign(stacked[0]) * np.abs(stacked).min(axis=0), 0.0)
