"""Estimate, chart, location, forecast and judgement of the monitor."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.measurement.flags import Flag
from jointwear.monitor import judge as judge_module
from jointwear.monitor import paper_detector
from jointwear.monitor.charts import CLIP, LENGTHS, inflation, run_chart, threshold_for, thresholds_for
from jointwear.monitor.estimate import (
    COLUMNS,
    Normal,
    change_columns,
    choose_free,
    column_change,
    contrast,
    coulomb_estimates,
    learn_normal,
    prior_scale,
)
from jointwear.monitor.events import Event
from jointwear.monitor.forecast import forecast
from jointwear.monitor.judge import CHANGED, HEALTHY, UNJUDGED, judge
from jointwear.monitor.judge_settings import JudgeSettings
from jointwear.monitor.limits import VISCOUS as VISCOUS_FRICTION
from jointwear.monitor.locate import axis_probability, honest_probability, named_axis
from jointwear.monitor.paper_detector import paper_alarms, raised_limit
from jointwear.monitor.records import evidence
from jointwear.monitor.shared_error import shared_error
from jointwear.monitor.watching import watch
from jointwear.monitor.windows import HISTOGRAM_BINS, HISTOGRAM_SPAN, blank_statistics

COULOMB = np.array([[10.0, 6.0], [2.0, 2.0], [1.0, 1.5]])
VISCOUS = np.array([3.0, 1.0, 0.5])
NOISE = np.array([0.3, 0.1, 0.05])
PER_WINDOW = 80


def motion(seed: int = 0) -> np.ndarray:
    """Regressors (s, n, 5) of the windows: speeds both ways, gravity and inertial torques."""
    random = np.random.default_rng(seed)
    v = random.uniform(0.2, 1.0, (PER_WINDOW, 3)) * np.where(np.arange(PER_WINDOW) % 2, 1.0, -1.0)[:, None]
    return np.stack(
        [v > 0, -1.0 * (v < 0), v, random.normal(0, 5, v.shape), random.normal(0, 2, v.shape)], axis=-1
    ).astype(float)


def residuals(windows: int, growth: np.ndarray, seed: int, extra: np.ndarray | float = 0.0) -> np.ndarray:
    """Residual torque (w, s, n) with growth (w, n) of the Coulomb friction."""
    x = motion()
    friction = x[..., 0] * COULOMB[:, 0] + x[..., 1] * COULOMB[:, 1]
    noise = NOISE * np.random.default_rng(seed).standard_normal((windows, PER_WINDOW, 3))
    return growth[:, None] * friction + noise + extra


def statistics_of(residual: np.ndarray, still: int | None = None):
    """Window statistics of residual torque; axis `still` is at rest."""
    x, w = motion(), len(residual)
    s = blank_statistics(3600.0 * np.arange(w), 3600.0, np.full(3, 20.0))
    gram = np.einsum("snp,snq->npq", x, x)
    moment = np.einsum("wsn,snp->wnp", residual, x)
    fit = np.linalg.solve(gram, moment[..., None])[..., 0]
    left = np.einsum("wsn,wsn->wn", residual, residual) - np.einsum("wnp,wnp->wn", fit, moment)
    s.gram[:], s.moment[:], s.residual_square[:] = gram, moment, left
    s.count[:], s.freedom[:], s.samples[:] = PER_WINDOW, PER_WINDOW - 5, PER_WINDOW
    torque = np.clip((residual + 8.0) / (HISTOGRAM_SPAN * 20.0), -1, 1)
    s.torque_peak[:] = np.abs(residual + 8.0).max(axis=1)
    index = np.clip(((torque + 1) * HISTOGRAM_BINS / 2).astype(int), 0, HISTOGRAM_BINS - 1)
    for k in range(w):
        for j in range(3):
            s.torque_histogram[k, j] = np.bincount(index[k, :, j], minlength=HISTOGRAM_BINS)
    if still is not None:
        for name in ("gram", "moment", "residual_square", "count", "freedom"):
            getattr(s, name)[:, still] = 0
        s.flags[:, still] = int(Flag.AT_REST)
    return s


def sums(residual: np.ndarray):
    s = statistics_of(residual)
    return change_columns(s.gram, s.moment, s.residual_square, s.freedom, s.count > 0, COULOMB)


SETTINGS = JudgeSettings(coulomb=COULOMB, viscous=VISCOUS, limit_percent=20.0)


def test_columns_turn_levels_into_one_growth():
    change = column_change(COULOMB)
    assert np.allclose(motion() @ change[0] @ np.eye(5)[0], motion()[..., 0] * 10 + motion()[..., 1] * 6)


def test_contrast_is_least_squares():
    x = motion()[:, 1]
    gram, y = x.T @ x, np.random.default_rng(1).standard_normal(PER_WINDOW)
    free = np.ones((1, 5), dtype=bool)
    weights, information = contrast(gram[None], free)
    assert weights[0] @ (x.T @ y) == pytest.approx(np.linalg.lstsq(x, y)[0][0])
    assert 1 / information[0] == pytest.approx(np.linalg.inv(gram)[0, 0])


def test_a_hidden_column_has_no_information():
    gram = np.zeros((1, 5, 5))
    gram[0, :2, :2] = 4.0
    weights, information = contrast(gram, np.array([[True, True, False, False, False]]))
    assert information[0] == 0.0
    assert not weights.any()
    assert not choose_free(gram)[0, 1]


def test_estimates_are_unbiased_and_their_deviation_is_honest():
    growth = np.tile([0.05, 0.0, -0.02], (400, 1))
    normal = learn_normal(sums(residuals(120, np.zeros((120, 3)), 2)), prior_scale(COULOMB, VISCOUS))
    change, std = coulomb_estimates(sums(residuals(400, growth, 3)), normal)
    mean_error = np.sqrt(std.mean(axis=0) ** 2 / 400 + 1 / normal.weight)
    assert np.all(np.abs(change.mean(axis=0) - growth[0]) < 3.5 * mean_error)
    assert change.std(axis=0) == pytest.approx(std.mean(axis=0), rel=0.2)


def test_what_is_wrong_in_the_model_leaves_with_the_normal_mean():
    x = motion()
    wrong = 0.05 * x[..., 3] + 0.1 * VISCOUS * x[..., 2] + 0.1 * COULOMB[:, 0] * x[..., 0]
    growth = np.tile([0.0, 0.04, 0.0], (50, 1))
    normal = learn_normal(sums(residuals(120, np.zeros((120, 3)), 4, wrong)), prior_scale(COULOMB, VISCOUS))
    change, std = coulomb_estimates(sums(residuals(50, growth, 5, wrong)), normal)
    assert np.all(np.abs(change.mean(axis=0) - growth[0]) < 4 * np.sqrt(std.mean(axis=0) ** 2 / 50 + 1 / normal.weight))


def test_a_load_on_the_arm_is_no_wear():
    load = 0.5 * motion()[..., 3] + 0.4
    normal = learn_normal(sums(residuals(120, np.zeros((120, 3)), 6)), prior_scale(COULOMB, VISCOUS))
    assert normal.free[:, COLUMNS.index("offset")].all()
    assert normal.free[:, COLUMNS.index("gravity")].all()
    change, std = coulomb_estimates(sums(residuals(50, np.zeros((50, 3)), 7, load)), normal)
    assert np.all(np.abs(change.mean(axis=0)) < 4 * np.sqrt(std.mean(axis=0) ** 2 / 50 + 1 / normal.weight))


def test_slow_variation_of_normal_windows_is_found_and_noise_has_none():
    slow = np.zeros((300, 3))
    random = np.random.default_rng(8)
    for k in range(1, 300):
        slow[k] = 0.95 * slow[k - 1] + 0.004 * random.standard_normal(3)
    found = learn_normal(sums(residuals(300, slow, 9)), prior_scale(COULOMB, VISCOUS))
    assert np.all(found.slow > 0.2)
    assert np.all(found.memory >= 0.8)
    white = learn_normal(sums(residuals(300, np.zeros((300, 3)), 10)), prior_scale(COULOMB, VISCOUS))
    assert np.all(white.slow == 0)


@given(st.integers(1, 200), st.floats(0.0, 0.98), st.floats(0.0, 1.0))
def test_inflation_is_the_variance_of_a_mean(length, memory, slow):
    lags = np.arange(1, length)
    expected = 1 + 2 * np.sum((1 - lags / length) * slow * memory**lags)
    assert float(inflation(length, np.float64(memory), np.float64(slow))) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def white(windows: int = 120, n: int = 1, lead: tuple[int, ...] = ()) -> Normal:
    one = np.ones((*lead, n))
    return Normal(
        np.zeros((*lead, n, 5)), np.zeros((n, 5), dtype=bool), one, 0 * one, one, 0 * one, 0 * one, windows * one,
        np.full(n, windows),
    )  # fmt: skip


def test_the_stated_rate_of_false_alarms_holds():
    random, windows, rate = np.random.default_rng(11), 120, 0.02
    x = random.standard_normal((300, 200, 3)) - random.standard_normal((300, 1, 3)) / np.sqrt(windows)
    threshold, fall = thresholds_for(rate, np.full(3, windows))
    trace = run_chart(x, np.ones_like(x), threshold, fall, white(windows, 3, (300,)))
    # Half of the allowance is kept back; 300 x 200 windows of 3 axes.
    assert 0.25 * rate < trace.alarm.sum() / (300 * 200) < rate


def test_thresholds_grow_where_less_is_allowed_or_known():
    assert threshold_for(1e-3, 6, 120) > threshold_for(1e-2, 6, 120) > threshold_for(1e-2, 1, 120)
    assert threshold_for(1e-5, 6, 120) > threshold_for(1e-4, 6, 120)
    assert threshold_for(1e-3, 6, 10) > threshold_for(1e-3, 6, 120)
    assert np.isinf(thresholds_for(1e-3, np.array([120, 5]))[0][1])


def test_one_absurd_window_does_not_alarm_and_a_shift_does():
    x = np.zeros((60, 1))
    x[20] = 1e6
    args = (np.ones_like(x), np.array([4.2]), np.array([4.8]), white())
    assert CLIP / np.sqrt(min(LENGTHS)) < 4.2
    assert not run_chart(x, *args).alarm.any()
    x[30:] = 2.0
    trace = run_chart(x, *args)
    first = int(trace.alarm[:, 0].argmax())
    assert 31 < first < 45
    assert trace.length[first, 0] <= first - 20


def test_windows_that_are_not_judged_are_passed_over():
    random = np.random.default_rng(12)
    x = random.standard_normal((80, 2)) + 0.4
    gappy, std = np.full((160, 2), np.nan), np.ones((160, 2))
    gappy[::2, 0], gappy[1::2, 1] = x[:, 0], x[:, 1]
    limits = (np.full(2, 3.0), np.full(2, 3.0), white(n=2))
    dense, sparse = run_chart(x, np.ones_like(x), *limits), run_chart(gappy, std, *limits)
    assert np.array_equal(dense.alarm[:, 0], sparse.alarm[::2, 0])
    assert np.allclose(dense.statistic[:, 1], sparse.statistic[1::2, 1])
    assert np.isnan(sparse.statistic[1::2, 0]).all()


def test_probabilities_of_axes():
    z, limit = np.array([5.0, 1.0, np.nan, 4.9]), np.full(4, 4.2)
    p = axis_probability(z, limit)
    assert p[0] > 0.99
    assert p[3] > 0.99
    assert p[1] == pytest.approx(1.0)
    assert p[2] == 0.0
    assert axis_probability(np.array([4.3, 4.1]), np.full(2, 4.2))[0] < 0.8
    assert named_axis(np.array([True, False, False, True]), z) == 1
    assert named_axis(np.zeros(4, dtype=bool), z) == 0


def test_a_weak_alarm_beside_a_strong_one_or_while_all_axes_move_is_not_sure():
    z, limit = np.array([9.0, 4.5, 1.0, np.nan]), np.full(4, 4.0)
    p = honest_probability(z, limit)
    assert p[0] > 0.99
    assert p[1] == pytest.approx(1 / (1 + 5 * np.exp((16 - 20.25) / 2)), abs=1e-3)
    assert p[3] == 0.0
    assert honest_probability(np.array([9.0, 8.0, 1.0, np.nan]), limit)[1] > 0.99
    one = np.array([4.0 + 1e-9, 0.0, 0.0, 0.0])
    assert honest_probability(one, limit)[0] == pytest.approx(axis_probability(one, limit)[0])
    assert honest_probability(one, limit, together=True)[0] == pytest.approx(0.5, abs=1e-3)


def test_a_step_is_as_sure_as_its_own_chart_is_beyond_its_threshold():
    def of(step):
        level = SimpleNamespace(
            residual=np.zeros((1, 2)), mean=np.array([[0.02, 0.0]]), mean_std=np.full((1, 2), 0.01),
            threshold=np.full(2, 4.0), step=np.array([[step, -np.inf]]), step_threshold=np.full(2, 5.0),
            alarm=np.array([[True, False]]),
        )  # fmt: skip
        return evidence(level)

    told, threshold = of(6.0)
    assert told[0, 0] ** 2 - threshold[0, 0] ** 2 == pytest.approx(11.0)
    assert honest_probability(told[0], threshold[0], together=True)[0] > 0.95
    # An alarm of the level alone stays what the level says.
    assert of(-np.inf)[0][0, 0] == pytest.approx(2.0)
    assert told[0, 1] == 0.0


@settings(deadline=None, max_examples=25)
@given(st.floats(1.0, 4.0), st.integers(60, 110))
def test_forecasts_of_clear_growth_are_close(exponent, now):
    hour = np.arange(1.0, now + 1)
    growth = 0.2 * (hour / 120) ** exponent
    told = forecast(hour, growth, np.full(now, 1e-4), 0.2, start=0.0)
    assert told.low <= told.hours <= told.high
    assert told.low - 3 <= 120 - now <= told.high + 3


def test_forecast_says_now_never_and_unknown():
    hour = np.arange(1.0, 61)
    risen = 0.3 * (hour / 60) ** 2
    now = forecast(hour, risen, np.full(60, 1e-3), 0.2, start=0.0)
    assert now.low == now.hours == 0.0
    flat = forecast(hour, np.zeros(60), np.full(60, 1e-5), 0.2, start=0.0)
    assert flat.hours > 300
    assert np.isnan(forecast(hour[:2], risen[:2], np.full(2, 1e-3), 0.2).hours)


def test_a_less_certain_past_gives_a_wider_interval():
    hour = np.arange(1.0, 81)
    growth = 0.2 * (hour / 120) ** 3
    widths = []
    for std in (1e-3, 1e-2, 3e-2):
        told = forecast(hour, growth, np.full(80, std), 0.2, start=0.0)
        widths.append(told.high - told.low)
    assert widths[0] < widths[1] < widths[2]


def test_judgement_names_the_worn_axis_and_says_what_it_cannot_judge():
    growth = np.zeros((200, 3))
    growth[120:, 0] = 0.15 * (np.arange(80) / 80) ** 2
    result = judge(statistics_of(residuals(200, growth, 13), still=2), 120, SETTINGS)
    mine = [a for a in result.alarms if a["detector"] == "model"]
    assert mine
    assert {a["axis"] for a in mine} == {1}
    first = mine[0]
    assert first["probability_axis"] > 0.95
    assert first["change_low"] <= first["change"] <= first["change_high"]
    assert first["unit"] == "N m"
    assert first["hours_to_limit_low"] <= first["hours_to_limit"]
    assert set(result.status[:, 2]) == {UNJUDGED}
    assert set(result.status[:, 1]) == {HEALTHY}
    assert result.status[-1, 0] == CHANGED
    assert result.status[100, 0] == HEALTHY
    assert result.estimates["coulomb_percent"][-1, 0] == pytest.approx(15, abs=2)
    assert result.estimates["coulomb"][-1, 0] == pytest.approx(0.15 * 8, abs=0.2)
    for name, values in result.estimates.items():
        assert values.shape == result.std[name].shape == result.status.shape
        assert name in result.units
    # A repeat a day later brings a new forecast; not more often.
    times = [a["time"] for a in mine]
    assert np.all(np.diff(times) >= 24 * 3600)


def test_two_axes_at_once_are_both_named():
    growth = np.zeros((220, 3))
    growth[120:, 0] = 0.1 * (np.arange(100) / 100)
    growth[120:, 2] = 0.2 * (np.arange(100) / 100)
    result = judge(statistics_of(residuals(220, growth, 14)), 120, SETTINGS)
    assert {a["axis"] for a in result.alarms if a["detector"] == "model"} == {1, 3}


def test_an_axis_too_coarse_for_its_limit_says_so_and_still_alarms_for_a_large_change():
    # Friction of the second axis differs from shift to shift.
    growth = np.zeros((300, 3))
    growth[:, 1] = np.repeat(0.17 * np.random.default_rng(3).uniform(-1, 1, 38), 8)[:300]
    quiet = judge(statistics_of(residuals(300, growth, 15)), 120, SETTINGS)
    (told,) = [f for f in quiet.findings if f["kind"] == "coarse"]
    assert told["axes"] == [2]
    assert told["least"] > 0.2
    assert f"{100 * told['least']:.0f} %" in told["words"]
    assert set(quiet.status[120:, 1]) == {HEALTHY}
    assert not [a for a in quiet.alarms if a["detector"] == "model"]
    growth[200:, 1] += 1.5 * told["least"]
    worn = judge(statistics_of(residuals(300, growth, 15)), 120, SETTINGS)
    assert {a["axis"] for a in worn.alarms if a["detector"] == "model"} == {2}
    assert worn.status[-1, 1] == CHANGED


def test_friction_that_drowns_is_not_called_healthy():
    loud = residuals(150, np.zeros((150, 3)), 15)
    loud[..., 1] *= 400
    result = judge(statistics_of(loud), 120, SETTINGS)
    assert set(result.status[:, 1]) == {UNJUDGED}
    assert set(result.status[:, 0]) == {HEALTHY}


def test_refused_and_empty_windows_are_not_judged():
    s = statistics_of(residuals(150, np.zeros((150, 3)), 16))
    flags = s.flags.copy()
    flags[130:140, 0] = int(Flag.REFUSED)
    result = judge(replace(s, flags=flags), 120, SETTINGS)
    assert set(result.status[130:140, 0]) == {UNJUDGED}
    assert np.isnan(result.estimates["coulomb"][130:140, 0]).all()


def test_an_axis_that_was_mended_is_healthy_again_once_somebody_says_so():
    growth = np.zeros((260, 3))
    growth[120:180, 1] = 0.1
    statistics = statistics_of(residuals(260, growth, 17))
    unsaid = judge(statistics, 120, SETTINGS)
    assert unsaid.status[170, 1] == CHANGED
    # Friction that fell back alone closes nothing: a service is proposed, the alarm stays open.
    assert unsaid.status[-1, 1] == CHANGED
    assert [f["axes"] for f in unsaid.findings if f["kind"] == "proposed_service"] == [[2]]
    said = judge(statistics, 120, replace(SETTINGS, events=(Event(180 * 3600.0, (1,), "service"),)))
    assert said.status[170, 1] == CHANGED
    assert said.status[-1, 1] == HEALTHY
    assert said.status[181, 1] == UNJUDGED
    assert (said.status[121:, 0] == HEALTHY).all()


def test_a_service_that_is_told_raises_no_alarm_and_wear_after_it_does():
    growth = np.zeros((420, 3))
    growth[200:, 0] = -0.15
    growth[320:, 0] += 0.15 * np.arange(100) / 100
    statistics = statistics_of(residuals(420, growth, 21))
    told = judge(statistics, 120, replace(SETTINGS, events=(Event(200 * 3600.0, (), "service"),)))
    alarms = [a for a in told.alarms if a["detector"] == "model"]
    assert {a["axis"] for a in alarms} == {1}
    assert alarms[0]["time"] > 320 * 3600


def test_a_fall_of_friction_starts_the_viscous_part_anew_too(monkeypatch):
    watched = []
    monkeypatch.setattr(judge_module, "watch", lambda *a, **k: watched.append(watch(*a, **k)) or watched[-1])
    growth = np.zeros((320, 3))
    growth[200:, 1] = -0.3
    judge(statistics_of(residuals(320, growth, 22)), 120, SETTINGS)
    viscous = watched[-1]
    assert [s.window for s in viscous.starts[1]] == [200]
    assert viscous.learning[200:210, 1].all()
    assert not viscous.learning[:, [0, 2]].any()


def test_all_axes_at_once_are_a_finding_and_no_wear():
    growth = np.zeros((240, 6))
    growth[160:] = 0.08
    result = shared_error(growth, np.full((240, 6), 1e-4), np.arange(240) < 120, np.arange(240) // 24)
    assert np.allclose(result.value[200:], 0.08, atol=0.02)
    assert (np.abs(result.value[:120]) < 1e-6).all()


def test_a_robot_without_friction_parameters_grows_from_its_own_baseline():
    growth = np.ones((200, 3))
    growth[120:, 1] = 1.2
    none = JudgeSettings(coulomb=np.zeros((3, 2)), viscous=np.zeros(3))
    result = judge(statistics_of(residuals(200, growth, 18)), 120, none)
    assert result.estimates["coulomb_percent"][-40:, 1].mean() == pytest.approx(20, abs=3)
    assert {a["axis"] for a in result.alarms if a["detector"] == "model"} == {2}
    assert result.estimates["coulomb"][-40:, 1].mean() == pytest.approx(0.4, abs=0.05)


def test_the_paper_detector_alarms_on_a_changed_distribution(monkeypatch):
    # Three axes need all their components for 75 % of the variance, which leaves no residual.
    monkeypatch.setattr(paper_detector, "VARIANCE_SHARE", 0.5)
    growth = np.zeros((200, 3))
    growth[150:, 0] = 0.5
    alarms = judge(statistics_of(residuals(200, growth, 19)), 120, SETTINGS).alarms
    paper = [a for a in alarms if a["detector"] == "paper"]
    assert paper
    assert all(a["time"] > 150 * 3600 for a in paper)
    assert paper[0]["axis"] == 1


def test_the_paper_detector_passes_over_a_program_that_it_never_saw(monkeypatch):
    monkeypatch.setattr(paper_detector, "VARIANCE_SHARE", 0.5)
    growth = np.zeros((200, 3))
    growth[150:, 0] = 0.5
    statistics, program = statistics_of(residuals(200, growth, 19)), np.zeros(200, dtype=int)
    assert paper_alarms(statistics, 120, 1e-3, program).alarm.any()
    program[150:] = 1
    verdict = paper_alarms(statistics, 120, 1e-3, program)
    assert not verdict.alarm.any()
    assert np.isnan(verdict.q[150:]).all()


def test_an_event_explains_what_the_paper_detector_saw_and_it_learns_anew(monkeypatch):
    monkeypatch.setattr(paper_detector, "VARIANCE_SHARE", 0.5)
    growth = np.zeros((400, 3))
    growth[150:, 0] = 0.5
    statistics = statistics_of(residuals(400, growth, 19))
    paper = [a["time"] for a in judge(statistics, 120, SETTINGS).alarms if a["detector"] == "paper"]
    assert max(paper) > 300 * 3600
    told = replace(SETTINGS, events=(Event(150 * 3600.0, (0,), "sensor"),))
    assert not [a for a in judge(statistics, 120, told).alarms if a["detector"] == "paper"]
    growth[300:, 0] = 1.2
    again = judge(statistics_of(residuals(400, growth, 19)), 120, told).alarms
    assert min(a["time"] for a in again if a["detector"] == "paper") > 300 * 3600


def test_no_baseline_yet_is_no_judgement():
    statistics = statistics_of(residuals(40, np.zeros((40, 3)), 19))
    result = judge(statistics, np.zeros(40, dtype=bool), SETTINGS)
    assert not result.alarms
    assert (result.status == UNJUDGED).all()


def test_raised_limits():
    random = np.random.default_rng(20)
    quiet = random.uniform(0, 0.5, 200)
    assert raised_limit(quiet, 1e-3) == 1.0
    assert raised_limit(4 * random.exponential(1, 200), 1e-3) > 1.0
    assert raised_limit(np.ones(3), 1e-3) == 1.0


def test_a_condition_that_lasts_a_shift_is_no_change_of_the_torque_pattern():
    """Programs change by the hour in the normal period, by the shift after it; the torques of one are wild."""
    random = np.random.default_rng(5)
    size = np.array([0.2, 6.0, 0.4])
    normal = random.integers(0, 3, 90)
    crossed = size[normal] * random.exponential(1, 90)
    later = size[np.repeat(random.integers(0, 3, 60), 8)] * random.exponential(1, 480)
    runs = np.lib.stride_tricks.sliding_window_view(later, 5).min(axis=-1)
    assert (runs > raised_limit(crossed, 1e-3)).any()
    assert not (runs > raised_limit(crossed, 1e-3, mixed=True)).any()


def test_viscous_wear_is_told_as_such_in_estimates_and_alarms():
    growth = np.zeros(220)
    growth[120:] = 0.8 * np.arange(100) / 100
    extra = growth[:, None, None] * VISCOUS * motion()[..., 2] * np.array([1.0, 0.0, 0.0])
    result = judge(statistics_of(residuals(220, np.zeros((220, 3)), 23, extra)), 120, SETTINGS)
    mine = [a for a in result.alarms if a["detector"] == "model"]
    assert {(a["axis"], a["quantity"]) for a in mine} == {(1, VISCOUS_FRICTION)}
    # The level leaves viscous friction out as it was: what it takes of this growth is not known.
    assert np.isnan(result.estimates["coulomb_percent"][-24:, 0]).all()
    assert np.isfinite(result.estimates["coulomb_percent"][-24:, 1]).all()
    assert result.limited_by[0] == VISCOUS_FRICTION
