"""Which axes lack something themselves, of those on which structure is left beside another's that nothing explains."""

from __future__ import annotations

from dataclasses import replace

from jointwear.discovery.estimates.outcome import Outcome, Unexplained
from jointwear.discovery.search.leftovers import unexplained
from jointwear.discovery.search.slow_noise import slower_noise


def of_its_own(outcome: Outcome, found: list[Unexplained]) -> list[Unexplained]:
    """Return the unexplained structure, of `found`, that an axis lacks by itself.

    All axes share the links. What one lacks by ten times its noise bends them, and the others then lack what bent links
    would have to do there. So each is asked again in a fit in which the others that stay unexplained say nothing of the
    links; what is left of it may be noise that is slower than was told, which much larger structure had hidden. The
    axis with most evidence, that of the first of `found`, keeps all that it lacks.
    """
    axes = {u.axis for u in found}
    if len(axes) < 2:
        return found
    most, own = found[0].axis, [u for u in found if u.axis == found[0].axis]
    for axis in sorted(axes - {most}):
        asked = {(u.axis, u.argument) for u in found if u.axis == axis}
        own += unexplained(outcome, True, asked, axes - {axis})[0]
    slower = slower_noise(replace(outcome, unexplained=own)) or outcome.white.whiteners
    noise = {axis for axis in axes - {most} if slower[axis] is not outcome.white.whiteners[axis]}
    kept = {(u.axis, u.argument) for u in own if u.axis not in noise}
    return [u for u in found if (u.axis, u.argument) in kept]
