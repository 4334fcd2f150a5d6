"""What the search hands on: effects that were accepted, structure that was not explained."""

from __future__ import annotations

from dataclasses import dataclass, field

from jointwear.discovery.candidates import Candidate, Dictionary
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem import Problem, White


@dataclass(frozen=True)
class Named:
    """An effect that was accepted, with its rivals.

    `evidence` [nats] is lost when the effect and the tolerance of its form are taken out of the final model;
    `cross_validated` the share of the squared residual that it explains in records left out in turn.
    """

    candidate: Candidate
    term: Term
    form: Term | None
    evidence: float
    cross_validated: float = 0.0
    ties: tuple[Candidate, ...] = ()

    @property
    def terms(self) -> list[Term]:
        """The term of the effect and that of the tolerance of its form."""
        return [self.term] if self.form is None else [self.term, self.form]


@dataclass(frozen=True)
class Unexplained:
    """Structure of one 0-based axis over an argument that no effect explains."""

    axis: int
    argument: str
    unit: str
    low: float
    high: float
    p_value: float
    nats: float


@dataclass
class Outcome:
    """What the search found; `white` and `fit` are those of the final model."""

    problem: Problem
    white: White
    fit: Fit
    dictionary: Dictionary
    refused: set = field(default_factory=set)
    named: list[Named] = field(default_factory=list)
    unexplained: list[Unexplained] = field(default_factory=list)
    profile: list[Unexplained] = field(default_factory=list)
