"""Study of the monitor: simulation shortcuts against the full simulation, scores, peers, factory."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from jointwear.files.documents import read_yaml
from jointwear.reproduction.simulation import Noise, RepeatedTask
from jointwear.reproduction.wear import Wear
from jointwear.reproduction.worn_run import coulomb_levels
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import load_task
from jointwear.studies.monitor_study import peers
from jointwear.studies.monitor_study.calibration import coverage, draw_history
from jointwear.studies.monitor_study.confounders import NORMAL, Factory, conditions, motion_at
from jointwear.studies.monitor_study.factory_study import PaperDetector, of_bodies
from jointwear.studies.monitor_study.nominal import coulomb_levels_of, wrong_nominal
from jointwear.studies.monitor_study.runs import TaskWear, learn, louder, regression_of, sums_of_torque, with_axis
from jointwear.studies.monitor_study.scores import chart, factor_for, first_hour, reset_alarms, run_minimum
from jointwear.studies.monitor_study.summary import rate, share

ROOT = Path(__file__).resolve().parents[2]
HOURS = 120
READING = read_yaml(ROOT / "config/config.yaml")["reading"]


@pytest.fixture(scope="module")
def arm():
    return load_robot(ROOT / "config/robots/puma560.yaml")


@pytest.fixture(scope="module")
def task():
    return load_task(ROOT / "config/tasks/T2.yaml")


def simulate(arm, task, hours, axis=None, wear=None, replicates=3, seed=1):
    """Torque (r, h, s, n) of the reproduction's own simulation."""
    noise = Noise(0.01, 1e-4, 0.5, READING)
    dynamics = Dynamics(arm)
    repeated = RepeatedTask(dynamics, task, coulomb_levels(dynamics, np.arange(1, hours + 1), axis, wear), noise)
    return np.stack([repeated.measure(np.random.default_rng([seed, r])) for r in range(replicates)])


@pytest.fixture(scope="module")
def runs(arm, task):
    regression = regression_of(arm, task.samples(10.0, 60))
    normal = learn(sums_of_torque(simulate(arm, task, HOURS, seed=1), regression), regression)
    worn = sums_of_torque(simulate(arm, task, HOURS, 3, Wear(20.0, 1.5), seed=2), regression)
    return regression, normal, worn, TaskWear(arm, task, regression, regression, 0.5, HOURS)


def test_the_worn_axis_is_found_and_no_other(runs):
    _, normal, worn, _ = runs
    seen = chart(worn, normal, 0.3)
    assert np.all(seen.named == 3)
    assert np.all(seen.hour < 60)
    assert np.all(seen.probability > 0.99)
    assert np.array_equal(seen.axis_hour(2), seen.hour)


def test_other_wear_from_the_same_run_is_what_the_simulation_gives(arm, task, runs):
    regression, _, worn, wear = runs
    changed = wear.changed(worn, 2, wear.growth(20.0, 1.5), wear.growth(10.0, 3.0))
    again = sums_of_torque(simulate(arm, task, HOURS, 3, Wear(10.0, 3.0), seed=2), regression)
    scale = np.sqrt(np.einsum("nkk->nk", regression.gram)) * 0.01
    assert np.all(np.abs(changed.moment - again.moment) <= scale + 1e-6)
    assert changed.residual_square[..., 2] == pytest.approx(again.residual_square[..., 2], rel=0.05)


def test_louder_noise_leaves_the_wear(runs):
    _, normal, worn, wear = runs
    rise = wear.growth(20.0, 1.5)[:, None] * wear.moment[2]
    twice = louder(worn, 2.0, 2, rise)
    noise = worn.moment[:, :, 2] - rise
    assert np.allclose(twice.moment[:, :, 2] - rise, 2 * noise)
    assert np.nanmean(chart(twice, normal, 0.3).axis_hour(2)) <= HOURS


def test_two_runs_make_one_with_two_worn_axes(arm, task, runs):
    regression, normal, worn, _ = runs
    other = sums_of_torque(simulate(arm, task, HOURS, 5, Wear(10.0, 1.5), seed=3), regression)
    seen = chart(with_axis(other, worn, 2), normal, 0.3)
    assert np.isfinite(seen.axis_hour(2)).all()
    assert np.isfinite(seen.axis_hour(4)).all()


def test_a_wrong_model_is_wrong_everywhere_and_still_a_body(arm):
    wrong = wrong_nominal(arm, np.random.default_rng(4))
    assert np.allclose(np.abs(wrong.viscous / arm.viscous - 1), 0.1)
    assert np.allclose(np.abs(coulomb_levels_of(wrong) / coulomb_levels_of(arm) - 1), 0.1)
    assert np.allclose(np.abs(wrong.armature / arm.armature - 1), 0.05)
    Dynamics(wrong)


def test_a_wrong_model_still_finds_the_axis(arm, task):
    regression = regression_of(wrong_nominal(arm, np.random.default_rng(5)), task.samples(10.0, 60))
    normal = learn(sums_of_torque(simulate(arm, task, HOURS, seed=1), regression), regression)
    worn = sums_of_torque(simulate(arm, task, HOURS, 3, Wear(20.0, 1.5), seed=2), regression)
    assert np.all(chart(worn, normal, 0.3).named == 3)


