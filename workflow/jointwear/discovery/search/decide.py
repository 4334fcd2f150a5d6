"""Which effects a data set shows: forward search, what is taken back, probabilities, structure that is left."""

from __future__ import annotations

from dataclasses import replace

from jointwear.discovery.estimates.outcome import Named, Outcome, Refusal
from jointwear.discovery.estimates.scan import scan
from jointwear.discovery.problem.candidates import LINK_MASS, Dictionary
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.acceptance import predictive, refusals
from jointwear.discovery.search.forward_search import search_forward
from jointwear.discovery.search.leftovers import fit_again
from jointwear.discovery.search.named_effects import named_effect, with_form, with_prediction
from jointwear.discovery.search.other_half import with_other_halves
from jointwear.discovery.search.posterior import weigh
from jointwear.discovery.search.standing_alone import doubt_early_torque, settle
from jointwear.discovery.search.taken_back import (
    believe_no_bent_links,
    believe_no_delay_within_the_clock,
    believe_no_form_beyond_its_bounds,
    believe_no_unknown_loads,
)

#: Probability from which an effect is named: nothing else is as likely.
LIKELY = 0.5


def decide(white: White, dictionary: Dictionary) -> Outcome:
    """Return the effects that whitened data show, out of those of a dictionary.

    Steps: forward search by evidence, near ties re-ranked with the tolerance of their form; each acceptance must also
    pass the gates of :mod:`.acceptance`, and what was refused before it is asked again beside it;
    elimination and exchange; the other halves of shared drives; then the tests for structure that is left.
    """
    problem = white.problem
    outcome = Outcome(problem, white, white.fit(), dictionary)
    outcome.not_tried = {(effect, axis): reason for effect, axis, reason in dictionary.not_tried}
    outcome.named = with_other_halves(white, search_forward(outcome))
    settle(outcome)
    believe_no_bent_links(outcome)
    believe_no_unknown_loads(outcome)
    believe_no_delay_within_the_clock(outcome)
    believe_no_form_beyond_its_bounds(outcome)
    before = {n.candidate.key for n in outcome.named}
    weighed = [likelier(outcome, n) for n in outcome.named]
    for n in weighed:
        if n.probability >= LIKELY:
            continue
        gate = "probability, given the data and the library"
        outcome.refusals.append(Refusal(n.candidate, n.evidence, gate, n.probability, LIKELY))
        if n.structure_left and n.log_odds >= 0.0:
            # No other effect of the library does better, but what is left may be the cause of all of it.
            outcome.suspects.append((n, f"probability {n.probability:.2f} beside the structure that is left"))
    outcome.named = sorted((n for n in weighed if n.probability >= LIKELY), key=lambda n: -n.evidence)
    named = {n.candidate.key for n in outcome.named}
    # A rival that took the place of a name may have been a suspect before.
    outcome.suspects = [s for s in outcome.suspects if s[0].candidate.key not in named]
    if named != before:
        fit_again(outcome)
        doubt_early_torque(outcome)
    return outcome


def likelier(outcome: Outcome, one: Named) -> Named:
    """Return a named effect with its probability, or the rival that is likelier: one of two that are as good is named.

    A rival that the gates refuse is none: the effect is weighed again without it.
    """
    white = outcome.white
    weighed = weigh(outcome, one, with_form)
    if weighed.probability >= LIKELY:
        return weighed
    rest = [n for n in outcome.named if n is not one]
    before = [t for n in rest for t in n.terms]
    fit = white.fit(before)
    keys = {c.key for c in weighed.ties if c.effect != LINK_MASS and c.axis == one.candidate.axis}
    for scored in scan(white, outcome.dictionary, fit, keys) if keys else []:
        rival = named_effect(white, fit, scored)
        failed = refusals(white, rest, rival)
        if failed:
            outcome.refusals += failed
            continue
        found, _ = predictive(white, before, rival)
        rival = with_prediction(rival, found)
        rival = weigh(replace(outcome, named=[*rest, rival]), rival, with_form)
        if rival.probability >= LIKELY:
            return rival
    return weigh(outcome, one, with_form)
