"""What structure without a name would explain if it stood in the place of a name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import Fit, gain
from jointwear.discovery.problem.candidates import LINK_MASS, of_bases, resolved_bases
from jointwear.discovery.search.tolerance import fit_beside_forms, with_tolerances
from jointwear.discovery.structure import Basis
from jointwear.effects import get_effect

#: Priors of the size of a structure, over the `usual` share of the friction of its axis: decades and halves of them,
#: from what noise hides to several times the friction. All are as likely.
SIZES = np.logspace(-2, 1, 7)


def better_in_its_place(outcome: Outcome, one: Named) -> tuple[Basis, int, float] | None:
    """Return the structure of one joint over one argument that explains more than a name does in its place, or None.

    A form that is right needs a few parameters where structure has one for each knot, and pays for them: structure over
    an argument, any of those that leftovers are tested over, then explains less. Where it explains more, by `accept`,
    the torque follows that argument and the name has only come close to it: a name is taken back for as much evidence
    as it is given for. Its torque may be off by `form_error`, which costs the square of that of its own nats; an effect
    of the whole arm is asked on every joint that it moves. Structure over the argument of the effect itself is no
    rival: what it does better is the form. Nor is structure that explains as much beside the name: that is something
    else, which does not take its place.

    Returns
    -------
    the structure, its 0-based axis and the nats by which it is ahead.
    """
    place, best = place_of(outcome, one), None
    if _noise_may_take(outcome, one, place):
        return None
    for axis in asked_of(one):
        rivals = [basis for basis in resolved_bases(outcome.white, axis) if not of_its_form(one, basis.argument)]
        for basis, seen in of_bases(outcome.white, place.without, axis, rivals):
            lead = place.lead(axis, seen.columns, seen.b, seen.gram, 0.0 if best is None else best[2])
            best = best if lead is None else (basis, axis, lead)
    return best


def _noise_may_take(outcome: Outcome, one: Named, place: Place) -> bool:
    """Return whether a strong name explains nothing beside what noise takes off fitted inertias, and all of it else.

    Of a torque constant with coarse positions the two cannot be told apart. Then nothing can take its place: structure
    of a few nats would be ahead of nothing.
    """
    settings, white = outcome.problem.settings, outcome.white
    if place.own >= settings.accept:
        return False
    rest = [n for n in outcome.named if n is not one]
    without, with_it = (white.fit(with_tolerances(white, named)).evidence for named in (rest, [*rest, one]))
    return with_it - without > settings.weak_nats


@dataclass(frozen=True)
class Place:
    """The place of a name: fits `without` it and `with_it`, what it explains there, `own` [nats], and by how many nats
    something else has to be ahead of that, `needed`."""

    outcome: Outcome
    without: Fit
    with_it: Fit
    own: float
    needed: float

    def lead_of(self, axis: int, columns: np.ndarray) -> float | None:
        """Return :meth:`lead` of whitened columns (m, k) of one axis alone."""
        return self.lead(axis, columns, *self.without.gram({axis: columns}))

    def lead(self, axis: int, columns: np.ndarray, b: np.ndarray, gram: np.ndarray, least: float = 0.0) -> float | None:
        """Return by how many nats whitened columns of one axis, with `b` and `gram` of the fit `without`, are ahead of
        the name; None where it is no more than `least`, or they explain as much beside the name."""
        nats = evidence_of(self.outcome, axis, b, gram)
        if nats - self.own <= max(self.needed, least):
            return None
        beside = evidence_of(self.outcome, axis, *self.with_it.gram({axis: columns}))
        return nats - self.own if nats - beside > self.outcome.problem.settings.accept else None


def place_of(outcome: Outcome, one: Named) -> Place:
    """Return the place of a name among all names, with the tolerances of their forms."""
    white, settings = outcome.white, outcome.problem.settings
    rest = [n for n in outcome.named if n is not one]
    # What noise takes off fitted inertias may stand for all of a torque constant, and what is left of the name is the
    # price of its tolerance: then there is nothing that structure could explain in its place.
    without, with_it = (fit_beside_forms(white, named) for named in (rest, [*rest, one]))
    own = max(with_it.evidence - without.evidence, 0.0)
    return Place(outcome, without, with_it, own, settings.accept + settings.form_error**2 * own)


def asked_of(one: Named) -> list[int]:
    """Return the 0-based axes on which structure may stand for an effect: its own, or all that it moves."""
    if one.candidate.effect == LINK_MASS:
        return []
    return sorted(one.term.blocks) if get_effect(one.candidate.effect).whole_arm else [one.candidate.axis]


def of_its_form(one: Named, argument: str) -> bool:
    """Return whether structure is over the argument of the effect itself, in whatever sense of motion."""
    own = get_effect(one.candidate.effect).argument
    return own.split(" x ")[0] == argument.split(" x ")[0] and " of joint " not in argument


def evidence_of(outcome: Outcome, axis: int, b: np.ndarray, gram: np.ndarray) -> float:
    """Return the evidence [nats] that structure over an argument adds to a fit, averaged over :data:`SIZES`.

    `b` (k,) and `gram` (k, k) are of :meth:`Fit.gram`.
    """
    size = outcome.problem.settings.usual * outcome.problem.scale[axis] * np.ones(len(b))
    return float(np.logaddexp.reduce([gain(b, gram, share * size) for share in SIZES]) - np.log(len(SIZES)))
