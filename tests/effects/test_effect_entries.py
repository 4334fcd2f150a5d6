"""Every effect by itself: what is fitted can be written, forms bend within bounds, signs, tilt, new files."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear import effects
from jointwear.effects.effect import correction_torque
from jointwear.effects.entries.presliding_hysteresis import EFFECT as HYSTERESIS
from jointwear.effects.needs import ALL as NEEDS
from jointwear.effects.order import lagged, late_torque
from jointwear.files.errors import InputError
from jointwear.files.schemas import check, read_schema
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import gravity_regressor, inertial_regressor, to_joint_frame
from jointwear.robots.robot import EffectEntry, load_robot, robot_from_data
from jointwear.robots.robot_file import read_robot_file

NAMES = sorted(name for name, effect in effects.library().items() if effect.identifiable)


@pytest.fixture(scope="module")
def robot():
    return load_robot("config/robots/puma560.yaml")


@pytest.fixture(scope="module")
def content():
    return read_robot_file("config/robots/puma560.yaml")


def motion(robot, seconds=4.0, rate=100.0):
    time = np.arange(0, seconds, 1 / rate)
    speed = np.linspace(1.0, 2.2, 6)
    phase = np.outer(time, speed) + np.arange(6)
    return time, 0.8 * np.sin(phase), 0.8 * speed * np.cos(phase), -0.8 * speed**2 * np.sin(phase)


@pytest.fixture(scope="module")
def state(robot):
    time, q, v, a = motion(robot)
    dynamics = Dynamics(robot)
    tip = inertial_regressor(dynamics, q, v, a)[:, :, -10:] @ to_joint_frame(robot, 5)
    pull = gravity_regressor(robot, q)
    return effects.make_state(
        robot,
        q,
        v,
        a,
        np.array(dynamics.rigid_body_torque(q, v, a)),
        time=time,
        temperature=30 + 5 * np.sin(0.5 * time),
        record=np.repeat([0, 1], len(time) // 2),
        tip_regressor=lambda: tip,
        gravity_regressor=lambda: pull,
    )


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=8, deadline=None)
@given(data=st.data())
def test_whatever_is_fitted_can_be_written_and_read_again(content, state, name, data):
    effect = effects.get_effect(name)
    source = 3 if effect.needs_source else None
    nonlinear = data.draw(st.sampled_from(list(effect.grid(state, 2))))
    width = effect.columns(state, 2, source, nonlinear).shape[-1]
    numbers = st.floats(-1e7, 1e7, allow_nan=False)
    coefficients = np.array(data.draw(st.lists(numbers, min_size=width, max_size=width)))
    parameters = effect.complete(effect.parameters_of(nonlinear, coefficients))
    written = [parameters]
    if effect.bend is not None and effect.bend.written is not None:
        used = np.ones(len(state.time), bool)
        knots = None if effect.bend.knots is None else effect.bend.knots(state, 2, source, nonlinear, used)
        size = effect.bend.columns(state, 2, source, nonlinear, knots).shape[1]
        bends = np.array(data.draw(st.lists(numbers, min_size=size, max_size=size)))
        written = effect.bend.written(parameters, knots, bends)
    if effect.writes is not None:
        content = effect.writes(content, effect.bounded(parameters))
    else:
        axis = {"axis": 3, "source_axis": None if source is None else source + 1}
        entries = [{"effect": name, **axis, "parameters": _plain(effect.bounded(p))} for p in written]
        content = {**content, "effects": entries}
    check(content, read_schema("robot"), "robot.yaml")
    effects.check_effects(robot_from_data(content))


def _plain(parameters):
    table = parameters.get("correction")
    more = {"correction": {k: [float(x) for x in v] for k, v in table.items()}} if table else {}
    return {k: float(v) for k, v in parameters.items() if k != "correction"} | more


@settings(max_examples=40, deadline=None)
@given(st.floats(0.01, 5), st.lists(st.floats(-2, 2), min_size=4, max_size=4), st.floats(0.005, 0.2))
def test_loops_of_hysteresis_never_drive_and_follow_the_fit(level, bends, distance):
    written = HYSTERESIS.bend.written({"level": level, "distance": distance}, None, np.array(bends))
    assert all(HYSTERESIS.possible(p) for p in written)
    # A file holds loops of distances within the bounds of the effect alone.
    if min(bends) >= 0 and distance * 0.3 > 0.004 and distance * 3.5 < 0.3:
        travel = np.linspace(0, distance, 50)
        factors = distance * np.array([1, 0.3, 0.6, 1.7, 3.5])
        wanted = np.exp(-travel[:, None] / factors) @ np.array([level, *bends])
        got = sum(p["level"] * np.exp(-travel / p["distance"]) for p in written)
        np.testing.assert_allclose(got, wanted, rtol=1e-6, atol=1e-6 * (level + sum(bends)))


@pytest.mark.parametrize("sign", [1, -1])
def test_a_torque_constant_may_change_either_way(state, sign):
    effect = effects.get_effect("torque_constant_temperature")
    nonlinear = effect.grid(state, 1)[0]
    parameters = effect.parameters_of(nonlinear, np.array([sign * 0.002, 0.0]))
    assert effect.possible(parameters)
    warm = state.temperature[:, 1] > parameters["reference"] + 1
    torque = effect.torque(state, 1, None, effect.complete(parameters))
    # A constant that falls as the motor warms takes more current: the recorded torque is too large, not too small.
    assert np.all(sign * torque[warm] * state.torque[warm, 1] >= 0)


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.003, 0.003).filter(lambda s: abs(s) > 1e-4), st.floats(-20.0, 80.0))
def test_the_temperature_at_which_a_gain_is_right_is_read_off_the_data(state, slope, reference):
    effect = effects.get_effect("torque_constant_temperature")
    wanted = {"slope": slope, "reference": reference}
    torque = effect.torque(state, 1, None, wanted)
    nonlinear = effect.grid(state, 1)[0]
    columns = effect.columns(state, 1, None, nonlinear)
    found = effect.parameters_of(nonlinear, np.linalg.lstsq(columns, torque, rcond=None)[0])
    assert found == pytest.approx(wanted, rel=1e-6)
    # A gain that is off and does not change has no such temperature.
    assert not effect.possible(effect.parameters_of(nonlinear, np.array([0.0, 0.05])))


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.02, 0.02).filter(lambda d: abs(d) > 1e-3))
def test_delays_and_lags_have_a_sign(state, delay):
    effect = effects.get_effect("actuation_delay")
    wave = np.sin(3 * state.time)
    for lag in (0, 1):
        torque = effect.torque(state, 1, None, {"delay": delay, "lag": lag})
        slope = np.gradient(state.torque[:, 1], state.time)
        calm = np.abs(state.velocity[:, 1]) > 0.4
        assert np.sign(np.sum(torque[calm] * slope[calm])) == -np.sign(delay)
    away = slice(60, 140)
    np.testing.assert_allclose(
        lagged(state, wave, delay)[away], np.sin(3 * (state.time - delay))[away], atol=2 * (3 * delay) ** 2 + 1e-4
    )
    back = late_torque(state, 1, -delay) - state.torque[:, 1]
    there = late_torque(state, 1, delay) - state.torque[:, 1]
    calm = np.abs(state.velocity[:, 1]) > 0.4
    assert np.corrcoef(back[calm], there[calm])[0, 1] < -0.9


def test_delays_that_searches_start_from_are_worked_out_once_for_a_state(state):
    effect = effects.get_effect("actuation_delay")
    delays = [*effect.grid(state, 1), {"delay": 0.007, "lag": 0}]
    once = [effect.columns(state, 1, None, p) for p in delays]
    again = [effect.columns(state, 1, None, p) for p in delays]
    assert [a is b for a, b in zip(once, again, strict=True)] == [True] * 12 + [False]
    # What is kept belongs to this torque: another state of the same motion has its own.
    other = effect.columns(replace(state, torque=2.0 * state.torque, drive=state.drive), 1, None, delays[0])
    assert np.abs(other - once[0]).max() > 0.1 * np.abs(once[0]).max()
    np.testing.assert_array_equal(once[-1], again[-1])


def test_unequal_levels_of_friction_fall_by_the_same_share(state, robot):
    """The PUMA's levels differ: warm, both lose their share, and only equal ones lose as much either way."""
    effect = effects.get_effect("temperature_dependent_coulomb_friction")
    plain = effect.plain(state, 1)[0]
    torque = effect.torque(state, 1, None, effect.complete({**plain, "slope": 0.1}))
    level = robot.coulomb(state.velocity)[:, 1]
    warm = state.temperature[:, 1] - plain["reference"]
    mean = 0.5 * (robot.coulomb_positive[1] - robot.coulomb_negative[1])
    np.testing.assert_allclose(torque, -0.1 * warm * level / mean, rtol=1e-3, atol=1e-9)
    assert {p["unequal"] for p in effect.grid(state, 1)} == {plain["unequal"], 0.0}
    level_arm = replace(state.drive, coulomb_negative=-state.drive.coulomb_positive)
    assert [p["unequal"] for p in effect.grid(replace(state, drive=level_arm), 1)] == [0.0] * 3


