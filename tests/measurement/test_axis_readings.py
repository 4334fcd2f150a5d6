"""How a recording is read, which effects are believed, and how wide the interval of an effect's torque is."""

import contextlib
import itertools
from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings, discover
from jointwear.discovery.estimates.peak_torque import Shape, height
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.search.acceptance import missed, stiff
from jointwear.discovery.search.crossval import CrossValidated
from jointwear.effects import make_state
from jointwear.measurement.checks import axes_check, axis_readings
from jointwear.measurement.checks.axes_check import FAVOURS, check_axes, explained, explained_otherwise, favours
from jointwear.measurement.checks.axis_readings import (
    Likelihood,
    Reading,
    least_solution,
    other_scale,
    readings,
    units_of_one,
)
from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.other_zero import zero_in_words
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.refused import Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot
from jointwear.studies.challenge.arms import arm_path


@pytest.fixture(scope="module")
def puma():
    return load_robot("config/robots/puma560.yaml")


def spring_of_the_last_joint(q, v, a, temperature, time, torque):
    """More than the friction of a joint whose torque is friction nearly alone."""
    result = np.zeros_like(torque)
    result[:, 5] = 0.3 * (q[:, 5] - 0.4)
    return result


@pytest.fixture(scope="module", params=[None, spring_of_the_last_joint], ids=["nothing", "spring"])
def recording(request, puma):
    return make_case(puma, 3, request.param)


def check(recording, puma):
    check_axes("arm", puma, measure(recording))


def turned(recording, axis, position=1.0, torque=1.0):
    q, tau = recording.position.copy(), recording.torque.copy()
    q[:, axis] *= position
    tau[:, axis] *= torque
    return replace(recording, position=q, torque=tau)


def test_right_recordings_are_not_refused(recording, puma):
    check(recording, puma)


@pytest.mark.long
@pytest.mark.parametrize(("axis", "position"), [(0, -1.0), (1, -1.0), (2, -1.0), (3, 1.0), (4, 1.0)])
def test_flipped_joints_are_named_by_a_file_without_friction(puma, axis, position):
    # What such a file lacks is unknown, not zero: bodies need not explain it.
    nothing = np.zeros(puma.joints)
    bare = replace(puma, coulomb_positive=nothing, coulomb_negative=nothing, viscous=nothing, armature=nothing)
    plain = make_case(puma, 3, None)
    check_axes("arm", bare, measure(plain))
    with pytest.raises(Refused, match=f"sign of .*joint {axis + 1} looks flipped"):
        check_axes("arm", bare, measure(turned(plain, axis, position, -1.0)))


@pytest.mark.long
@pytest.mark.parametrize("axis", [0, 1, 3, 4])
def test_flipped_joints_are_named(recording, puma, axis):
    with pytest.raises(Refused, match=f"sign of joint {axis + 1} looks flipped"):
        check(turned(recording, axis, -1.0, -1.0), puma)


@pytest.mark.long
@pytest.mark.parametrize("axis", range(6))
def test_a_position_that_alone_is_turned_is_named(recording, puma, axis):
    """Not as the torque: that would mirror the arm."""
    with pytest.raises(Refused, match=f"sign of the position of joint {axis + 1} looks flipped") as refused:
        check(turned(recording, axis, -1.0), puma)
    assert f"position of joint {axis + 1}: give 'sign' and 'scale' with -1 for it" in refused.value.suggestion


@pytest.mark.parametrize("axis", range(6))
def test_a_torque_that_alone_is_turned_is_named_first(puma, axis):
    """A position that is turned is believed too, but less."""
    with pytest.raises(Refused, match=f"^arm: the sign of the torque of joint {axis + 1} looks flipped"):
        check(turned(make_case(puma, 3, None), axis, 1.0, -1.0), puma)


@pytest.mark.parametrize("axis", [1, 2])
def test_another_zero_is_told_of_the_joint_that_has_it(puma, axis):
    """The joint behind it, counted from another zero or from the base, would explain half as much."""
    recording = make_case(puma, 3, None)
    q = recording.position.copy()
    q[:, axis] += 0.5 * np.pi
    with pytest.raises(Refused, match=f"^arm: the position of joint {axis + 1} looks counted from another zero"):
        check(replace(recording, position=q), puma)


