"""A gain of the torque of single axes is told from what is logged, before conditions of operation explain it away."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import make_log, model
from monitor_windows import COULOMB, NOISE, PER_WINDOW, SETTINGS, VISCOUS, motion, statistics_of
from test_monitor_windows import statistics

from jointwear.monitor.findings.findings import _scales
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.normal.series import Series
from jointwear.monitor.reading.windows import blank_statistics
from jointwear.monitor.watching.gain_of_axes import gains_of_axes, without_gain
from jointwear.monitor.watching.scale import ScaleStep

#: Ten shifts of eight windows, four of them the baseline; the step begins at the third window of the sixth.
SHIFT = np.arange(80) // 8
BASELINE = SHIFT < 4
BEGIN = 42


def series(steps: dict[int, float], seed: int, scatter: float = 0.003) -> Series:
    """Logs of six axes that step from `BEGIN` on."""
    rng = np.random.default_rng(seed)
    value = scatter * rng.standard_normal((80, 6))
    for axis, size in steps.items():
        value[BEGIN:, axis] += size
    return Series(value, np.full((80, 6), scatter**2), np.ones(6), np.ones(6))


def told(friction, bodies, events=None, regime=None):
    return gains_of_axes(friction, bodies, regime, SHIFT, BASELINE, events or [[]] * 6)


@pytest.mark.parametrize("factor", [0.8, 1.05, 1.25])
@pytest.mark.parametrize("axes", [(2,), range(6)], ids=["one axis", "all axes"])
def test_friction_and_bodies_that_step_by_one_factor_are_a_gain(factor, axes):
    both = dict.fromkeys(axes, float(np.log(factor)))
    found = told(series(both, 1), series(both, 2))
    assert [(s.axis, s.window) for s in found] == [(j, BEGIN) for j in axes]
    assert [s.factor for s in found] == pytest.approx([factor] * len(found), abs=0.005)


@pytest.mark.parametrize(
    ("rubs", "moves"),
    [
        ({2: 0.2}, {}),
        ({}, {2: 0.2}),
        ({2: 0.2}, {2: 0.1}),
        ({2: 0.1}, {2: -0.1}),
        ({2: 0.02}, {2: 0.02}),
        ({1: 0.1, 2: 0.03}, {1: 0.1, 2: 0.15, 4: 0.2}),
    ],
    ids=["wear", "bodies alone", "another share", "opposite", "small", "a load that one axis feels alike"],
)
def test_wear_and_loads_are_none(rubs, moves):
    assert told(series(rubs, 1), series(moves, 2)) == []


def test_one_shift_alone_or_after_an_event_or_in_a_new_program_is_none():
    both = series({2: 0.2}, 1), series({2: 0.2}, 2)
    assert told(*both)
    assert told(*both, events=[[], [], [40], [], [], []]) == []
    assert told(*both, events=[[], [40], [10], [], [], []])
    assert told(*both, regime=np.where(np.arange(80) < BEGIN, 0, 1)) == []
    passing = [replace(s, value=np.where((np.arange(80) >= 48)[:, None], 0.0, s.value)) for s in both]
    assert told(*passing) == []
    # A baseline that scatters by as much as the step says nothing.
    assert told(series({2: 0.2}, 1, scatter=0.2), both[1]) == []


def test_a_product_that_comes_back_in_a_cold_spell_is_none():
    """As on a robot whose part of 0.9 kg turned about its first axis in some shifts, and once in a cold week."""
    cold = np.isin(SHIFT, (6, 7, 8))[:, None] * (np.arange(6) == 2)
    carried = np.isin(SHIFT, (4, 7, 8))[:, None] * (np.arange(6) == 2)
    rubs, moves = series({}, 1), series({}, 2)
    rubbed = replace(rubs, value=rubs.value + 0.13 * cold)
    assert told(rubbed, replace(moves, value=moves.value + 0.13 * carried)) == []
    # Without a shift in which the bodies moved alone it is a gain.
    first = carried & (SHIFT > 4)[:, None]
    assert [s.axis for s in told(rubbed, replace(moves, value=moves.value + 0.13 * first))] == [2]


def test_a_gain_of_an_axis_that_wears_is_told_beside_its_wear():
    """As of all axes of a robot of the shop floor (`choose` 513) whose sixth had grown by 6 %."""
    rubs, moves = series({}, 1), series({}, 2)
    gained = 0.1 * (np.arange(80) >= 66)[:, None] * np.isin(np.arange(6), (2, 3))
    worn = np.interp(np.arange(80), [32, 56], [0.0, 0.06])[:, None] * (np.arange(6) == 2)
    found = told(replace(rubs, value=rubs.value + gained + worn), replace(moves, value=moves.value + gained))
    assert [(s.axis, s.window) for s in found] == [(2, 66), (3, 66)]
    assert [s.factor for s in found] == pytest.approx([np.exp(0.1)] * 2, abs=0.01)
    assert told(replace(rubs, value=rubs.value + worn), moves) == []


def test_a_gain_of_most_axes_is_told_of_those_whose_bodies_say_little():
    """As on an arm whose wrist carries parts by lots: its bodies move by half of themselves from shift to shift."""
    rubs, moves = (series(dict.fromkeys(range(6), 0.14), seed) for seed in (1, 2))
    parts = moves.value.copy()
    parts[:, 4:] += np.where(SHIFT % 2, 0.3, -0.3)[:, None]
    found = told(rubs, replace(moves, value=parts))
    assert [(s.axis, s.window) for s in found] == [(j, BEGIN) for j in range(6)]
    # Friction that stays, bodies that stay or something that was done to it speak against it.
    other = series(dict.fromkeys(range(5), 0.14), 1)
    assert [s.axis for s in told(other, replace(moves, value=parts))] == list(range(5))
    still = series(dict.fromkeys(range(4), 0.14), 2)
    assert [s.axis for s in told(rubs, still)] == list(range(4))
    events = [[], [], [], [], [], [40]]
    assert [s.axis for s in told(rubs, replace(moves, value=parts), events=events)] == list(range(5))
    # Two of six are no common cause.
    light = replace(moves, value=np.where(np.arange(6) < 2, parts, parts[:, 4:5]))
    assert [s.axis for s in told(rubs, light)] == [0, 1]


@pytest.mark.parametrize("factor", [0.9, 1.15])
def test_a_gain_is_told_where_gravity_turns_with_the_motion_and_looks_like_friction(factor):
    """As of an axis that lifts one way and lowers the other in its only cycle (one of six, 0.9): gravity is held in its
    estimate of friction, which a gain then moves by a third more than the bodies."""
    x = motion()
    x[:, 1, 3] = 6.0 * np.sign(x[:, 1, 2]) + np.random.default_rng(2).normal(0, 3, PER_WINDOW)
    torque = x[..., 0] * COULOMB[:, 0] + x[..., 1] * COULOMB[:, 1] + x[..., 2] * VISCOUS + x[..., 3] + x[..., 4]
    residual = 0.1 * NOISE * np.random.default_rng(3).standard_normal((200, PER_WINDOW, 3))
    residual[120:, :, 1] += (factor - 1) * torque[:, 1]
    judgement = judge(statistics_of(residual, x=x), 80, SETTINGS)
    (scale,) = [f for f in judgement.findings if f["kind"] == "scale"]
    assert (scale["axes"], scale["time"]) == ([2], 120 * 3600.0)
    assert f"of axis 2 changed by {factor:.3g}:" in scale["words"]
    assert judgement.alarms == []
    assert abs(judgement.estimates["coulomb_percent"][-1, 1]) < 1.0


def test_windows_without_a_gain_are_those_of_the_torque_divided_by_it():
    log, arm = make_log(36.0, seed=3, noise=0.3), model()
    factor, robot = 1.3, arm.robot
    later = log.time >= 24.0
    torque = log.torque.copy()
    torque[later, 1] *= factor
    gained = statistics(replace(log, torque=torque))
    step = ScaleStep(1, 2, factor)
    level = np.abs([robot.coulomb_positive[1], robot.coulomb_negative[1]])
    mended = without_gain(gained, step, level, float(np.abs(robot.viscous[1])))
    assert not np.allclose(gained.moment[2, 1], mended.moment[2, 1])
    plain = statistics(log)
    np.testing.assert_allclose(mended.moment, plain.moment, rtol=1e-4)
    for name in ("square", "residual_square", "lag_square", "score", "pulse_near", "pulse_far", "torque_peak"):
        np.testing.assert_allclose(getattr(mended, name), getattr(plain, name), rtol=1e-3, atol=1e-6, err_msg=name)


def test_axes_of_one_gain_are_named_in_order():
    blank = blank_statistics(np.arange(40) * 3600.0, 3600.0, np.ones(3), True)
    steps = [ScaleStep(1, 20, 1.2), ScaleStep(2, 20, 1.2), ScaleStep(0, 20, 1.2)]
    (one,) = _scales(blank, np.arange(40) // 4, steps, np.zeros((40, 3), dtype=bool))
    assert one["axes"] == [1, 2, 3]
    assert "torque of axes 1, 2 and 3 changed by 1.2" in one["words"]


def test_a_gain_begins_with_the_bodies_though_cold_hides_it_in_the_friction():
    """Friction that cold had raised fitted the factor of the bodies some days later alone: the gain was told then, and
    what was left of it before once more, so that no axis was judged for a week."""
    both = dict.fromkeys(range(6), float(np.log(1.05)))
    friction, bodies = series(both, 1), series(both, 2)
    friction.value[BEGIN:64] += 0.04
    found = told(friction, bodies)
    assert [(s.axis, s.window) for s in found] == [(j, BEGIN) for j in range(6)]
    # An axis whose friction scatters shows it late, and behind an odd shift: it makes no second gain.
    friction.value[:32, 4] += np.repeat([0.012, -0.012, 0.012, -0.012], 8)
    friction.value[BEGIN:, 4] += np.where(np.arange(BEGIN, 80) < 64, -0.05, 0.01)
    bodies.value[56:64, 4] = 0.0
    found = told(friction, bodies)
    assert [(s.axis, s.window) for s in found] == [(j, BEGIN) for j in range(6)]
    # One that steps by as much later is one of its own.
    bodies.value[BEGIN:64, 4] = 0.0
    assert {s.window for s in told(friction, bodies) if s.axis == 4} == {64}
    # Friction without a gain leaves bodies that stepped before alone.
    friction.value[BEGIN:64] = 0.0
    bodies.value[BEGIN:64, 4] = bodies.value[64:, 4].mean()
    assert not [s for s in told(friction, bodies) if s.window < 56]
