"""Retuned parameters: as the robot file has them, and those that stand in for something else."""

import copy
from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings, discover
from jointwear.discovery.model import retuned
from jointwear.discovery.model.link_masses import moving_bodies
from jointwear.discovery.model.retuned import ended_on_bounds, retuned_parameters, stands_in
from jointwear.discovery.verdict import Retuned
from jointwear.robots.robot import robot_from_data
from jointwear.robots.robot_file import read_robot_file


@pytest.mark.parametrize("value", [3.0, 1.2])
def test_an_unlikely_mass_is_a_body_that_may_exist(value):
    one = Retuned("link_mass", 2, 2.0, value, 0.01, "kg")
    assert [(b.link, b.mass) for b in moving_bodies([one], Settings())] == [(2, pytest.approx(value - 2.0))]
    assert not moving_bodies([replace(one, value=2.1)], Settings())


def test_parameters_of_a_joint_that_stays_unexplained_stand_in_for_it():
    found = [
        Retuned(name, axis, 1.0, 1.2, 0.1, "") for name, axis in (("viscous", 4), ("link_mass", 2), ("viscous", 1))
    ]
    (told,) = stands_in(found, {1, 3})
    assert told.startswith("joint 4: retuned friction")
    assert not stands_in(found, {1})


def test_a_parameter_that_the_data_would_have_below_zero_is_told():
    ended = Retuned("motor_inertia", 3, 2e-4, 0.0, 1e-5, "kg m2")
    (told,) = ended_on_bounds([ended, replace(ended, value=1e-5)])
    assert told.startswith("the fit of motor_inertia of joint 3 ended on its bound")


def test_parameters_of_a_verdict_are_those_of_the_file(robot):
    content = copy.deepcopy(read_robot_file("config/robots/puma560.yaml"))
    for joint in content["joints"]:
        joint |= {"motor_inertia": 0.6 * joint["motor_inertia"], "viscous": 0.7 * joint["viscous"]}
        joint["coulomb"] = {side: 0.8 * level for side, level in joint["coulomb"].items()}
    found = discover(make_case(robot, 5), robot_from_data(content))
    joints = found.files["retuned"].data["joints"]
    kinds = set()
    for one in found.data["retuned"]:
        entry = joints[one["axis"] - 1]
        name, _, side = one["parameter"].partition("coulomb_")
        written = entry["coulomb"][side] if side else entry.get(name)
        if written is not None:
            kinds.add(one["parameter"])
            assert one["value"] == pytest.approx(written, rel=1e-5)
    assert kinds == {"motor_inertia", "viscous", "coulomb_positive", "coulomb_negative"}


def test_a_mass_that_is_told_is_as_certain_as_the_other_links_leave_it(robot):
    content = copy.deepcopy(read_robot_file("config/robots/puma560.yaml"))
    rng = np.random.default_rng(4)
    for link in content["links"]:
        link["com"] = [x * (1 + 0.02 * rng.standard_normal()) for x in link["com"]]
    found = discover(make_case(robot, 4), robot_from_data(content)).data["retuned"]
    # Every mass of the file is right, its centres are wrong: one mass alone would be 3.7 standard deviations off.
    (one,) = [one for one in found if one["parameter"] == "link_mass"]
    assert abs(one["value"] - one["nominal"]) < 2.0 * one["std"]


def test_a_link_that_is_too_heavy_in_the_file_is_told_with_its_mass(robot):
    content = copy.deepcopy(read_robot_file("config/robots/puma560.yaml"))
    link = content["links"][2]
    true = link["mass"]
    link["mass"], link["inertia"] = 1.1 * true, [1.1 * float(x) for x in link["inertia"]]
    found = discover(make_case(robot, 5), robot_from_data(content)).data["retuned"]
    (one,) = [one for one in found if one["parameter"] == "link_mass"]
    assert one["axis"] == 3
    assert abs(one["value"] - true) < 2.5 * one["std"]


@pytest.mark.long
def test_parameters_that_are_each_within_their_tolerance_are_told_where_all_together_predict_better(robot, monkeypatch):
    content = copy.deepcopy(read_robot_file("config/robots/puma560.yaml"))
    for joint in content["joints"]:
        joint["coulomb"] = {side: 0.98 * level for side, level in joint["coulomb"].items()}
    found = discover(make_case(robot, 5), robot_from_data(content))
    assert found.verdict == "retuned"
    (one,) = found.data["retuned"]
    assert one["parameter"].startswith("coulomb")
    assert abs(one["value"] - one["nominal"] / 0.98) < 2.0 * one["std"]
    gap = found.data["gap"]
    assert min(a / g for a, g in zip(gap["augmented"], gap["nominal"], strict=True)) < 0.97
    # Within its own error nothing is wrong, whatever predicts better.
    told, asked = retuned.farthest_together(found.final), retuned.corrected_parameter
    assert [one.parameter for one in told] == [one["parameter"]]
    monkeypatch.setattr(retuned, "corrected_parameter", lambda *place: (asked(*place)[0], 0.9, asked(*place)[2]))
    assert retuned.farthest_together(found.final) == []
    # The robot as it is has nothing to be told, and its file stays.
    assert discover(make_case(robot, 5), robot).verdict == "none"


def test_of_links_that_were_put_back_no_mass_is_told(robot):
    content = copy.deepcopy(read_robot_file("config/robots/puma560.yaml"))
    content["links"][2]["mass"] *= 0.8
    final = discover(make_case(robot, 5), robot_from_data(content)).final
    assert "link_mass" in {one.parameter for one in retuned_parameters(final)}
    nothing = np.zeros_like(final.delta_inertial)
    back = replace(final, delta_inertial=nothing, retuned_inertial=nothing)
    assert "link_mass" not in {one.parameter for one in retuned_parameters(back)}