@pytest.mark.parametrize(("way", "remedy"), [(1.0, "subtract {} from"), (-1.0, "add {} to")])
def test_a_joint_that_is_counted_from_the_base_is_named(recording, puma, way, remedy):
    """As the third joint is in the display of some controllers, from the horizontal."""
    q = recording.position.copy()
    q[:, 2] += way * q[:, 1]
    with pytest.raises(Refused, match="position of joint 3 looks counted from the base") as refused:
        check(replace(recording, position=q), puma)
    assert f"{remedy.format('the position of joint 2')} that of joint 3" in refused.value.suggestion


def test_only_neighbours_whose_axes_are_parallel_are_counted_together(puma):
    """The planar pairs of the arm: joints 2 and 3."""
    pairs = [(r.axes, r.factors) for r in readings(puma) if r.kind == "base"]
    assert pairs == [((2,), (1.0,)), ((2,), (-1.0,))]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_one_joint_in_degrees_is_named(recording, puma, axis):
    with pytest.raises(Refused, match=f"position of joint {axis + 1} looks like degrees, those of the others do not"):
        check(turned(recording, axis, 180 / np.pi), puma)


def test_readings_that_the_torque_cannot_tell_apart_are_all_told(puma):
    # Without limits that differ, an upper arm that turns the other way is one that hangs from half a turn of the base.
    with pytest.raises(Refused) as refused:
        check(turned(make_case(puma, 3), 1, -1.0, -1.0), puma)
    believed = refused.value.reason.split("; or ")
    assert any("joint 2 looks flipped" in words for words in believed)
    assert len(refused.value.suggestion.split("; or ")) == len(believed)


@pytest.mark.parametrize("gravity", [(9.81, 0.0, 0.0), (0.0, 0.0, 9.81)])
def test_a_file_of_another_mounting_is_told_with_its_gravity(puma, gravity):
    with pytest.raises(Refused, match=r"gravity along \[0, 0, -9.81\]"):
        checked(make_case(puma, 3), replace(puma, gravity=np.array(gravity)))


def test_torques_without_gravity_are_told(puma):
    plain = make_case(puma, 3)
    light = plain.torque - Dynamics(puma).gravity_torque(plain.position)
    with pytest.raises(Refused, match="hold nothing of gravity"):
        checked(replace(plain, torque=light), puma)


@pytest.mark.long
def test_the_file_of_another_arm_is_told_as_a_cause_beside_what_resembles_it(recording, puma):
    with pytest.raises(Refused, match=r"even so the model leaves .* of the squared torque") as refusal:
        checked(recording, load_robot(arm_path("ur10")))
    assert "that of 'ur10' is another's" in refusal.value.suggestion
    with pytest.raises(Refused, match=r"look swapped; exchanged they fit the model$"):
        check(replace(recording, torque=recording.torque[:, [0, 2, 1, 3, 4, 5]]), puma)


def test_a_joint_that_counts_from_a_zero_some_degrees_off_is_told(puma):
    plain = make_case(puma, 3)
    assert zero_in_words(measure(plain), puma) == []
    off = replace(plain, position=plain.position + np.radians([0, 8, 0, 0, 0, 0]))
    (told,) = zero_in_words(measure(off), puma)
    assert told.startswith("the position of joint 2 looks counted from another zero, -")


@pytest.mark.parametrize("axis", [2, 5])
def test_motor_side_torque_is_named(puma, axis):
    # What tells of the last joint is the size of its friction: there is next to no other torque.
    recording = make_case(puma, 3)
    with pytest.raises(Refused, match=f"torque of joint {axis + 1} looks like that of the motor") as refusal:
        check(turned(recording, axis, 1.0, 1 / puma.gear_ratio[axis]), puma)
    assert "motor" in refusal.value.readings


