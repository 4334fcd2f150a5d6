"""Move a fit, by as little as its posterior has it, to effects and links that may exist."""

from __future__ import annotations

import numpy as np
from scipy.linalg import null_space

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Fit
from jointwear.discovery.model.sound_links import nearest_links
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.problem.whitening import INERTIAL, White
from jointwear.effects import get_effect
from jointwear.robots.inertia import mass_direction

#: Standard deviations by which the first coefficient of an effect is moved until something like it may exist.
SOUND = np.linspace(0.0, 3.0, 31)


def make_sound(fit: Fit, candidate: Candidate, where: slice) -> None:
    """Move a fit along its posterior to the nearest parameters of an effect that may exist, where there are any.

    A mass that the motion hardly shows comes out too small for its moments: the inertia about the centre of mass would
    be negative, and what is written for it another torque. Everything else follows the mass as its covariance says.
    """
    effect = get_effect(candidate.effect)
    if effect.sound is None:
        return
    theta, column = fit.theta, fit.covariance[:, where.start]
    deviation = column / np.sqrt(column[where.start])
    for step in SOUND:
        for moved in (theta + step * deviation, theta - step * deviation):
            if effect.sound(effect.parameters_of(candidate.nonlinear, moved[where])):
                fit.theta = moved
                return


def make_links_sound(white: White, fit: Fit, masses: list[Named]) -> np.ndarray:
    """Move a fit along its posterior to the nearest links that may exist.

    Returns
    -------
    what is added to the inertial parameters (10 n,) beside the coefficients: directions that the data cannot see cost
    no torque, and are bent before those that they do.
    """
    problem, mass_terms = white.problem, [t for n in masses for t in n.terms]
    where = fit.where(INERTIAL)
    own = [] if where is None else [np.arange(where.start, where.stop)]
    links = next((t for t in fit.terms if t.label == INERTIAL), None)
    change = [] if links is None else [problem.factor @ white.directions_of(links)]
    for term, place in zip(fit.terms, fit.slices, strict=True):
        for one, of_mass in zip(masses, mass_terms, strict=True):
            if term is of_mass:
                own.append(np.arange(place.start, place.stop))
                change.append(mass_direction(problem.robot, one.candidate.axis)[:, None])
    if not own:
        return np.zeros(10 * problem.robot.joints)
    places = np.concatenate(own)
    seen = white.directions if where is not None else np.zeros((problem.factor.shape[1], 0))
    unseen = problem.factor @ null_space(seen.T)
    count = len(places)
    covariance = fit.covariance[np.ix_(places, places)]
    precision = np.eye(count + unseen.shape[1])
    precision[:count, :count] = np.linalg.inv(covariance)
    fitted = np.concatenate([fit.theta[places], np.zeros(unseen.shape[1])])
    found = nearest_links(problem.robot, np.concatenate([*change, unseen], axis=1), fitted, precision)
    if found is not fitted:
        moved = precision[:count, :count] @ (found - fitted)[:count]
        fit.theta = fit.theta + fit.covariance[:, places] @ moved
    return unseen @ found[count:]
