"""Which effects a data set shows: forward search, gates, elimination, exchange, structure that is left."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from functools import cached_property

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.estimates.effect_estimates import links_error
from jointwear.discovery.estimates.forms import form_term
from jointwear.discovery.estimates.outcome import Named, Outcome, Refusal
from jointwear.discovery.estimates.refine import evidence_at, free_parameters, refine
from jointwear.discovery.estimates.scan import Scored, contenders, scan
from jointwear.discovery.linear import Fit, Term, gain
from jointwear.discovery.problem.candidates import (
    LINK_MASS,
    Candidate,
    Dictionary,
    raw_blocks,
    term_of,
    wider,
)
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.acceptance import (
    bound_missed,
    nats_without_witnesses,
    of_drive,
    of_late_torque,
    predictive,
    refusals,
)
from jointwear.discovery.search.crossval import CrossValidated
from jointwear.discovery.search.early_torque import delay_of
from jointwear.discovery.search.forms_beyond import of_another_form
from jointwear.discovery.search.leftovers import fit_again
from jointwear.discovery.search.other_half import with_other_halves
from jointwear.discovery.search.posterior import weigh
from jointwear.discovery.search.standing_alone import doubt_early_torque, stand_alone
from jointwear.discovery.search.tolerance import with_tolerances
from jointwear.effects import get_effect

#: Refusals in a row after which the search leaves an axis alone: what a misfit of one joint costs must not end the
#: search on the others. Bounds on time, not limits: what comes later has the least evidence.
MOST_REFUSED_ON_AXIS = 5
#: Leading families that are ranked again with forms that may bend: a bound on time.
RANKED = 6
#: Probability from which an effect is named: nothing else is as likely.
LIKELY = 0.5
#: Refusals after which the search ends.
MOST_REFUSED = 24


def settle(outcome: Outcome) -> None:
    """Fit the named effects again and test what they leave; names that do not stand beside it become suspects."""
    fit_again(outcome)
    if outcome.named:
        stand_alone(outcome)


def decide(white: White, dictionary: Dictionary) -> Outcome:
    """Return the effects that whitened data show, out of those of a dictionary.

    Steps: forward search by evidence, near ties re-ranked with the tolerance of their form; each acceptance must also
    pass the gates of :mod:`.acceptance`, and what was refused before it is asked again beside it;
    elimination and exchange; the other halves of shared drives; then the tests for structure that is left.
    """
    problem = white.problem
    outcome = Outcome(problem, white, white.fit(), dictionary)
    outcome.not_tried = {(effect, axis): reason for effect, axis, reason in dictionary.not_tried}
    outcome.named = with_other_halves(white, _searched(outcome))
    settle(outcome)
    _believe_no_bent_links(outcome)
    _believe_no_unknown_loads(outcome)
    _believe_no_delay_within_the_clock(outcome)
    _believe_no_form_beyond_its_bounds(outcome)
    before = {n.candidate.key for n in outcome.named}
    weighed = [_weighed(outcome, n) for n in outcome.named]
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


def _believe_no_bent_links(outcome: Outcome) -> None:
    """Take the names back that nothing but a joint with structure left asks for.

    It bends the links that it shares with the others, and a factor of all torque or a spring there makes up for that.
    """
    half = 0.5 * outcome.problem.settings.accept
    gate = "nats where joints that stay unexplained say nothing of the links"
    bent = {u.axis for u in outcome.unexplained}
    refused = []
    for one in outcome.named:
        axis = one.candidate.axis
        if axis is None or one.candidate.effect == LINK_MASS or not bent - {axis}:
            continue
        nats = nats_without_witnesses(outcome.white, outcome.terms_beside(one), one, bent - {axis})
        if nats < half:
            refused.append(Refusal(one.candidate, one.evidence, gate, nats, half))
    _take_back(outcome, refused)


def _believe_no_unknown_loads(outcome: Outcome) -> None:
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


def _believe_no_delay_within_the_clock(outcome: Outcome) -> None:
    """Take the names back of delays that are shorter than the time of a torque is known to.

    A controller whose torque is logged a part of its own period beside the position does that on all joints; where the
    model of the others is too coarse to say so, one joint alone would get the name.
    """
    gate = "delay over what the time of a torque is known to"
    refused = []
    for one in outcome.named:
        if of_late_torque(one.candidate):
            delay = abs(delay_of(outcome, one)) * outcome.problem.measured.logged_rate / assumed.CLOCK
            if delay < 1.0:
                refused.append(Refusal(one.candidate, one.evidence, gate, delay, 1.0))
    _take_back(outcome, refused)


def _believe_no_form_beyond_its_bounds(outcome: Outcome) -> None:
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


def _searched(outcome: Outcome) -> list[Named]:
    """Return the effects of a forward search that, all together, are needed and predict records left out.

    What is dropped at the end has kept a place from others: the search goes on without it until nothing is dropped.
    """
    dropped: list[Named] = []
    named: list[Named] = []
    while True:
        found = _forward(outcome, named, dropped)
        named = _predicting(outcome, _eliminate(outcome, found))
        keys = {n.candidate.key for n in named}
        fresh = [n for n in found if n.candidate.key not in keys]
        if not fresh:
            return named
        dropped += fresh


def _forward(outcome: Outcome, named: list[Named], dropped: list[Named]) -> list[Named]:
    """Return `named` and what a forward search by evidence adds to it; never any of `dropped`."""
    white, dictionary = outcome.white, outcome.dictionary
    refused = list(dropped)
    refusals_so_far = 0
    ranking = _Ranking(white, dictionary, named)
    while (best := ranking.best(refused)) is not None:
        trial, failed = _tried(white, ranking.fit, named, best)
        if failed:
            outcome.refusals += failed
            refused.append(trial)
            refusals_so_far += 1
            if refusals_so_far > MOST_REFUSED:
                break
            continue
        named = _exchange(white, dictionary, [*named, trial], dropped)
        ranking = _Ranking(white, dictionary, named)
        # What a hidden effect spoilt may pass now that this one has a name.
        refused = list(dropped)
    return named


def _weighed(outcome: Outcome, one: Named) -> Named:
    """Return a named effect with its probability, or the rival that is likelier: one of two that are as good is named.

    A rival that the gates refuse is none: the effect is weighed again without it.
    """
    white = outcome.white
    weighed = weigh(outcome, one, _with_form)
    if weighed.probability >= LIKELY:
        return weighed
    rest = [n for n in outcome.named if n is not one]
    before = [t for n in rest for t in n.terms]
    fit = white.fit(before)
    keys = {c.key for c in weighed.ties if c.effect != LINK_MASS and c.axis == one.candidate.axis}
    for scored in scan(white, outcome.dictionary, fit, keys) if keys else []:
        rival = _named(white, fit, scored)
        failed = refusals(white, rest, rival)
        if failed:
            outcome.refusals += failed
            continue
        found, _ = predictive(white, before, rival)
        rival = _with_prediction(rival, found)
        rival = weigh(replace(outcome, named=[*rest, rival]), rival, _with_form)
        if rival.probability >= LIKELY:
            return rival
    return weigh(outcome, one, _with_form)


def _tried(white: White, fit: Fit, named: list[Named], best: Scored) -> tuple[Named, list[Refusal]]:
    """Return the form of a family that passes the gates and predicts best, else that of most evidence with its misses.

    A form with more coefficients fits better what has been seen, and may say less of what has not.
    """
    others = [s for s in best.others if s.evidence > white.problem.settings.accept]
    trials = [_named(white, fit, s) for s in (best, *others)]
    failed = [refusals(white, named, t) for t in trials]
    passed = [t for t, gates in zip(trials, failed, strict=True) if not gates]
    strong = best.evidence >= white.problem.settings.weak_nats
    wide = wider(white, best.candidate) if strong and not passed else None
    if wide is not None:
        # Noise feigns no strong gear in the columns that were asked: it may predict by what it does further up.
        trial = _named(white, fit, replace(best, candidate=wide))
        if not refusals(white, named, trial):
            return trial, []
    if len(passed) < 2:
        return (passed[0], []) if passed else (trials[0], failed[0])
    before = [t for n in named for t in n.terms]
    # A form on all axes predicts worse beside what they still lack, however much more it explains.
    enough = (1.0 - white.problem.settings.usual) * max(t.evidence for t in passed)
    close = [t for t in passed if t.evidence >= enough]
    return max(close, key=lambda t: predictive(white, before, t)[0].gain_share), []


class _Ranking:
    """The families of a dictionary by evidence beside some named effects: the same until one more is named."""

    def __init__(self, white: White, dictionary: Dictionary, named: list[Named]) -> None:
        self._white, self._dictionary, self._named = white, dictionary, named
        self._with_form: dict[tuple, float] = {}

    @cached_property
    def fit(self) -> Fit:
        """The named effects with the tolerance of their forms."""
        return self._white.fit(with_tolerances(self._white, self._named))

    @cached_property
    def _found(self) -> list[Scored]:
        found = scan(self._white, self._dictionary, self.fit)
        return [s for s in found if s.evidence > self._white.problem.settings.accept]

    def best(self, refused: list[Named]) -> Scored | None:
        """Return the best family not named or refused yet; near ties are decided with the tolerance of the form.

        An axis on which no more may be named, or on which too many were refused, has none.
        """
        settings = self._white.problem.settings
        taken = {n.candidate.key for n in [*self._named, *refused]}
        tried = Counter(n.candidate.axis for n in refused)
        full = _full_axes(self._named, settings.most_on_axis)
        full |= {a for a, n in tried.items() if n >= MOST_REFUSED_ON_AXIS}
        found = [s for s in self._found if s.candidate.key not in taken and s.candidate.axis not in full]
        close = contenders(found, settings)[:RANKED]
        if len(close) < 2:
            return close[0] if close else None
        return max(close, key=self._bent)

    def _bent(self, scored: Scored) -> float:
        key = scored.candidate.key
        if key not in self._with_form:
            self._with_form[key] = _with_form(self._white, self.fit, scored)
        return self._with_form[key]


def _full_axes(named: list[Named], most: int) -> set:
    """Return the axes on which no further effect may be named."""
    axes = [n.candidate.axis for n in named if n.candidate.axis is not None and n.candidate.effect != LINK_MASS]
    return {a for a in axes if axes.count(a) >= most}


def _off_grid(white: White, fit: Fit, scored: Scored) -> Scored:
    """Return a family at the largest evidence near its best point.

    A bend makes up for a step of the grid as for a form that is a little off, and grids are not equally fine.
    """
    candidate = scored.candidate
    if candidate.effect == LINK_MASS or get_effect(candidate.effect).scaled or not free_parameters(candidate):
        return scored
    moved = refine(white, fit, candidate)
    nats = evidence_at(white, fit, moved) - evidence_at(white, fit, candidate)
    term = term_of(white, moved)
    return replace(scored, candidate=moved, evidence=scored.evidence + nats, blocks=term.blocks, std=term.std)


def _with_form(white: White, fit: Fit, scored: Scored) -> float:
    """Return the evidence of a candidate off the grid when its form may bend, half the prior weight on either."""
    scored = _off_grid(white, fit, scored)
    form = form_term(white, fit, scored.candidate, scored.blocks, scored.std)
    if form is None:
        return scored.evidence
    axis = scored.candidate.axis
    joint = {axis: np.concatenate([scored.blocks[axis], form.blocks[axis]], axis=1)}
    b, gram = fit.gram(joint)
    k = len(scored.std)
    plain = gain(b[:k], gram[:k, :k], scored.std)
    bent = gain(b, gram, np.concatenate([scored.std, form.std]))
    return scored.evidence - plain + float(np.logaddexp(plain, bent) - np.log(2))


def _named(white: White, fit: Fit, scored: Scored) -> Named:
    if scored.candidate.axis is not None and scored.candidate.effect != LINK_MASS:
        candidate = refine(white, fit, scored.candidate)
        misfit = _stuck(scored.candidate, candidate)
        term = term_of(white, candidate)
        scored = Scored(candidate, scored.evidence, term.blocks, term.std)
    else:
        misfit = ""
        label = f"{scored.candidate.effect} {scored.candidate.axis}"
        term = Term(label, scored.blocks, scored.std, raw_blocks(white, scored.candidate), effect=True)
    form = form_term(white, fit, scored.candidate, scored.blocks, scored.std)
    return Named(scored.candidate, term, form, scored.evidence, misfit=misfit)


def _stuck(start: Candidate, end: Candidate) -> str:
    """Say that a search ended where it began: its steps are finer than any grid."""
    free = [p.name for p in free_parameters(start)]
    if not free or any(start.nonlinear[name] != end.nonlinear[name] for name in free):
        return ""
    return f"the search for {', '.join(free)} of {start.effect} on joint {start.axis + 1} ended at its start"


def _beside(white: White, others: list[Named], one: Named) -> float:
    """Return the evidence that one effect, with its form, adds to others whose forms have their tolerance."""
    terms = with_tolerances(white, others)
    return white.fit([*terms, *one.terms]).evidence - white.fit(terms).evidence


def _eliminate(outcome: Outcome, named: list[Named]) -> list[Named]:
    """Drop effects that the others have made unnecessary, weakest first."""
    white, needed = outcome.white, 0.5 * outcome.problem.settings.accept
    while named:
        named = [replace(n, evidence=_beside(white, [x for x in named if x is not n], n)) for n in named]
        weakest = min(named, key=lambda n: n.evidence)
        if weakest.evidence >= needed:
            return named
        outcome.refusals.append(
            Refusal(weakest.candidate, weakest.evidence, "nats beside the other effects", weakest.evidence, needed)
        )
        named = [n for n in named if n is not weakest]
    return named


def _exchange(white: White, dictionary: Dictionary, named: list[Named], dropped: list[Named]) -> list[Named]:
    """Try, for every named effect, whether another family does better in its place now that all are there.

    What takes the place of a name passes the same gates as a name.
    """
    if len(named) < 2:
        return named
    result = list(named)
    for i in range(len(result) - 1):
        rest = [n for k, n in enumerate(result) if k != i]
        fit = white.fit(with_tolerances(white, rest))
        taken = {n.candidate.key for n in [*rest, *dropped]}
        own = result[i].candidate
        found = [
            s for s in scan(white, dictionary, fit) if s.candidate.key not in taken and _in_place(s.candidate, own)
        ]
        close = contenders(found, white.problem.settings)[:RANKED]
        if not close:
            continue
        best = max(close, key=lambda s: _with_form(white, fit, s))
        if best.candidate.key != result[i].candidate.key:
            other, failed = _tried(white, fit, rest, best)
            if not failed:
                result[i] = other
    return result


def _in_place(other: Candidate, own: Candidate) -> bool:
    """Return whether one effect may stand for another: what another axis lacks is no rival, it comes beside."""
    return other.axis == own.axis or other.axis is None or own.axis is None


def _with_prediction(one: Named, found: CrossValidated) -> Named:
    """Return an effect with what it does on records left out."""
    return replace(one, cross_validated=found.share, lowers_error=found.lowers_error, gain_share=found.gain_share)


def _predicting(outcome: Outcome, named: list[Named]) -> list[Named]:
    """Drop effects that, beside all the others, do not predict records left out; the worst first.

    First go those that beside the others would need parameters beyond their bounds.
    """
    white = outcome.white

    def others(one: Named) -> list[Term]:
        return [t for n in named for t in n.terms if n is not one]

    beyond = [bound_missed(white, white.fit(others(n)), n) for n in named]
    outcome.refusals += [Refusal(n.candidate, n.evidence, *b) for n, b in zip(named, beyond, strict=True) if b]
    named = [n for n, b in zip(named, beyond, strict=True) if b is None]
    while named:
        found = [predictive(white, others(n), n) for n in named]
        failed = [(result.nats, gates, n) for n, (result, gates) in zip(named, found, strict=True) if gates]
        if not failed:
            return [_with_prediction(n, r) for n, (r, _) in zip(named, found, strict=True)]
        _, gates, worst = min(failed, key=lambda x: x[0])
        outcome.refusals += gates
        named = [n for n in named if n is not worst]
    return named