def test_without_friction_in_the_file_a_motor_side_torque_needs_more(puma):
    nothing = np.zeros(puma.joints)
    bare = replace(puma, coulomb_positive=nothing, coulomb_negative=nothing, viscous=nothing, armature=nothing)
    motor = Reading("motor", (5,))
    assert favours(motor, bare) == FAVOURS["torque"] > favours(motor, puma) == FAVOURS["motor"]
    # Bodies tell the size of a torque that they make up.
    plain = make_case(puma, 3, None)
    with pytest.raises(Refused, match="torque of joint 3 looks like that of the motor"):
        check(turned(plain, 2, 1.0, 1 / puma.gear_ratio[2]), bare)


@pytest.mark.parametrize("pair", [(3, 5), (4, 5)])
def test_swapped_wrist_joints_are_named(recording, puma, pair):
    order = np.arange(6)
    order[list(pair)] = pair[::-1]
    mixed = replace(recording, position=recording.position[:, order], torque=recording.torque[:, order])
    with pytest.raises(Refused, match=f"joints {pair[0] + 1} and {pair[1] + 1} look swapped"):
        check(mixed, puma)


@pytest.mark.parametrize("pair", [(1, 2), (3, 4)])
@pytest.mark.parametrize("role", ["torque", "position"])
def test_exchanged_columns_of_one_quantity_are_named(puma, pair, role):
    recording = make_case(puma, 3)
    values = getattr(recording, role).copy()
    values[:, list(pair)] = values[:, pair[::-1]]
    with pytest.raises(Refused, match=f"the {role}s of joints {pair[0] + 1} and {pair[1] + 1} look swapped"):
        check(replace(recording, **{role: values}), puma)


def test_torques_of_a_wrist_as_a_share_of_a_rating_are_no_exchange(puma):
    recording, factors = make_case(puma, 3), np.array([1.0, 0.53, 1.11, 4.2, 5.0, 5.0])
    with pytest.raises(Refused, match=r"torque of joints 4, 5 and 6 is 4\.2, 5 and 5 times that") as refusal:
        check(replace(recording, torque=factors * recording.torque), puma)
    assert "'scale' with 0.238, 0.2 and 0.2 for joints 4, 5 and 6" in refusal.value.suggestion


def test_torques_of_the_size_of_the_model_have_no_other_scale(recording, puma):
    measured = measure(recording)
    parts = np.stack([measured.position, measured.velocity, measured.acceleration, measured.torque], axis=1)
    assert other_scale(Dynamics(puma), parts, measured.usable) is None


@pytest.mark.parametrize("seen", [True, False])
def test_an_exchange_of_axes_that_hardly_move_is_not_believed(recording, puma, monkeypatch, seen):
    exchange = next(r for r in readings(puma) if r.kind == "swap" and set(r.axes) == {3, 4})
    unknown = 0.2 if seen else np.nan
    left, other = np.full(6, unknown), np.full(6, unknown)
    left[5], other[5] = 1.07, 0.12
    nats = itertools.count()
    monkeypatch.setattr(axes_check, "explained", lambda *_: left)
    monkeypatch.setattr(axes_check, "explained_otherwise", lambda *_: iter([(exchange, other)]))
    monkeypatch.setattr(axes_check, "Likelihood", lambda *_: lambda *_: float(next(nats)))
    with pytest.raises(Refused, match="joints 4 and 5 look swapped") if seen else contextlib.nullcontext():
        check(recording, puma)


@pytest.mark.parametrize(("left", "other", "refused"), [(0.004, 0.09, False), (0.09, 0.004, True), (0.02, 0.09, True)])
def test_an_exchange_that_makes_a_right_axis_wrong_is_not_believed(recording, puma, monkeypatch, left, other, refused):
    """Joint 5 of a drive that turns with joint 6 resembles joint 4, which the model explains as it is."""
    exchange = next(r for r in readings(puma) if r.kind == "swap" and set(r.axes) == {3, 4})
    as_read, read_so, nats = np.full(6, 0.001), np.full(6, 0.001), iter([0.0, 28.0])
    as_read[3:5], read_so[3:5] = (left, 0.12), (other, 0.02)
    monkeypatch.setattr(axes_check, "explained", lambda *_: as_read)
    monkeypatch.setattr(axes_check, "explained_otherwise", lambda *_: iter([(exchange, read_so)]))
    monkeypatch.setattr(axes_check, "Likelihood", lambda *_: lambda *_: next(nats))
    with pytest.raises(Refused, match="joints 4 and 5 look swapped") if refused else contextlib.nullcontext():
        check(recording, puma)


