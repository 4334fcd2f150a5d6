"""The step of a position is found whatever the speed, and none where there is none."""

import numpy as np
import pytest
from monitor_logs import make_log

from jointwear.discovery.preflight import check_data
from jointwear.measurement.derived.encoder_step import encoder_step
from jointwear.measurement.recording_files import load_recording
from jointwear.robots.robot import load_robot

SMOOTH = make_log(60.0).position[:, 0]
STEP = 1.53398e-4


def test_the_example_shows_the_steps_of_all_joints():
    recording = load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm")
    found = check_data(recording, load_robot("config/robots/puma560.yaml"))
    steps = [joint.encoder_step for joint in found.joints]
    np.testing.assert_allclose(
        steps, [1.53126e-6, 1.77849e-6, 3.5703e-6, 1.00871e-5, 2.13281e-5, 1.00017e-5], rtol=1e-5
    )


@pytest.mark.parametrize(
    ("written", "unit"),
    [
        (lambda q: q, 1.0),
        (np.radians, np.pi / 180),
        (lambda q: np.round(q, 6), 1.0),
        (lambda q: np.round(q, 5), 1.0),
        (lambda q: q.astype(np.float32).astype(float), 1.0),
        (lambda q: np.where(np.arange(len(q)) % 90 == 0, np.nan, q), 1.0),
    ],
)
def test_a_step_is_found_however_the_numbers_were_written(written, unit):
    found = encoder_step(written(STEP * np.round(SMOOTH / STEP)))
    assert found == pytest.approx(unit * STEP, rel=1e-3)


@pytest.mark.parametrize(
    "values",
    [
        SMOOTH,
        SMOOTH.astype(np.float32).astype(float),
        # At rest but for a hundred samples, as an axis that a program hardly uses.
        np.concatenate([np.full(5000, 0.3), 0.3 + 1e-3 * SMOOTH[:100]]),
        np.full(100, 0.5),
    ],
)
def test_positions_without_a_step_have_none(values):
    assert encoder_step(values) is None