def test_an_axis_at_rest_has_no_estimate(arm):
    still = load_task(ROOT / "config/tasks/T1.yaml")
    regression = regression_of(arm, still.samples(10.0, 60))
    sums = sums_of_torque(simulate(arm, still, 20), regression)
    seen = chart(sums, learn(sums, regression), 1.0)
    assert np.isnan(seen.change[..., 5]).all()
    assert np.isinf(seen.threshold[5])
    assert np.isfinite(seen.threshold[:5]).all()


def test_alarms_start_anew_after_each():
    ratio = np.array([[0, 2, 2, 2, 2, 2, 2, 0, 2.0]])
    assert reset_alarms(ratio, 1.0, 3)[0].nonzero()[0].tolist() == [3, 6]
    assert run_minimum(ratio, 3)[0].tolist() == [0, 0, 0, 2, 2, 2, 2, 0, 0]
    assert np.array_equal(first_hour(reset_alarms(ratio, 3.0, 1)), [np.nan], equal_nan=True)


def test_factors_keep_the_stated_rate():
    ratio = np.random.default_rng(6).exponential(1, (20, 200))
    for consecutive in (1, 3):
        factor = factor_for(ratio, 5.0, consecutive)
        assert reset_alarms(ratio, factor, consecutive).sum() <= 5.0 / 1000 * ratio.size
        assert reset_alarms(ratio, 0.97 * factor, consecutive).sum() >= 0.6 * 5.0 / 1000 * ratio.size


def test_shares_and_rates():
    assert share(8, 10)["share"] == 0.8
    assert share(8, 10)["low"] < 0.8 < share(8, 10)["high"]
    assert rate(0, 1000)["at_most"] == pytest.approx(2.9957, abs=1e-3)
    assert rate(2, 1000)["per_1000_h"] == 2


def test_peers_see_a_shift_and_densities_name_the_axis():
    random = np.random.default_rng(7)
    training, run = random.standard_normal((120, 6)), random.standard_normal((60, 6))
    run[30:, 2] += 6
    training[:, 5] = run[:, 5] = 0.0
    found = peers.fit_peers(peers.standardised(training, training), 1)
    for name, statistic in found.items():
        values = statistic(peers.standardised(training, run))
        assert values.shape == (60,), name
        assert values[30:].max() > values[:30].max(), name
    torque, worn = random.standard_normal((50, 60, 3)), random.standard_normal((20, 60, 3))
    worn[..., 1] *= 2
    assert np.all(peers.KernelDensities(torque).score(worn).argmax(axis=1) == 1)


def test_conditions_come_after_the_quiet_period():
    for name in ("temperature", "payload", "speed", "all"):
        c = conditions(name)
        assert np.ptp(c.temperature[:NORMAL]) < 1.5
        assert np.all(c.speed[:NORMAL] == 1)
        assert not c.tool[:NORMAL].any()
    assert np.ptp(conditions("temperature").temperature) > 15
    assert conditions("payload").tool[NORMAL:].all()
    assert set(conditions("speed").speed) == {0.5, 0.75, 1.0}


def test_motion_at_half_speed_is_the_same_path():
    full, half = motion_at(1.0), motion_at(0.5)
    assert np.allclose(half.position[::2], full.position[: len(half.position[::2])])
    assert np.allclose(half.velocity[::2], 0.5 * full.velocity[:120])


def test_factory_logs_follow_their_conditions(arm):
    warm, steady = Factory(arm, "temperature", 1), Factory(arm, None, 1)
    cold = slice(NORMAL, NORMAL + 6)
    assert np.array_equal(steady.torque(cold, 2, "a"), steady.torque(cold, 2, "a"))
    model, regressions = steady.model_torque({False: arm, True: arm}, cold)
    sums = steady.sums(steady.torque(cold, 2, "a") - model, regressions, cold)
    assert sums.moment.shape == (2, 6, 6, 5)
    assert np.all(sums.freedom > 0)
    noise = np.std(warm.torque(cold, 1, "a")[0, 0] - warm.torque(cold, 1, "b")[0, 0], axis=0) / np.sqrt(2)
    assert noise == pytest.approx(warm.noise, rel=0.2)


def test_paper_detector_on_torque():
    # Six axes: of three the model may keep every component, and Q has nothing left.
    random = np.random.default_rng(8)
    pattern = random.uniform(1, 5, (240, 6))
    settings = {"bins": 12, "confidence": 0.95, "variance_share": 0.75, "reading": READING}
    normal = pattern + 0.05 * random.standard_normal((2, 60, 240, 6))
    detector = PaperDetector(normal, settings)
    changed = 1.1 * pattern + 0.05 * random.standard_normal((2, 20, 240, 6))
    same = pattern + 0.05 * random.standard_normal((2, 20, 240, 6))
    assert np.median(detector.ratio(changed)) > 3 * np.median(detector.ratio(same))


def test_inertias_become_those_of_bodies():
    data = {"links": [{"inertia": [-1e-4, 2e-4, 3e-4, 0, 0, 0]}, {"inertia": [1.0, 2.0, 2.5, 0, 0, 0]}]}
    mended = of_bodies(json.loads(json.dumps(data)))["links"]
    assert min(mended[0]["inertia"][:3]) > 0
    assert mended[1]["inertia"] == data["links"][1]["inertia"]


@pytest.mark.long
def test_made_up_growth_never_falls_and_is_covered():
    random = np.random.default_rng(9)
    for _ in range(20):
        drawn = draw_history(random)
        assert np.all(np.diff(drawn.true) >= -1e-12)
        assert drawn.limit > 0
    held = coverage(3, 60, 0.8)
    assert held["alarm"].mean() > 0.6
    assert len(held["later"]) > 20
