"""Which axes lack something themselves, of those on which structure is left beside another's that nothing explains."""

from __future__ import annotations

from dataclasses import replace

from jointwear.discovery.estimates.outcome import Outcome, Unexplained
from jointwear.discovery.search.leftovers import LEAST_P, unexplained
from jointwear.discovery.search.slow_noise import slower_noise


def of_its_own(outcome: Outcome, found: list[Unexplained]) -> list[Unexplained]:
    """Return the unexplained structure, of `found`, that an axis lacks by itself.

    All axes share the links. What one lacks by ten times its noise bends them, and the others then lack what bent links
    would have to do there. So each is asked again in a fit in which the others that stay unexplained say nothing of the
    links; what is left of it may be noise that is slower than was told, which much larger structure had hidden. The
    axis with most evidence of its own, else that of the first of `found`, keeps all that it lacks.
    """
    axes = {u.axis for u in found}
    if len(axes) < 2:
        return found
    own: list[Unexplained] = []
    for axis in sorted(axes):
        asked = {(u.axis, u.argument) for u in found if u.axis == axis}
        own += unexplained(outcome, True, asked, axes - {axis})[0]
    most = max(own, key=lambda u: u.nats, default=found[0]).axis
    slower = slower_noise(replace(outcome, unexplained=own)) or outcome.white.whiteners
    # What is surer than a number can say is no noise.
    sure = {u.axis for u in own if u.p_value <= LEAST_P} | {most}
    noise = {axis for axis in axes - sure if slower[axis] is not outcome.white.whiteners[axis]}
    kept = {(u.axis, u.argument) for u in own if u.axis not in noise}
    return [u for u in found if u.axis == most or (u.axis, u.argument) in kept]
