"""Whether a delay keeps the size with which it was accepted, once everything that is named is fitted together."""

from __future__ import annotations

from dataclasses import replace

from jointwear.discovery.estimates.effect_estimates import Estimate
from jointwear.discovery.estimates.outcome import Named, Outcome, Refusal
from jointwear.discovery.model.estimation import finalise
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.discovery.search.standing_alone import settle
from jointwear.effects import get_effect

#: The gate, in words.
GATE = "its size beside all that is named over that with which it was found"


def with_kept_sizes(outcome: Outcome) -> Outcome:
    """Return an outcome without the delays that shrink or turn round when all is fitted, the worst given up first.

    What was accepted and what would be written are then two different delays, and the data asked for neither. As much
    is allowed as its size may be off when it is accepted.
    """
    least = 1.0 / outcome.problem.settings.off_scale
    while any(_is_late(n) for n in outcome.named):
        estimates = {e.named.candidate.key: e for e in finalise(outcome).estimates}
        kept = [(_kept(n, estimates[n.candidate.key]), n) for n in outcome.named if _is_late(n)]
        share, worst = min(kept, key=lambda pair: pair[0])
        if share >= least:
            break
        refused = Refusal(worst.candidate, worst.evidence, GATE, share, least)
        named = [n for n in outcome.named if n is not worst]
        outcome = replace(outcome, named=named, refusals=[*outcome.refusals, refused])
        settle(outcome)
    return outcome


def _is_late(one: Named) -> bool:
    return one.candidate.effect != LINK_MASS and get_effect(one.candidate.effect).late


def _kept(one: Named, estimate: Estimate) -> float:
    """Return the size of an effect as estimated over that of its candidate; below 0 it has turned round."""
    name = get_effect(one.candidate.effect).scaled
    return float(estimate.parameters[name]) / float(one.candidate.nonlinear[name])
