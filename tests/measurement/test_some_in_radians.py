"""Joints in radians among others in degrees: told from the load that they move, not from friction."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.some_in_radians import joints_in_radians
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import Recording, split
from jointwear.measurement.recording_files import load_recording
from jointwear.measurement.refused import Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def scara(tmp_path_factory):
    """Two links that turn about the vertical: no weight tells of their positions."""
    drive = {"limits": [-2.9, 2.9], "gear_ratio": 100.0, "motor_inertia": 2e-4, "viscous": 4e-4}
    drive["coulomb"] = {"positive": 0.05, "negative": -0.05}
    path = tmp_path_factory.mktemp("robot") / "scara.yaml"
    links = [
        {"mass": 6.0, "com": [-0.25, 0.0, 0.0], "inertia": [0.05, 0.15, 0.15, 0.0, 0.0, 0.0]},
        {"mass": 4.0, "com": [-0.2, 0.0, 0.0], "inertia": [0.03, 0.08, 0.08, 0.0, 0.0, 0.0]},
    ]
    arm = {"name": "scara", "dh": [{"a": a, "d": 0.0, "alpha": 0.0} for a in (0.5, 0.4)], "links": links}
    path.write_text(yaml.safe_dump({**arm, "joints": [{"name": name, **drive} for name in ("one", "two")]}))
    return load_robot(path)


def moved(robot, sizes, friction=lambda v, robot: robot.friction(v)):
    """Forty seconds of motion of these sizes [rad] with the torque that they need."""
    rng, time = np.random.default_rng(3), np.arange(0, 40, 0.01)
    w = 2 * np.pi * np.linspace(0.05, 0.45, 5)
    at = np.outer(time, w)[:, :, None] + rng.uniform(0, 2 * np.pi, (5, robot.joints))
    size = np.asarray(sizes) / 5 * np.ones((5, robot.joints))
    q, v, a = (
        np.sum(f, axis=1)
        for f in (size * np.sin(at), size * np.cos(at) * w[:, None], -size * np.sin(at) * w[:, None] ** 2)
    )
    torque = Dynamics(robot).rigid_body_torque(q, v, a) + friction(v, robot)
    torque += 0.01 * torque.std(axis=0) * rng.standard_normal(torque.shape)
    return split(Recording(time, np.zeros(len(time), int), q, torque, name="arm", units={"position": "deg"}))


def in_radians(recording, joints):
    """The recording read as degrees, though these joints are in radians."""
    some = np.isin(np.arange(recording.joints), joints)
    return replace(recording, position=np.where(some, np.radians(recording.position), recording.position))


@pytest.mark.parametrize("joint", [0, 1])
def test_a_joint_in_radians_beside_one_in_degrees_is_refused(scara, joint):
    """What is left of either axis is less than a right file leaves: the masses were bent to it."""
    recording = moved(scara, [2.5, 2.5])
    checked(recording, scara)
    with pytest.raises(Refused, match=f"position of joint {joint + 1} looks like radians taken for degrees") as refused:
        checked(in_radians(recording, [joint]), scara)
    assert refused.value.suggestion.startswith(f"write the position of joint {joint + 1} in the unit of the others")
    assert not refused.value.by_keys


def test_several_joints_in_radians_are_named_together():
    robot = load_robot("config/robots/puma560.yaml")
    recording = split(
        load_recording({"measured": "data/examples/puma560_hidden.nc", "units": {"position": "rad"}}, "arm")
    )
    mixed = replace(in_radians(recording, [0, 1, 2]), units={"position": "deg"})
    with pytest.raises(Refused, match="positions of joints 1, 2 and 3 look like radians taken for degrees") as refused:
        checked(mixed, robot)
    assert "write the positions of joints 1, 2 and 3 in the unit of the others: they are" in refused.value.suggestion


@pytest.mark.parametrize(
    "friction",
    [
        lambda v, robot: robot.friction(v),
        lambda v, robot: robot.coulomb_positive * np.tanh(v / 0.05),
        lambda v, robot: robot.friction(v) + 9 * robot.viscous * v,
        lambda v, robot: robot.friction(v) * (1 + 0.8 * np.exp(-((v / 0.02) ** 2))),
    ],
)
@pytest.mark.parametrize("sizes", [[2.5, 0.04], [0.04, 2.5], [2.5, 0.004]])
def test_a_joint_that_moves_little_in_degrees_is_none(scara, friction, sizes):
    """Friction that rises slowly from rest, or is not that of the file, makes a larger motion likelier by far."""
    recording = moved(scara, sizes, friction)
    assert joints_in_radians(thinned(measure(recording)), scara, "deg") == ()


def test_what_is_read_as_radians_and_what_stands_still_is_not_asked(scara):
    recording = moved(scara, [2.5, 2.5])
    assert joints_in_radians(thinned(measure(in_radians(recording, [1]))), scara, "rad") == ()
    still = replace(recording, position=recording.position * [1.0, 0.0])
    assert joints_in_radians(thinned(measure(still)), scara, "deg") == ()
    # All of them are the matter of the unit that is stated.
    assert joints_in_radians(thinned(measure(in_radians(recording, [0, 1]))), scara, "deg") == ()
