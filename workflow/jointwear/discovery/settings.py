"""Settings of discovery: the user's, and the thresholds that were chosen on tuning seeds."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Settings:
    """What decides a verdict.

    Attributes
    ----------
    inertial_prior : relative standard deviation of the nominal inertial parameters.
    most_effects : no more effects than this are named; `most_on_axis` on one axis.
    accept : evidence [nats], after the price of complexity and of searching, that an effect needs.
    share : a further effect on the same axis, and unexplained structure there, must be worth at least this share
        of the evidence of the effects already named: a form is never known exactly.
    unexplained_p : structure is unexplained below this probability.
    retuned_nats : evidence that a number of the model needs to be called wrong.
    """

    inertial_prior: float = 0.05
    most_effects: int = 6
    most_on_axis: int = 2
    accept: float = 9.0
    share: float = 0.02
    unexplained_p: float = 1e-8
    retuned_nats: float = 8.0
