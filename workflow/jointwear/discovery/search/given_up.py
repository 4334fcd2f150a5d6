"""Names of a search that a later one of the same data, asked in another way, has no more."""

from __future__ import annotations

from dataclasses import replace

from jointwear.discovery.estimates.outcome import Outcome, Refusal
from jointwear.discovery.estimates.refine import evidence_at
from jointwear.discovery.problem.candidates import LINK_MASS


def telling_names_given_up(before: Outcome, after: Outcome, gate: str) -> Outcome:
    """Return the outcome of a later search that tells, as refused, the names of joints that only the one before had.

    A reader of the verdict is to see that a name was close, and what stands for it. What the later search refused or
    suspects itself is told by that.

    Parameters
    ----------
    gate : what the later search holds the evidence of a name against.
    """
    told = {n.candidate.key for n in after.named} | {n.candidate.key for n, _ in after.suspects}
    told |= {r.candidate.key for r in after.refusals}
    lost = [n.candidate for n in before.named if n.candidate.key not in told]
    lost = [c for c in lost if c.axis is not None and c.effect != LINK_MASS]
    if not lost:
        return after
    white, needed = after.white, after.problem.settings.accept
    nats = [evidence_at(white, after.fit, candidate) for candidate in lost]
    refused = [Refusal(c, n, gate, n, needed) for c, n in zip(lost, nats, strict=True)]
    return replace(after, refusals=[*after.refusals, *refused])
