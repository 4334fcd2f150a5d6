"""The augmented robot takes out of the friction what the nominal one takes for a change."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import columns, layout, make_log, model, write_parquet

from jointwear.monitor.normal.friction import window_friction
from jointwear.monitor.presentation.temperature import temperature_share
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.survey import survey_log
from jointwear.robots.robot import EffectEntry

LENGTH, AXIS, SLOPE = 24.0, 0, 0.2


@pytest.mark.long
def test_a_day_and_a_night_are_no_wear_for_the_augmented_robot(tmp_path):
    effect = EffectEntry(
        "temperature_dependent_coulomb_friction", AXIS + 1, None, {"slope": SLOPE, "scale": 1e4, "reference": 25.0}
    )
    augmented = TorqueModel(replace(model().robot, effects=(effect,)))
    log = make_log(480.0)
    temperature = 25 + 10 * np.sin(2 * np.pi * log.time / 240)
    warm = np.broadcast_to(temperature[:, None], log.torque.shape)
    change = augmented(log.position, log.velocity, log.acceleration, log.time, warm).total
    change = change - model()(log.position, log.velocity, log.acceleration).total
    table = columns(replace(log, torque=log.torque + change)) | {"temperature": temperature}
    path = str(write_parquet(tmp_path / "log.parquet", table))
    found = {}
    for name, arm in (("nominal", model()), ("augmented", augmented)):
        survey = survey_log(path, layout(), arm, LENGTH)
        statistics = log_statistics(path, layout(), arm, survey, LENGTH).statistics
        friction = window_friction(statistics, arm.robot, np.arange(statistics.windows) < 20)
        inverse = np.linalg.pinv(statistics.gram[:, AXIS], hermitian=True, rcond=1e-12)
        fit = np.einsum("wpk,wk->wp", inverse, statistics.moment[:, AXIS])[:, :2].mean(axis=1)
        found[name] = (
            fit,
            temperature_share(
                friction.value[:, AXIS], friction.std[:, AXIS], statistics.temperature[:, AXIS], statistics.start
            ),
        )
    assert np.ptp(found["nominal"][0]) > 10 * SLOPE
    assert np.std(found["augmented"][0]) < 0.1 * np.std(found["nominal"][0])
    share = found["nominal"][1]
    assert share.explained > 0.95
    np.testing.assert_allclose(share.slope, -SLOPE, rtol=0.1)
