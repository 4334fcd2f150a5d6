"""What the search hands on: effects that were accepted, structure that was not explained."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.candidates import Candidate, Dictionary
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.saturated import noise_level
from jointwear.discovery.problem.whitening import White


@dataclass(frozen=True)
class Named:
    """An effect that was accepted, with its rivals.

    `evidence` [nats] is lost when the effect and the tolerance of its form are taken out of the final model;
    `cross_validated` the share of the squared residual that it explains in records left out in turn, `gain_share` the
    drop of the squared error there over the noise variance, `lowers_error` the probability that it drops.
    `probability` that the effect is there; `repeated` share of the runs without one group of recordings that name it.
    `structure_left` says that its axis stays unexplained, `misfit` in words that the search for its parameters went
    wrong.
    """

    candidate: Candidate
    term: Term
    form: Term | None
    evidence: float
    cross_validated: float = 0.0
    gain_share: float = 0.0
    lowers_error: float = 1.0
    probability: float = 1.0
    log_odds: float = 0.0
    repeated: float | None = None
    structure_left: bool = False
    misfit: str = ""
    ties: tuple[Candidate, ...] = ()

    @property
    def terms(self) -> list[Term]:
        """The term of the effect and that of the tolerance of its form."""
        return [self.term] if self.form is None else [self.term, self.form]


#: An effect that was taken off an axis that stays unexplained, and the reason.
Suspected = tuple[Named, str]


@dataclass(frozen=True)
class Unexplained:
    """Structure of one 0-based axis over an argument that no effect explains.

    It is strongest from `low` to `high`, a `share` of what the motion covers of the argument. `freedom` is that
    of its chi-square, 0 where it is none.
    """

    axis: int
    argument: str
    unit: str
    low: float
    high: float
    p_value: float
    nats: float
    share: float = 0.0
    freedom: int = 0


@dataclass(frozen=True)
class Refusal:
    """A candidate that a gate refused: what it reached and what the gate asks for."""

    candidate: Candidate
    evidence: float
    gate: str
    reached: float
    needed: float


@dataclass
class Outcome:
    """What the search found; `white`, `fit` and `dictionary` are those of the final model, None where it failed.

    `refusals` are candidates that a gate refused, `suspects` what was taken off an axis that stays
    unexplained, `unsteady` the keys of those whose size changes over time or with the speed, `not_tried` (effect,
    0-based axis or None) -> reason. `force` (4,) [N, N m-1] at the flange in the base frame, where what is unexplained
    is most like one.
    """

    problem: Problem
    white: White | None
    fit: Fit | None
    dictionary: Dictionary | None
    named: list[Named] = field(default_factory=list)
    unexplained: list[Unexplained] = field(default_factory=list)
    profile: list[Unexplained] = field(default_factory=list)
    refusals: list[Refusal] = field(default_factory=list)
    suspects: list[Suspected] = field(default_factory=list)
    unsteady: set[tuple] = field(default_factory=set)
    not_tried: dict[tuple[str, int | None], str] = field(default_factory=dict)
    force: np.ndarray | None = None

    def terms_beside(self, one: Named) -> list[Term]:
        """Return the terms of all names but one, which is one of them."""
        return [t for n in self.named if n is not one for t in n.terms]

    @property
    def noise_floor(self) -> list[float | None]:
        """Standard deviation of the noise of the torque of every axis, that of derived accelerations too [N m], None
        where it cannot be judged."""
        if self.white is None:
            return [None] * self.problem.robot.joints
        return [None if w is None else noise_level(self.problem, a, w) for a, w in enumerate(self.white.whiteners)]
