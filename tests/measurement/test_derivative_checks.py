"""Velocities and accelerations that do not belong to their positions, clocks and temperatures in other units."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.derivative_checks import check_derivatives
from jointwear.measurement.recording import Recording, split
from jointwear.measurement.recording_files import load_recording
from jointwear.measurement.refused import Refused
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def swing():
    time = np.arange(0, 8, 0.01)
    phase = time[:, None] * np.array([2.0, 5.0])
    speed = np.array([2.0, 5.0])
    rng = np.random.default_rng(0)
    return Recording(
        time,
        np.zeros(len(time), int),
        np.sin(phase) + rng.normal(0, 1e-4, phase.shape),
        np.ones_like(phase),
        velocity=speed * np.cos(phase) + rng.normal(0, 0.05, phase.shape),
        acceleration=-(speed**2) * np.sin(phase) + rng.normal(0, 0.5, phase.shape),
    )


def check(recording):
    check_derivatives(recording, recording.trajectory, "arm")


def test_derivatives_of_the_positions_are_taken(swing):
    check(swing)
    check(replace(swing, acceleration=None))
    holes = swing.velocity.copy()
    holes[100:120] = np.nan
    check(replace(swing, velocity=holes))
    missing = swing.position.copy()
    missing[::150] = np.nan
    check(replace(swing, position=missing))


@pytest.mark.parametrize(
    ("change", "words", "key"),
    [
        ({"velocity": np.degrees}, "velocity of joint 1 is 57.* degrees", "{velocity: deg/s}"),
        ({"acceleration": np.degrees}, "acceleration of joint 1 is 57.* degrees", "{acceleration: deg/s2}"),
        ({"velocity": lambda v: v * 30 / np.pi}, "velocity of joint 1 is 9.55.* revolutions", "{velocity: rpm}"),
        ({"velocity": lambda v: v / (2 * np.pi)}, "velocity of joint 1 is 0.159.* revolutions", "{velocity: rev/s}"),
        ({"position": np.degrees}, "the positions look like degrees", "{position: deg}"),
        ({"velocity": lambda v: v * [1, -1]}, "velocity of joint 2 is -", "sign of the velocity"),
        ({"velocity": lambda v: 0 * v}, "velocity of joint 1 is 0 times", "leave it out"),
        ({"acceleration": lambda a: 0 * a}, "acceleration of joint 1 is 0 times", "leave it out"),
        ({"time": lambda t: 0.1 * t}, "velocity of joint 1 is 0.0999", "units"),
    ],
)
def test_what_does_not_belong_to_the_positions_is_told_with_its_key(swing, change, words, key):
    wrong = replace(swing, **{role: turn(getattr(swing, role)) for role, turn in change.items()})
    with pytest.raises(Refused, match=words) as refusal:
        check(wrong)
    assert key in refusal.value.suggestion


@pytest.mark.parametrize(
    ("role", "change", "words", "key"),
    [
        ("time", lambda t: 1e3 * t, "20 s apart", "{time: ms}"),
        ("time", lambda t: np.arange(len(t)), "numbers of rows", "time of each row"),
        ("position", lambda q: np.round(2**18 * q / (2 * np.pi)), "another unit, or another quantity", "counts of an"),
        ("temperature", lambda t: t + 273.15, "looks like kelvin", "{temperature: K}"),
    ],
)
def test_a_clock_and_a_temperature_in_another_unit_are_told(role, change, words, key):
    found = split(load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm"))
    with pytest.raises(Refused, match=words) as refusal:
        checked(replace(found, **{role: change(getattr(found, role))}), load_robot("config/robots/puma560.yaml"))
    assert key in refusal.value.suggestion


def test_a_joint_that_is_counted_within_one_turn_is_unwrapped(tmp_path):
    time = np.arange(0, 10, 0.02)
    angle = 3.0 + 1.2 * np.sin(time)
    wrapped = (angle + np.pi) % (2 * np.pi) - np.pi
    table = np.column_stack([time, wrapped, np.ones_like(time)])
    np.savetxt(tmp_path / "r.csv", table, delimiter=",", header="time,position_1,torque_1", comments="")
    found = load_recording({"measured": "r.csv"}, "arm", tmp_path)
    np.testing.assert_allclose(np.ptp(found.position), np.ptp(angle), atol=1e-9)
