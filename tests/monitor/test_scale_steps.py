"""Torque that another scale of one axis, or a gain of all axes, changes is told from wear."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.monitor.findings.findings import _scales
from jointwear.monitor.reading.windows import blank_statistics
from jointwear.monitor.watching.gain_of_all import gain_of_all
from jointwear.monitor.watching.scale import ScaleStep, scale_steps


def quantity(steps: dict[int, float], alarms: dict[int, int], weak: tuple[int, ...] = (), begin: int = 40):
    """Six axes over ten shifts of eight windows; steps from window `begin` on, alarms at a window."""
    residual, alarm = np.zeros((80, 6)), np.zeros((80, 6), dtype=bool)
    for axis, size in steps.items():
        residual[begin:, axis] = size
    for axis, window in alarms.items():
        alarm[window, axis] = True
    normal = [
        SimpleNamespace(
            fit=SimpleNamespace(left_out_variance=np.array([0.04**2 if j in weak else 1e-6])),
            dispersion=SimpleNamespace(between=0.005),
        )
        for j in range(6)
    ]
    return SimpleNamespace(
        residual=residual, noise=np.full((80, 6), 1e-6), mean=residual, shifts=np.full((80, 6), 2), alarm=alarm,
        axes=normal, starts=[[] for _ in range(6)], dips=[[] for _ in range(6)], baseline=np.zeros(80, dtype=bool),
    )  # fmt: skip


def test_alarms_that_begin_with_another_scale_are_told_beside_it():
    statistics = blank_statistics(np.arange(40) * 3600.0, 3600.0, np.ones(3), True)
    changed = np.zeros((40, 3), dtype=bool)
    changed[24:, 1] = changed[36:, 2] = True
    (told,) = _scales(statistics, np.arange(40) // 4, [ScaleStep(0, 20, 1.1)], changed)
    assert "torque of axis 1 changed by 1.1" in told["words"]
    assert told["words"].endswith("The friction of axis 2 rose with it: look at the gain there before the gear.")
    (alone,) = _scales(statistics, np.arange(40) // 4, [ScaleStep(0, 8, 1.1)], changed)
    assert "rose with it" not in alone["words"]


def test_a_step_of_the_scale_is_told_from_wear_and_taken_over_by_axes_that_step_with_it():
    shift = np.repeat(np.arange(10), 8)
    wear = quantity({2: 0.06}, {2: 50})
    none = np.zeros(80, dtype=bool)
    assert scale_steps(wear, wear, quantity({}, {}), shift, none) == []
    (step,) = scale_steps(wear, wear, quantity({2: 0.06}, {}), shift, none)
    assert (step.axis, step.window, step.factor) == (2, 40, pytest.approx(np.exp(0.06)))
    # A few windows of like conditions before the alarm, in which the scale looks changed and then does not: wear.
    passing = quantity({2: 0.06}, {})
    passing.residual[48:] = 0.0
    late = quantity({2: 0.06}, {2: 45})
    assert scale_steps(late, late, passing, shift, none) == []
    assert [s.axis for s in scale_steps(late, late, quantity({2: 0.06}, {}), shift, none)] == [2]
    # A cabinet scales all axes; the last two hardly move a body.
    level = quantity(dict.fromkeys(range(6), 0.06), {0: 50, 4: 50, 5: 55})
    scale = quantity(dict.fromkeys(range(4), 0.06), {}, weak=(4, 5))
    assert {s.axis for s in scale_steps(level, level, scale, shift, none)} == set(range(6))
    # It is found where no axis has alarmed, at the window at which it came.
    quiet = quantity(dict.fromkeys(range(6), 0.06), {}, begin=43)
    steps = scale_steps(quiet, quiet, quantity(dict.fromkeys(range(4), 0.06), {}, weak=(4, 5), begin=43), shift, none)
    assert {s.axis for s in steps} == set(range(6))
    assert {s.window for s in steps} == {43}
    # A load or a program moves the bodies of all axes, and not their friction: no gain.
    loaded = quantity(dict.fromkeys(range(4), 0.06), {}, weak=(4, 5), begin=43)
    assert scale_steps(quantity({}, {}), quantity({}, {}), loaded, shift, none) == []


def test_what_goes_on_growing_beyond_a_step_of_the_scale_is_wear():
    """As on a wrist whose bodies wandered by 2 % while its friction grew by 3 % a shift (fleet 29)."""
    shift, none = np.repeat(np.arange(10), 8), np.zeros(80, dtype=bool)
    bodies = quantity({3: 0.02}, {})
    steady = quantity({3: 0.028}, {3: 44})
    assert [s.axis for s in scale_steps(steady, steady, bodies, shift, none)] == [3]
    worn = quantity({3: 0.028}, {3: 44})
    worn.residual[48:, 3] += 0.03
    worn.residual[56:, 3] += 0.03
    assert scale_steps(worn, worn, bodies, shift, none) == []


def test_wear_beside_a_heavier_part_is_no_other_scale_of_its_axis():
    """As on an arm whose part grew 1.4 times heavier while axis 4 wore (fleet 23): all bodies move, friction of one."""
    shift, none = np.repeat(np.arange(10), 8), np.zeros(80, dtype=bool)
    worn = quantity({3: 0.067}, {3: 45})
    bodies = quantity(dict(enumerate((0.032, 0.04, 0.049, 0.08, 0.019, 0.048))), {})
    assert scale_steps(worn, worn, bodies, shift, none) == []
    # Bodies of one more axis alone may have moved by chance; a torque whose friction moves with it has another scale.
    assert [s.axis for s in scale_steps(worn, worn, quantity({3: 0.08, 1: 0.04}, {}), shift, none)] == [3]
    cabinet = quantity({3: 0.067, 1: 0.04, 2: 0.045}, {3: 45})
    assert 3 in {s.axis for s in scale_steps(cabinet, cabinet, quantity({3: 0.08, 1: 0.04, 2: 0.045}, {}), shift, none)}


def test_another_scale_of_one_axis_is_told_though_a_load_takes_part_of_it_away():
    """As on an arm without a part whose shoulder had a gain of 1.09 (fleet 25): a lighter load seems to explain some of
    it, and the bodies of the elbow and the wrist go the opposite way."""
    shift, none = np.repeat(np.arange(10), 8), np.zeros(80, dtype=bool)
    level = quantity({0: -0.008, 1: 0.063, 2: 0.007, 3: 0.007}, {1: 50})
    bodies = quantity({0: 0.008, 1: 0.067, 2: -0.039, 3: -0.03, 5: -0.014}, {})
    (step,) = scale_steps(level, level, bodies, shift, none)
    assert (step.axis, step.window, step.factor) == (1, 40, pytest.approx(np.exp(0.067)))


def test_a_gain_of_all_axes_is_told_though_a_load_takes_part_of_it_away_and_the_weather_is_none():
    shift, none = np.repeat(np.arange(10), 8), np.zeros(80, dtype=bool)
    # As on a robot whose torque was scaled by 1.1: the bodies of the wrist hardly show it.
    rubbed = dict(enumerate((0.125, 0.076, 0.1, 0.11, 0.115, 0.125)))
    moved = dict(enumerate((0.085, 0.056, 0.034, 0.013, -0.015, 0.095)))
    level = quantity(rubbed, {}, begin=43)
    steps = gain_of_all(level, quantity(moved, {}, begin=43), shift, none)
    assert [s.axis for s in steps] == list(range(6))
    assert {s.window for s in steps} == {43}
    assert steps[0].factor == pytest.approx(np.exp(0.09))
    # Weather moves all friction and no body, a gain of one axis one of each, wear one axis.
    assert gain_of_all(level, quantity({}, {}), shift, none) == []
    assert gain_of_all(quantity({2: 0.1}, {}), quantity({2: 0.1}, {}), shift, none) == []
    # One axis that keeps both has another amplifier.
    kept = [s.axis for s in gain_of_all(quantity({**rubbed, 4: 0.0}, {}), quantity(moved, {}), shift, none)]
    assert kept == [0, 1, 2, 3, 5]
