"""What a robot file does not have must not cost a robot its first log, and what it needs in vain must be told."""

import re
from dataclasses import asdict, replace

import numpy as np
import pytest
from discovery_cases import make_case
from monitor_logs import columns, layout, make_log, model, write_parquet

from jointwear.files.errors import InputError
from jointwear.measurement.checks.left_over import left_over
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.refused import Refused
from jointwear.monitor.events import Event
from jointwear.monitor.findings.misfits import misfit_findings
from jointwear.monitor.findings.read_findings import missing_temperature
from jointwear.monitor.findings.seen_growth import dead_band_findings
from jointwear.monitor.presentation.to_answer import asks_for_answer
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.misfit import misfit_of
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.reversals import reach_of
from jointwear.monitor.reading.survey import read_survey, survey_log
from jointwear.robots.robot import EffectEntry, Link, load_robot
from jointwear.studies.shop_floor.cell import draw_cell
from jointwear.studies.shop_floor.fast_path import survey_of

LENGTH = 12.0
VISCOUS = "temperature_dependent_viscous_friction"


def surveyed(tmp_path, log):
    path = write_parquet(tmp_path / "log.parquet", columns(log))
    return survey_log(str(path), layout(), model(), LENGTH)


@pytest.mark.parametrize("noise", [0.005, 0.01, 0.02])
def test_a_short_first_log_is_not_refused(tmp_path, noise):
    # Read with joints 4 and 5 exchanged the model leaves a hundred-thousandth of the torque too.
    assert surveyed(tmp_path, make_log(10.0, noise=noise)).left[3] < 0.01


def test_a_first_log_without_torque_decides_nothing(tmp_path):
    log = make_log(10.0)
    with pytest.raises(InputError, match=r"log\.parquet: no torque of any joint is a finite number"):
        surveyed(tmp_path, replace(log, torque=np.full_like(log.torque, np.nan)))


@pytest.mark.long
@pytest.mark.parametrize("index", [13, 21, 33])
def test_a_gripper_and_wear_of_a_shop_floor_do_not_look_turned_around(index):
    assert survey_of(draw_cell("choose", index)).rate == pytest.approx(50.0)


@pytest.mark.long
@pytest.mark.parametrize("mass", [1.0, 3.0])
@pytest.mark.parametrize("turned", [None, 1, 2])
def test_a_load_alone_refuses_nothing_and_hides_no_flip(tmp_path, mass, turned):
    body = Link(mass, np.array([0.05, -0.03, 0.1]), np.eye(3) * mass * 0.05**2)
    log = make_log(30.0)
    loaded = TorqueModel(replace(model().robot, payload=body))(log.position, log.velocity, log.acceleration).total
    loaded += 0.02 * loaded.std(axis=0) * np.random.default_rng(3).standard_normal(loaded.shape)
    if turned is None:
        surveyed(tmp_path, replace(log, torque=loaded))
        return
    sign = np.where(np.arange(6) == turned, -1.0, 1.0)
    with pytest.raises(Refused, match=f"sign of joint {turned + 1} looks flipped"):
        surveyed(tmp_path, replace(log, position=sign * log.position, torque=sign * loaded))


def test_an_axis_at_rest_in_the_first_log_takes_its_dead_band_from_those_that_move(tmp_path):
    log = make_log(20.0)
    rest = log.position.copy()
    rest[:, 5] = 0.3 + 1e-3 * np.sin(2 * np.pi * 0.8 * log.time)
    moving, still = surveyed(tmp_path, log).dead_band, surveyed(tmp_path, replace(log, position=rest)).dead_band
    assert still[:5] == pytest.approx(moving[:5])
    assert still[5] >= min(moving[:5]) > 2 * np.pi * 0.8 * 1e-3


@pytest.mark.long
def test_samples_that_are_missing_are_no_noise(tmp_path):
    """Rows that the logger dropped and values that are not finite, as many as a bad network loses."""
    log, random = make_log(60.0), np.random.default_rng(7)
    whole = surveyed(tmp_path, log)
    kept = random.random(len(log.time)) > 0.005
    dropped = replace(log, **{k: getattr(log, k)[kept] for k in ("time", "position", "torque")})
    holed = log.position.copy()
    holed[~kept] = np.nan
    for other in (dropped, replace(log, position=holed)):
        found = surveyed(tmp_path, other)
        assert found.dead_band == pytest.approx(whole.dead_band, rel=0.1)
        assert found.cutoff == pytest.approx(whole.cutoff, rel=0.1)


def test_a_log_full_of_holes_is_surveyed_all_the_same(tmp_path):
    log = make_log(60.0)
    kept = np.arange(len(log.time)) % 40 != 0
    found = surveyed(tmp_path, replace(log, **{k: getattr(log, k)[kept] for k in ("time", "position", "torque")}))
    assert np.isfinite(found.dead_band).all()


