"""Which link mass of the given robot the data contradict."""

from __future__ import annotations

import numpy as np
from scipy.special import softmax

from jointwear.discovery.estimates.base import INERTIAL_ERRORS, weighed_links
from jointwear.discovery.estimates.misfit import divided, masses_of
from jointwear.discovery.estimates.scan import Scored, scan
from jointwear.discovery.linear import Fit, gain
from jointwear.discovery.model.final_model import Final
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.discovery.problem.whitening import INERTIAL
from jointwear.discovery.settings import Settings
from jointwear.discovery.verdict import MovingBody, Retuned
from jointwear.files.json_values import six_digits
from jointwear.robots.inertia import bodies


def wrong_mass(final: Final) -> list[Retuned]:
    """Return the link whose mass best explains that inertial parameters are not nominal, if they are not.

    Of a mass that the search has named all of the change is its own. Elsewhere it is the one that is farthest off.
    """
    outcome, problem = final.outcome, final.outcome.problem
    white, settings = final.white, problem.settings
    named = {n.candidate.key for n in outcome.named if n.candidate.effect == LINK_MASS}
    fixed = [t for t in white.base if t.label != INERTIAL]
    effects = [divided(t, final.misfit) for n in outcome.named if n.candidate.effect != LINK_MASS for t in n.terms]
    fit = Fit(white.targets, [*fixed, *effects])
    full = white.fit([*effects])
    worth = full.evidence - fit.evidence
    if not named and worth < settings.accept:
        return []
    keys = {(LINK_MASS, link, None) for link in range(problem.robot.joints)}
    found = scan(white, masses_of(outcome.dictionary, final.misfit, LINK_MASS), fit, keys)
    singles = [(s, *fit.gram(s.blocks)) for s in found if np.isfinite(s.evidence)]
    own = next((one for one in singles if one[0].candidate.key in named), None)
    if own is None:
        return _farthest_mass(final, full, worth, singles)
    link, share, std = _alone(*own)
    mass = bodies(problem.robot)[link][0]
    return [_link_mass(link, mass, mass * (1 + share), mass * float(np.hypot(std, settings.parameter_error)))]


def _alone(one: Scored, b: np.ndarray, gram: np.ndarray) -> tuple[int, float, float]:
    """Return a link, the share by which its mass is off if nothing else of the links is, and how well that is known."""
    precision = float(gram[0, 0] + 1 / one.std[0] ** 2)
    return one.candidate.axis, float(b[0]) / precision, precision**-0.5


def _farthest_mass(
    final: Final, full: Fit, worth: float, singles: list[tuple[Scored, np.ndarray, np.ndarray]]
) -> list[Retuned]:
    """Return the link mass that is most standard deviations off, whatever is wrong with the links.

    One mass alone explains what the masses of neighbours, or centres and inertias of them all, explain as well: how
    sure it is beside nothing else says little. Each mass alone, and all inertial parameters off by each of
    ``base.INERTIAL_ERRORS``, count as much as the data speak for them, half of it before the data for either kind
    (Bayesian model averaging: Hoeting et al. 1999, eq. 3 and 4).

    Parameters
    ----------
    full : the fit of everything. worth : nats of all inertial parameters in it. singles : of each mass alone what the
        scan found, and what the rest of the model leaves of its gradient and its Gram matrix.
    """
    problem, white = final.outcome.problem, final.white
    masses = np.array([body[0] for body in bodies(problem.robot)])
    nats, changes, variances = [], [], []
    for one, b, gram in singles:
        link, share, std = _alone(one, b, gram)
        own = (np.arange(len(masses)) == link) * masses
        nats.append(gain(b, gram, one.std) - np.log(len(singles)))
        changes.append(share * own)
        variances.append((std * own) ** 2)
    where, rows = full.where(INERTIAL), problem.factor[::10]
    seen = rows @ white.directions
    weighed = weighed_links(white, full)
    for error, (evidence, theta, covariance) in zip(INERTIAL_ERRORS if weighed else (), weighed, strict=True):
        nats.append(worth + evidence - weighed[INERTIAL_ERRORS.index(1.0)][0] - np.log(len(weighed)))
        changes.append(seen @ theta[where])
        # What no direction of the fit holds is known by its prior alone.
        hidden = error**2 * (np.sum(rows**2, axis=1) - np.sum(seen**2, axis=1))
        variances.append(np.maximum(hidden, 0.0) + np.einsum("lp,pq,lq->l", seen, covariance[where, where], seen))
    if not nats:
        return []
    weight = softmax(nats)
    change = weight @ np.array(changes)
    variance = np.maximum(weight @ (np.array(variances) + np.array(changes) ** 2) - change**2, 0.0)
    std = np.hypot(np.sqrt(variance), problem.settings.parameter_error * masses)
    link = int(np.argmax(np.divide(np.abs(change), std, out=np.zeros_like(std), where=std > 0)))
    if not change[link]:
        return []
    return [_link_mass(link, masses[link], masses[link] + change[link], std[link])]


def _link_mass(link: int, nominal: float, value: float, std: float) -> Retuned:
    return Retuned("link_mass", link + 1, six_digits(nominal), six_digits(value), six_digits(std), "kg")


def moving_bodies(retuned: list[Retuned], settings: Settings) -> tuple[MovingBody, ...]:
    """Return a body for each link mass that the inertial prior hardly allows: it would do the same."""
    found = []
    for one in retuned:
        if one.parameter != "link_mass" or not one.nominal:
            continue
        sigmas = abs(one.value / one.nominal - 1.0) / settings.inertial_prior
        if sigmas > settings.mass_sigmas:
            found.append(MovingBody(one.axis, six_digits(one.value - one.nominal), six_digits(sigmas)))
    return tuple(found)
