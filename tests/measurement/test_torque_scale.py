"""Torques of another size than the model's: refused with the factor, whatever load the arm carries."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.measurement.checks.late_torque import check_delay
from jointwear.measurement.checks.model_size import check_model_size
from jointwear.measurement.checks.silent_joints import moving_torques
from jointwear.measurement.checks.torque_follows import check_follows
from jointwear.measurement.checks.torque_scale import check_scale, check_scale_of_one, check_size, torque_factors
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import load_recording
from jointwear.measurement.refused import Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def example():
    recording = split(load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm"))
    return recording, load_robot("config/robots/puma560.yaml"), measure(recording)


def check(example, factor, more=0.0):
    recording, robot, measured = example
    found = torque_factors(recording, robot, replace(measured, torque=measured.torque * factor + more))
    told = check_scale(found)
    check_scale_of_one(found)
    return told


def test_a_torque_of_the_models_size_is_taken(example):
    assert check(example, 1.0) == []
    assert check(example, np.array([0.7, 1.3, 0.9, 1.2, 0.8, 1.1])) == []


@pytest.mark.parametrize("factor", [0.7, 1 / 1.356, 1.6])
def test_a_factor_that_all_joints_share_is_told(example, factor):
    (words,) = check(example, factor)
    assert "times that of the model on all joints" in words
    assert "unit" in words


def test_a_factor_that_one_joint_does_not_share_is_not_told_of_all(example):
    assert check(example, np.array([1.3, 0.9, 1.3, 1.3, 1.3, 1.3])) == []


@pytest.mark.parametrize(
    ("factor", "words", "key"),
    [
        (0.1, "0.1.* on joint 2", "'torque_constant'"),
        (1000.0, "looks like mN m", "torque: mN m"),
        ("gears", "looks like that of the motor, before the gear", "'scale' for each joint"),
        (1 / np.array([3.0, 4.0, 5.0, 6.0, 7.0, 8.0]), "looks like a current", "'torque_constant'"),
    ],
)
def test_another_unit_or_a_current_is_told_with_its_key(example, factor, words, key):
    factor = 1 / example[1].gear_ratio if isinstance(factor, str) else factor
    with pytest.raises(Refused, match=words) as refusal:
        check(example, factor)
    assert key in refusal.value.suggestion


def test_torques_of_the_other_sign_are_told_of_all_joints_at_once(example):
    with pytest.raises(Refused, match=r"sign of the torque of joints .* looks flipped") as refusal:
        check(example, -1.0)
    assert "-1" in refusal.value.suggestion


def test_one_joint_in_another_unit_is_told(example):
    with pytest.raises(Refused, match="torque of joint 3 is 903 times that of the model") as refusal:
        check(example, np.array([1.0, 1.0, 1000.0, 1.0, 1.0, 1.0]))
    assert "'scale' with 0.00111 for joint 3" in refusal.value.suggestion


def test_a_heavy_load_is_no_unit(example):
    _, robot, measured = example
    load = FlangeLoad(robot).unit_sum(measured.position, measured.velocity, measured.acceleration)
    check(example, 1.0, np.einsum("mkn,k->mn", load, [20.0, 0.0, 0.0, 4.0]))


def test_a_current_in_columns_of_another_order_is_told(example):
    recording, robot, measured = example
    swapped = 0.4 * measured.torque[:, [1, 0, 2, 3, 4, 5]]
    (words,) = check_scale(torque_factors(recording, robot, replace(measured, torque=swapped)))
    assert "another multiple of the model's" in words
    assert "the columns have another order too" in words


@pytest.mark.parametrize("turn", [lambda x: np.random.default_rng(0).permutation(x), lambda x: np.roll(x, 300, axis=0)])
def test_torques_of_other_rows_are_told(example, turn):
    _, robot, measured = example
    check_follows(measured, robot, "arm")
    with pytest.raises(Refused, match="does not follow the motion"):
        check_follows(replace(measured, torque=turn(measured.torque)), robot, "arm")


def test_a_controller_that_shakes_the_arm_is_no_other_recording(example):
    """What follows coarse encoders shakes the torque from sample to sample by more than the motion asks of it."""
    _, robot, measured = example
    noise = np.random.default_rng(5).standard_normal(measured.torque.shape)
    shaken = replace(measured, torque=measured.torque + 1.2 * np.nanstd(measured.torque, axis=0) * noise)
    check_follows(shaken, robot, "arm")
    with pytest.raises(Refused, match="does not follow the motion"):
        check_follows(replace(shaken, torque=np.roll(shaken.torque, 300, axis=0)), robot, "arm")


@pytest.mark.parametrize("seconds", [0.1, -0.1, 0.3])
def test_a_torque_of_another_time_is_told(example, seconds):
    recording, robot, _ = example
    assert check_delay(measure(recording), robot, "arm") == []
    with pytest.raises(Refused, match=f"about {abs(1e3 * seconds):.0f} ms {'late' if seconds > 0 else 'early'}"):
        check_delay(measure(shifted(recording, seconds)), robot, "arm")


def test_friction_that_builds_up_after_reversals_is_no_clock(example):
    """Its torque turns late, over a travel: read later it would fit friction that jumps, and nothing else."""
    recording, robot, measured = example
    friction = 0.5 * (robot.coulomb_positive - robot.coulomb_negative)
    late = np.zeros_like(measured.torque)
    for label in recording.labels:
        rows = np.flatnonzero(measured.trajectory == label)
        for joint in range(robot.joints):
            state = 0.0
            for row, step in zip(rows[1:], np.diff(measured.position[rows, joint]), strict=True):
                state = float(np.clip(state + step / 0.02, -1.0, 1.0))
                late[row, joint] = 4.0 * friction[joint] * state
    assert check_delay(replace(measured, torque=measured.torque + late), robot, "arm") == []


def test_a_short_delay_of_all_joints_is_told_in_words(example):
    recording, robot, _ = example
    (words,) = check_delay(measure(shifted(recording, 0.035)), robot, "arm")
    assert "35 ms late" in words
    assert "clock of the log" in words


def test_what_alternates_from_sample_to_sample_is_no_clock(example):
    """A controller that answers to the steps of its encoder: read between two samples such a torque would vanish."""
    _, robot, measured = example
    assert 0.05 * measured.rate % 1 == pytest.approx(0.5)
    alternates = 0.2 * measured.torque.std(axis=0) * np.where(np.arange(len(measured.time)) % 2, 1.0, -1.0)[:, None]
    assert check_delay(replace(measured, torque=measured.torque + alternates), robot, "arm") == []


def shifted(recording, seconds):
    """The recording with the torque of some time before."""
    torque = recording.torque.copy()
    for label in recording.labels:
        rows = recording.trajectory == label
        time = recording.time[rows]
        torque[rows] = np.stack([np.interp(time - seconds, time, x) for x in recording.torque[rows].T], axis=1)
    return replace(recording, torque=torque)


WRONG_UNITS = {
    "link inertia in kg mm2": (
        "bodies", lambda r: {"links": tuple(replace(x, inertia=1e6 * x.inertia) for x in r.links)}
    ),
    "friction of the joint side": ("friction", lambda r: {
        "coulomb_positive": r.coulomb_positive * r.gear_ratio, "coulomb_negative": r.coulomb_negative * r.gear_ratio,
        "viscous": r.viscous * r.gear_ratio**2,
    }),
    "motor inertia of the joint side": ("motor inertia", lambda r: {"armature": r.armature * r.gear_ratio**2}),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG_UNITS)
def test_a_model_of_another_size_is_told_with_what_is_too_large(example, case):
    _, robot, measured = example
    check_model_size(measured, robot, "arm")
    part, change = WRONG_UNITS[case]
    changes = {k: np.abs(v) if k in ("armature", "viscous") else v for k, v in change(robot).items()}
    with pytest.raises(Refused, match=f"torque of .*{part} is far too large"):
        check_model_size(measured, replace(robot, **changes), "arm")


def test_friction_of_motors_that_a_link_sensor_does_not_feel_is_asked_to_be_left_out(example):
    _, robot, measured = example
    stiff = replace(robot, **WRONG_UNITS["friction of the joint side"][1](robot))
    for behind, asked in ((True, "leave out 'coulomb'"), (False, "give 'coulomb'")):
        with pytest.raises(Refused) as refused:
            check_model_size(measured, stiff, "arm", behind_gears=behind)
        assert refused.value.suggestion.startswith(asked)


def test_a_joint_whose_torque_keeps_one_value_is_not_judged_and_all_of_them_are_refused(example):
    recording, _, _ = example
    still = recording.torque.copy()
    still[:, 2] = 0.0
    found = moving_torques(replace(recording, torque=still))
    assert found.usable.any(axis=0).tolist() == [True, True, False, True, True, True]
    with pytest.raises(Refused, match="keeps one value while the axes move"):
        moving_torques(replace(recording, torque=np.ones_like(still)))


def test_a_file_without_motor_inertia_is_no_other_unit(example):
    """A URDF of the links alone lacks the rotors, which make up most of what turns a wrist."""
    recording, robot, measured = example
    nothing = np.zeros(robot.joints)
    bare = replace(robot, armature=nothing, viscous=nothing, coulomb_positive=nothing, coulomb_negative=nothing)
    found = torque_factors(recording, bare, measured)
    np.testing.assert_allclose(found.factor, [1.0, 1.0, np.nan, np.nan, np.nan, np.nan], atol=0.15)
    with pytest.raises(Refused, match=r"torque of joint 2 is 944 times .* another unit than that of the other joints"):
        check_scale_of_one(
            torque_factors(recording, bare, replace(measured, torque=measured.torque * [1, 1e3, 1, 1, 1, 1]))
        )


def test_of_one_joint_alone_that_tells_its_unit_nothing_is_said_of_the_others(example):
    recording, robot, measured = example
    found = torque_factors(recording, robot, replace(measured, torque=1e3 * measured.torque))
    only = replace(found, factor=np.where(np.arange(6) == 1, found.factor, np.nan))
    with pytest.raises(Refused, match=r"torque of joint 2 is \d+ times that of the model; it looks like mN m$") as told:
        check_scale_of_one(only)
    assert told.value.suggestion.startswith("state units: {torque: mN m} if all joints are, or give 'scale' with 0.")


@pytest.mark.parametrize("unit", [1.0, 1000.0], ids=["N m", "mN m"])
def test_a_turntable_whose_torque_is_its_friction_is_in_its_unit(example, unit):
    _, robot, measured = example
    friction = 0.01 * np.array(robot.coulomb_positive)
    small = {"viscous": 0 * friction, "coulomb_positive": friction, "coulomb_negative": -friction}
    bodies = Dynamics(robot).rigid_body_torque(measured.position, measured.velocity, measured.acceleration)
    rubbing = 40.0 * np.sqrt(np.mean(bodies**2, axis=0))
    turntable = replace(robot, **{**small, "coulomb_positive": rubbing, "coulomb_negative": -rubbing})
    torque = unit * (bodies + turntable.coulomb(measured.velocity))
    moved = replace(measured, torque=torque)
    if unit == 1.0:
        check_size(moved, turntable, "log")
    else:
        with pytest.raises(Refused, match="looks like another unit"):
            check_size(moved, turntable, "log")
    # Without that friction in the file nothing tells it from a unit.
    with pytest.raises(Refused, match="times what the bodies"):
        check_size(moved, replace(robot, **small), "log")
