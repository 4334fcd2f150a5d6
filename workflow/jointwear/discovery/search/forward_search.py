"""Forward search by evidence: gates, exchange, elimination, and records left out."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from functools import cached_property

from jointwear.discovery.estimates.outcome import Named, Outcome, Refusal
from jointwear.discovery.estimates.scan import Scored, contenders, scan
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, Dictionary, wider
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.acceptance import bound_missed, predictive, refusals
from jointwear.discovery.search.named_effects import named_effect, with_form, with_prediction
from jointwear.discovery.search.tolerance import with_tolerances

#: Refusals in a row after which the search leaves an axis alone: what a misfit of one joint costs must not end the
#: search on the others. Bounds on time, not limits: what comes later has the least evidence.
MOST_REFUSED_ON_AXIS = 5
#: Leading families that are ranked again with forms that may bend: a bound on time.
RANKED = 6
#: Refusals after which the search ends.
MOST_REFUSED = 24


def search_forward(outcome: Outcome) -> list[Named]:
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
        trial, failed = best_form(white, ranking.fit, named, best)
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


def best_form(white: White, fit: Fit, named: list[Named], best: Scored) -> tuple[Named, list[Refusal]]:
    """Return the form of a family that passes the gates and predicts best, else that of most evidence with its misses.

    A form with more coefficients fits better what has been seen, and may say less of what has not.
    """
    others = [s for s in best.others if s.evidence > white.problem.settings.accept]
    trials = [named_effect(white, fit, s) for s in (best, *others)]
    failed = [refusals(white, named, t) for t in trials]
    passed = [t for t, gates in zip(trials, failed, strict=True) if not gates]
    strong = best.evidence >= white.problem.settings.weak_nats
    wide = wider(white, best.candidate) if strong and not passed else None
    if wide is not None:
        # Noise feigns no strong gear in the columns that were asked: it may predict by what it does further up.
        trial = named_effect(white, fit, replace(best, candidate=wide))
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
            self._with_form[key] = with_form(self._white, self.fit, scored)
        return self._with_form[key]


def _full_axes(named: list[Named], most: int) -> set:
    """Return the axes on which no further effect may be named."""
    axes = [n.candidate.axis for n in named if n.candidate.axis is not None and n.candidate.effect != LINK_MASS]
    return {a for a in axes if axes.count(a) >= most}


def _beside(white: White, others: list[Named], one: Named) -> float:
    """Return the evidence that one effect, with its form, adds to others whose forms have their tolerance."""
    return white.evidence_of(one.terms, with_tolerances(white, others))


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
        best = max(close, key=lambda s: with_form(white, fit, s))
        if best.candidate.key != result[i].candidate.key:
            other, failed = best_form(white, fit, rest, best)
            if not failed:
                result[i] = other
    return result


def _in_place(other: Candidate, own: Candidate) -> bool:
    """Return whether one effect may stand for another: what another axis lacks is no rival, it comes beside."""
    return other.axis == own.axis or other.axis is None or own.axis is None


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
            return [with_prediction(n, r) for n, (r, _) in zip(named, found, strict=True)]
        _, gates, worst = min(failed, key=lambda x: x[0])
        outcome.refusals += gates
        named = [n for n in named if n is not worst]
    return named
