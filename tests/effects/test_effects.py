"""The effect library: one file an effect, columns and torque agree, unordered samples, robots with effects."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from jointwear import effects
from jointwear.effects import order
from jointwear.effects.entries.presliding_hysteresis import bristle, relaxing_bristle
from jointwear.effects.swing import wind_up
from jointwear.files.errors import InputError
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import gravity_regressor, inertial_regressor, to_joint_frame, wind_up_regressor
from jointwear.robots.robot import EffectEntry, load_robot

IDENTIFIERS = {
    "stribeck_friction",
    "nonlinear_viscous_friction",
    "load_dependent_friction",
    "temperature_dependent_viscous_friction",
    "temperature_dependent_coulomb_friction",
    "position_dependent_friction",
    "presliding_hysteresis",
    "cogging_torque",
    "torque_constant_ripple",
    "torque_constant_error",
    "torque_constant_temperature",
    "torque_offset_drift",
    "joint_spring",
    "payload",
    "mounting_tilt",
    "joint_flexibility",
    "actuation_delay",
    "drive_coupling",
    "wear_drift",
    "backlash",
}


@pytest.fixture(scope="module")
def robot():
    return load_robot("config/robots/puma560.yaml")


@pytest.fixture(scope="module")
def state(robot):
    time = np.arange(0, 6, 0.01)
    phase = np.outer(time, np.linspace(1.0, 2.2, 6)) + np.arange(6)
    q, v = 0.8 * np.sin(phase), 0.8 * np.linspace(1.0, 2.2, 6) * np.cos(phase)
    a = -0.8 * np.linspace(1.0, 2.2, 6) ** 2 * np.sin(phase)
    dynamics = Dynamics(robot)
    regressor = inertial_regressor(dynamics, q, v, a)[:, :, -10:] @ to_joint_frame(robot, 5)
    return effects.make_state(
        robot,
        q,
        v,
        a,
        np.array(dynamics.rigid_body_torque(q, v, a)),
        time=time,
        temperature=30 + 5 * np.sin(0.5 * time),
        record=np.repeat([0, 1], 300),
        tip_regressor=lambda: regressor,
        gravity_regressor=lambda: gravity_regressor(robot, q),
    )


def test_library_holds_every_effect():
    assert set(effects.library()) == IDENTIFIERS


@pytest.mark.parametrize(
    "name", sorted(IDENTIFIERS - {"backlash", "actuation_delay", "joint_flexibility", "mounting_tilt"})
)
def test_torque_is_columns_times_coefficients(state, name):
    effect = effects.get_effect(name)
    source = 3 if effect.needs_source else None
    grid = effect.grid(state, 2)
    assert grid
    for nonlinear in grid:
        columns = effect.columns(state, 2, source, nonlinear)
        coefficients = np.linspace(0.01, 0.02, columns.shape[-1])
        parameters = effect.complete(effect.parameters_of(nonlinear, coefficients))
        np.testing.assert_allclose(
            effect.torque(state, 2, source, parameters), columns @ coefficients, rtol=1e-9, atol=1e-12
        )
        assert set(parameters) <= {p.name for p in effect.parameters}


def test_delay_is_linear_for_small_delays(state):
    effect = effects.get_effect("actuation_delay")
    column = effect.columns(state, 1, None, {"delay": 0.004})[:, 0]
    half = effect.torque(state, 1, None, effect.parameters_of({"delay": 0.004}, np.array([0.5])))
    # Friction jumps at a reversal; away from one the torque is smooth.
    direction = np.sign(state.velocity[:, 1])
    near = np.convolve(np.abs(np.diff(direction, append=direction[-1])), np.ones(5), mode="same") > 0
    assert 0 < near.sum() < 0.5 * len(near)
    # Splines between samples are linear to the second order of the delay.
    np.testing.assert_allclose(half[~near], 0.5 * column[~near], atol=5e-3 * np.abs(column).max())
    with_lag = effect.torque(state, 1, None, {"delay": 0.004, "lag": 1})
    assert np.corrcoef(with_lag[~near], column[~near])[0, 1] > 0.99


def test_lag_of_friction_knows_the_instant_of_reversal(state):
    from jointwear.effects.order import lagged

    lag, rate = 0.013, 5.0
    time = np.arange(300) * 0.01
    samples = replace(state, time=time, record=np.zeros(len(time), int))
    np.testing.assert_allclose(lagged(samples, 2 + 3 * time, lag), 2 + 3 * (time - lag), atol=1e-12)
    velocity = np.sin(rate * time + 0.3)
    turns = (np.arange(1, 5) * np.pi - 0.3) / rate
    steps = [2 * (-1) ** (k + 1) * np.where(time > t, 1 - np.exp(-(time - t) / lag), 0) for k, t in enumerate(turns)]
    np.testing.assert_allclose(lagged(samples, np.sign(velocity), lag, velocity), 1 + sum(steps), atol=0.01)


def test_friction_of_a_flexible_joint_is_that_of_its_motor(state):
    effect = effects.get_effect("joint_flexibility")
    plain = {"inertia_over_stiffness": 1e-3}
    inertia = effect.torque(state, 1, None, effect.complete(plain))
    np.testing.assert_allclose(
        inertia, 2 * effect.torque(state, 1, None, effect.complete({"inertia_over_stiffness": 5e-4})), atol=1e-12
    )
    friction = effect.torque(state, 1, None, effect.complete({**plain, "inertia": 0.5})) - inertia
    # Where the motor runs the other way round than the link, all of Coulomb friction has turned.
    drive, velocity = state.drive, state.velocity[:, 1]
    step = drive.coulomb_positive[1] - drive.coulomb_negative[1]
    turned = np.abs(friction) > 0.5 * step
    assert 0 < turned.sum() < 0.2 * len(turned)
    assert np.abs(velocity[turned]).max() < 0.5 * np.abs(velocity).max()


def test_what_a_load_holds_up_to_a_frequency_is_not_late_and_ends_with_each_record(state):
    time = np.tile(np.arange(500) / 100.0, 2)
    slow, fast = np.sin(2 * np.pi * 1.5 * time), np.sin(2 * np.pi * 30.0 * time)
    ordered = replace(
        state,
        **{name: np.zeros((1000, 6)) for name in ("position", "velocity", "acceleration", "load", "torque")},
        temperature=np.full((1000, 6), np.nan),
        time=time,
        record=np.repeat([0, 1], 500),
    )
    kept = order.up_to(ordered, slow + fast, 10.0)
    # At an end a wave has no other half to be told from what is slow.
    assert kept[20:480] == pytest.approx(slow[20:480], abs=0.02)
    alone = order.up_to(ordered, np.where(ordered.record == 0, slow + fast, 7.0), 10.0)
    assert np.array_equal(alone[:500], kept[:500])
    assert alone[500:] == pytest.approx(7.0)
    assert np.array_equal(order.up_to(replace(ordered, record=None), fast, 10.0), fast)


def test_a_link_behind_an_elastic_gear_swings_as_its_equation_says():
    count, swing, damping = 4000, 2 * np.pi * 12.0, 0.04
    time = np.arange(count) / 200.0
    state = SimpleNamespace(time=time, record=np.repeat([0, 1], count // 2))
    inertia, stiffness = np.full(count, 2.0), 2.0 * swing**2
    load = np.where(np.arange(count) < count // 2, 30.0 * np.sin(2 * np.pi * 3.0 * time), 30.0)
    step = 3 * count // 4
    load[count // 2 : step] = 0.0
    twist, _, acceleration = wind_up(state, load, inertia, stiffness, 2 * damping * np.sqrt(2.0 * stiffness))
    share = 3.0 / 12.0
    gain = 1 / np.hypot(1 - share**2, 2 * damping * share)
    # A sine after its start has died away: straight lines between samples take off two parts in a thousand.
    settled = slice(count // 4, count // 2)
    assert np.abs(twist[settled]).max() == pytest.approx(30 / stiffness * gain, rel=5e-3)
    np.testing.assert_allclose(acceleration[settled], -((2 * np.pi * 3.0) ** 2) * twist[settled], atol=0.03)
    # A step overshoots as an oscillator does.
    overshoot = 1 + np.exp(-np.pi * damping / np.sqrt(1 - damping**2))
    assert twist[step:].max() == pytest.approx(30 / stiffness * overshoot, rel=0.02)
    assert not np.any(wind_up(SimpleNamespace(time=time, record=None), load, inertia, stiffness, 1.0))


@pytest.mark.long
@pytest.mark.parametrize("unwound", [0.0, 2e-3])
def test_a_link_swings_as_its_inertia_changes_and_gravity_pulls_and_however_a_record_began(unwound):
    """A link of changing inertia on a soft gear, integrated step by step, at ease or let go unwound at the start."""
    stiffness, drag, time = 4000.0, 4.0, np.arange(0, 15.0, 1 / 250)

    def inertia(t):
        return 2.0 + 0.6 * np.sin(2 * np.pi * 0.7 * t)

    def by_angle(t):
        return 200.0 * np.cos(2 * np.pi * 0.3 * t)

    def load(t):
        return 30.0 * np.sin(2 * np.pi * 0.9 * t) + 8.0 * np.sign(np.sin(2 * np.pi * 0.23 * t + 0.7))

    def slopes(t, at):
        place, momentum = at
        return momentum / inertia(t), load(t) - drag * momentum / inertia(t) - (stiffness + by_angle(t)) * place

    start = [load(0.0) / (stiffness + by_angle(0.0)) + unwound, 0.0]
    place, momentum = solve_ivp(slopes, (0.0, time[-1]), start, t_eval=time, max_step=1e-3, rtol=1e-8).y
    true = stiffness * place + drag * momentum / inertia(time) - load(time)
    state = SimpleNamespace(time=time, record=np.zeros(len(time), int))
    twist, speed, acceleration = wind_up(state, load(time), inertia(time), stiffness, drag, by_angle(time))
    column = -inertia(time) * acceleration - by_angle(time) * twist
    assert column @ true / (column @ column) == pytest.approx(1.0, abs=0.02)
    later = time > 5.0
    assert np.std((true - column)[later]) < 0.05 * np.std(true[later])
    turning = momentum / inertia(time)
    assert np.std((turning - speed)[later]) < 0.05 * np.std(turning[later])


@pytest.mark.parametrize("drag", [0.0, 1e-3, 10.0, 80.0])
@pytest.mark.parametrize("count", [2, 3, 9, 40])
def test_a_swing_of_any_damping_and_length_is_finite(drag, count):
    state = SimpleNamespace(time=0.02 * np.arange(count), record=np.zeros(count, int))
    found = wind_up(state, np.linspace(3.0, 5.0, count), np.full(count, 0.4), 4000.0, drag)
    assert np.isfinite(found).all()
    assert np.abs(found[0]).max() <= 2 * 5.0 / 4000.0


def test_a_gear_swings_in_each_record_as_if_it_were_alone():
    rng = np.random.default_rng(4)
    record = np.repeat([3, 5, 4, 6], [300, 1, 2, 200])
    time = np.arange(len(record)) / 200.0
    load, inertia = rng.standard_normal(len(record)).cumsum(), rng.uniform(1.0, 2.0, len(record))
    found = wind_up(SimpleNamespace(time=time, record=record), load, inertia, 4000.0, 5.0)
    for label in (3, 5, 4, 6):
        own = record == label
        alone = wind_up(SimpleNamespace(time=time[own], record=record[own]), load[own], inertia[own], 4000.0, 5.0)
        for whole, part in zip(found, alone, strict=True):
            np.testing.assert_allclose(whole[own], part, rtol=1e-9, atol=1e-9 * np.abs(whole).max())
    assert not found[0][record == 5].any()


@pytest.mark.parametrize("shake", [50.0, 25.0])
def test_a_gear_that_twists_behind_its_encoder_shows_on_every_joint(robot, shake):
    """Link and motor of joint 2 move apart by load / K: what the rigid model lacks on all joints is what it says."""
    axis, stiffness = 1, 3e4
    time = np.arange(0, 6.0, 1 / 200)
    speed, phase = np.array([2.0, 3.1, 4.3, 5.0, 6.1, 3.7]), np.arange(6.0)
    angle = np.outer(time, speed) + phase
    q, v, a = 0.5 * np.sin(angle), 0.5 * speed * np.cos(angle), -0.5 * speed**2 * np.sin(angle)
    # A shake as that of friction that turns over, or so slow that Coriolis torques count.
    own = np.eye(6)[axis]
    swing = np.outer(np.sin(shake * time), own)
    q, a = q + 7.5 / shake**2 * swing, a - 7.5 * swing
    v = v + np.outer(7.5 / shake * np.cos(shake * time), own)
    dynamics = Dynamics(robot)
    load = np.array(dynamics.rigid_body_torque(q, v, a)) - robot.armature * a
    lead = np.zeros_like(q)
    lead[:, axis] = load[:, axis] / stiffness
    motor = [x + np.gradient(lead, time, axis=0) if k == 1 else x + lead for k, x in enumerate((q, v))]
    turning = a + np.gradient(np.gradient(lead, time, axis=0), time, axis=0)
    rigid = np.array(dynamics.rigid_body_torque(*motor, turning))
    lacking = load - (rigid - robot.armature * turning)
    state = effects.make_state(
        robot,
        *motor,
        turning,
        rigid,
        time=time,
        record=np.zeros(len(time), int),
        wind_up_regressor=wind_up_regressor(dynamics, *motor, turning),
    )
    link = float(np.mean(state.wind_up_regressor(axis)[0][:, axis]))
    found = {"inertia_over_stiffness": link / stiffness, "inertia": link, "side": 1, "damping": 0.02}
    effect = effects.get_effect("joint_flexibility")
    assert effect.spreads(found)
    torque = effect.spread(state, axis, None, found)
    inside = slice(500, -100)
    moved = [j for j in range(6) if np.std(lacking[inside, j]) > 0.02]
    assert axis in moved
    assert len(moved) >= 3
    for j in moved:
        assert np.mean((lacking - torque)[inside, j] ** 2) < 0.01 * np.mean(lacking[inside, j] ** 2), j
    # A robot file gives the same, and the torque on its own axis is that part of it.
    entry = EffectEntry("joint_flexibility", axis + 1, None, found)
    np.testing.assert_allclose(effects.effect_torque(replace(robot, effects=(entry,)), state), torque)
    np.testing.assert_allclose(effect.torque(state, axis, None, found), torque[:, axis])
    # Half of the record is half of the answer, but for its start, of which all of a record speaks.
    half = effect.spread(state.part(np.arange(600)), axis, None, found)
    np.testing.assert_allclose(half, torque[:600], atol=1e-3 * np.abs(torque).max())
    np.testing.assert_allclose(half[300:], torque[300:600], atol=1e-5 * np.abs(torque).max())


@pytest.mark.parametrize("name", sorted(IDENTIFIERS - {"backlash"}))
def test_metadata_is_complete(name):
    effect = effects.get_effect(name)
    assert effect.equation
    assert effect.source
    assert effect.excitation
    assert set(effect.confused_with) <= IDENTIFIERS
    for parameter in effect.parameters:
        assert parameter.lower <= parameter.default <= parameter.upper
        assert parameter.unit
        assert parameter.description


def test_names_stand_within_a_sentence():
    phrases = {name: effect.phrase for name, effect in effects.library().items()}
    assert phrases["stribeck_friction"] == "Stribeck friction"
    assert phrases["wear_drift"] == "wear: growing Coulomb friction"
    assert phrases["payload"] == "payload"


def test_sequential_effects_settle_without_an_order(state):
    unordered = replace(state, record=None)
    for name in ("presliding_hysteresis", "actuation_delay", "joint_flexibility"):
        effect = effects.get_effect(name)
        assert effect.sequential
        nonlinear = effect.grid(state, 0)[0]
        assert not np.any(effect.columns(unordered, 0, None, nonlinear))
        assert np.any(effect.columns(state, 0, None, nonlinear))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(-0.2, 0.2), min_size=2, max_size=60), st.floats(0.002, 0.3))
def test_bristle_stays_between_its_limits(steps, distance):
    position = np.cumsum(steps)
    direction = np.sign(np.gradient(position))
    z = bristle(position, direction, distance)
    assert np.all(np.abs(z) <= 1 + 1e-12)


def test_bristle_settles_after_many_distances():
    position = np.concatenate([np.linspace(0, 1, 50), np.linspace(0.98, 0, 50)])
    z = bristle(position, np.sign(np.gradient(position)), 0.02)
    assert z[45] == pytest.approx(1.0)
    assert z[-1] == pytest.approx(-1.0, abs=1e-6)
    assert -1 < z[51] < 1


@pytest.mark.parametrize("spring", [0, 1])
def test_a_record_may_begin_at_ease_or_moved_back(spring):
    """The state of the first sample is as told, and is forgotten beyond a reversal or a long travel."""
    position = np.concatenate([np.linspace(0, 0.3, 60), np.linspace(0.298, 0, 60)])
    direction = np.sign(np.gradient(position))
    settled, ease, back = (bristle(position, direction, 0.02, spring, start) for start in (1, 0, -1))
    assert (settled[0], ease[0], back[0]) == (1.0, 0.0, -1.0)
    assert np.all(np.diff(back[:20]) >= 0)
    assert np.allclose(settled[50:], ease[50:], atol=1e-5)
    assert np.allclose(settled[50:], back[50:], atol=1e-5)


def test_friction_that_relaxes_falls_at_rest_and_else_builds_up_as_before():
    """Within its time it falls to 1/e at rest; motion that is too slow to let it slip holds it where both are even."""
    position = np.concatenate([np.linspace(0, 0.3, 60), np.full(200, 0.3), np.linspace(0.298, 0, 60)])
    time = 0.01 * np.arange(len(position))
    direction = np.sign(np.diff(position, prepend=-0.01))
    never = relaxing_bristle(position, time, 0.02, 1e9)
    assert np.allclose(never[1:], bristle(position, direction, 0.02, spring=1)[1:], atol=1e-6)
    z = relaxing_bristle(position, time, 0.02, 0.5)
    assert (z[59], z[-1]) == (1.0, -1.0)
    assert z[59 + 50] == pytest.approx(np.exp(-1))
    slow = relaxing_bristle(0.02 * time, time, 0.02, 0.5, start=0)
    assert slow[-1] == pytest.approx(0.5, rel=0.01)


def test_noise_of_a_joint_at_rest_does_not_say_how_a_record_begins():
    rest = 1e-5 * (-1.0) ** np.arange(20)
    position = np.concatenate([rest, np.linspace(0, 0.3, 60)])
    for first in (0, 1):
        z = bristle(position[first:], np.sign(np.diff(position[first:], prepend=0.0)), 0.02)
        assert np.all(z[20 - first :] > 0.95)


def test_effect_torque_adds_entries_and_tables(robot, state):
    from dataclasses import replace

    entry = EffectEntry(
        "stribeck_friction",
        2,
        None,
        {"excess": 2.0, "speed": 0.1, "exponent": 1.0, "correction": {"knots": [0.0, 1.0], "values": [0.5, 0.5]}},
    )
    arm = replace(robot, effects=(entry,))
    effects.check_effects(arm)
    torque = effects.effect_torque(arm, state)
    v = state.velocity[:, 1]
    np.testing.assert_allclose(torque[:, 1], (2 * np.exp(-np.abs(v) / 0.1) + 0.5) * np.sign(v))
    assert not np.any(np.delete(torque, 1, axis=1))


def test_payload_is_the_same_as_the_payload_of_the_robot(robot, state):
    from dataclasses import replace

    from jointwear.robots.robot import Link

    com = np.array([0.02, -0.01, 0.09])
    arm = replace(robot, payload=Link(1.5, com, np.diag([2e-3, 3e-3, 1e-3])))
    about = np.diag([2e-3, 3e-3, 1e-3]) + 1.5 * (com @ com * np.eye(3) - np.outer(com, com))
    six = [about[i] for i in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
    values = dict(zip(("mass", "moment_x", "moment_y", "moment_z"), (1.5, *(1.5 * com)), strict=True))
    values |= dict(zip(("xx", "xy", "yy", "xz", "yz", "zz"), six, strict=True))
    torque = effects.get_effect("payload").torque(state, 0, None, values)
    plain, loaded = (
        np.array(Dynamics(r).rigid_body_torque(state.position, state.velocity, state.acceleration))
        for r in (robot, arm)
    )
    np.testing.assert_allclose(torque, loaded - plain, atol=1e-9)


def _corrected(knots, values):
    return EffectEntry("stribeck_friction", 1, None, {"correction": {"knots": knots, "values": values}})


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (EffectEntry("stribek_friction", 1, None, {}), "did you mean 'stribeck_friction'"),
        (EffectEntry("stribeck_friction", None, None, {}), "axis' is missing"),
        (EffectEntry("drive_coupling", 5, None, {}), "source_axis' is missing"),
        (EffectEntry("stribeck_friction", 1, None, {"exces": 1.0}), "did you mean 'excess'"),
        (EffectEntry("stribeck_friction", 1, None, {"excess": -1.0}), "nearest valid value is 0"),
        (EffectEntry("backlash", 1, None, {}), "no torque function"),
        (EffectEntry("drive_coupling", 5, 5, {}), "source_axis' is 5, as is 'axis'"),
        (_corrected([1.0, 0.0], [0.5, 0.5]), "correction.knots' is [1.0, 0.0]; knots must rise"),
        (_corrected([0.0, 1.0], [0.5]), "correction' has 2 knots and 1 value"),
        (_corrected([], []), "correction.knots' is [], must be a list of numbers"),
        (_corrected([0.0, 1.0], ["a", "b"]), "correction.values' is"),
        (EffectEntry("stribeck_friction", 1, None, {"correction": [1, 2]}), "must be a table of 'knots' and 'values'"),
    ],
)
def test_wrong_entries_are_named(robot, entry, words):
    from dataclasses import replace

    with pytest.raises(InputError, match=re.escape(words)):
        effects.check_effects(replace(robot, effects=(entry,)))


def test_wear_drift_is_equation_7(robot):
    from jointwear.reproduction.wear import Wear

    wear = Wear(10.0, 1.5, 120.0)
    hours = np.array([0.0, 30.0, 60.0, 120.0])
    c1, c2 = wear.constants(5.0)
    one = np.ones((4, 6))
    state = effects.make_state(robot, 0 * one, one, 0 * one, 0 * one, time=hours)
    torque = effects.get_effect("wear_drift").torque(
        state, 0, None, {"level": c1, "rate": c2, "exponent": 4.0, "start": 0.0}
    )
    np.testing.assert_allclose(torque, 5.0 * wear.growth(hours), atol=1e-12)


@pytest.mark.parametrize(("exponent", "coefficient", "may"), [(0.5, 1.0, True), (0.5, -1.0, False), (1.5, -1.0, True)])
def test_friction_that_falls_the_steeper_the_slower_is_not_nonlinear_viscous(exponent, coefficient, may):
    effect = effects.get_effect("nonlinear_viscous_friction")
    assert effect.possible({"exponent": exponent, "coefficient": coefficient}) == may


def test_friction_over_a_travel_goes_on_to_where_it_is_nothing_unless_it_is_a_law(state):
    """A curve over a third of a turn, gone on with as a wave, made a file twice as bad as the given one beyond."""
    place = np.linspace(-4.0, 4.0, 801)
    moving = replace(
        state,
        **{name: np.zeros((801, 6)) for name in ("acceleration", "load", "torque")},
        position=np.repeat(place[:, None], 6, axis=1),
        velocity=np.ones((801, 6)),
        temperature=np.full((801, 6), np.nan),
        time=np.arange(801.0),
        record=None,
    )
    friction = effects.get_effect("position_dependent_friction")
    wave = {"amplitude": 2.0, "order": 1.5, "phase": 0.3}
    everywhere = friction.torque(moving, 1, None, wave)
    assert everywhere == pytest.approx(2.0 * np.sin(1.5 * place + 0.3))
    seen = {**wave, "low": -1.0, "high": 0.9}
    torque = friction.torque(moving, 1, None, seen)
    inside = (place >= -1.0) & (place <= 0.9)
    assert np.array_equal(torque[inside], everywhere[inside])
    # Nothing jumps, and far beyond the file is as it was given.
    assert np.abs(np.diff(torque)).max() < 0.04
    assert not torque[np.abs(place) > 3.2].any()
    law = {**wave, "low": -4.0, "high": 4.4}
    assert np.array_equal(friction.torque(moving, 1, None, law), everywhere)