@pytest.mark.parametrize("identifier", ["wear_drift", "position_dependent_friction", "stribeck_friction"])
def test_unequal_levels_of_friction_change_by_the_same_share(state, robot, identifier):
    """What a form adds is in one proportion to the friction of either direction, and equal where the levels are."""
    effect = effects.get_effect(identifier)
    grid = effect.grid(state, 1)
    proportional, equal = ({**p, "unequal": p["unequal"]} for p in (grid[0], grid[-1]))
    assert equal["unequal"] == 0.0
    one, other = (effect.columns(state, 1, None, p) for p in (proportional, {**proportional, "unequal": 0.0}))
    mean = 0.5 * (robot.coulomb_positive[1] - robot.coulomb_negative[1])
    still = other == 0
    np.testing.assert_allclose(
        one[~still] / other[~still],
        np.broadcast_to(np.abs(robot.coulomb(state.velocity)[:, 1] / mean)[:, None], one.shape)[~still],
        rtol=1e-3,
    )
    level_arm = replace(state.drive, coulomb_negative=-state.drive.coulomb_positive)
    assert {p["unequal"] for p in effect.grid(replace(state, drive=level_arm), 1)} == {0.0}


def test_a_spring_carries_its_preload(state):
    effect = effects.get_effect("joint_spring")
    nonlinear = effect.grid(state, 1)[0]
    columns = effect.columns(state, 1, None, nonlinear)
    fit = np.linalg.lstsq(columns, 10.7 + 3 * state.position[:, 1], rcond=None)[0]
    found = effect.parameters_of(nonlinear, fit)
    assert found["preload"] - 3 * found["centre"] == pytest.approx(10.7, abs=1e-9)
    assert len(effect.widths) == columns.shape[1]


