"""Friction of a drive that two joints turn and that has its name on one of them: what the other one makes of it."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.model.final_model import Final
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.verdict import Retuned
from jointwear.effects import get_effect


def shared_friction(final: Final) -> list[str]:
    """Say of which joints a drive that has its name on another joint is written too, with one coefficient on both."""
    return [
        f"joint {c.source + 1} turns the drive too that has its name on joint {c.axis + 1}: the robot file has its "
        f"friction on both, with one coefficient, which needs no other friction of joint {c.source + 1}"
        for c in (e.named.candidate for e in final.estimates)
        if c.both
    ]


def undecided_friction(final: Final, retuned: Iterable[Retuned]) -> list[str]:
    """Say of which joints corrected Coulomb friction may be that of a drive that has its name on another joint.

    By virtual work the friction of a drive acts on every joint that turns it. Where the drive turns as its second joint
    does, but for samples at which it is at rest, nothing tells its friction from that of the joint alone, and no name
    comes of it there: Coulomb friction is corrected in its place, which is wrong wherever the two differ.

    Parameters
    ----------
    retuned : parameters that are told to be wrong.
    """
    corrected = {one.axis - 1 for one in retuned if one.parameter.startswith("coulomb")}
    drives = [(e.named.candidate, e.parameters) for e in (*final.estimates, *final.unwritten)]
    drives = [(c, p) for c, p in drives if c.effect != LINK_MASS and get_effect(c.effect).rubs]
    known = {(half.axis, half.source) for c, _ in drives for half in c.halves}
    return [
        f"joint {c.source + 1} turns the drive too that has its name on joint {c.axis + 1}, and its friction acts on "
        f"both: in training the drive changes direction only where joint {c.source + 1} does, whose corrected Coulomb "
        f"friction may stand in for it; let joint {c.axis + 1} move faster than joint {c.source + 1}, and against it"
        for c, p in drives
        if p["own"]
        and p["other"]
        and c.source in corrected
        and (c.source, c.axis) not in known
        and not _told_apart(final.outcome.white, c, p["coulomb"], final.outcome.problem.judged)
    ]


def _told_apart(white: White, drive: Candidate, level: float, judged: Collection[int]) -> bool:
    """Return whether training shows whose friction of a `level` [N m] acts on the second joint of a shared drive.

    Samples at which the drive is slow enough to stick say nothing: there its friction is of any level.
    """
    if drive.source not in judged:
        return True
    velocity = white.problem.train_state.velocity
    own = velocity[:, drive.source]
    # Friction of the drive, as the second joint feels it: by its share in the motion.
    share = drive.nonlinear["other"]
    speed = drive.nonlinear["own"] * velocity[:, drive.axis] + share * own
    apart = np.where(np.abs(speed) < assumed.STICKS, 0.0, level * (share * np.sign(speed) - np.sign(own)))
    seen = white.columns(drive.source, apart[:, None])
    return bool(np.sum(seen**2) > white.problem.settings.visible)
