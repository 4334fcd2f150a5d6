"""Which parameters of the given robot the data contradict."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from jointwear.discovery.model.final_model import Final
from jointwear.discovery.model.left_out import Asked
from jointwear.discovery.model.link_masses import wrong_mass
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.discovery.problem.problem import FRICTION, SENSE, Problem
from jointwear.discovery.verdict import Retuned
from jointwear.files.json_values import six_digits
from jointwear.files.wording import numbered

_FRICTION_UNITS = ("N m", "N m", "N m s/rad", "kg m2")


def retuned_parameters(final: Final) -> list[Retuned]:
    """Return the parameters of the model that the data contradict, by the evidence that moving each is worth."""
    problem, need = final.outcome.problem, final.outcome.problem.settings.accept
    found = []
    for axis in problem.judged:
        prior = problem.friction_prior(axis)
        for k in range(len(FRICTION)):
            if final.std_friction[axis, k] <= 0 and not _found(problem, axis, k)[0]:
                continue
            one, sigmas, std = corrected_parameter(final, axis, k)
            nats = 0.5 * sigmas**2 - np.log(max(prior[k] / std, 1.0))
            if nats > need and one.value != one.nominal:
                found.append(one)
    # Where no mass is off by its own uncertainty, centres and inertias differ: it is told if nothing else would be.
    # Beside a body on the whole arm that of a link whose joint stays unexplained takes what has no name.
    whole = any(n.candidate.axis is None for n in final.outcome.named)
    left = {u.axis + 1 for u in final.outcome.unexplained} if whole else set()
    masses = [m for m in wrong_mass(final) if m.axis not in left] if _links_move(final) else []
    told = found + [m for m in masses if not found or abs(m.value - m.nominal) > m.std]
    return told or farthest_together(final)


def _links_move(final: Final) -> bool:
    """Return whether a robot file that is written has other links than the given one: of links that were put back, as
    they predicted worse, no mass is told."""
    named = any(n.candidate.effect == LINK_MASS for n in final.outcome.named)
    return named or bool(np.any(final.delta_inertial) or np.any(final.retuned_inertial))


def _found(problem: Problem, axis: int, k: int) -> tuple[float, float]:
    """Return what the search began with of a parameter of a drive that the robot file has not, joint side, with its
    standard deviation; zeros of all others."""
    if problem.motors is None or FRICTION[k] != "motor_inertia":
        return 0.0, 0.0
    return float(problem.motors.inertia[axis]), float(problem.motors.std[axis])


def corrected_parameter(final: Final, axis: int, k: int) -> tuple[Retuned, float, float]:
    """Return a parameter of a drive as corrected, the standard deviations by which it is off, and one [joint side]."""
    problem = final.outcome.problem
    sign = float(SENSE[k])
    found, std_found = _found(problem, axis, k)
    nominal = float(problem.drive_parameters[axis, k]) - found
    change = found + sign * float(final.delta_friction[axis, k])
    known = known_to(final, axis, k, std_found)
    # Sample times, kinematics and forms are never exact: neither is a parameter that follows from them.
    std = float(np.hypot(known, problem.settings.parameter_error * (nominal + found)))
    gear = abs(problem.robot.gear_ratio[axis])
    # The parameters of a robot file: motor side.
    side = gear if k < 2 else gear**2
    # As the robot file has it: no friction drives, no inertia is negative.
    given, value = (six_digits(sign * max(v, 0.0) / side) + 0.0 for v in (nominal, nominal + change))
    one = Retuned(FRICTION[k], axis + 1, given, value, six_digits(std / side), _FRICTION_UNITS[k])
    return one, change / std, std


def known_to(final: Final, axis: int, k: int, std_found: float) -> float:
    """Return the standard deviation to which the data know a parameter of a drive, joint side.

    Where its correction was put back it is what it was found as. So it is where the correction was held narrower than
    it was found: that prior lies about a value of the same data, and would make it certain whatever they say.
    """
    std = float(final.std_friction[axis, k])
    if not std_found or final.fit is None:
        return std or std_found
    held = min((float(t.std[0]) for t in final.fit.terms if t.drive == (axis, k)), default=0.0)
    return std if held >= std_found else std_found


def farthest_together(final: Final) -> list[Retuned]:
    """Return the drive parameter that is farthest off where none is beyond doubt, but all together predict better.

    A tolerance of each parameter says nothing of a robot of which several are wrong by as much. On the axis that gains
    most the fit has to predict records left out better than the given robot by the margin of `not_worse`. Where the
    farthest lies within its own standard deviation none of them is wrong.
    """
    outcome = final.outcome
    if final.fit is None or outcome.named or outcome.unexplained:
        return []
    terms = list(final.fit.terms)
    ratio = Asked(final.white, terms)(terms).ratio
    places = [(a, k) for a in outcome.problem.judged for k in range(len(FRICTION)) if final.std_friction[a, k] > 0]
    places = [(a, k) for a, k in places if ratio[a] * outcome.problem.settings.not_worse < 1.0]
    told = [corrected_parameter(final, *place) for place in places]
    best = max(told, key=lambda one: abs(one[1]), default=None)
    return [best[0]] if best is not None and abs(best[1]) > 1.0 and best[0].value != best[0].nominal else []


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
