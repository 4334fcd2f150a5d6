"""A unit that is stated and is not that of the data: told with the right one, whatever was stated."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import columns, layout, make_log, model, write_parquet

from jointwear.discovery.preflight import check_data
from jointwear.files.errors import InputError
from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.checks import check_recording
from jointwear.measurement.checks.position_unit import check_position_unit
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import load_recording
from jointwear.measurement.refused import Refused
from jointwear.monitor.reading.survey import survey_log
from jointwear.robots.robot import load_robot

EXAMPLE = "data/examples/puma560_hidden.nc"
SIZES = {"rad": 1.0, "deg": np.pi / 180, "rev": 2 * np.pi}


def remedy(**units):
    """What discovery advises where the example is said to be in these units."""
    recording = split(load_recording({"measured": EXAMPLE, "units": units}, "arm"))
    with pytest.raises(Refused) as refused:
        checked(recording, load_robot("config/robots/puma560.yaml"))
    return refused.value.suggestion


@pytest.mark.parametrize("stated", ["deg", "rev"])
def test_radians_that_are_stated_as_another_unit_are_told(stated):
    assert remedy(position=stated) == "state units: {position: rad}"


@pytest.mark.long
@pytest.mark.parametrize("stated", ["mN m", "kN m", "kgf m"])
def test_newton_metres_that_are_stated_as_another_unit_are_told(tmp_path, stated):
    assert remedy(torque=stated) == "state units: {torque: N m}"
    path = str(write_parquet(tmp_path / "log.parquet", columns(make_log(40.0))))
    with pytest.raises(Refused) as refused:
        survey_log(path, layout(units={"torque": stated}), model(), 12.0)
    assert refused.value.suggestion == "state units: {torque: N m}"


def test_amperes_that_are_stated_as_milliamperes_are_told(tmp_path):
    path = str(write_parquet(tmp_path / "log.parquet", columns(make_log(40.0))))
    with pytest.raises(Refused) as refused:
        survey_log(path, layout(units={"torque": "mA"}, torque_constant=[1.0] * 6), model(), 12.0)
    assert refused.value.suggestion == "state units: {torque: A}"


def test_a_unit_of_time_that_is_stated_is_not_advised():
    recording = split(load_recording({"measured": EXAMPLE, "units": {"time": "ms"}}, "arm"))
    with pytest.raises(Refused) as refused:
        check_data(recording, load_robot("config/robots/puma560.yaml"))
    assert "units: {time: s}" in refused.value.suggestion
    with pytest.raises(InputError, match=r"units: \{time: s\}"):
        load_recording({"measured": EXAMPLE, "units": {"time": "us"}}, "arm")


def test_celsius_that_is_stated_as_kelvin_is_told():
    assert remedy(temperature="K") == "state units: {temperature: degC}"


@pytest.mark.parametrize("stated", ["deg", "rev"])
def test_the_example_of_the_monitor_is_told_to_be_in_radians(stated):
    with pytest.raises(Refused) as refused:
        survey_log("data/examples/monitor_puma560/day_1.nc", layout(units={"position": stated}), model(), 12.0)
    assert refused.value.suggestion == "state units: {position: rad}"


def test_radians_that_are_far_outside_the_limits_once_read_as_revolutions_are_told(tmp_path):
    log = make_log(40.0)
    table = columns(log) | {"position_6": log.position[:, 5] + 2.0}
    path = str(write_parquet(tmp_path / "log.parquet", table))
    with pytest.raises(Refused, match="look like radians") as refused:
        survey_log(path, layout(units={"position": "rev"}), model(), 12.0)
    assert refused.value.suggestion.startswith("state units: {position: rad}")


@pytest.mark.parametrize(("truth", "stated"), [("rad", "deg"), ("rad", "rev"), ("deg", "rad"), ("deg", "rev")])
def test_the_first_log_of_the_monitor_is_held_to_the_stated_unit(tmp_path, truth, stated):
    log = make_log(40.0)
    table = columns(log) | {f"position_{j + 1}": q / SIZES[truth] for j, q in enumerate(log.position.T)}
    path = str(write_parquet(tmp_path / "log.parquet", table))
    survey_log(path, layout(units={"position": truth}), model(), 12.0)
    with pytest.raises(Refused) as refused:
        survey_log(path, layout(units={"position": stated}), model(), 12.0)
    assert f"state units: {{position: {truth}}}" in refused.value.suggestion


def test_measured_velocities_tell_of_the_stated_unit_of_the_positions(tmp_path):
    log = make_log(40.0)
    path = str(write_parquet(tmp_path / "log.parquet", columns(log, "position", "velocity", "torque")))
    with pytest.raises(Refused, match="the positions look like radians") as refused:
        survey_log(path, layout(units={"position": "deg"}), model(), 12.0)
    assert refused.value.suggestion == "state units: {position: rad}"
    with pytest.raises(Refused, match=r"velocity of joint 1 .* it looks like radians") as refused:
        survey_log(path, layout(units={"velocity": "deg/s"}), model(), 12.0)
    assert refused.value.suggestion == "state units: {velocity: rad/s}"


def test_without_motion_no_unit_is_told():
    robot = load_robot("config/robots/puma560.yaml")
    recording = split(load_recording({"measured": EXAMPLE}, "arm"))
    still = measure(replace(recording, position=0 * recording.position))
    for samples in (still, replace(still, position=np.nan * still.position)):
        check_position_unit(samples, robot, "arm", "deg")


def log_that_one_joint_tells(tmp_path):
    """A log whose third joint stands still; of the others all but the second are friction nearly alone."""
    log = make_log(40.0)
    still = np.where(np.arange(6) == 2, 0.0, 1.0)
    q, v, a = (log.position * still, log.velocity * still, log.acceleration * still)
    torque = model()(q, v, a).total
    torque += 0.01 * torque.std(axis=0) * np.random.default_rng(4).standard_normal(torque.shape)
    table = columns(replace(log, position=q, velocity=v, acceleration=a, torque=torque))
    return str(write_parquet(tmp_path / "log.parquet", table))


def test_radians_that_one_joint_alone_tells_are_those_of_all(tmp_path):
    path = log_that_one_joint_tells(tmp_path)
    survey_log(path, layout(), model(), 12.0)
    with pytest.raises(Refused, match="the positions look like radians, their stated unit is deg") as refused:
        survey_log(path, layout(units={"position": "deg"}), model(), 12.0)
    assert "state units: {position: rad}" in refused.value.suggestion


def test_a_joint_in_radians_among_others_in_degrees_is_the_odd_one(tmp_path):
    log = make_log(40.0)
    table = columns(log) | {f"position_{j + 1}": np.degrees(log.position[:, j]) for j in (0, 2, 3, 4, 5)}
    path = str(write_parquet(tmp_path / "log.parquet", table))
    with pytest.raises(Refused, match="position of joint 2 looks like radians taken for degrees, those of the others"):
        survey_log(path, layout(units={"position": "deg"}), model(), 12.0)


@pytest.mark.parametrize(
    ("degrees", "named"), [((0, 1, 2), "joints 1, 2 and 3"), ((3, 4, 5), "joints 4, 5 and 6"), ((3,), "joint 4")]
)
def test_joints_in_degrees_beside_others_in_radians_are_all_named(degrees, named):
    """One key holds for all: of half of the joints in degrees it alone was advised, and read the others so too."""
    robot = load_robot("config/robots/puma560.yaml")
    recording = split(load_recording({"measured": EXAMPLE}, "arm"))
    some = np.isin(np.arange(6), degrees)
    mixed = replace(recording, position=np.where(some, np.degrees(recording.position), recording.position))
    with pytest.raises(Refused) as refused:
        check_recording(mixed, robot)
    assert f"state units: {{position: deg}}; where the other joints are right, write {named} in their unit" in (
        refused.value.suggestion
    )
