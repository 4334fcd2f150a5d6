"""The load at the flange that no log tells."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.monitor.reading.carried import LoadsOnMotion, with_loads
from jointwear.monitor.reading.load_groups import together
from jointwear.monitor.reading.load_search import _positive, find_load, near_switch
from jointwear.monitor.reading.model import ModelTorque
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.studies.shop_floor.arms import LIGHT, robot_data, robot_of

STEP = 0.1


@pytest.fixture(scope="module")
def motion():
    """Half a minute of a light arm: position, velocity, acceleration, and torque of unit loads."""
    random = np.random.default_rng(7)
    time = STEP * np.arange(300)
    pace, phase = random.uniform(0.6, 1.6, 6), random.uniform(0, 6, 6)
    home, reach = np.array(LIGHT.home), 0.6 * np.array(LIGHT.reach)
    angle = pace * time[:, None] + phase
    position = home + reach * np.sin(angle)
    velocity, acceleration = reach * pace * np.cos(angle), -reach * pace**2 * np.sin(angle)
    unit = FlangeLoad(robot_of(robot_data(LIGHT))).unit(position, velocity, acceleration)
    return position, velocity, acceleration, unit


def columns_of(velocity):
    return np.stack([velocity > 0, -(velocity < 0).astype(float), velocity], axis=0).transpose(2, 0, 1)


def test_unit_loads_add_up_to_a_payload(motion):
    position, velocity, acceleration, unit = motion
    data = robot_data(LIGHT)
    bare, loaded = (Dynamics(robot_of({**data, "payload": {**data["payload"], "mass": m}})) for m in (0.0, 4.0))
    more = loaded.rigid_body_torque(position, velocity, acceleration)
    more = more - bare.rigid_body_torque(position, velocity, acceleration)
    # Its inertia about the flange is of second order in the distance of its centre.
    assert np.einsum("smkn,k->mn", unit, [4.0, 0.0, 0.08, 0.32]) == pytest.approx(more, abs=0.02 * np.abs(more).max())


@settings(max_examples=8, deadline=None)
@given(mass=st.floats(2.0, 8.0), begin=st.integers(20, 140), length=st.integers(60, 150), worn=st.floats(0.0, 1.0))
def test_mass_and_switches_are_found_whatever_the_friction(motion, mass, begin, length, worn):
    velocity, unit = motion[1], motion[3]
    random = np.random.default_rng(length)
    carried = (np.arange(300) >= begin) & (np.arange(300) < begin + length)
    torque = np.einsum("smkn,k->mn", unit, [mass, 0.0, 0.0, 0.06 * mass]) * carried[:, None]
    torque = torque + worn * np.array(LIGHT.coulomb) * np.sign(velocity) + 0.1 * random.standard_normal(velocity.shape)
    load = find_load(torque, columns_of(velocity), unit.sum(axis=0), np.abs(velocity) > 0.02, STEP)
    assert load.moments[0] == pytest.approx(mass, rel=0.05)
    assert load.moments[3] == pytest.approx(0.06 * mass, abs=0.05 * mass)
    assert np.mean(load.carried == carried) > 0.97


def program(seed, samples=300):
    """Three moves of 3 s from rest to rest, again and again: position, velocity, acceleration, and the move."""
    span = 3.0
    points = np.array(LIGHT.home) + np.array(LIGHT.reach) * np.random.default_rng(seed).uniform(-0.7, 0.7, (3, 6))
    time = STEP * np.arange(samples) + 0.5 * STEP
    move, s = (time // span).astype(int) % 3, ((time % span) / span)[:, None]
    way = points[(move + 1) % 3] - points[move]
    position = points[move] + way * (10 * s**3 - 15 * s**4 + 6 * s**5)
    velocity = way * (30 * s**2 - 60 * s**3 + 30 * s**4) / span
    return position, velocity, way * (60 * s - 180 * s**2 + 120 * s**3) / span**2, move


def test_a_load_on_one_move_of_three_is_found():
    """What is fitted along (friction, gravity, inertia) swallows most of a load as long as its switch is wrong."""
    found = []
    for seed in range(20):
        position, velocity, acceleration, move = program(seed)
        unit = FlangeLoad(robot_of(robot_data(LIGHT))).unit(position, velocity, acceleration)
        noise = 0.2 * np.random.default_rng(seed).standard_normal(velocity.shape)
        torque = np.einsum("smkn,k->mn", unit, [3.0, 0.0, 0.0, 0.24]) * (move == 0)[:, None] + noise
        load = find_load(torque, columns_of(velocity), unit.sum(axis=0), np.abs(velocity) > 0.02, STEP)
        same = load is not None and np.mean(load.carried == (move == 0)) > 0.95
        found.append(same and load.moments[0] == pytest.approx(3.0, rel=0.1))
        assert find_load(noise, columns_of(velocity), unit.sum(axis=0), np.abs(velocity) > 0.02, STEP) is None
    assert sum(found) >= 19


def test_such_a_load_is_found_in_a_long_window_that_begins_at_rest():
    samples = 9000
    position, velocity, acceleration, move = program(4, samples)
    unit = FlangeLoad(robot_of(robot_data(LIGHT))).unit(position, velocity, acceleration).sum(axis=0)
    noise = 0.2 * np.random.default_rng(2).standard_normal(velocity.shape)
    torque = np.einsum("mkn,k->mn", unit, [3.0, 0.0, 0.0, 0.24]) * (move == 0)[:, None] + noise
    used = (np.abs(velocity) > 0.02) & (np.arange(samples) >= 3000)[:, None]
    load = find_load(torque, columns_of(velocity) * used.T[:, None], unit, used, STEP)
    assert load.moments[0] == pytest.approx(3.0, rel=0.05)
    assert np.mean((load.carried == (move == 0))[3000:]) > 0.98


def test_a_load_does_not_turn_on_round_off_where_gravity_does_not_act(motion):
    velocity, unit = motion[1], motion[3]
    random = np.random.default_rng(3)
    carried = np.arange(300) >= 120
    torque = np.einsum("smkn,k->mn", unit, [4.0, 0.0, 0.0, 0.2]) * carried[:, None]
    torque = torque + 0.2 * random.standard_normal(velocity.shape)
    model = random.standard_normal((6, 2, 300))
    # The last moment has no torque but round-off, as has the gravity of the first axis.
    hidden = unit.sum(axis=0)
    hidden[:, 3] = 0.0
    loads = []
    for noise in (0.0, 1e-16, -3e-16):
        model[0, 0] = noise * random.standard_normal(300)
        hidden[:, 2] = noise * random.standard_normal((300, 6))
        columns = np.concatenate([columns_of(velocity), model], axis=1)
        loads.append(find_load(torque, columns, hidden, np.abs(velocity) > 0.02, STEP))
    for load in loads:
        assert load.moments[2:] == pytest.approx([0.0, 0.0], abs=1e-12)
        assert load.moments[0] == pytest.approx(loads[0].moments[0], rel=1e-9)
        assert np.array_equal(load.carried, loads[0].carried)


def test_friction_and_noise_are_no_load_and_a_load_becomes_part_of_the_model(motion):
    velocity, unit = motion[1], motion[3]
    along = LoadsOnMotion(FlangeLoad(robot_of(robot_data(LIGHT))), *motion[:3])
    used = np.abs(velocity) > 0.02
    noise = 0.3 * np.random.default_rng(1).standard_normal(velocity.shape)
    torque = 4.0 * np.sign(velocity) + noise
    assert find_load(torque, columns_of(velocity), unit.sum(axis=0), used, STEP) is None
    zeros = np.zeros_like(velocity)
    plain = ModelTorque(zeros, zeros, zeros)
    whole = [[slice(0, 300)]]
    same, clear = with_loads(plain, torque, velocity, used, whole, STEP, along)
    assert not same.total.any()
    assert clear.all()
    torque = torque + 5.0 * unit.sum(axis=0)[:, 0] * (np.arange(300) >= 150)[:, None]
    found, clear = with_loads(plain, torque, velocity, used, whole, STEP, along)
    left = (torque - 4.0 * np.sign(velocity) - found.total)[clear & used]
    assert np.std(left) < 1.3 * np.std(noise)
    assert found.gravity + found.inertial == pytest.approx(found.total)
    assert 0 < (~clear[:, 0]).sum() < 20


@pytest.mark.parametrize(("begin", "end"), [(25, 65), (40, 70), (235, 262)])
def test_a_hole_hides_no_load_of_the_short_piece_beside_it(motion, begin, end):
    velocity, unit = motion[1], motion[3]
    along = LoadsOnMotion(FlangeLoad(robot_of(robot_data(LIGHT))), *motion[:3])
    used = np.abs(velocity) > 0.02
    carried = np.sin(0.12 * np.arange(300) + 0.3) > 0
    load = 5.0 * unit.sum(axis=0)[:, 0] * carried[:, None]
    torque = 4.0 * np.sign(velocity) + 0.3 * np.random.default_rng(1).standard_normal(velocity.shape) + load
    zeros = np.zeros_like(velocity)
    pieces = [slice(0, begin), slice(end, 300)]
    groups = together(pieces, np.zeros(300), np.arange(300) >= end, STEP)
    found, clear = with_loads(ModelTorque(zeros, zeros, zeros), torque, velocity, used, groups, STEP, along)
    known = clear[:, 0] & ((np.arange(300) < begin) | (np.arange(300) >= end))
    wrong = (np.abs(found.total - load) > 0.05 * np.abs(load).max()).any(axis=1)
    # A switch within a quarter of a second of a hole is not seen.
    assert wrong[known].mean() < 0.02
    assert known[: pieces[0].stop].any()
    assert known[pieces[1].start :].any()


def test_pieces_too_short_to_show_a_load_go_with_what_is_beside_them():
    def lengths(pieces, window, stretch):
        ends = np.cumsum([0, *pieces])
        slices = [slice(a, b) for a, b in itertools.pairwise(ends)]
        labels = [np.repeat(x, pieces) for x in (window, stretch)]
        return [[s.stop - s.start for s in group] for group in together(slices, *labels, STEP)]

    assert lengths([300, 44, 300], [0, 0, 0], [0, 1, 2]) == [[300], [44, 300]]
    assert lengths([220, 44, 300], [0, 0, 1], [0, 1, 2]) == [[220, 44], [300]]
    assert lengths([30, 300], [0, 1], [0, 0]) == [[30, 300]]
    assert lengths([30, 300], [0, 1], [0, 1]) == [[30], [300]]
    assert lengths([100, 100, 100, 100], [0, 0, 0, 0], [0, 1, 2, 3]) == [[100, 100], [100, 100]]
    assert together([], np.zeros(0), np.zeros(0), STEP) == []


def test_samples_around_a_switch_are_left_out():
    near = near_switch(np.arange(100) >= 50, 0.02)
    assert near[50]
    assert not near[:30].any()
    assert near.sum() < 40
    assert near_switch(np.arange(7) >= 5, 0.02).all()


def test_a_switch_does_not_turn_on_round_off_at_rest():
    gain = np.zeros(40)
    gain[10:20], gain[25:30] = 3.0, [1e-15, -1e-15, 2e-15, -1e-16, 1e-16]
    shown = _positive(gain, 3)
    assert np.array_equal(shown, _positive(gain * (1 - 1e-16), 3))
    assert np.flatnonzero(shown).tolist() == list(range(9, 21))
    assert not _positive(np.zeros(5), 3).any()