@pytest.mark.parametrize(
    ("other", "nats", "refused"), [(0.0145, 30.0, False), (0.0145, 51.0, True), (0.004, 30.0, True)]
)
def test_an_exchange_that_moves_what_is_wrong_needs_more(recording, puma, monkeypatch, other, nats, refused):
    """A zero that drifts on joint 6 of a UR10 had made joints 4 and 6 look exchanged."""
    exchange = next(r for r in readings(puma) if r.kind == "swap" and set(r.axes) == {3, 5})
    as_read, read_so, told = np.full(6, 0.001), np.full(6, 0.001), iter([0.0, nats])
    as_read[[3, 5]], read_so[[3, 5]] = (0.0012, 0.0123), (other, 0.0012)
    monkeypatch.setattr(axes_check, "explained", lambda *_: as_read)
    monkeypatch.setattr(axes_check, "explained_otherwise", lambda *_: iter([(exchange, read_so)]))
    monkeypatch.setattr(axes_check, "Likelihood", lambda *_: lambda *_: next(told))
    with pytest.raises(Refused, match="joints 4 and 6 look swapped") if refused else contextlib.nullcontext():
        check(recording, puma)


@pytest.mark.parametrize(("left", "nats", "refused"), [(0.004, 41.0, False), (0.004, 81.0, True), (0.02, 41.0, True)])
def test_a_flip_of_an_axis_that_the_model_explains_needs_more(recording, puma, monkeypatch, left, nats, refused):
    flip = next(r for r in readings(puma) if r.kind == "flip" and r.axes == (5,))
    shares, told = np.full(6, left), iter([0.0, nats])
    monkeypatch.setattr(axes_check, "explained", lambda *_: shares)
    monkeypatch.setattr(axes_check, "explained_otherwise", lambda *_: iter([(flip, shares)]))
    monkeypatch.setattr(axes_check, "Likelihood", lambda *_: lambda *_: next(told))
    with pytest.raises(Refused, match="sign of joint 6 looks flipped") if refused else contextlib.nullcontext():
        check(recording, puma)


@pytest.mark.parametrize(("turned", "nats", "refused"), [(0.05, 21.0, False), (0.05, 41.0, True), (0.008, 21.0, True)])
def test_a_flip_that_leaves_more_than_a_right_axis_needs_more(recording, puma, monkeypatch, turned, nats, refused):
    """A hose on a joint about the vertical looks like its flip (bench 31)."""
    flip = next(r for r in readings(puma) if r.kind == "flip" and r.axes == (0,))
    left, other, told = np.full(6, 0.004), np.full(6, 0.004), iter([0.0, nats])
    left[0], other[0] = 0.16 if turned > 0.01 else 0.03, turned
    monkeypatch.setattr(axes_check, "explained", lambda *_: left)
    monkeypatch.setattr(axes_check, "explained_otherwise", lambda *_: iter([(flip, other)]))
    monkeypatch.setattr(axes_check, "Likelihood", lambda *_: lambda *_: next(told))
    with pytest.raises(Refused, match="sign of joint 1 looks flipped") if refused else contextlib.nullcontext():
        check(recording, puma)


