"""Logs with holes, without noise, or of an arm that moves in part: a healthy arm stays healthy, or is refused."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import discover
from jointwear.discovery.preflight import check_data
from jointwear.measurement.checks import checked
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.refused import Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import robot_from_data
from jointwear.robots.robot_file import read_robot_file

HOLES = (slice(200, 500), slice(1300, 1600))


@pytest.fixture(scope="module")
def healthy(robot):
    return make_case(robot, 3)


@pytest.fixture(scope="module")
def derived(healthy):
    """The same with its derivatives, as a controller logs them."""
    measured = measure(healthy)
    return replace(healthy, velocity=measured.velocity, acceleration=measured.acceleration)


def with_holes(recording, role, joint):
    values = getattr(recording, role).copy()
    for hole in HOLES:
        values[hole, joint] = np.nan
    return replace(recording, **{role: values})


@pytest.mark.long
@pytest.mark.parametrize("role", ["position", "velocity"])
def test_long_holes_in_the_motion_of_one_joint_hide_nothing_and_feign_nothing(healthy, derived, robot, role):
    log = with_holes(healthy if role == "position" else replace(derived, acceleration=None), role, 1)
    measured = measure(log)
    inside = np.isin(np.round(measured.time, 6), np.round(np.concatenate([log.time[hole] for hole in HOLES]), 6))
    assert inside.sum() > 500
    assert not measured.usable[inside].any()
    assert measured.usable[~inside].mean() > 0.5
    assert discover(log, robot).verdict == "none"


def test_a_short_gap_concerns_its_joint_alone(healthy):
    position = healthy.position.copy()
    position[300:302, 1] = np.nan
    usable = measure(replace(healthy, position=position)).usable[300:302]
    assert not usable[:, 1].any()
    assert usable.any()


def test_a_cell_that_cannot_be_read_moves_no_cut_off(healthy):
    """One cell of 8,640 rows had made filters of all splines, each with the highest cut-off."""
    position = healthy.position.copy()
    position[300, 1] = np.nan
    whole, lacking = measure(healthy), measure(replace(healthy, position=position))
    np.testing.assert_allclose(lacking.cutoff, whole.cutoff, rtol=0.3)
    both = whole.usable & lacking.usable
    assert both.sum() > 0.98 * whole.usable.sum()
    np.testing.assert_allclose(lacking.acceleration[both], whole.acceleration[both], atol=0.05)


@pytest.mark.parametrize("role", ["velocity", "acceleration"])
def test_a_column_without_a_number_is_refused_by_name(derived, robot, role):
    values = getattr(derived, role).copy()
    values[:, 2] = np.nan
    for ask in (discover, check_data):
        with pytest.raises(Refused, match=f"the {role} of joint 3 in 0 %") as refused:
            ask(replace(derived, **{role: values}), robot)
        assert "are derived" in refused.value.suggestion


def test_a_trajectory_that_comes_back_is_refused_with_its_sample(healthy, robot):
    label = np.where(healthy.trajectory == 2, 0, healthy.trajectory)
    with pytest.raises(Refused, match="trajectory 0 comes back at sample 2001") as refused:
        discover(replace(healthy, trajectory=label), robot)
    assert "label every run" in refused.value.suggestion
    twice = np.r_[:2500, 500 : len(label)]
    with pytest.raises(Refused, match=r"comes back at sample 2501, .* rows come twice") as refused:
        discover(replace(healthy.part(twice), trajectory=healthy.trajectory[twice]), robot)
    assert "leave out rows that come twice" in refused.value.suggestion


@pytest.mark.long
@pytest.mark.parametrize("given", [True, False])
def test_a_simulated_log_without_noise_is_judged(derived, robot, given):
    torque = Dynamics(robot).inverse_dynamics(derived.position, derived.velocity, derived.acceleration)
    log = replace(derived, torque=torque)
    log = log if given else replace(log, velocity=None, acceleration=None)
    assert check_data(log, robot).joints[0].noise > 0.0
    found = discover(log, robot)
    assert (found.verdict, found.content.misfits) == ("none", ())


def test_a_joint_without_a_recorded_torque_is_not_said_to_be_at_a_limit(healthy, robot):
    torque = healthy.torque.copy()
    torque[:, 3] = 0.0
    told = check_data(replace(healthy, torque=torque), robot).restrictions
    assert any("joint 4 has a torque that keeps one value" in words for words in told)
    assert not any("at its limit" in words for words in told)


@pytest.mark.long
def test_a_payload_is_named_while_the_first_joint_rests(robot):
    content = read_robot_file("config/robots/puma560.yaml")
    loaded = robot_from_data({**content, "payload": {"mass": 2.5, "com": [0.02, 0.0, 0.1]}})
    log = make_case(robot, 4)
    position = log.position.copy()
    position[:, 0] = 0.3
    measured = measure(replace(log, position=position))
    torque = Dynamics(loaded).inverse_dynamics(measured.position, measured.velocity, measured.acceleration)
    torque += 0.01 * torque.std(axis=0) * np.random.default_rng(0).standard_normal(torque.shape)
    found = discover(replace(log, position=position, torque=torque), robot)
    (payload,) = found.effects
    assert payload["effect"] == "payload"
    assert payload["regime"]["range"][1] > payload["regime"]["range"][0]


@pytest.mark.long
def test_what_could_not_be_asked_is_not_said_to_have_passed(healthy, robot, monkeypatch):
    assert any("no other sign" in words for words in check_data(healthy, robot).passed)
    monkeypatch.setattr(checked, "check_axes_and_zero", lambda *_: False)
    told = check_data(healthy, robot)
    assert checked.UNASKED in told.restrictions
    assert not any("no other sign" in words for words in told.passed)
