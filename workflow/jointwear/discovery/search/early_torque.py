"""Torque that seems to act before it is recorded as acting: the log of a command does so, that of a motor does not."""

from __future__ import annotations

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.search.acceptance import of_late_torque
from jointwear.effects import get_effect

#: What is said of an early torque on an axis on which structure is left.
EARLY = (
    "the torque would have to be early, as a logged command is and that of a motor or a sensor is not, and structure "
    "is left there"
)


def early(outcome: Outcome, one: Named) -> bool:
    """Return whether an effect is torque at an earlier time, of a log that is not told to hold commands.

    A command precedes the torque that follows it. What a motor or a sensor tells is late or in time: there a name for
    an early torque says only that it goes with the rate of torque, as much else does, and beside structure that
    nothing explains it may stand in for that.
    """
    if not of_late_torque(one.candidate) or outcome.problem.state.torque_kind == "command":
        return False
    return delay_of(outcome, one) < 0


def delay_of(outcome: Outcome, one: Named) -> float:
    """Return the dead time or lag [s] of a name that is the torque at another time, negative where it is early.

    It is that beside all names without the tolerances of their forms: that of a delay holds the delay itself, and a
    torque that is 17 ms early came out as 0.9 ms late beside it.
    """
    effect, plain = get_effect(one.candidate.effect), outcome.white.fit([n.term for n in outcome.named])
    return float(effect.parameters_of(one.candidate.nonlinear, plain.coefficients(one.term))[effect.scaled])