def test_every_reading_is_undone_by_itself_or_its_gear(puma):
    rng = np.random.default_rng(0)
    parts, usable = rng.standard_normal((5, 4, 6)), rng.random((5, 6)) > 0.5
    kinds = {"swap": 15, "torques": 15, "positions": 15, "flip": 6, "torque": 6, "motor": 6, "zero": 18, "base": 2}
    kinds["position"] = 6
    found = list(readings(puma))
    assert {k: sum(r.kind == k for r in found) for k in kinds} == kinds
    for reading in found:
        once = reading.read(parts, usable, puma)
        assert not np.array_equal(once[0], parts)
        if reading.kind != "motor":
            back = replace(reading, angle=-reading.angle, factors=tuple(-f for f in reading.factors))
            again = back.read(*once, puma)
            np.testing.assert_allclose(again[0], parts, rtol=1e-12, atol=1e-12)
            assert np.array_equal(again[1], usable)
    scaled = Reading("motor", (2,)).read(parts, usable, puma)[0]
    np.testing.assert_allclose(scaled[:, 3, 2], puma.gear_ratio[2] * parts[:, 3, 2])


def test_a_missing_torque_is_usable_in_no_reading(puma):
    rng = np.random.default_rng(0)
    parts, usable = rng.standard_normal((50, 4, 6)), np.ones((50, 6), dtype=bool)
    parts[7, 3, 2], usable[7, 2] = np.nan, False
    for reading in readings(puma):
        turned, known = reading.read(parts, usable, puma)
        assert np.isfinite(turned[:, 3][known]).all(), reading
    found = [left for _, left in explained_otherwise(Dynamics(puma), parts, usable)]
    assert np.isfinite(found).all()


def test_what_another_reading_leaves_is_what_is_left_of_the_samples_read_that_way(puma):
    rng = np.random.default_rng(0)
    parts, usable = rng.standard_normal((200, 4, 6)), rng.random((200, 6)) > 0.3
    dynamics = Dynamics(puma)
    found = list(explained_otherwise(dynamics, parts, usable))
    assert [reading for reading, _ in found] == [*readings(puma), *units_of_one(puma, parts[:, 0])]
    for reading, left in found:
        np.testing.assert_allclose(left, explained(dynamics, *reading.read(parts, usable, puma)), rtol=1e-9)


def test_some_of_the_samples_refute_no_reading_that_all_of_them_do_not(recording, puma):
    measured = measure(recording)
    parts, _, usable = axes_check.features(measured)
    dynamics = Dynamics(puma)

    def leaves_much(reading, left):
        return bool(np.nanmax(left[list(reading.axes)], initial=0.0) >= axes_check.WRONG)

    every = list(explained_otherwise(dynamics, parts, usable))
    asked = [reading for reading, _ in explained_otherwise(dynamics, parts, usable, leaves_much)]
    believable = [reading for reading, left in every if not leaves_much(reading, left)]
    assert set(believable) <= set(asked)
    assert len(asked) < len(every)


def test_what_bodies_do_to_an_axis_is_the_same_without_those_that_it_does_not_feel(recording, puma):
    parts, _, _ = axes_check.features(measure(recording))
    parts, likelihood = parts[:200], Likelihood(Dynamics(puma), 40)
    of_motion, factor = likelihood._of_motion(parts[:, :3]), likelihood._factor
    regressor = axis_readings.inertial_regressor(Dynamics(puma), *(parts[:, k] for k in range(3)))
    for j, (columns, felt) in enumerate(zip(of_motion.columns, of_motion.parameters, strict=True)):
        every = np.zeros((factor.shape[1], len(parts)))
        every[felt] = columns
        np.testing.assert_allclose(every, (regressor[:, j] @ factor).T, rtol=1e-9, atol=1e-12)
    assert len(of_motion.parameters[5]) < len(of_motion.parameters[0]) / 2


def test_torques_that_are_read_otherwise_ask_nothing_of_the_same_motion_again(recording, puma, monkeypatch):
    parts, _, usable = axes_check.features(measure(recording))
    asked, regressor = [], axis_readings.inertial_regressor
    monkeypatch.setattr(axis_readings, "inertial_regressor", lambda *x: asked.append(1) or regressor(*x))
    kept = Likelihood(Dynamics(puma), 40)
    for reading in (Reading("torque", (1,)), Reading("torques", (1, 2)), Reading("flip", (0,))):
        turned = reading.read(parts, usable, puma)
        as_read, otherwise = kept(parts, usable), kept(*turned)
        assert otherwise != as_read
        assert otherwise == Likelihood(Dynamics(puma), 40)(*turned)
        assert kept(parts, usable) == as_read
    # As read, and turned round; and each once anew.
    assert len(asked) == 2 + 3


