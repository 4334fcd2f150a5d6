"""Windows of programs that the log names: each has its own normal, one that was never seen is not judged."""

from __future__ import annotations

import numpy as np
import pytest
from monitor_windows import SETTINGS, residuals, statistics_of

from jointwear.monitor.judging.judge import judge
from jointwear.monitor.normal.conditions import Conditions, design_of
from jointwear.monitor.normal.normal_state import Noise, fit_normal_state
from jointwear.monitor.normal.programs import labelled_regimes
from jointwear.monitor.reading.program_labels import add_labels, label_text, window_programs
from jointwear.monitor.watching.records import HEALTHY, UNJUDGED, Reason


def labelled(growth, names, seed=0):
    statistics = statistics_of(residuals(len(names), growth, seed))
    statistics.labels[:] = [label_text(np.array([name] * 80)) for name in names]
    return statistics


def test_a_program_of_the_baseline_has_its_own_level():
    names = ["weld", "pick"] * 75
    growth = np.where(np.arange(150)[:, None] % 2, 0.08, 0.0) * np.ones(3)
    judgement = judge(labelled(growth, names), 72, SETTINGS)
    assert not judgement.alarms
    assert (judgement.status[80:] == HEALTHY).all()


def test_a_program_that_was_never_seen_cannot_be_judged_yet():
    names = ["weld"] * 120 + ["pick"] * 30
    growth = np.zeros((150, 3))
    growth[120:] = 0.3
    judgement = judge(labelled(growth, names), 72, SETTINGS)
    assert not judgement.alarms
    assert (judgement.status[120:126] == UNJUDGED).all()
    assert (judgement.reason[120:126] == Reason.CONDITIONS).all()
    told = [f for f in judgement.findings if f["kind"] == "program"]
    assert "'pick'" in told[0]["words"]
    assert told[0]["time"] == 120 * 3600.0
    assert "judged in it after" in told[0]["words"]
    fresh = judge(labelled(growth, names).part(slice(0, 123)), 72, SETTINGS)
    told = [f for f in fresh.findings if f["kind"] == "program"]
    assert "cannot be judged yet" in told[0]["words"]
    assert (judgement.status[80:120] == HEALTHY).all()
    # Later its level is known.
    assert (judgement.status[-5:] == HEALTHY).all()


def test_the_first_window_of_a_program_does_not_set_its_level():
    # One window before the end of a shift, while the joint still has the heat of the program before.
    names = ["weld"] * 127 + ["pick"] * 23
    growth = np.zeros((150, 3))
    growth[127:] = 0.3
    growth[127] = 0.25
    judgement = judge(labelled(growth, names), 72, SETTINGS)
    assert (judgement.status[127:133] == UNJUDGED).all()
    assert not judgement.alarms
    assert (judgement.status[-5:] == HEALTHY).all()


@pytest.mark.parametrize("grown", [0.0, 0.3])
def test_a_new_program_hides_no_wear_that_was_there_before(grown):
    names = ["weld"] * 120 + ["pick"] * 60
    growth = np.zeros((180, 3))
    # The new program has a level of its own, 0.2 above the other, on every axis.
    growth[120:] = np.log(1.2)
    growth[90:, 1] += np.log1p(grown) * np.minimum((np.arange(90, 180) - 90) / 24.0, 1.0)
    judgement = judge(labelled(np.expm1(growth), names), 72, SETTINGS)
    assert {a["axis"] for a in judgement.alarms} == ({2} if grown else set())
    told = judgement.estimates["coulomb_percent"][-24:]
    assert np.median(told[:, 1]) == pytest.approx(100 * grown, abs=6.0)
    assert np.abs(np.median(told[:, [0, 2]], axis=0)).max() < 4.0


def at_speed(statistics, rows, factor):
    """Let windows run their program at another speed: its path is the same."""
    scale = np.array([1.0, 1.0, factor, 1.0, factor**2])
    statistics.gram[rows] *= scale[:, None] * scale
    statistics.moment[rows] *= scale
    return statistics


@pytest.mark.parametrize("wear", [0.0, 0.2])
def test_a_speed_that_the_baseline_lacks_is_no_wear_and_hides_none(wear):
    growth, slow = np.zeros((240, 3)), np.zeros(240, dtype=bool)
    slow[120:144] = slow[192:216] = True
    # What the model lacks on the path looks like another friction at another speed, on each axis by its own share.
    growth[slow, :2] = (0.25, -0.1)
    growth[150:, 2] = wear
    judgement = judge(at_speed(statistics_of(residuals(240, growth, 31)), slow, 0.8), 96, SETTINGS)
    assert (judgement.status[120:122] == UNJUDGED).all()
    assert (judgement.reason[120:122] == Reason.CONDITIONS).all()
    assert {a["axis"] for a in judgement.alarms if a["detector"] == "model"} == ({3} if wear else set())
    (told,) = (f for f in judgement.findings if f["kind"] == "override")
    assert told["time"] == 120 * 3600.0
    assert "48 h at 0.8 times its usual speed" in told["words"]
    # Its level is known when it comes again.
    assert np.abs(np.median(judgement.estimates["coulomb_percent"][200:216, :2], axis=0)).max() < 4.0