def test_a_spring_goes_on_straight_beyond_its_travel_and_so_does_its_correction(state):
    effect = effects.get_effect("joint_spring")
    found = {"centre": 0.0, "low": -1.0, "high": 1.0, "stiffness": 2.0, "quadratic": 0.5, "cubic": 0.1, "preload": -3.0}
    (bent,) = effect.bend.written(found, np.array([-1.0, 0.0, 0.5, 1.0]), np.array([0.1, 0.0, 0.0, -0.2]))

    def torque(places, parameters):
        one = replace(state, position=np.repeat(np.array(places)[:, None], state.position.shape[1], axis=1))
        return effect.torque(one, 1, None, parameters) + correction_torque(effect, one, 1, parameters)

    for parameters, slope in ((found, 3.3), (bent, 2.9)):
        edge, near, last, beyond = torque([1.0, 1.5, 3.0, 9.0], parameters)
        np.testing.assert_allclose([near - edge, last - edge, beyond], [0.5 * slope, 2.0 * slope, last], rtol=1e-12)


def test_friction_under_load_may_differ_with_the_direction(state):
    effect = effects.get_effect("load_dependent_friction")
    plain = {"coefficient": 0.1, "exponent": 1.0}
    same = effect.torque(state, 1, None, effect.complete({**plain, "driven": 0.1, "directional": 1}))
    np.testing.assert_allclose(same, effect.torque(state, 1, None, effect.complete(plain)), atol=1e-12)
    one = effect.torque(state, 1, None, effect.complete({**plain, "driven": 0.0, "directional": 1}))
    driven = state.load[:, 1] * state.velocity[:, 1] < 0
    assert not np.any(one[driven])
    assert np.all(one[~driven] * state.velocity[~driven, 1] >= 0)
    assert any(p.get("directional") for p in effect.grid(state, 1))