def test_an_effect_of_one_record_is_not_one_of_the_robot():
    limits = Settings()
    of_all = CrossValidated(nats=60.0, share=0.25, worst=3.0, lowers_error=0.999, gain_share=0.1)
    assert missed(of_all, 60.0, limits) == []
    # In nats alone nothing is believed.
    assert missed(replace(of_all, lowers_error=0.9), 60.0, limits) == [
        ("probability of a smaller error on records left out", 0.9, limits.certainty)
    ]
    assert missed(replace(of_all, gain_share=-0.01), 60.0, limits)[0][0].startswith("drop of the squared error")
    assert missed(replace(of_all, worst=-20.0), 60.0, limits)[0][0].endswith("that gains least")
    assert missed(replace(of_all, nats=1.0), 60.0, limits)[0][0].startswith("nats gained")
    # Nor is one of a single stop.
    assert missed(replace(of_all, elsewhere=-3.0), 60.0, limits)[0][0].endswith("block of time that gains most")
    # Every gate that is missed is told.
    assert len(missed(replace(of_all, nats=1.0, worst=-20.0), 60.0, limits)) == 2
    assert stiff(Candidate("joint_flexibility", 1, None))
    assert stiff(Candidate("drive_coupling", 4, 5))
    assert not stiff(Candidate("stribeck_friction", 1, None))


def test_height_of_a_narrow_series_is_its_top():
    values = np.zeros(1000)
    values[:20] = 3.0
    assert height(values) == pytest.approx(3.0)
    assert height(np.full(7, -2.0)) == pytest.approx(2.0)


def test_a_drive_that_turns_with_two_axes_is_seen_from_either(puma):
    rng = np.random.default_rng(2)
    q, v, a = rng.standard_normal((3, 50, 6))
    state = make_state(puma, q, v, a, np.array(Dynamics(puma).rigid_body_torque(q, v, a)))
    candidate = Candidate("drive_coupling", 4, 5, {"own": 1.0, "other": -1.0})
    both = v[:, 5] - v[:, 4]
    file, other, own = (Shape(candidate, drive=kind).columns(state) for kind in ("", "other", "own"))
    np.testing.assert_allclose(other[:, 1], both)
    np.testing.assert_allclose(other[:, 2], a[:, 5] - a[:, 4])
    np.testing.assert_allclose(file[:, 1], v[:, 5])
    np.testing.assert_allclose(own[:, 0], file[:, 0] - np.sign(v[:, 4]))


@pytest.mark.long
def test_the_interval_knows_that_the_zero_of_a_spring_is_open(puma):
    # Only a constant tells where the spring is slack, and friction that differs by direction is one too.
    zero, axis = 0.5 * (puma.lower[1] + puma.upper[1]) + 0.6, 1

    def spring(q, v, a, temperature, time, torque):
        result = np.zeros_like(torque)
        result[:, axis] = 2.5 * np.sinh(1.3 * (q[:, axis] - zero))
        return result

    recording = make_case(puma, 11, spring)
    (effect,) = discover(recording, puma, Settings()).effects
    assert (effect["effect"], effect["axis"]) == ("joint_spring", axis + 1)
    moving = recording.trajectory == recording.trajectory.max()
    true = np.abs(2.5 * np.sinh(1.3 * (recording.position[moving, axis] - zero))).max()
    peak = effect["peak_torque"]
    assert peak["low"] <= true <= peak["high"]
    assert peak["high"] - peak["low"] < 1.5 * true


def test_equations_that_rounding_makes_singular_have_the_solution_that_comes_nearest():
    matrix = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 2.0]])
    np.testing.assert_allclose(least_solution(matrix, np.array([2.0, 2.0, 4.0])), [1.0, 1.0, 2.0])
    regular = matrix + np.eye(3)
    np.testing.assert_array_equal(least_solution(regular, matrix[0]), np.linalg.solve(regular, matrix[0]))
