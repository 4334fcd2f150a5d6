"""The searches that answer a problem: as it is, with nothing that shakes the arm as noise, beside a force outside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.problem.candidates import build_dictionary
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.whitening import White, whiten
from jointwear.discovery.search.acceptance import of_timing
from jointwear.discovery.search.decide import decide
from jointwear.discovery.search.outside_force import beside_force, force_beside, force_of, outside_force
from jointwear.discovery.search.rocking import swings
from jointwear.discovery.search.standing_alone import settle


def whitened(problem: Problem) -> White:
    """Return the training samples of `problem` whitened, with the noise of a saturated fit."""
    return whiten(problem, estimate_noise(problem))


def search(white: White) -> Outcome:
    """Return the effects that whitened data show, out of all of the library: :func:`decide`.

    Where a force from outside explains more than any of them they are looked for beside it. What shakes the arm is
    noise, unless what was found explains it: :func:`_found_still`.
    """
    return _found_still(white) or _search(white)


def _found_still(white: White) -> Outcome | None:
    """Return what is found where nothing that shakes the arm is noise, if that explains it, else None."""
    if not white.problem.shaken.any():
        return None
    outcome = _search(whitened(replace(white.problem, still=True)))
    return outcome if explains_shaking(outcome) else None


def explains_shaking(outcome: Outcome) -> bool:
    """Return whether what was found where nothing that shakes the arm is noise explains it.

    A strong gear shakes all joints, as noise in the drives does, and a drive of two joints both of them. Noise feigns
    rates of torque: names of timing say nothing here, but for a link that swings, which needs the stiffness, the size
    and the pull on all other joints of one gear. With little evidence it must also leave nothing on its own joint, and
    be worth more than any other name of timing: where noise feigns more, it feigns that much.
    Other names explain it where they leave nothing at all.
    """
    lacking = {u.axis for u in outcome.unexplained}
    weak = outcome.problem.settings.weak_nats
    timing = [n for n in outcome.named if of_timing(n.candidate)]
    gears = [n for n in timing if swings(n)]
    feigned = max((n.evidence for n in timing if not swings(n)), default=0.0)
    if any(n.evidence > weak or (n.candidate.axis not in lacking and n.evidence > feigned) for n in gears):
        return True
    drives = pairs_of_drives(outcome.named, weak)
    if drives and {int(a) for a in np.flatnonzero(replace(outcome.problem, still=False).shaken)} in drives:
        return True
    return bool(outcome.named) and not outcome.unexplained and not timing


def pairs_of_drives(named: list[Named], weak: float) -> list[set[int]]:
    """Return the pairs of 0-based axes each of which names the other as turning one drive with it, or that have one
    name.

    Parameters
    ----------
    weak : nats that the name of either axis needs.
    """
    sums = {}
    for one in named:
        candidate, axis, source = one.candidate, one.candidate.axis, one.candidate.source
        if axis is None or source is None or one.evidence <= weak or not candidate.nonlinear.get("own"):
            continue
        for half in candidate.halves:
            sums[half.axis, half.source] = np.sign(half.nonlinear["own"] * half.nonlinear["other"])
    return [{axis, source} for (axis, source), sign in sums.items() if sums.get((source, axis)) == sign]


def _search(white: White) -> Outcome:
    dictionary = build_dictionary(white)
    term, outcome = outside_force(white, dictionary), None
    if term is None:
        outcome = decide(white, dictionary)
        term = force_beside(white, outcome.named)
    if term is None:
        return outcome
    beside = decide(*beside_force(white, dictionary, term))
    beside.force = force_of(white, term, beside.named)
    if beside.force is None:
        return outcome or decide(white, dictionary)
    beside.white, beside.dictionary = white, dictionary
    settle(beside)
    return beside