@pytest.mark.parametrize("gravity", [(0, 0, -9.81), (9.81, 0, 0), (0, -9.0, 3.0)])
@settings(max_examples=8, deadline=None)
@given(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_a_tilted_base_is_gravity_from_elsewhere(robot, gravity, about_x, about_y):
    effect = effects.get_effect("mounting_tilt")
    arm = replace(robot, gravity=np.array(gravity, dtype=float))
    _, q, v, a = motion(arm, 0.5)
    pull = gravity_regressor(arm, q)
    level = Dynamics(arm).rigid_body_torque(q, v, a)
    state = effects.make_state(arm, q, v, a, level, gravity_regressor=lambda: pull)
    parameters = {"about_x": about_x, "about_y": about_y}
    content = effect.writes({"gravity": list(gravity)}, parameters)
    assert np.linalg.norm(content["gravity"]) == pytest.approx(np.linalg.norm(gravity))
    tilted = Dynamics(replace(arm, gravity=np.array(content["gravity"]))).rigid_body_torque(q, v, a)
    np.testing.assert_allclose(effect.torque(state, 0, None, parameters), tilted - level, atol=1e-9)
    angle = np.hypot(about_x, about_y)
    linear = effect.columns(state, 0, None, {}) @ np.array([about_x, about_y])
    held = np.abs(pull).sum(axis=2).max() * np.linalg.norm(gravity)
    assert np.abs(linear - (tilted - level)).max() <= 0.6 * angle**2 * held + 1e-9
    back = effect.parameters_of({}, np.sin(angle) / max(angle, 1e-12) * np.array([about_x, about_y]))
    assert (back["about_x"], back["about_y"]) == pytest.approx((about_x, about_y), abs=1e-9)


def test_needs_are_known_and_say_what_is_missing(robot, state):
    for effect in effects.library().values():
        assert set(effect.needs) <= set(NEEDS)
        if effect.identifiable:
            assert effect.unmet(state, 2) == ""
    bare = replace(
        state,
        temperature=np.full_like(state.temperature, np.nan),
        record=None,
        tip_regressor=None,
        gravity_regressor=None,
        drive=replace(state.drive, gear_ratio=np.ones(6)),
    )
    missing = {e.identifier: e.unmet(bare, 2) for e in effects.library().values()}
    assert "gear ratio" in missing["cogging_torque"]
    assert "temperature" in missing["torque_constant_temperature"]
    assert "order" in missing["actuation_delay"]
    assert missing["payload"]
    assert missing["mounting_tilt"]
    assert missing["backlash"]
    assert missing["stribeck_friction"] == ""
    behind = replace(state, torque_kind="link_sensor")
    assert "behind the gear" in effects.get_effect("torque_constant_ripple").unmet(behind, 2)
    # A file with friction there knows of friction behind the sensor; one without has none to change.
    assert effects.get_effect("stribeck_friction").unmet(behind, 2) == ""
    zero = np.zeros(6)
    bare = replace(behind, drive=replace(behind.drive, viscous=zero, coulomb_positive=zero, coulomb_negative=zero))
    assert "no friction there" in effects.get_effect("stribeck_friction").unmet(bare, 2)
    assert effects.get_effect("payload").unmet(behind, 2) == ""


NEW = '''
"""A worn stop."""
import numpy as np
from jointwear.effects.effect import Effect, Parameter

def _columns(state, axis, source, p):
    return np.tanh((state.position[..., axis] - p["edge"]) / 0.05)[..., None]

EFFECT = Effect(
    identifier="worn_stop", name="Worn stop", equation="t tanh((q - q0)/0.05)",
    parameters=(Parameter("torque", "N m", 0.0, 1e4, "t"), Parameter("edge", "rad", -9.0, 9.0, "q0")),
    confused_with=("joint_spring",), excitation="both sides", source="a test", argument="position",
    argument_unit="rad", columns=_columns,
    torque=lambda state, axis, source, p: p["torque"] * _columns(state, axis, source, p)[..., 0],
    parameters_of=lambda p, c: {**p, "torque": float(c[0])},
    grid=lambda state, axis: [{"edge": float(x)} for x in np.quantile(state.position[..., axis], (0.3, 0.5, 0.7))],
)
'''


def test_a_file_in_another_folder_is_an_effect(robot, state, tmp_path):
    (tmp_path / "worn_stop.py").write_text(NEW, encoding="utf-8")
    with pytest.raises(InputError, match="unknown effect"):
        effects.get_effect("worn_stop")
    with effects.more_entries(tmp_path):
        effect = effects.get_effect("worn_stop")
        assert effect.unmet(state, 0) == ""
        entry = EffectEntry("worn_stop", 1, None, {"torque": 2.0, "edge": 0.0})
        torque = effects.effect_torque(replace(robot, effects=(entry,)), state)
        np.testing.assert_allclose(torque[:, 0], 2 * np.tanh(state.position[:, 0] / 0.05))
    assert "worn_stop" not in effects.library()


def test_content_of_a_robot_file_with_a_payload_is_a_body(content):
    effect = effects.get_effect("payload")
    parameters = effect.complete({"mass": 1.2, "moment_x": 0.3, "xx": -5.0})
    base, content = content, effect.writes({"payload": {"mass": 0.5, "com": [0.0, 0.1, 0.0]}}, parameters)
    assert content["payload"]["mass"] == pytest.approx(1.7)
    assert robot_from_data({**base, **content}).payload.com == pytest.approx([0.3 / 1.7, 0.05 / 1.7, 0.0])


@settings(max_examples=30, deadline=None)
@given(
    st.floats(0.1, 20.0),
    st.lists(st.floats(-0.4, 0.4), min_size=3, max_size=3),
    st.lists(st.floats(1e-3, 0.5), min_size=3, max_size=3),
)
def test_a_sound_payload_is_a_body_and_a_light_one_with_its_moments_is_none(mass, com, moments):
    payload = effects.get_effect("payload")
    com = np.abs(com) + 0.1
    about = np.diag(moments) + mass * (com @ com * np.eye(3) - np.outer(com, com))
    moment = dict(zip(("moment_x", "moment_y", "moment_z"), mass * com, strict=True))
    pairs = {"xx": (0, 0), "xy": (0, 1), "yy": (1, 1), "xz": (0, 2), "yz": (1, 2), "zz": (2, 2)}
    parameters = {"mass": mass, **moment, **{k: float(about[i]) for k, i in pairs.items()}}
    assert payload.sound(parameters)
    written = payload.writes({}, parameters)["payload"]
    np.testing.assert_allclose(written["com"], com, rtol=1e-6)
    np.testing.assert_allclose(written["inertia"][:3], moments, rtol=1e-5, atol=1e-9)
    # The same moments on next to no mass would be those of no body.
    assert not payload.sound({**parameters, "mass": 1e-4 * mass})
    assert not payload.sound({**parameters, "mass": -mass})


def test_a_plain_form_is_one_that_is_searched(state):
    """Where the data leave a scale open it is the usual one: another would grow beyond what was recorded."""
    for name, effect in effects.library().items():
        if name.startswith("temperature_dependent"):
            (plain,) = effect.plain(state, 1)
            assert plain in effect.grid(state, 1)
            assert plain["scale"] == next(p.default for p in effect.parameters if p.name == "scale")


def test_the_words_of_an_argument_are_those_of_its_values():
    for effect in effects.library().values():
        assert effect.argument_in_words in (effect.argument, "position")
    # A rate of torque and a second derivative are no values of the argument: the position is told instead.
    assert effects.get_effect("joint_flexibility").argument_in_words == "position"
    assert effects.get_effect("actuation_delay").argument_in_words == "position"
    assert effects.get_effect("stribeck_friction").argument_in_words != "position"
    assert effects.get_effect("payload").argument_in_words == effects.get_effect("payload").argument
