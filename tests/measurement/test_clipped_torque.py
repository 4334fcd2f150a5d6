"""Torques at a limit are told, coarse ones and joints at rest are not."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.clipped_torque import clipped_torques
from jointwear.measurement.recording import Recording, split
from jointwear.measurement.recording_files import load_recording
from jointwear.robots.robot import load_robot


def swing(noise=0.0, step=0.0):
    time = np.arange(0, 20, 0.01)
    torque = 30 * np.sin(1.3 * time) + np.random.default_rng(0).normal(0, noise or 1e-12, len(time))
    if step:
        torque = step * np.round(torque / step)
    return Recording(time, np.zeros(len(time), int), np.sin(time)[:, None], torque[:, None])


@settings(max_examples=20, deadline=None)
@given(st.sampled_from([0.0, 0.3]), st.one_of(st.just(0.0), st.floats(1e-3, 2.0)))
def test_what_is_not_clipped_is_not_told(noise, step):
    assert clipped_torques(swing(noise, step)) == []


@settings(max_examples=20, deadline=None)
@given(limit=st.floats(5.0, 28.0), noise=st.sampled_from([0.0, 0.3]), both=st.booleans())
def test_a_torque_at_its_limit_is_told_with_the_limit(limit, noise, both):
    whole = swing(noise)
    clipped = replace(whole, torque=np.clip(whole.torque, -limit if both else None, limit))
    (told,) = clipped_torques(clipped)
    assert f"joint 1 stays at {f'-{limit:.4g} and ' if both else ''}{limit:.4g} N m" in told


def test_a_joint_at_rest_hides_no_limit_of_its_motion():
    whole = swing()
    rest = whole.time > 15
    position, torque = whole.position.copy(), np.minimum(whole.torque, 25.0)
    position[rest], torque[rest] = 0.2, 7.0
    assert len(clipped_torques(replace(whole, position=position, torque=torque))) == 1
    assert clipped_torques(replace(whole, position=0 * position, torque=torque)) == []


def test_it_is_a_restriction_of_discovery():
    found = split(load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm"))
    robot = load_robot("config/robots/puma560.yaml")
    assert not any("at its limit" in words for words in checked(found, robot).restrictions)
    limit = np.quantile(np.abs(found.torque), 0.97, axis=0)
    told = checked(replace(found, torque=np.clip(found.torque, -limit, limit)), robot).restrictions
    assert sum("at its limit" in words for words in told) >= 5


@pytest.mark.long
@pytest.mark.parametrize("angle", [np.pi / 2, -np.pi / 2, np.pi])
@pytest.mark.parametrize("axis", [1, 2])
def test_a_joint_that_counts_from_another_zero_is_told_with_the_angle(axis, angle):
    found = split(load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm"))
    position = found.position.copy()
    position[:, axis] -= angle
    with pytest.raises(Exception, match=f"joint {axis + 1} looks counted from another zero, {np.degrees(angle):.4g} d"):
        checked(replace(found, position=position), load_robot("config/robots/puma560.yaml"))
