"""A later torque in another unit, without sign or at a limit is told and not judged; wear and gains are judged."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import LENGTH, columns, flagged, layout, make_log, model, read, write_parquet

from jointwear.measurement.flags import Flag
from jointwear.monitor.findings import reading_findings
from jointwear.monitor.logs import log_statistics
from jointwear.monitor.survey import survey_log

SCALES = {
    "current": -1.0 / np.array([11.8, -23.6, 10.8, -5.7, -4.7, -5.1]),
    "share of a rating": 100 / np.array([97.6, 186.4, 89.4, 24.2, 20.1, 21.3]),
    "N mm": np.full(6, 1e3),
    "kgf m": np.full(6, 1 / 9.80665),
}


@pytest.mark.parametrize("kind", SCALES)
def test_a_later_torque_in_another_unit_is_refused(tmp_path, good, kind):
    log = make_log(48.0, seed=12)
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=log.torque * SCALES[kind])))
    found = read(path, good)
    assert len(found.refused) == 1
    assert "another multiple" in found.refused[0]
    assert "write the torque of this log" in found.refused[0]
    assert (found.statistics.count == 0).all()


@pytest.mark.parametrize("axes", [slice(2, 3), slice(None)])
@pytest.mark.parametrize("factor", [0.74, 1.05, 1.15, 1.3])
def test_a_gain_is_no_other_unit(tmp_path, good, axes, factor):
    log = make_log(48.0, seed=13)
    log.torque[:, axes] *= factor
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert found.refused == ()
    assert found.statistics.judgeable[:, :5].all()


@pytest.mark.parametrize(("axes", "times"), [([2], 5.0), ([0], 3.0), (slice(None), 3.0)])
def test_friction_that_multiplied_is_judged(tmp_path, good, axes, times):
    log = make_log(48.0, seed=14)
    robot = model().robot
    log.torque[:, axes] += (times - 1) * (np.sign(log.velocity) * np.abs(robot.coulomb_positive))[:, axes]
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert found.refused == ()
    assert found.statistics.judgeable[:, :5].all()


def test_a_torque_that_the_model_does_not_know_is_not_judged(tmp_path, good):
    log = make_log(48.0, seed=15)
    whole = np.abs(log.torque)
    found = read(write_parquet(tmp_path / "abs.parquet", columns(replace(log, torque=whole))), good)
    assert not found.statistics.judgeable[:, :5].any()
    log.torque[:, 2] = np.random.default_rng(0).permutation(log.torque[:, 2])
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert found.refused == ()
    assert flagged(found, Flag.CONTRADICTED, 2)
    assert not found.statistics.judgeable[:, 2].any()
    assert found.statistics.judgeable[:, :2].all()
    (told,) = reading_findings(found.statistics)
    assert told["axes"] == [3]
    assert "none that the model and the first log know" in told["words"]


def test_another_unit_from_the_middle_of_a_log_on(tmp_path, good):
    log = make_log(96.0, seed=3)
    log.torque[len(log.time) // 2 :] *= 1000.0
    survey = survey_log(str(good), layout(), model(), LENGTH)
    found = log_statistics(
        str(write_parquet(tmp_path / "log.parquet", columns(log))), layout(), model(), survey, LENGTH
    )
    assert "another multiple" in found.refused[0]
    assert (found.statistics.count[:3, :5] > 0).all()
    assert (found.statistics.count[4:] == 0).all()


def test_what_lies_at_a_limit_of_the_torque_is_left_out(tmp_path, good):
    log = make_log(48.0, seed=16)
    limit = 0.7 * np.abs(log.torque[:, 1]).max()
    log.torque[:, 1] = np.clip(log.torque[:, 1], -limit, limit)
    path = write_parquet(tmp_path / "log.parquet", columns(log))
    found = read(path)
    at_limit = np.abs(log.torque[:, 1]) == np.abs(log.torque[:, 1]).max()
    assert at_limit.sum() > 50
    assert found.statistics.count[:, 1].sum() < (~at_limit).sum()
    assert flagged(found, Flag.SATURATED, 1)
    assert not flagged(found, Flag.SATURATED, 0)
    assert found.statistics.judgeable[:, 1].all()
    (told,) = reading_findings(found.statistics)
    assert told["axes"] == [2]
    assert "limit" in told["words"]
