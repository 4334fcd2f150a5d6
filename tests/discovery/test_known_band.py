"""A file has the rates of a load up to where the motion tells them."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from jointwear.discovery.model.known_band import with_known_bands
from jointwear.effects import get_effect, make_state


@dataclass(frozen=True)
class Estimate:
    named: SimpleNamespace
    parameters: dict


@dataclass(frozen=True)
class Model:
    outcome: SimpleNamespace
    white: SimpleNamespace
    estimates: tuple


SHARE = {"inertia_over_stiffness": 4e-4, "inertia": 1.0, "side": 0}


def logged(robot, noise, timing=12.0):
    """A model with a gear of SHARE on the second joint, and the torque of its file.

    The measured torque is that of the true load, the file has one with `noise` [N m]; `timing` is the cut-off of rates.
    """
    rng, count, rate, axis = np.random.default_rng(2), 4000, 250.0, 1
    time, n = np.arange(count) / rate, robot.joints
    load = np.zeros((count, n))
    load[:, axis] = 30 * np.sin(2 * np.pi * 0.7 * time) + 2 * np.sin(2 * np.pi * 8.0 * time)
    zeros, record = np.zeros((count, n)), np.repeat([0, 1], count // 2)

    def state(torque):
        return make_state(robot, zeros, zeros, zeros, torque, time=time, record=record)

    shaken = state(load + noise * rng.standard_normal((count, n)))
    gear = get_effect("joint_flexibility")
    measured, told = load.copy(), load.copy()
    measured[:, axis] += gear.torque(state(load), axis, None, SHARE)
    told[:, axis] += gear.torque(shaken, axis, None, SHARE)
    problem = SimpleNamespace(
        state=shaken,
        moving=np.ones((count, n), bool),
        train=record == 0,
        measured=SimpleNamespace(torque=measured, rate=rate),
    )
    candidate = SimpleNamespace(effect="joint_flexibility", axis=axis, nonlinear=SHARE)
    white = SimpleNamespace(cutoffs=[SimpleNamespace(timing=timing)] * n)
    estimate = Estimate(SimpleNamespace(candidate=candidate), SHARE)
    return Model(SimpleNamespace(problem=problem), white, (estimate,)), told


def error(model, torque, axis=1):
    """The RMS error [N m] of a file in the records left out, with the band of the model."""
    problem, gear = model.outcome.problem, get_effect("joint_flexibility")
    with_band = gear.torque(problem.state, axis, None, model.estimates[0].parameters)
    told = torque[:, axis] - gear.torque(problem.state, axis, None, SHARE) + with_band
    return float(np.sqrt(np.mean((problem.measured.torque[:, axis] - told)[~problem.train] ** 2)))


def test_the_load_ends_where_noise_begins(robot):
    model, torque = logged(robot, noise=0.05)
    ended = with_known_bands(model, torque)
    assert 12.0 <= ended.estimates[0].parameters["band"] <= 40.0
    assert error(ended, torque) < 0.1 * error(model, torque)
    # What is written is asked again from the file in which it ends.
    problem, gear = model.outcome.problem, get_effect("joint_flexibility")
    change = [gear.torque(problem.state, 1, None, m.estimates[0].parameters) for m in (model, ended)]
    torque[:, 1] += change[1] - change[0]
    assert with_known_bands(ended, torque) is ended


def test_all_of_a_load_without_noise_is_taken(robot):
    model, torque = logged(robot, noise=0.0)
    assert with_known_bands(model, torque) is model
    model, torque = logged(robot, noise=0.05, timing=np.inf)
    assert with_known_bands(model, torque) is model


def test_what_ends_at_no_frequency_stays(robot):
    model, torque = logged(robot, noise=0.05)
    model.estimates[0].named.candidate.effect = "actuation_delay"
    assert with_known_bands(model, torque) is model
