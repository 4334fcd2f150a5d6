"""The other half of a drive that two joints turn: one coefficient on both axes, where the data do not speak against it.

By virtual work the friction of a drive acts on every joint that turns it. Where the drive nearly always turns as its
second joint does, a correction of the Coulomb friction of that joint does there what the drive does, and the half on
the second axis gets no name of its own. The correction needs parameters that the data have to set free, the other half
needs none: its coefficient has been found on the first axis.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.base import likely_base
from jointwear.discovery.estimates.forms import form_term
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.estimates.scan import possible
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, term_of
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.crossval import cross_validate
from jointwear.discovery.search.drives_at_rest import unknown_at_rest
from jointwear.effects import get_effect


def with_other_halves(white: White, named: list[Named]) -> list[Named]:
    """Return named effects in which shared drives act on both joints that turn them, where the data allow it.

    What one joint feels of the drive that the other one names is asked with its coefficient, against the name as it is,
    both beside the errors of the robot under which the data are likeliest. Half of a drive is the form that is less
    plain: it stays where it is better by half of `accept`, as a whole or on records left out, and where the other joint
    needs less of a correction of its Coulomb friction with it.
    """
    result = list(named)
    for i, one in enumerate(named):
        if not _may_be_half(white, one.candidate, {n.candidate.key for n in result}):
            continue
        beside = [t for k, n in enumerate(result) if k != i for t in n.terms]
        _, result[i] = max(_wholes(white, beside, one), key=lambda found: found[0], default=(0.0, one))
    return result


def _may_be_half(white: White, candidate: Candidate, known: set[tuple]) -> bool:
    """Return whether a candidate is the friction of another axis's drive, and that axis has not the same name."""
    if candidate.effect == LINK_MASS or not get_effect(candidate.effect).rubs:
        return False
    return candidate.source in white.problem.judged and candidate.other_half.key not in known


def _wholes(white: White, beside: list[Term], one: Named) -> Iterator[tuple[float, Named]]:
    """Yield a named drive with one coefficient on both axes in every form that the data allow, with the nats by which
    it is ahead of its half."""
    fit, needed = white.fit(beside), 0.5 * white.problem.settings.accept
    for nonlinear in get_effect(one.candidate.effect).plain(white.problem.train_state, one.candidate.axis):
        drive = replace(one.candidate, nonlinear=dict(nonlinear), both=True)
        term = term_of(white, drive)
        size = white.fit([*beside, term]).coefficients(term)
        if not possible(get_effect(drive.effect), drive.nonlinear, size):
            # Turned round it says as much, with friction that drives.
            continue
        form = None if one.form is None else form_term(white, fit, drive, term.blocks, term.std)
        whole = replace(one, candidate=drive, term=term, form=form)
        moving, (beside_it, terms, half) = _where_it_moves(white, drive, float(size[0]), beside, whole.terms, one.terms)
        both, alone = (_likeliest(moving, [*beside_it, *group]) for group in (terms, half))
        lead = both.evidence - alone.evidence
        if lead <= -needed or _corrected(both, drive.source) > _corrected(alone, drive.source):
            continue
        predicted = [cross_validate(moving, beside_it, group).nats for group in (terms, half)]
        if predicted[0] > predicted[1] - needed:
            yield lead, whole


def _where_it_moves(
    white: White, drive: Candidate, level: float, *groups: list[Term]
) -> tuple[White, list[list[Term]]]:
    """Return a problem and groups of terms that say nothing where a drive of Coulomb friction `level` [N m] may stick.

    There its friction is of any level, on both joints: a few such samples would decide.
    """
    keep = {half.axis: ~unknown_at_rest(white, half, level) for half in drive.halves}

    def kept(terms: list[Term]) -> list[Term]:
        return [replace(t, blocks={a: _kept(x, keep.get(a)) for a, x in t.blocks.items()}) for t in terms]

    targets = [_kept(y, keep.get(axis)) for axis, y in enumerate(white.targets)]
    return replace(white, targets=targets, base=kept(white.base)), [kept(terms) for terms in groups]


def _kept(values: np.ndarray, keep: np.ndarray | None) -> np.ndarray:
    """Return values (m,) or (m, k) that are zero but for the samples to `keep` (m,), None for all."""
    return values if keep is None else (values.T * keep).T


def _likeliest(white: White, terms: list[Term]) -> Fit:
    """Return the fit of terms beside errors of the robot under the prior with which its evidence is largest."""
    return Fit(white.targets, [*likely_base(white, terms)[0], *terms])


def _corrected(fit: Fit, axis: int) -> float:
    """Return the squares [(N m)^2] of what a fit corrects of the Coulomb friction of an axis, of both its senses."""
    places = [w for t, w in zip(fit.terms, fit.slices, strict=True) if t.drive in ((axis, 0), (axis, 1))]
    return float(sum(np.sum(fit.theta[w] ** 2) for w in places))
