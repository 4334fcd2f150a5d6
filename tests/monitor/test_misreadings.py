"""A first log that is read wrongly is refused for the right reason, with the key that mends it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import columns, layout, make_log, model, write_parquet

from jointwear.measurement.checks.torque_scale import WrongScale
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import Refused
from jointwear.monitor.reading import misreadings
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.survey import survey_log
from jointwear.robots.robot import Link

LENGTH = 12.0
#: Torque per current [N m/A] and rated torque [N m] of each axis; exchange of axes 2 and 3.
CONSTANT, RATED = np.array([25.0, 30.0, 20.0, 5.0, 5.0, 4.0]), np.array([97.0, 186.0, 89.0, 24.0, 20.0, 21.0])
ORDER = [0, 2, 1, 3, 4, 5]
LOG = make_log(40.0, noise=0.01)
DEGREE = 180 / np.pi


_MEASURED = Measured(
    time=LOG.time,
    trajectory=np.zeros(len(LOG.time), dtype=int),
    position=LOG.position,
    velocity=LOG.velocity,
    acceleration=LOG.acceleration,
    torque=LOG.torque,
    temperature=np.full_like(LOG.torque, np.nan),
    usable=np.ones(LOG.torque.shape, dtype=bool),
    cutoff=np.full(6, np.nan),
    rate=1.0,
    speed_floor=np.full(6, 0.01),
)


def turned(axis):
    return np.where(np.arange(6) == axis - 1, -1.0, 1.0)


def survey(tmp_path, roles=("position", "torque"), entry=None, **changed):
    path = write_parquet(tmp_path / "log.parquet", columns(replace(LOG, **changed), *roles))
    return survey_log(str(path), layout(**(entry or {})), model(), LENGTH)


WRONG = {
    "current": ({"torque": LOG.torque / CONSTANT}, "looks like a current", "torque_constant"),
    "current, two axes exchanged": ({"torque": (LOG.torque / CONSTANT)[:, ORDER]}, "looks like a current", "scale"),
    "per mille of a rating": ({"torque": 1e3 * LOG.torque / RATED}, "share of a rating", "scale"),
    "mN m": ({"torque": 1e3 * LOG.torque}, "looks like mN m", "units: {torque: mN m}"),
    "motor's side": ({"torque": LOG.torque / 60}, "multiple of the model's", "scale"),
    "torque turned": ({"torque": LOG.torque * turned(2)}, "sign of the torque of joint 2", "'scale' with -1"),
    "axis turned": (
        {"torque": LOG.torque * turned(3), "position": LOG.position * turned(3)},
        "sign of joint 3 looks flipped",
        "'sign' with -1",
    ),
    "axes exchanged": (
        {"torque": LOG.torque[:, ORDER], "position": LOG.position[:, ORDER]},
        "joints 2 and 3 look swapped",
        "'variables'",
    ),
    "degrees": ({"position": DEGREE * LOG.position}, "look like degrees", "units: {position: deg}"),
    "degrees, one axis turns on and on": (
        {"position": DEGREE * LOG.position + 3600 * (np.arange(6) == 5)},
        "look like degrees",
        "units: {position: deg}",
    ),
    "thousandths of a radian": ({"position": 1e3 * LOG.position}, "another unit", "'variables'"),
    "no torque": ({"torque": 0 * LOG.torque}, "keeps one value", "'variables'"),
}


@pytest.mark.parametrize("name", WRONG)
def test_the_reason_and_the_key_are_right(tmp_path, name):
    changed, reason, key = WRONG[name]
    with pytest.raises(Refused) as refused:
        survey(tmp_path, **changed)
    assert reason in str(refused.value)
    assert key in refused.value.suggestion


@pytest.mark.parametrize(("factor", "key"), [(DEGREE, "velocity: deg/s"), (1 / DEGREE, "position: deg")])
def test_a_velocity_in_another_unit_than_the_position_is_told(tmp_path, factor, key):
    with pytest.raises(Refused) as refused:
        survey(tmp_path, ("position", "velocity", "torque"), velocity=factor * LOG.velocity)
    assert key in refused.value.suggestion


@pytest.mark.parametrize(
    ("changed", "entry"),
    [
        ({"torque": LOG.torque / CONSTANT}, {"torque_constant": CONSTANT.tolist(), "units": {"torque": "A"}}),
        ({"torque": 1e3 * LOG.torque / RATED}, {"scale": (1e-3 * RATED).tolist()}),
        ({"torque": LOG.torque * turned(2)}, {"scale": turned(2).tolist()}),
        ({"torque": LOG.torque * turned(3), "position": LOG.position * turned(3)}, {"sign": turned(3).tolist()}),
        ({"position": DEGREE * LOG.position}, {"units": {"position": "deg"}}),
        ({}, {}),
    ],
)
def test_the_keys_mend_it(tmp_path, changed, entry):
    assert max(x for x in survey(tmp_path, entry=entry, **changed).left if x is not None) < 0.02


def test_a_load_that_takes_the_wrong_scale_away_is_told_as_the_other_cause(monkeypatch):
    found = misreadings.WrongScale("the torque is another multiple", "give 'scale'", 0.01)
    for lighter, left, told in (("lighter", None, True), ("lighter", found, False), (None, None, False)):
        monkeypatch.setattr(misreadings, "without_load", lambda *_, x=lighter: x)
        monkeypatch.setattr(misreadings, "thinned", lambda x: x)
        monkeypatch.setattr(misreadings, "wrong_scale", lambda *_, x=left: x)
        scale = misreadings._or_a_load(found, LOG, model().robot)
        assert ("carries a load that its file does not have" in scale.reason) == told
        assert ("'payload' of the robot file" in scale.remedy) == told
        assert scale.remedy.endswith("give 'scale'")


def mounted(gravity, payload=None):
    """The log of the same motion on an arm that gravity pulls another way [m/s2]."""
    robot = replace(model().robot, gravity=np.array(gravity), **({"payload": payload} if payload else {}))
    torque = TorqueModel(robot)(LOG.position, LOG.velocity, LOG.acceleration).total
    return torque + 0.01 * torque.std(axis=0) * np.random.default_rng(4).standard_normal(torque.shape)


SLOPE = [9.81 * np.sin(np.radians(50)), 0.0, -9.81 * np.cos(np.radians(50))]


@pytest.mark.parametrize(
    ("gravity", "told"),
    [([0, -9.81, 0], "[0, -9.81, 0]"), ([9.81, 0, 0], "[9.81, 0, 0]"), ([0, 0, 9.81], "[0, 0, 9.81]"), (SLOPE, "[")],
)
@pytest.mark.parametrize("mass", [0.0, 3.0])
def test_another_mounting_is_told_with_its_gravity(tmp_path, gravity, told, mass):
    load = Link(mass, np.array([0.05, -0.03, 0.1]), np.eye(3) * mass * 0.05**2) if mass else None
    with pytest.raises(Refused) as refused:
        survey(tmp_path, torque=mounted(gravity, load))
    assert f"gravity along {told}" in str(refused.value)
    assert f"'gravity: {told}" in refused.value.suggestion


def test_a_floor_that_slopes_a_little_is_no_other_mounting(tmp_path):
    gravity = [9.81 * np.sin(np.radians(5)), 0.0, -9.81 * np.cos(np.radians(5))]
    survey(tmp_path, torque=mounted(gravity))


def test_a_clock_at_another_speed_is_told_with_its_factor(tmp_path):
    # At the speed of the task inertial torques are too small to tell.
    velocity, acceleration = 4 * LOG.velocity, 16 * LOG.acceleration
    torque = TorqueModel(model().robot)(LOG.position, velocity, acceleration).total
    right = {"time": LOG.time / 4, "torque": torque}
    survey(tmp_path, **right)
    with pytest.raises(Refused, match="inertial torques of all joints") as refused:
        survey(tmp_path, **right | {"time": 0.8 * LOG.time / 4})
    told = float(refused.value.suggestion.split("divide the times by ")[1].split(",")[0])
    assert told == pytest.approx(0.8, rel=0.03)


@pytest.mark.parametrize(
    ("entry", "advice"),
    [
        ({"sign": turned(3).tolist()}, "'sign' has -1 for joint 3: take 'sign' out"),
        ({"scale": turned(2).tolist()}, "'scale' has -1 for joint 2: take 'scale' out"),
        ({"scale": (1.5 * turned(2)).tolist()}, "'scale' has -1.5 for joint 2: make that 1.5"),
    ],
)
def test_a_key_that_is_wrong_is_not_advised_again(tmp_path, entry, advice):
    with pytest.raises(Refused) as refused:
        survey(tmp_path, entry=entry)
    assert refused.value.suggestion == advice


def test_a_torque_constant_of_what_is_no_current_is_to_be_taken_out(tmp_path):
    with pytest.raises(Refused, match="times 'torque_constant'; it looks like N m as it is logged") as refused:
        survey(tmp_path, entry={"torque_constant": CONSTANT.tolist()})
    assert refused.value.suggestion.startswith("take 'torque_constant' out")


@pytest.mark.parametrize("what_is_left", ["nothing", "axes exchanged", "another scale"])
def test_factors_and_axes_that_a_load_explains_are_no_current(monkeypatch, what_is_left):
    """A gripper and a part on half of the moves of a light arm: three factors, and joints that look exchanged."""
    scale = WrongScale("it looks like a current", "give 'torque_constant'", 0.05)
    monkeypatch.setattr(misreadings, "thinned", lambda x: x)
    monkeypatch.setattr(misreadings, "check_reach", lambda *_: None)
    monkeypatch.setattr(misreadings, "check_size", lambda *_: None)
    monkeypatch.setattr(misreadings, "_read_as_rad", lambda *_: None)
    lighter = replace(_MEASURED, time=_MEASURED.time + 1)
    monkeypatch.setattr(misreadings, "without_load", lambda *_: lighter)
    left = scale if what_is_left == "another scale" else None
    monkeypatch.setattr(misreadings, "wrong_scale", lambda x, *_: left if x is lighter else scale)
    monkeypatch.setattr(misreadings, "a_load_explains", lambda *_: True)

    def check(samples):
        if samples is not lighter or what_is_left == "axes exchanged":
            raise Refused("joints 2 and 3 look swapped", "exchange them")

    if what_is_left == "nothing":
        misreadings.check_readings(_MEASURED, model().robot, check, "log")
    else:
        told = "swapped" if what_is_left == "axes exchanged" else "current"
        with pytest.raises(Refused, match=told):
            misreadings.check_readings(_MEASURED, model().robot, check, "log")
