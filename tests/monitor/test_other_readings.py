"""A later log that has to be read otherwise is told by what is wrong with it, whatever load the robot file lacks."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import LENGTH, columns, layout, make_log, model, read, survey_of, write_parquet

from jointwear.measurement.checks.axis_readings import Reading
from jointwear.monitor.reading.decade_of_torque import decade_of
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.other_readings import refusal_of
from jointwear.robots.robot import Link


def with_load(mass, seconds=48.0, seed=9):
    """A log of an arm that carries a load, which its file does not have."""
    log = make_log(seconds, seed=seed)
    body = Link(mass, np.array([0.05, -0.03, 0.1]), np.eye(3) * 0.003 * mass)
    free, loaded = (
        TorqueModel(arm)(log.position, log.velocity, log.acceleration).total
        for arm in (model().robot, replace(model().robot, payload=body))
    )
    return replace(log, torque=log.torque + loaded - free)


def written(path, log):
    return write_parquet(path, columns(log))


@pytest.mark.parametrize("role", ["torque", "position"])
def test_exchanged_columns_of_a_wrist_are_told_as_what_they_are(tmp_path, role):
    """Torques were told as positions, and positions as torques: one of the two joints was then explained better than
    before by as much as the other worse. Mended so, a log has two more wrong columns."""
    first, log = written(tmp_path / "first.parquet", with_load(2.0, seed=1)), with_load(2.0)
    values = getattr(log, role)[:, [0, 1, 2, 4, 3, 5]]
    found = read(written(tmp_path / "log.parquet", replace(log, **{role: values})), first)
    assert f"the {role}s of joints 4 and 5 look swapped against the first log" in found.refused[0]
    assert len(found.refused) == 1
    assert (found.statistics.count == 0).all()


def test_signs_of_all_torques_are_told_beside_another_product(tmp_path):
    """The model leaves more of the turned torques than in the first log, which had a lighter product."""
    first = written(tmp_path / "first.parquet", with_load(0.0, seed=1))
    other = with_load(2.0)
    assert read(written(tmp_path / "other.parquet", other), first).refused == ()
    found = read(written(tmp_path / "turned.parquet", replace(other, torque=-other.torque)), first)
    assert "the sign of the torque of joints 1, 2, 3, 4, 5 and 6 looks flipped" in found.refused[0]
    assert (found.statistics.count == 0).all()


@pytest.mark.parametrize(("factor", "unit"), [(100.0, "N cm"), (1000.0, "mN m")])
def test_a_unit_is_no_factor_of_each_joint_where_the_file_lacks_the_load(tmp_path, factor, unit):
    first, log = written(tmp_path / "first.parquet", with_load(6.0, seed=1)), with_load(6.0)
    found = read(written(tmp_path / "log.parquet", replace(log, torque=factor * log.torque)), first)
    assert f"about {factor:g} times those of the first log; it looks like {unit}, read as N m" in found.refused[0]
    assert (found.statistics.count == 0).all()


def test_a_power_of_ten_is_one_of_all_joints_and_has_the_unit_of_what_was_logged():
    usual = np.array([80.0, 90.0, 40.0, 10.0, 9.0, np.nan])
    assert decade_of(1.3 * usual, usual, "N m") is None
    assert decade_of(usual * [1000, 1000, 1, 1000, 1000, 1], usual, "N m") is None
    current = decade_of(1000 * usual, usual, "A")
    assert (current.power, current.unit, current.close) == (3, "mA", True)
    assert decade_of(10 * usual, usual, "N m").unit == ""
    assert not decade_of(usual * [100, 100, 100, 470, 100, 1], usual, "N m").close


def test_parts_of_a_log_with_exchanged_torques_are_refused_with_it(tmp_path, good):
    """A part in which the exchange is just below what is no chance was judged with the torque of another joint."""
    log = make_log(480.0, seed=9)
    torque = log.torque[:, [0, 1, 2, 4, 3, 5]]
    half = len(torque) // 2
    path = written(tmp_path / "log.parquet", replace(log, torque=np.r_[torque[:half], log.torque[half:]]))
    found = log_statistics(str(path), layout(), model(), survey_of(good), LENGTH)
    assert "the torques of joints 4 and 5 look swapped" in found.refused[0]
    assert (found.statistics.count[:19] == 0).all()
    assert (found.statistics.count[21:, :5] > 0).all()


def test_readings_that_explain_as_well_are_both_told():
    told = refusal_of("log", [Reading("torques", (3, 4)), Reading("positions", (3, 4))])
    assert "the torques of joints 4 and 5 look swapped; or the positions of joints 4 and 5 look swapped" in str(told)
    assert "; or exchange the positions of joints 4 and 5" in told.suggestion
