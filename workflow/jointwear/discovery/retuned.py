"""Which parameters of the given robot the data contradict."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from jointwear.discovery.candidates import LINK_MASS
from jointwear.discovery.estimation import Final
from jointwear.discovery.linear import Fit, gain
from jointwear.discovery.misfit import divided, masses_of
from jointwear.discovery.problem import FRICTION
from jointwear.discovery.scan import scan
from jointwear.discovery.settings import Settings
from jointwear.discovery.verdict import Retuned
from jointwear.discovery.whitening import INERTIAL
from jointwear.files.json_values import six_digits
from jointwear.files.wording import numbered
from jointwear.robots.inertia import bodies

_FRICTION_UNITS = ("N m", "N m", "N m s/rad", "kg m2")


def retuned_parameters(final: Final) -> list[Retuned]:
    """Return the parameters of the model that the data contradict, by the evidence that moving each is worth."""
    problem = final.outcome.problem
    robot, need = problem.robot, problem.settings.accept
    nominal = np.stack([robot.coulomb_positive, -robot.coulomb_negative, robot.viscous, robot.armature], axis=1)
    delta = final.delta_friction * np.array([1, -1, 1, 1])
    found = []
    for axis in problem.judged:
        prior = problem.friction_prior(axis)
        for k, name in enumerate(FRICTION):
            if final.std_friction[axis, k] <= 0:
                continue
            # Sample times, kinematics and forms are never exact: neither is a parameter that follows from them.
            std = float(np.hypot(final.std_friction[axis, k], problem.settings.parameter_error * nominal[axis, k]))
            nats = 0.5 * (delta[axis, k] / std) ** 2 - np.log(max(prior[k] / std, 1.0))
            value = max(nominal[axis, k] + delta[axis, k], 0.0)
            if nats > need and value != nominal[axis, k]:
                gear = abs(robot.gear_ratio[axis])
                # The parameters of a robot file: motor side.
                side = gear if k < 2 else gear**2
                sign = -1.0 if name == "coulomb_negative" else 1.0
                found.append(
                    Retuned(
                        parameter=name,
                        axis=axis + 1,
                        nominal=six_digits(sign * nominal[axis, k] / side),
                        # As the robot file has it: no friction drives, no inertia is negative.
                        value=six_digits(sign * value / side) + 0.0,
                        std=six_digits(std / side),
                        unit=_FRICTION_UNITS[k],
                    )
                )
    # Where no mass is off by its own uncertainty, centres and inertias differ: it is told if nothing else would be.
    # Beside a body on the whole arm that of a link whose joint stays unexplained takes what has no name.
    whole = any(n.candidate.axis is None for n in final.outcome.named)
    left = {u.axis + 1 for u in final.outcome.unexplained} if whole else set()
    masses = [m for m in _wrong_mass(final) if m.axis not in left]
    return found + [m for m in masses if not found or abs(m.value - m.nominal) > m.std]


def _wrong_mass(final: Final) -> list[Retuned]:
    """Return the link whose mass best explains that inertial parameters are not nominal, if they are not.

    Where no other inertial parameter is needed beside one mass, it is the cause, and all of the change is its own.
    Elsewhere it is that of the written robot which is farthest off, known as well as the data and the prior have it
    beside all the others.
    """
    outcome, problem = final.outcome, final.outcome.problem
    white, settings = final.white, problem.settings
    named = [n for n in outcome.named if n.candidate.effect == LINK_MASS]
    fixed = [t for t in white.base if t.label != INERTIAL]
    effects = [divided(t, final.misfit) for n in outcome.named if n.candidate.effect != LINK_MASS for t in n.terms]
    fit = Fit(white.targets, [*fixed, *effects])
    full = white.fit([*effects])
    worth = full.evidence - fit.evidence
    if not named and worth < settings.accept:
        return []
    keys = {(LINK_MASS, link, None) for link in range(problem.robot.joints)}
    found = scan(white, masses_of(outcome.dictionary, final.misfit, LINK_MASS), fit, keys)
    best = next((s for s in found if np.isfinite(s.evidence)), None)
    if named:
        best = next((s for s in found if s.candidate.key == named[0].candidate.key), best)
    if best is None:
        return []
    b, gram = fit.gram(best.blocks)
    alone = gain(b, gram, best.std)
    if not named and worth - alone > settings.accept:
        return _farthest_mass(final, full)
    mass = bodies(problem.robot)[best.candidate.axis][0]
    precision = float(gram[0, 0] + 1 / best.std[0] ** 2)
    std = float(np.hypot(1.0 / np.sqrt(precision), settings.parameter_error))
    return [_link_mass(best.candidate.axis, mass, mass * (1 + float(b[0]) / precision), mass * std)]


def _farthest_mass(final: Final, full: Fit) -> list[Retuned]:
    """Return the link mass of the written robot that is most standard deviations off, beside all inertial parameters.

    Parameters
    ----------
    full : the fit of everything.
    """
    problem, directions = final.outcome.problem, final.white.directions
    where = full.where(INERTIAL)
    masses = np.array([body[0] for body in bodies(problem.robot)])
    rows = problem.factor[::10]
    seen = rows @ directions
    # What no direction of the fit holds is known by its prior alone.
    variance = np.sum(rows**2, axis=1) - np.sum(seen**2, axis=1)
    variance = variance + np.einsum("lp,pq,lq->l", seen, full.covariance[where, where], seen)
    std = np.hypot(np.sqrt(np.maximum(variance, 0.0)), problem.settings.parameter_error * masses)
    change = final.delta_inertial[::10]
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
