"""What a robot carries: the body that was found belongs to the load, and may be as large as it was found to be.

The columns of the search are made of the torque of the given model. Beside a payload of the rated load that is half of
what the drives give: a torque constant that is 3 % off looks like 9 % of the half that is known and a lighter payload,
and friction that grows with the load has the wrong load. And a body that is heavier and longer than bodies usually are
is drawn to the usual by the prior, its inertia most, and its mass with it. So the search is run again with the body
that was found among the torques of which columns are made, and with a prior as wide as it is large. It stays an effect
that is to be named. A joint that the first search left without a name and without structure is not asked again: the
body explains it, and how links that carry it swing is not in the given inertias.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.problem.candidates import build_dictionary
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.decide import decide
from jointwear.discovery.search.given_up import telling_names_given_up
from jointwear.discovery.search.searches import explains_shaking, whitened
from jointwear.discovery.search.slow_noise import beside_slow_noise
from jointwear.effects import Effect, get_effect
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import wind_up_regressor
from jointwear.robots.robot import Robot, body_content, with_payload

#: Gate that a name misses for which the load of the body stands.
GATE = "nats beside the body in its load"


def carrying(outcome: Outcome) -> Problem | None:
    """Return the problem with the body that was named in its load, or None where that would say nothing new.

    Something is to be learnt where the body is no small share (`usual`) of the torque of an axis and not all is
    explained by it, because other names stand beside it or structure is left; or where one of its parameters lies
    further (`mass_sigmas`) from nothing than its prior has it.
    """
    problem, fit = outcome.problem, outcome.fit
    state, settings, loaded = problem.state, problem.settings, problem.robot
    carried, wider = np.zeros_like(state.torque), {}
    for one in outcome.named:
        effect = get_effect(one.candidate.effect) if one.candidate.axis is None else None
        found = fit.coefficients(one.term)
        if effect is None or effect.sound is None or found is None:
            continue
        std = effect.prior(problem.robot)
        carried += effect.columns(state, None, None, one.candidate.nonlinear) @ found
        loaded = _with_body(loaded, effect, effect.parameters_of(one.candidate.nonlinear, found))
        away = float(np.max(np.abs(found) / std))
        if away > settings.mass_sigmas:
            wider[one.candidate.effect] = away * std
    share = np.sqrt(np.mean(carried**2, axis=0) / np.maximum(np.mean(state.torque**2, axis=0), 1e-300))
    beside = len(outcome.named) > 1 or bool(outcome.unexplained)
    if not wider and not (beside and any(share[axis] > settings.usual for axis in problem.judged)):
        return None
    # A gear twists by the inertia and the weight of all that hangs behind it.
    behind = wind_up_regressor(Dynamics(loaded), state.position, state.velocity, state.acceleration)
    heavier = replace(state, load=state.load + carried, torque=state.torque + carried, wind_up_regressor=behind)
    return replace(problem, state=heavier, body_prior=wider)


def _with_body(robot: Robot, effect: Effect, parameters: dict[str, float]) -> Robot:
    """Return a robot that carries a body with the parameters of an effect too; the same where its file has no place
    for it."""
    if effect.writes is None:
        return robot
    content = effect.writes({"payload": body_content(robot.payload)}, parameters)
    return with_payload(robot, content["payload"])


def search_beside(found: Outcome) -> Outcome:
    """Return what is found when a named body belongs to the load, or `found` where that is nothing new."""
    loaded = carrying(found)
    if loaded is None:
        return found
    asked = {n.candidate.axis for n in found.named} | {u.axis for u in found.unexplained}

    def ask(white: White) -> Outcome:
        dictionary = build_dictionary(white)
        outcome = decide(white, dictionary.of_axes(asked))
        outcome.dictionary = dictionary
        return outcome

    outcome = beside_slow_noise(whitened(loaded), ask)
    if loaded.still and not explains_shaking(outcome):
        # What spoke against noise that moves the arm was the body's.
        outcome = beside_slow_noise(whitened(replace(loaded, still=False)), ask)
    return telling_names_given_up(found, outcome, GATE)