def test_a_dead_band_that_is_all_noise_is_told_where_an_axis_cannot_be_judged(tmp_path, statistics):
    log = make_log(60.0)
    rough = log.position.copy()
    rough[:, 1] += 2e-3 * np.random.default_rng(8).standard_normal(len(rough))
    found = surveyed(tmp_path, replace(log, position=rough))
    assert found.noisy == [False, True, False, False, False, False]
    unseen = np.array([True, True, False, False, False, False])
    baseline = np.arange(statistics.windows) < 2
    (told,) = dead_band_findings(statistics, baseline, unseen, found.noisy, found.dead_band)
    assert (told["axes"], told["time"]) == ([2], statistics.end[1])
    assert "state 'dead_band'" in told["words"]
    assert not dead_band_findings(statistics, baseline, ~unseen, found.noisy, found.dead_band)
    found.write(tmp_path / "survey.json")
    assert read_survey(tmp_path / "survey.json").noisy == found.noisy


@pytest.fixture(scope="module")
def statistics(tmp_path_factory):
    path = str(write_parquet(tmp_path_factory.mktemp("cold") / "log.parquet", columns(make_log(48.0))))
    survey = survey_log(path, layout(), model(), LENGTH)
    return log_statistics(path, layout(), model(), survey, LENGTH).statistics


def warm_robot(*axes):
    entries = (EffectEntry(VISCOUS, axis, None, {"coefficient": 1.0}) for axis in axes)
    return replace(model().robot, effects=tuple(entries))


def test_an_effect_without_its_temperature_is_told_once(statistics):
    (told,) = missing_temperature(statistics, warm_robot(2, 3))
    assert told["axes"] == [2, 3]
    assert told["time"] == statistics.start[0]
    assert "temperature-dependent viscous friction" in told["words"]
    assert "no temperature of axes 2 and 3:" in told["words"]


def test_only_axes_and_windows_that_lack_it_are_named(statistics):
    temperature = np.full(statistics.temperature.shape, 30.0)
    assert missing_temperature(replace(statistics, temperature=temperature), warm_robot(2, 3)) == []
    temperature[1, 2] = np.nan
    (told,) = missing_temperature(replace(statistics, temperature=temperature), warm_robot(2, 3))
    assert told["axes"] == [3]
    assert told["time"] == statistics.start[1]
    assert f"in 1 of {statistics.windows} windows" in told["words"]
    assert missing_temperature(statistics, model().robot) == []


@pytest.mark.parametrize(("rate", "reach"), [(10.0, 0), (25.0, 2), (50.0, 5)])
def test_dates_make_a_rate_no_slower(tmp_path, rate, reach):
    # Seconds since 1970 have no more than seven digits behind the point: 10 Hz are 9.99999998 Hz.
    log = make_log(30.0, start=1.767e9, rate=rate)
    survey = surveyed(tmp_path, log)
    assert survey.rate == pytest.approx(rate, rel=1e-6)
    assert reach_of(survey.rate) == reach
    slower = make_log(30.0, start=1.767e9, rate=9.5)
    with pytest.raises(InputError, match=r"sampled at 9\.5 Hz, .* or at least 10 Hz"):
        surveyed(tmp_path, slower)


def test_a_robot_file_that_leaves_most_of_an_axis_is_told_with_its_share(tmp_path, statistics):
    """It was stored as what later logs are compared with, and every axis was healthy."""
    arm = model().robot.links[1]
    bodies = (model().robot.links[0], replace(arm, com=arm.com[[1, 2, 0]]), *model().robot.links[2:])
    wrong = TorqueModel(replace(model().robot, links=bodies))
    path = write_parquet(tmp_path / "log.parquet", columns(make_log(60.0)))
    (told,) = misfit_findings(statistics, survey_log(str(path), layout(), wrong, LENGTH), [])
    assert told["axes"] == [2]
    assert asks_for_answer(told)
    assert "of the squared torque of axis 2 unexplained" in told["words"]
    assert misfit_findings(statistics, survey_log(str(path), layout(), model(), LENGTH), []) == []


@pytest.mark.parametrize("axis", [1, 2])
def test_a_zero_that_no_convention_has_is_the_reason_where_others_look_exchanged(tmp_path, axis):
    log = make_log(60.0)
    off = log.position + np.radians(27.0) * (np.arange(6) == axis)
    with pytest.raises(Refused, match=f"joint {axis + 1} looks counted from another zero, -2[67]"):
        surveyed(tmp_path, replace(log, position=off))


def test_a_zero_that_refuses_nothing_is_told_with_its_degrees(tmp_path, statistics):
    arm = load_robot("config/robots/puma560.yaml")
    plain = make_case(arm, 3)
    off = measure(replace(plain, position=plain.position + np.radians([0, 20, 0, 0, 0, 0])))
    misfit = misfit_of(off, arm, left_over(off, arm))
    found = replace(surveyed(tmp_path, make_log(20.0)), **asdict(misfit))
    (told,) = misfit_findings(statistics, found, [])
    assert told["axes"] == [2]
    assert asks_for_answer(told)
    assert re.search(r"add -(19|20)[.\d]* deg to the position of joint 2", told["words"])
    (answered,) = misfit_findings(statistics, found, [Event(0.0, (1,), "sensor")])
    assert not asks_for_answer(answered)
