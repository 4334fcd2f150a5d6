"""Which parameters of the given robot the data contradict."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from scipy.special import softmax

from jointwear.discovery.base import INERTIAL_ERRORS, weighed_links
from jointwear.discovery.candidates import LINK_MASS
from jointwear.discovery.estimation import Final
from jointwear.discovery.left_out import Asked
from jointwear.discovery.linear import Fit, gain
from jointwear.discovery.misfit import divided, masses_of
from jointwear.discovery.problem import FRICTION, Problem
from jointwear.discovery.scan import Scored, scan
from jointwear.discovery.settings import Settings
from jointwear.discovery.verdict import Retuned
from jointwear.discovery.whitening import INERTIAL
from jointwear.files.json_values import six_digits
from jointwear.files.wording import numbered
from jointwear.robots.inertia import bodies

_FRICTION_UNITS = ("N m", "N m", "N m s/rad", "kg m2")


def retuned_parameters(final: Final) -> list[Retuned]:
    """Return the parameters of the model that the data contradict, by the evidence that moving each is worth."""
    problem, need = final.outcome.problem, final.outcome.problem.settings.accept
    found = []
    for axis in problem.judged:
        prior = problem.friction_prior(axis)
        for k in range(len(FRICTION)):
            if final.std_friction[axis, k] <= 0:
                continue
            one, sigmas, std = _corrected(final, axis, k)
            nats = 0.5 * sigmas**2 - np.log(max(prior[k] / std, 1.0))
            if nats > need and one.value != one.nominal:
                found.append(one)
    # Where no mass is off by its own uncertainty, centres and inertias differ: it is told if nothing else would be.
    # Beside a body on the whole arm that of a link whose joint stays unexplained takes what has no name.
    whole = any(n.candidate.axis is None for n in final.outcome.named)
    left = {u.axis + 1 for u in final.outcome.unexplained} if whole else set()
    masses = [m for m in _wrong_mass(final) if m.axis not in left]
    told = found + [m for m in masses if not found or abs(m.value - m.nominal) > m.std]
    return told or _together(final)


def _drive_of(problem: Problem, axis: int) -> np.ndarray:
    """Return the parameters (4,) of the drive of one axis as the robot file has them, joint side."""
    robot = problem.robot
    return np.array(
        [robot.coulomb_positive[axis], -robot.coulomb_negative[axis], robot.viscous[axis], robot.armature[axis]]
    )


def _corrected(final: Final, axis: int, k: int) -> tuple[Retuned, float, float]:
    """Return a parameter of a drive as corrected, the standard deviations by which it is off, and one [joint side]."""
    problem = final.outcome.problem
    sign = -1.0 if FRICTION[k] == "coulomb_negative" else 1.0
    nominal, change = _drive_of(problem, axis)[k], sign * float(final.delta_friction[axis, k])
    # Sample times, kinematics and forms are never exact: neither is a parameter that follows from them.
    std = float(np.hypot(final.std_friction[axis, k], problem.settings.parameter_error * nominal))
    gear = abs(problem.robot.gear_ratio[axis])
    # The parameters of a robot file: motor side.
    side = gear if k < 2 else gear**2
    # As the robot file has it: no friction drives, no inertia is negative.
    value = six_digits(sign * max(nominal + change, 0.0) / side) + 0.0
    one = Retuned(
        FRICTION[k], axis + 1, six_digits(sign * nominal / side), value, six_digits(std / side), _FRICTION_UNITS[k]
    )
    return one, change / std, std


def _together(final: Final) -> list[Retuned]:
    """Return the drive parameter that is farthest off where none is beyond doubt, but all together predict better.

    A tolerance of each parameter says nothing of a robot of which several are wrong by as much. On the axis that gains
    most the fit has to predict records left out better than the given robot by the margin of `not_worse`.
    """
    outcome = final.outcome
    if final.fit is None or outcome.named or outcome.unexplained:
        return []
    terms = list(final.fit.terms)
    ratio = Asked(final.white, terms)(terms).ratio
    places = [(a, k) for a in outcome.problem.judged for k in range(len(FRICTION)) if final.std_friction[a, k] > 0]
    places = [(a, k) for a, k in places if ratio[a] * outcome.problem.settings.not_worse < 1.0]
    told = [_corrected(final, *place) for place in places]
    best = max(told, key=lambda one: abs(one[1]), default=None)
    return [best[0]] if best is not None and best[0].value != best[0].nominal else []


def _wrong_mass(final: Final) -> list[Retuned]:
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
    for error, (evidence, theta, covariance) in zip(INERTIAL_ERRORS, weighed, strict=bool(weighed)):
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


def stands_in(retuned: list[Retuned], open_axes: Collection[int]) -> list[str]:
    """Return a sentence on the parameters of drives of joints that stay unexplained; `open_axes` 0-based."""
    axes = sorted({one.axis for one in retuned if one.parameter in FRICTION and one.axis - 1 in open_axes})
    if not axes:
        return []
    return [f"{numbered('joint', axes)}: retuned friction and motor inertia stand in for what stays unexplained there"]


def ended_on_bounds(retuned: list[Retuned]) -> list[str]:
    """Return a sentence for each parameter of a drive that the data would have below zero: something else is wrong."""
    return [
        f"the fit of {one.parameter} of joint {one.axis} ended on its bound, 0: it stands in for something else"
        for one in retuned
        if one.value == 0.0
    ]


def unlikely_masses(retuned: list[Retuned], settings: Settings) -> list[str]:
    """Return a sentence for each link mass that the inertial prior hardly allows: a body at the link does the same."""
    told = []
    for one in retuned:
        if one.parameter != "link_mass" or not one.nominal:
            continue
        sigmas = abs(one.value / one.nominal - 1.0) / settings.inertial_prior
        if sigmas > settings.mass_sigmas:
            more = one.value - one.nominal
            body = (
                f"a body of {more:.3g} kg that moves with it, as a payload does,"
                if more > 0
                else f"a body of {-more:.3g} kg that the robot file has there and the robot has not"
            )
            told.append(
                f"the mass of link {one.axis} is {sigmas:.2g} standard deviations of its prior off; {body} "
                "would explain the same"
            )
    return told