def test_a_speed_within_those_of_the_baseline_is_judged_as_it_was():
    growth, slow = np.zeros((200, 3)), np.zeros(200, dtype=bool)
    slow[40:50] = slow[150:] = True
    growth[150:, 1] = 0.25
    judgement = judge(at_speed(statistics_of(residuals(200, growth, 32)), slow, 0.8), 96, SETTINGS)
    assert {a["axis"] for a in judgement.alarms if a["detector"] == "model"} == {2}
    assert not [f for f in judgement.findings if f["kind"] == "override"]


def test_windows_that_mix_programs_are_a_program_of_their_own():
    total = np.full(2, "", dtype=object)
    add_labels(total, [0, 0, 1], [label_text(np.array(["a"] * 30)), label_text(np.array(["b"] * 30)), ""])
    add_labels(total, [0], [label_text(np.array(["c"] * 2 + [""] * 5))])
    assert window_programs(total) == ["a + b", ""]
    assert labelled_regimes(np.full(3, "", dtype=object), np.ones(3, dtype=bool)) is None
    labels = np.array([label_text(np.array([name])) for name in "aaaabbbbab"], dtype=object)
    regime = labelled_regimes(labels, np.arange(10) < 4)
    assert regime.tolist() == [0] * 4 + [1] * 4 + [0, 1]


def test_a_temperature_that_changes_faster_than_ever_is_unsure_within_its_range():
    day = 26.0 + 4.0 * np.sin(2 * np.pi * np.arange(96) / 24.0)
    steady, jump = np.concatenate([day, day]), np.concatenate([day, np.where(np.arange(96) < 48, 23.0, 29.0)])
    start, first = 3600.0 * np.arange(192), np.arange(192) < 96

    def beyond(temperature):
        conditions = Conditions(
            start, start + 3600, temperature[:, None], np.zeros((192, 1, 5)), np.ones((192, 1)), np.zeros(192), None
        )
        return design_of(conditions, 0, first, None).beyond

    assert np.sqrt(beyond(steady)).max() < 1e-4
    found = beyond(jump)
    assert np.sqrt(found[144]) > 0.01
    # It fades as oil and thermometer come to agree.
    assert (np.diff(found[144:]) <= 0).all()
    assert np.sqrt(found[168:]).max() < 1e-4


def test_what_a_part_and_the_speed_do_to_friction_is_learnt_program_by_program():
    random, w = np.random.default_rng(2), 96
    regime, load = np.arange(w) % 2, random.uniform(0.0, 0.2, w)
    speed = random.choice([-0.5, 0.0], w)
    features = np.zeros((w, 1, 5))
    features[:, 0, 0] = speed
    start = 3600.0 * np.arange(w)
    conditions = Conditions(
        start, start + 3600, np.full((w, 1), 30.0), features, np.ones((w, 1)), load, regime, named=True
    )
    shift, first = np.arange(w) // 8, np.arange(w) < 64
    value = regime * (-0.6 * load + 0.15 * speed) + 0.002 * random.standard_normal(w)
    design = design_of(conditions, 0, first, None)
    noise = Noise(np.full(w, 4e-6), 0.0, 1e-6)
    fit = fit_normal_state(design.matrix, np.where(first, value, np.nan), noise, shift, design.prior)
    expected, spread = fit.posterior.predict(design.matrix[~first])
    assert np.abs(value[~first] - expected).max() < 0.015
    assert np.sqrt(spread).max() < 0.01


@pytest.mark.parametrize("minutes", [12, 20])
@pytest.mark.parametrize("tau", [0.7, 2.0])
def test_a_thermometer_that_lags_on_cold_mornings_does_not_hide_what_a_cold_day_does(minutes, tau):
    random = np.random.default_rng(3)
    step = 1 / 60
    time = np.arange(0, 24 * 12, step)
    hall = 20 + 2 * np.sin(2 * np.pi * (time / 24 - 0.3)) + np.interp(time / 24, np.arange(13), random.normal(0, 1, 13))
    hall -= 8.0 * (time > 24 * 10)
    on = (time % 24 >= 6) & (time % 24 < 22)
    heat, sensed = np.zeros(len(time)), np.zeros(len(time))
    sensed[0] = hall[0]
    for k in range(1, len(time)):
        heat[k] = heat[k - 1] + step / tau * (12.0 * on[k] - heat[k - 1])
        sensed[k] = sensed[k - 1] + step * 60 / minutes * (hall[k] + heat[k] - sensed[k - 1])
    hours = np.array([24 * d + h for d in range(12) for h in range(6, 22)])
    at = ((hours + random.uniform(0.3, 0.7, len(hours))) / step).astype(int)
    w, start = len(hours), 3600.0 * hours
    value = -0.035 * (hall + heat - 30)[at] + 0.001 * random.standard_normal(w)
    conditions = Conditions(
        start, start + 3600, sensed[at, None], np.zeros((w, 1, 5)), np.ones((w, 1)), np.zeros(w), None
    )
    shift, first = hours // 24, hours < 24 * 6
    design = design_of(conditions, 0, first, None)
    noise = Noise(np.full(w, 1e-6), 0.0, 1e-6)
    fit = fit_normal_state(design.matrix, np.where(first, value, np.nan), noise, shift, design.prior)
    expected, _ = fit.posterior.predict(design.matrix)
    cold, error = shift >= 10, value - expected
    assert np.sqrt(np.mean(error[~first & ~cold] ** 2)) < 0.005
    # Oil and thermometer part by up to 3 K on mornings: a law of the thermometer alone is 5 to 12 % off.
    assert abs(error[cold].mean()) < 0.02
