"""Whether what the flange lacks is a body that hangs there, or the links are not what the robot file says."""

from __future__ import annotations

import numpy as np

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Fit, Term, gain, posterior_mean
from jointwear.discovery.problem.whitening import INERTIAL, White
from jointwear.effects import get_effect
from jointwear.robots.inertia import bodies, reach_of_link


def lead_over_links(white: White, before: list[Term], trial: Named) -> float:
    """Return the nats by which a body does better than links that are all known less well than the user said.

    Either way the links are as well known as said, or as much worse as a link that is off without being told, whichever
    the data ask for (MacKay 1992, Bayesian interpolation): a last link far off alone is a body, a whole table of links
    that are off is none. So is no table in which the mass of a link would be off by more than as a parameter it may be.
    What hangs at the flange moves as the last link does: where it is known less than all others, the body counts as
    that does, whose ten parameters cost less than those of a body of which nothing is known.
    """
    links = next((t for t in white.base if t.label == INERTIAL), None)
    rest = [t for t in white.base if t.label != INERTIAL]
    without = Fit(white.targets, [*rest, *before])
    body = gain(*without.gram(trial.term.blocks), trial.term.std)
    if links is None:
        return body
    beside = Fit(white.targets, [*rest, *before, trial.term])
    best, other = (nats_of_links(white, links.std, *fit.gram(links.blocks)) for fit in (beside, without))
    return max(body + best, _nats_of_last(white, links, without)) - other


def _nats_of_last(white: White, links: Term, without: Fit) -> float:
    """Return the nats of links as well known as said, beside a fit without them, where the last is known less well."""
    problem, settings = white.problem, white.problem.settings
    own = np.any(problem.factor[-10:] != 0.0, axis=0)
    turned = white.directions_of(links)[own].T
    blocks = {axis: np.concatenate([x, x @ turned], axis=1) for axis, x in links.blocks.items()}
    # Beside what is said, so that both together are as wide as they would be for links that are all known less.
    more = np.full(turned.shape[1], np.sqrt(settings.mass_sigmas**2 - 1.0))
    return float(gain(*without.gram(blocks), np.concatenate([links.std, more])))


def nats_of_links(white: White, std: np.ndarray, b: np.ndarray, gram: np.ndarray) -> float:
    """Return the nats of the links, as well known as said or less well, of their sums `b` (r,) and `gram` (r, r).

    Parameters
    ----------
    std : (r,) of the inertial directions of the fit, as well known as said.
    """
    problem, settings = white.problem, white.problem.settings
    said, wide = gain(b, gram, std), settings.mass_sigmas * std
    masses = np.array([body[0] for body in bodies(problem.robot)])[:, None]
    change = problem.factor[::10] @ white.directions @ posterior_mean(b, gram, wide)[:, None]
    if np.any(np.abs(change) > settings.wrongest_mass * masses):
        return said
    return max(said, gain(b, gram, wide))


def nats_of_its_mass(white: White, beside: Fit, trial: Named) -> float:
    """Return the nats by which a body does better than a last link whose centre of mass and inertia alone are off.

    Infinite where its centre of mass would have to be off by more of the size of the link than a mass may be of itself:
    that is a body, though the motion may not show its mass.
    """
    (b, gram), std = beside.gram(trial.term.blocks), trial.term.std
    moment = posterior_mean(b[1:], gram[1:, 1:], std[1:])[:3]
    mass, com, inertia = bodies(white.problem.robot)[-1]
    size = reach_of_link(mass, com, inertia)
    if np.linalg.norm(moment) > white.problem.settings.wrongest_mass * mass * size:
        return np.inf
    return gain(b, gram, std) - gain(b[1:], gram[1:, 1:], std[1:])


def impossible_nats(white: White, beside: Fit, trial: Named) -> float:
    """Return the nats of an effect that are lost where its coefficients have to be those of something that may exist.

    Where it stands for something else a body without mass and with negative moments of inertia may fit best.
    """
    nearest = get_effect(trial.candidate.effect).nearest
    if nearest is None:
        return 0.0
    (b, gram), std = beside.gram(trial.term.blocks), trial.term.std
    precision = gram + np.diag(1 / std**2)
    best = posterior_mean(b, gram, std)
    off = nearest(white.problem.robot, best, precision) - best
    return float(0.5 * off @ precision @ off)
