"""How probable a named effect is, against the sets of effects that come next, and which it is tied with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.estimates.scan import Scored, contenders, scan
from jointwear.discovery.linear import Fit
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.calibration import COARSE, calibrated
from jointwear.discovery.search.standing_alone import left_open

#: Rivals of one effect that are weighed with the tolerance of their form.
BEAM = 8
#: A rival is tied with a name that is less ahead of it than so many nats, or than this share of its own.
TIED_NATS, TIED_SHARE = 2.0, 0.01


def weigh(outcome: Outcome, one: Named, with_form: Callable[[White, Fit, Scored], float]) -> Named:
    """Return a named effect with evidence, rivals that the data do not exclude, and its probability.

    The sets weighed are those with the effect, with each rival in its place, with both, and with neither; the evidence
    of each is exact for given forms, averaged over the grid of a family and over whether a form is bent.

    Parameters
    ----------
    with_form : evidence [nats] of a scored family when its form may bend.
    """
    white = outcome.white
    rest = [n for n in outcome.named if n is not one]
    others = [t for n in rest for t in n.terms]
    fit = white.fit(others)
    taken = {n.candidate.key for n in rest} | {r.candidate.key for r in outcome.refusals}
    found = [s for s in scan(white, outcome.dictionary, fit) if s.candidate.key not in taken]
    close = contenders(found, white.problem.settings)[:BEAM]
    scores = {s.candidate.key: with_form(white, fit, s) for s in close}
    own = scores.get(one.candidate.key, one.evidence)
    margin = max(TIED_NATS, TIED_SHARE * own)
    ties = [
        s.candidate for s in close if s.candidate.key != one.candidate.key and scores[s.candidate.key] > own - margin
    ]
    rivals = {key: v for key, v in scores.items() if key != one.candidate.key}
    with_it = white.fit([*others, *one.terms])
    evidence = with_it.evidence - fit.evidence
    # What comes beside the effect, as on another axis, is as likely with it as without it: no rival.
    beside = {s.candidate.key: s for s in scan(white, outcome.dictionary, with_it, rivals.keys())} if rivals else {}
    both = [with_form(white, with_it, beside[key]) if key in beside else 0.0 for key in rivals]
    ahead = own + float(np.logaddexp.reduce([*both, 0.0]) - np.logaddexp.reduce([*rivals.values(), 0.0]))
    score = ahead / (1.0 + COARSE * max(own, 0.0))
    left = bool(left_open(outcome, one))
    probability = calibrated(score, one.cross_validated, left)
    return replace(
        one, ties=tuple(ties), evidence=evidence, log_odds=score, probability=probability, structure_left=left
    )
