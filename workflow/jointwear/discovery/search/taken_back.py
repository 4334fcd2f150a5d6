"""Names that do not stand once all names, and all that they leave, are known."""

from __future__ import annotations

from jointwear.discovery import assumed
from jointwear.discovery.estimates.effect_estimates import links_error
from jointwear.discovery.estimates.outcome import Outcome, Refusal
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.discovery.search.acceptance import nats_without_witnesses, of_drive, of_late_torque
from jointwear.discovery.search.early_torque import delay_of, early
from jointwear.discovery.search.forms_beyond import of_another_form
from jointwear.discovery.search.shared_delay import HELD, of_others_against
from jointwear.discovery.search.standing_alone import settle


def believe_no_bent_links(outcome: Outcome) -> None:
    """Take the names back that nothing but a joint with structure left asks for.

    It bends the links that it shares with the others, and a factor of all torque or a spring there makes up for that.
    Where half of the other joints stay unexplained, as where a link has another length, none of them says what the
    links are, and a factor of the torque of a joint has to be more than all links that are as much heavier.
    """
    settings = outcome.problem.settings
    half = 0.5 * settings.accept
    gate = "nats where joints that stay unexplained say nothing of the links"
    bent = {u.axis for u in outcome.unexplained}
    refused = []
    for one in outcome.named:
        axis = one.candidate.axis
        if axis is None or one.candidate.effect == LINK_MASS or not bent - {axis}:
            continue
        others = set(outcome.problem.judged) - {axis}
        doubtful = of_drive(one.candidate) and 2 * len(bent - {axis}) >= len(others)
        witnesses, wider = (others, settings.mass_sigmas) if doubtful else (bent - {axis}, 1.0)
        nats = nats_without_witnesses(outcome.white, outcome.terms_beside(one), one, witnesses, wider)
        if nats < half:
            refused.append(Refusal(one.candidate, one.evidence, gate, nats, half))
    _take_back(outcome, refused)


def believe_no_unknown_loads(outcome: Outcome) -> None:
    """Take the names back of a factor of all torque of a joint of whose load the fit corrects a large share.

    How far that torque is off is known no better than the load itself: the interval of such a factor holds none.
    """
    least = outcome.problem.settings.mass_sigmas
    gate = "load of its joint over what the fit corrects of the links there"
    refused = []
    for one in outcome.named:
        share = links_error(outcome.white, outcome.fit, one.candidate) if of_drive(one.candidate) else 0.0
        if share * least > 1.0:
            refused.append(Refusal(one.candidate, one.evidence, gate, 1.0 / share, least))
    _take_back(outcome, refused)


def believe_no_delay_within_the_clock(outcome: Outcome) -> None:
    """Take the names back of delays that are shorter than the time of a torque is known to.

    A controller whose torque is logged a part of its own period beside the position does that on all joints; where the
    model of the others is too coarse to say so, one joint alone would get the name. A torque that it holds is early by
    up to half of a period of the log: that is no name where the other joints do not speak against it.
    """
    refused = []
    for one in outcome.named:
        if not of_late_torque(one.candidate):
            continue
        delay, half = delay_of(outcome, one), 0.5 * outcome.problem.settings.accept
        periods = abs(delay) * outcome.problem.measured.logged_rate
        if periods < assumed.CLOCK:
            gate = "delay over what the time of a torque is known to"
            refused.append(Refusal(one.candidate, one.evidence, gate, periods / assumed.CLOCK, 1.0))
        elif early(outcome, one) and periods < HELD:
            against = of_others_against(outcome.white, outcome.fit, one.candidate.axis, delay)
            gate = "nats of the other joints against a torque that is held, and early on all of them"
            refused += [] if against >= half else [Refusal(one.candidate, one.evidence, gate, against, half)]
    _take_back(outcome, refused)


def believe_no_form_beyond_its_bounds(outcome: Outcome) -> None:
    """Turn the names of which the data would have another form into suspects where structure is left without them."""
    needed = 0.5 * outcome.problem.settings.accept
    gate = "nats that it does not lack within the bounds of its parameters"
    found = list(of_another_form(outcome.white, outcome.named))
    _take_back(outcome, [Refusal(n.candidate, n.evidence, gate, -nats, -needed) for n, nats in found])
    still = {u.axis for u in outcome.unexplained}
    for one, nats in found:
        if one.candidate.axis in still:
            reason = (
                f"parameters beyond their bounds would explain {nats:.0f} nats more, and its form bends all the same"
            )
            outcome.suspects.append((one, reason))


def _take_back(outcome: Outcome, refused: list[Refusal]) -> None:
    """Take the names back that are refused, if any, and settle what is left."""
    if refused:
        outcome.refusals += refused
        keys = {r.candidate.key for r in refused}
        outcome.named = [n for n in outcome.named if n.candidate.key not in keys]
        settle(outcome)
