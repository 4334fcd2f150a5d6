"""Backlash: pulses of the torque where the load of a gear reverses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from monitor_windows import SETTINGS, residuals, statistics_of

from jointwear.monitor.judging.judge import judge
from jointwear.monitor.normal.series import friction_series, known_coulomb
from jointwear.monitor.reading.accumulate import Samples, WindowSettings, window_statistics
from jointwear.monitor.reading.model import ModelTorque
from jointwear.monitor.reading.program_labels import label_text
from jointwear.monitor.reading.reversals import SLOWEST, pulses, reach_of
from jointwear.monitor.reading.windows import merge
from jointwear.monitor.watching.backlash import (
    BACKLASH,
    COARSEST,
    FEWEST_TURNS,
    _outlasts_a_batch,
    backlash_series,
    hidden_because,
)
from jointwear.monitor.watching.records import CHANGED
from jointwear.monitor.watching.watched_axis import UNSEEN
from jointwear.studies.shop_floor.cell import draw_cell
from jointwear.studies.shop_floor.closed_loop import RATE, SAMPLES, Runs, at_phase
from jointwear.studies.shop_floor.gear import NEW_GAP
from jointwear.studies.shop_floor.lost_motion import drive_with_gaps

WINDOWS = 150


@pytest.fixture(scope="module")
def plant():
    """Six windows of new gears and six with a gap of a milliradian in all axes, as window statistics."""
    return windows_of_gears()


def windows_of_gears(known=1.0):
    """Return the windows, and Coulomb friction (n, 2); the robot file has the part `known` of all friction."""
    cell = draw_cell("choose", 1)
    w, n = 12, 6
    job = cell.jobs(0, float(cell.month.mass[cell.logged[0]]))
    runs = Runs(np.zeros(w), np.ones(w), np.full((w, n), 30.0), np.ones((w, n)), np.ones((w, n)))
    gap = np.full((w, n), NEW_GAP)
    gap[6:] = 1e-3
    driven = drive_with_gaps([job], np.zeros(w, dtype=int), cell.arm, cell.gear, cell.controller, runs, gap)
    phase = np.broadcast_to(np.arange(SAMPLES) / RATE, (w, SAMPLES))
    bodies = at_phase(job.true, phase)
    velocity = at_phase(job.program.velocity, phase) + driven.rate
    level = np.array(cell.arm.coulomb)
    random = np.random.default_rng(3)
    torque = driven.torque + 0.01 * level * random.standard_normal(driven.torque.shape)
    total = bodies.sum(axis=2) + known * (level * np.sign(velocity) + np.array(cell.arm.viscous) * velocity)
    rows = {"position": at_phase(job.program.position, phase), "velocity": velocity, "torque": torque}
    flat = {name: values.reshape(-1, n) for name, values in rows.items()}
    model = ModelTorque(*(x.reshape(-1, n) for x in (total, bodies[:, :, 0], bodies[:, :, 1])))
    time = (3600.0 * np.arange(w)[:, None] + np.arange(SAMPLES) / RATE).ravel()
    settings = WindowSettings(3600.0, np.full(n, 0.02), 10 * level, reach=reach_of(RATE))
    found = window_statistics(Samples(time, model=model, stretch=np.repeat(np.arange(w), SAMPLES), **flat), settings)
    return found, np.stack([level, level], axis=1)


def test_a_gap_in_the_gear_shows_as_pulses_where_the_load_reverses(plant):
    statistics, coulomb = plant
    reasons = hidden_because(statistics, coulomb, np.arange(12) < 6)
    assert not reasons[0]
    series = backlash_series(statistics, np.array([not reason for reason in reasons]))
    new, worn = series.value[:6, 0], series.value[6:, 0]
    assert worn.mean() - new.mean() > 0.5
    assert new.std() < 0.1
    assert np.sqrt(series.variance[:, 0]).max() < 0.2


def test_where_the_gear_stays_on_one_flank_or_friction_rules_backlash_cannot_be_judged(plant):
    statistics, coulomb = plant
    reasons = hidden_because(statistics, coulomb, np.arange(12) < 6)
    assert "one direction" in reasons[1]
    assert "friction" in reasons[5]
    slow = replace(statistics, near_count=0 * statistics.near_count, far_count=0 * statistics.far_count)
    assert all("too far apart" in r for r in hidden_because(slow, coulomb, np.arange(12) < 6)[:1])
    # What later windows hold is no reason of the baseline.
    after = (np.arange(12) >= 6)[:, None]
    late = replace(statistics, near_count=after * statistics.near_count, far_count=after * statistics.far_count)
    assert hidden_because(late, coulomb, np.arange(12) < 6) == hidden_because(slow, coulomb, np.arange(12) < 6)
    assert reach_of(0.9 * SLOWEST) == 0


@pytest.mark.long
def test_where_friction_rules_a_robot_file_without_it_hides_backlash_too():
    """What the baseline shows of Coulomb friction tells."""
    bare, nominal = windows_of_gears(known=0.0)
    baseline = np.arange(12) < 6
    friction = friction_series(bare, 0 * nominal, np.zeros(len(nominal)), baseline)["friction"]
    found = known_coulomb(0 * nominal, friction, baseline)
    # Where the motion does not tell viscous friction, all of it counts.
    assert np.all((found > 0.8 * nominal) & (found < 1.8 * nominal))
    assert np.all(known_coulomb(nominal, friction, baseline) == nominal)
    reasons = hidden_because(bare, found, baseline)
    assert not reasons[0]
    assert "friction" in reasons[5]


def test_what_the_model_misses_is_no_filter(plant):
    statistics, coulomb = plant
    for missed, words in ((0.5, "the model misses too much of its torque"), (0.1, "filtered too much")):
        square = statistics.freedom * (missed * coulomb.mean(axis=1)) ** 2
        blurred = replace(statistics, residual_square=square, pulse_far=1e-9 * statistics.pulse_far)
        assert words in hidden_because(blurred, coulomb, np.arange(12) < 6)[0]


def test_noise_ripple_and_scale_leave_the_ratio_as_it_is():
    m = 6000
    random = np.random.default_rng(0)
    bodies = 5.0 * np.sin(np.arange(m) / 40.0)[:, None]
    model = ModelTorque(bodies + 1.0, np.zeros((m, 1)), bodies)
    used = np.ones((m, 1), dtype=bool)
    residual = random.standard_normal((m, 1))

    def ratio(values):
        found = pulses(values.T, model, used, np.zeros(m), 5)
        assert 0.1 < found.near.mean() < 0.9
        return (found.square * found.near).sum() / found.near.sum() / (found.square * found.far).sum() * found.far.sum()

    assert ratio(residual) == pytest.approx(1.0, abs=0.15)
    assert ratio(7.0 * residual) == pytest.approx(ratio(residual))
    # What lies within reach of a gap in the samples is not known.
    stretch = (np.arange(m) >= 3000).astype(int)
    whole = pulses(residual.T, model, used, stretch, 5)
    assert not (whole.near | whole.far)[:, 2995:3006].any()


def windows_of(error, kept=slice(None)):
    """Statistics of two windows of 30 s whose bodies turn round every second and are `error` of themselves wrong."""
    m = 3000
    random = np.random.default_rng(1)
    time = np.arange(m) / 50.0
    bodies = (8.0 * np.sign(np.sin(np.pi * time)) * np.abs(np.sin(np.pi * time)) ** 0.3)[:, None]
    velocity = (1.0 + 0.5 * np.sin(0.7 * time))[:, None]
    zeros = np.zeros((m, 1))
    model = ModelTorque(bodies + 1.0, zeros, bodies)
    torque = model.total + error * bodies + 0.1 * random.standard_normal((m, 1))
    settings = WindowSettings(30.0, np.full(1, 0.02), np.full(1, 20.0), reach=reach_of(50.0))
    return window_statistics(Samples(time, zeros, velocity, torque, model), settings, kept)


def test_bodies_that_are_wrong_show_no_pulses():
    right, wrong = windows_of(0.0), windows_of(0.15)
    assert right.turns.min() >= FEWEST_TURNS
    for name in ("pulse_near", "pulse_far"):
        np.testing.assert_allclose(getattr(wrong, name), getattr(right, name), rtol=1e-4)


def test_pulses_of_a_window_hardly_depend_on_where_a_block_ends():
    whole = windows_of(0.15)
    parts = merge(
        [windows_of(0.15, slice(0, 700)), windows_of(0.15, slice(700, 2000)), windows_of(0.15, slice(2000, 3000))]
    )
    for name in ("near_count", "far_count", "turns"):
        np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name))
    for name in ("pulse_near", "pulse_far"):
        np.testing.assert_allclose(getattr(parts, name), getattr(whole, name), rtol=0.02)


def with_pulses(growth, seed=0):
    """Statistics of three axes of which the second has pulses that grow by `growth` (w,)."""
    statistics = statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), seed))
    random, shape = np.random.default_rng(seed), (WINDOWS, 3)
    count = 300
    statistics.near_count[:], statistics.far_count[:] = count, count
    statistics.turns[:] = FEWEST_TURNS
    statistics.gram[:, :, 4, 4] *= 40
    noise = 0.5 * statistics.residual_square / statistics.freedom
    for name in ("pulse_near", "pulse_far"):
        getattr(statistics, name)[:] = noise * random.chisquare(count / 4, shape) * 4
    statistics.pulse_near[:, 1] *= (1 + growth) ** 2
    return statistics


def alarms_of(judgement):
    return [a for a in judgement.alarms if a["quantity"] == BACKLASH]


@pytest.mark.long
def test_growing_play_alarms_under_its_own_name_and_steady_play_does_not():
    growth = np.clip((np.arange(WINDOWS) - 90) / 40.0, 0, 1)
    worn = judge(with_pulses(growth), 72, SETTINGS)
    found = alarms_of(worn)
    assert found
    assert {a["axis"] for a in found} == {2}
    assert found[0]["time"] > 90 * 3600
    assert found[0]["unit"] == "%"
    assert found[0]["change_low"] < found[0]["change"] < found[0]["change_high"]
    assert worn.status[-1, 1] == CHANGED
    assert not [a for a in worn.alarms if "friction" in a["quantity"]]
    assert not [f for f in worn.findings if f["kind"] == "proposed_service"]
    assert worn.estimates[BACKLASH][-1, 1] == pytest.approx(100, abs=40)
    # Of pulses twice as large the same relative error is twice as many percent.
    judged = np.isfinite(worn.std[BACKLASH][:, 1])
    before, after = (np.median(worn.std[BACKLASH][part, 1][judged[part]]) for part in (slice(72, 90), slice(-20, None)))
    assert after > 1.5 * before
    for seed in range(3):
        assert not alarms_of(judge(with_pulses(np.zeros(WINDOWS), seed), 72, SETTINGS))


def in_batches(statistics, hours):
    """The same windows, of two programs that take turns every so many hours."""
    batch = np.arange(WINDOWS) // hours
    statistics.labels[:] = [label_text(np.full(50, name)) for name in np.array(["weld", "pick"])[batch % 2]]
    return statistics


@pytest.mark.long
def test_pulses_that_come_and_go_with_a_batch_are_no_play():
    """Poses taught anew for a batch move them as much as a gap does, until the next batch."""
    place = np.arange(WINDOWS)
    batch = 0.45 * ((place >= 96) & (place < 120))
    assert alarms_of(judge(with_pulses(batch), 72, SETTINGS))
    assert not alarms_of(judge(in_batches(with_pulses(batch), 24), 72, SETTINGS))
    play = 0.45 * (place >= 96)
    found = alarms_of(judge(in_batches(with_pulses(play), 24), 72, SETTINGS))
    assert [a["axis"] for a in found] == [2]
    assert found[0]["time"] >= 120 * 3600


def test_what_lasts_over_the_next_batch_or_for_long_outlasts_a_batch():
    def outlasts(growth, program, since=0):
        growth, program = np.repeat(growth, 8), np.repeat(program, 8)
        return _outlasts_a_batch(growth, program, np.arange(len(growth)) // 8, since)

    nan = np.nan
    assert not outlasts([0, 0, 0.4], [0, 1, 0])
    assert not outlasts([0, 0.4, 0], [0, 1, 0])
    assert outlasts([0, 0.4, 0.3], [0, 1, 0])
    # A batch that is not judged lies between; none that is known does.
    assert outlasts([0, 0.4, nan, 0.3], [0, 1, 0, 1])
    assert not outlasts([0, 0.4, nan, 0.3], [0, 1, -1, 1])
    # A program that goes on and on is held against itself no more, nor is the only one there is.
    assert not outlasts([0, *[0.4] * 5], [0, *[1] * 5])
    assert outlasts([0, *[0.4] * 6], [0, *[1] * 6])
    assert outlasts([0.4], [0])
    # What was before a service does not count.
    assert not outlasts([0, 0.4, 0.4], [0, 1, 0], since=16)
    # Programs that take turns all the time are no batches.
    assert _outlasts_a_batch(np.full(40, 0.4), np.arange(40) // 2 % 2, np.arange(40) // 8, 0)


def test_after_a_baseline_of_little_pulses_are_judged_as_they_are_known_well_enough_for_what_alarms():
    assert COARSEST > UNSEEN
    found = judge(in_batches(with_pulses(np.zeros(WINDOWS)), 24), 24, SETTINGS)
    assert np.isfinite(found.estimates[BACKLASH][24:]).mean() > 0.9
    assert not alarms_of(found)


def test_axes_whose_backlash_cannot_be_judged_are_named_with_the_reason():
    statistics = with_pulses(np.zeros(WINDOWS))
    statistics.turns[:, 0] = 0
    told = [f for f in judge(statistics, 72, SETTINGS).findings if f["kind"] == BACKLASH]
    assert [f["axes"] for f in told] == [[1]]
    assert "one flank" in told[0]["words"]
