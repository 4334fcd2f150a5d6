"""A force at the flange that no effect of the library is: a hose, the wind, a rope or a contact.

Most of what such a force does is that of a mean force, the same in the base frame at all poses, at the end of the arm:
three columns J' F (Siciliano and Khatib 2016, Springer Handbook of Robotics, statics of serial chains). What is fixed
somewhere, as a hose or a rope is, pulls the harder the further the flange is off, towards where it is fixed: a force
F - k (x - mean x), whose fourth column is J' (mean x - x). Without them
effects that pull at all joints take it: a tilted base turns the pull of gravity on every link, and is named with
thousands of nats where a hose hangs at the last. So where these four columns explain more than any effect does,
effects of single joints are looked for beside them; what the force changes by would look like those of the whole arm.
They are no effect themselves: the torque stays unexplained, and what it looks like is told in words.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.estimates.scan import scan
from jointwear.discovery.linear import Term, gain, posterior_mean
from jointwear.discovery.problem.candidates import Dictionary
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect, library

#: Label of the term of such a force among those of the base.
LABEL = "force at the flange"


def outside_force(white: White, dictionary: Dictionary) -> Term | None:
    """Return the term of a force at the flange that explains more than any effect of the library, None for none."""
    term = force_term(white)
    if term is None:
        return None
    fit, accept = white.fit(), white.problem.settings.accept
    nats = gain(*fit.gram(term.blocks), term.std)
    if nats <= accept or any(nats <= gain(*fit.gram(blocks), std) + accept for _, blocks, std in dictionary.whole):
        return None
    return term if nats > max((s.evidence for s in scan(white, dictionary, fit)), default=0.0) + accept else None


def force_beside(white: White, named: Sequence[Named]) -> Term | None:
    """Return the term of a force at the flange that shows beside a name that acts on the whole arm, None for none.

    A rope that turns with the pose pulls at all joints as a tilted base does, and may look more like one than like a
    force that stays the same. A base that is tilted, and nothing else, leaves no more for a force than its form may be
    off by: links that gravity turns are not exact, and of a tilt of a million nats that is seen. A body leaves its own
    weight to be known better: that is no force.
    """
    no_body = [n for n in named if n.candidate.axis is None and get_effect(n.candidate.effect).sound is None]
    if not no_body:
        return None
    term = force_term(white)
    if term is None:
        return None
    settings = white.problem.settings
    least = max(settings.accept, settings.form_error * max(n.evidence for n in no_body))
    b, gram = white.fit([t for n in named for t in n.terms]).gram(term.blocks)
    return term if gain(b, gram, term.std) > least else None


def beside_force(white: White, dictionary: Dictionary, term: Term) -> tuple[White, Dictionary]:
    """Return the problem with a force at the flange among the terms of its base, and what is looked for beside it."""
    single = [one for one in dictionary.whole if one[0].axis is not None]
    return replace(white, base=[*white.base, term]), replace(dictionary, whole=single)


def force_of(white: White, term: Term, named: Sequence[Named]) -> np.ndarray | None:
    """Return the force (4,) beside named effects, None where they do without it.

    Its mean over the poses in the base frame [N], and by how much it pulls back as the flange moves [N/m].

    Parameters
    ----------
    white : the problem without the force.
    """
    b, gram = white.fit([t for n in named for t in n.terms]).gram(term.blocks)
    if gain(b, gram, term.std) <= white.problem.settings.accept:
        return None
    return posterior_mean(b, gram, term.std)


def force_in_words(force: np.ndarray) -> str:
    """Return what is told of a force (4,) at the flange, as :func:`force_of` has it."""
    mean, stiffness = force[:3], force[3]
    parts = ", ".join(f"{x:.2g}" for x in mean)
    way = "against" if stiffness > 0 else "along with"
    return (
        f"what is unexplained is most like a force of {np.linalg.norm(mean):.2g} N at the flange, ({parts}) N along "
        f"x, y and z of the base in the mean of all poses, that grows by {abs(stiffness):.2g} N/m {way} the motion of "
        "the flange: look for a hose, a cable, a rope, wind or a contact"
    )


def force_term(white: White) -> Term | None:
    """Return the columns of a force at the flange, as strong as the weight of a usual load; None without gravity.

    It usually changes by as much over the way of the flange.
    """
    problem = white.problem
    usual = [effect.prior(problem.robot)[0] for effect in library().values() if effect.sound is not None]
    weight = max(usual, default=0.0) * float(np.linalg.norm(problem.robot.gravity))
    if not weight > 0:
        return None
    path = problem.flange_path
    back = np.einsum("...ij,...j->...i", problem.flange_pull, -path)
    pull = np.concatenate([problem.flange_pull, back[..., None]], axis=-1)
    way = max(float(np.sqrt(np.mean(np.sum(path**2, axis=-1)))), np.finfo(float).tiny)
    std = np.array([weight, weight, weight, weight / way])
    blocks = {a: white.columns(a, pull[:, a]) for a in problem.judged}
    raw = {a: white.raw(a, pull[:, a]) for a in problem.judged}
    return Term(LABEL, blocks, std, raw)
