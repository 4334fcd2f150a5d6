"""Whether what stays unexplained goes away with links that are known less well than the user said.

A name has to stand beside links that are `mass_sigmas` times as far off (:mod:`.acceptance`). That
something is there which nobody can name is said of the prior as it is: a single centre of mass that lies far off leaves
structure over the position of its joint, and the robot file can hold that error. It stays the user's decision what
the links may be off by; what that would change is told.
"""

from __future__ import annotations

from dataclasses import replace

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.problem.whitening import INERTIAL
from jointwear.discovery.search.leftovers import unexplained
from jointwear.discovery.search.rocking import rocking
from jointwear.files.wording import numbered

#: Largest `inertial_prior` that the schema of the config allows.
_LARGEST = 2.0


def links_in_words(outcome: Outcome) -> list[str]:
    """Return a sentence where links that are known less well leave no joint unexplained; empty elsewhere.

    Of what acts from outside some structure is left beside any links, so that one joint is not asked alone.
    """
    if not outcome.unexplained or outcome.white is None:
        return []
    settings = outcome.problem.settings
    times = settings.mass_sigmas
    if times * settings.inertial_prior > _LARGEST:
        return []
    base = [replace(t, std=times * t.std) if t.label == INERTIAL else t for t in outcome.white.base]
    wide = replace(outcome, white=replace(outcome.white, base=base))
    if unexplained(wide)[0] or rocking(wide):
        return []
    axes = sorted({u.axis + 1 for u in outcome.unexplained})
    said, wider = f"{settings.inertial_prior:.2g}", f"{times * settings.inertial_prior:.2g}"
    words = (
        f"{numbered('joint', axes)}: links off by {wider} of their mass and size, in place of {said}, leave nothing "
        f"unexplained; if the robot file may be as wrong, state inertial_prior: {wider}"
    )
    return [words]
