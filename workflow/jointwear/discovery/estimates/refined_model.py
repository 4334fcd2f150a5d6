"""The effects of a model on its way to a robot file: refined parameters, bends of their forms, link masses."""

from __future__ import annotations

from dataclasses import dataclass, replace

from jointwear.discovery.estimates.forms import Form
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate


@dataclass(frozen=True)
class RefinedEffect:
    """A named effect with its nonlinear parameters at the largest evidence.

    `bend` is the correction of its form and the term of it, None where its own form is kept.
    """

    named: Named
    candidate: Candidate
    term: Term
    bend: tuple[Form, Term] | None = None

    @property
    def terms(self) -> list[Term]:
        """Its term, and that of its bend where it has one."""
        return [self.term] if self.bend is None else [self.term, self.bend[1]]


@dataclass(frozen=True)
class RefinedModel:
    """What a model has beside the base: `effects`, and `masses` of links that have a name."""

    effects: tuple[RefinedEffect, ...]
    masses: tuple[Named, ...]

    @property
    def candidates(self) -> list[Candidate]:
        """The candidates of the effects."""
        return [e.candidate for e in self.effects]

    @property
    def axes(self) -> list[int | None]:
        """The 0-based axes on which it acts, None for the whole arm."""
        return [axis for c in self.candidates for axis in c.axes] + [n.candidate.axis for n in self.masses]

    @property
    def effect_terms(self) -> list[Term]:
        """The terms of the effects, without their bends."""
        return [e.term for e in self.effects]

    @property
    def mass_terms(self) -> list[Term]:
        """The terms of the masses of links."""
        return [t for n in self.masses for t in n.terms]

    @property
    def bend_terms(self) -> list[Term]:
        """The terms of the bends."""
        return [e.bend[1] for e in self.effects if e.bend is not None]

    @property
    def terms(self) -> list[Term]:
        """All terms of the model beside the base."""
        return self.effect_terms + self.mass_terms + self.bend_terms

    def plain_where_kept(self, plainer: list[list[tuple[Candidate, Term]]], left: set[int]) -> RefinedModel:
        """Return the model with the plain forms that took the place of an effect, and without bends that were given up.

        Parameters
        ----------
        plainer : of each effect, as of :func:`jointwear.discovery.model.steps_back.plainer_forms`.
        left : identities of the terms that were kept.
        """
        effects = [_as_kept(e, forms, left) for e, forms in zip(self.effects, plainer, strict=True)]
        # A bend goes alone, or with the form that it bends.
        effects = [
            e if e.bend is None or id(e.bend[1]) in left or id(e.term) not in left else replace(e, bend=None)
            for e in effects
        ]
        return replace(self, effects=tuple(effects))

    def lost(self, left: set[int]) -> list[RefinedEffect]:
        """Return the effects whose terms are not among those `left`."""
        return [e for e in self.effects if id(e.term) not in left]

    def only(self, left: set[int]) -> RefinedModel:
        """Return the model with the effects and masses whose terms are `left`."""
        return RefinedModel(
            tuple(e for e in self.effects if id(e.term) in left), tuple(n for n in self.masses if id(n.term) in left)
        )


def _as_kept(effect: RefinedEffect, plainer: list[tuple[Candidate, Term]], left: set[int]) -> RefinedEffect:
    """Return an effect as it is in a model with the terms `left`: in a plain form where that took its place."""
    found = [] if id(effect.term) in left else [(c, t) for c, t in plainer if id(t) in left]
    return replace(effect, candidate=found[0][0], term=found[0][1]) if found else effect
