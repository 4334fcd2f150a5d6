"""What a problem says of itself, and what the gates make of it: parts that the search rests on, one by one."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, raw_columns, term_of
from jointwear.discovery.problem.problem import FRICTION, FoundMotors
from jointwear.discovery.search import acceptance
from jointwear.effects import get_effect

AXIS = 1


def test_motors_that_were_found_are_taken_off_again_by_what_is_as_given(bare):
    """The corrections that make the drives those of the file leave what the file leaves."""
    problem, _ = bare
    inertia = np.linspace(0.5, 1.0, problem.robot.joints)
    found = replace(problem, motors=FoundMotors(inertia, 0.1 * inertia))
    for axis in range(problem.robot.joints):
        taken_off = found.friction_columns(found.state, axis) @ found.as_given[axis]
        np.testing.assert_allclose(found.given_discrepancy[:, axis], found.discrepancy[:, axis] - taken_off)
    assert FRICTION[-1] == "motor_inertia"
    np.testing.assert_array_equal(found.as_given[:, :-1], 0.0)


def test_behind_a_gear_nothing_of_the_motor_is_fitted_that_the_file_lacks(bare):
    problem, _ = bare
    nothing = np.zeros(problem.robot.joints)
    robot = replace(problem.robot, viscous=nothing, armature=nothing)
    motor = replace(problem, robot=robot)
    sensor = replace(motor, state=replace(motor.state, torque_kind="link_sensor"))
    ratio = sensor.friction_prior(AXIS) / motor.friction_prior(AXIS)
    assert ratio[:2] == pytest.approx(1.0)
    assert (ratio[2:] < 1e-3).all()


@pytest.mark.parametrize("lead", [-50.0, 50.0])
def test_a_gate_of_what_follows_time_asks_whether_levels_do_better(white, monkeypatch, lead):
    monkeypatch.setattr(acceptance, "levels_lead", lambda *_: lead)
    state = white.problem.train_state
    wave = next(p for p in get_effect("torque_offset_drift").grid(state, AXIS) if "period" in p)
    candidate = Candidate("torque_offset_drift", AXIS, None, wave)
    trial = Named(candidate, term_of(white, candidate), None, 99.0)
    reached = [r.reached for r in acceptance.refusals(white, [], trial) if "a level of its own" in r.gate]
    assert reached == ([-lead] if lead > 0 else [])


@pytest.mark.parametrize("grows", [True, False])
def test_a_change_between_two_records_is_no_growth(white, grows):
    state = white.problem.train_state
    time, record = state.time - state.time[0], np.asarray(state.record)
    span, half = np.ptp(time), 0.5 * white.problem.settings.accept
    last = record == record[-1]
    # As late and as sudden as the step: free parameters would find it.
    rate = 1.0 / time[last][0]
    late = {"start": float(state.time[0]), "rate": 0.7 / span if grows else rate, "exponent": 1.0 if grows else 6.0}
    candidate = Candidate("wear_drift", AXIS, None, late)
    course = raw_columns(white, candidate)[:, 0] if grows else 0.2 * last * state.direction[:, AXIS]
    lacking = replace(white, targets=[y.copy() for y in white.targets])
    lacking.targets[AXIS][:] += white.columns(AXIS, 40.0 * course[:, None])[:, 0]
    trial = Named(candidate, term_of(lacking, candidate), None, 99.0)
    reached = [r.reached for r in acceptance.refusals(lacking, [], trial) if "one step between two records" in r.gate]
    assert reached == [] if grows else reached[0] < -half


def test_a_link_mass_is_off_by_so_many_standard_deviations_of_its_prior(white):
    candidate = Candidate(LINK_MASS, 2, None)
    torque = white.problem.link_mass_torque(2)
    blocks = {a: white.columns(a, torque[:, [a]]) for a in white.problem.judged}
    term = Term("mass", blocks, np.array([0.3]), {a: torque[:, [a]] for a in blocks})
    trial = Named(candidate, term, None, 99.0)

    def sigmas(prior):
        settings = replace(white.problem.settings, inertial_prior=prior)
        asked = replace(white, problem=replace(white.problem, settings=settings))
        (refusal,) = acceptance.mass_refusals(asked, [], trial)
        return refusal.reached

    assert sigmas(0.05) == pytest.approx(4 * sigmas(0.2))
