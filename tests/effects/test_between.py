"""Samples between samples."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from jointwear.effects.between import Between
from jointwear.files.errors import InputError

TIME = np.arange(40) / 20.0


def test_a_smooth_signal_is_read_off_at_any_time_of_its_record_and_held_beyond_its_ends():
    both = np.concatenate([TIME, TIME])
    values = np.stack([np.sin(both), both**2], axis=1)
    values[40:] += 100.0
    found = Between(both, values, [slice(0, 40), slice(40, 80)]).earlier(0.031)
    wanted = np.stack([np.sin(both - 0.031), (both - 0.031) ** 2], axis=1)
    wanted[40:] += 100.0
    wanted[[0, 40]] = values[[0, 40]]
    np.testing.assert_allclose(found, wanted, atol=1e-7)


def test_beyond_the_ends_of_a_record_what_is_turned_goes_on_and_the_rest_is_held():
    values = np.stack([3.0 - 2.0 * TIME, 3.0 - 2.0 * TIME], axis=1)
    between = Between(TIME, values, [slice(0, 40)], turned=[0])
    for delay in (0.12, -0.12):
        line = 3.0 - 2.0 * (TIME - delay)
        np.testing.assert_allclose(between.earlier(delay)[:, 0], line, atol=1e-9)
        held = np.clip(line, values[-1, 1], values[0, 1])
        np.testing.assert_allclose(between.earlier(delay)[:, 1], held, atol=1e-9)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_records_too_short_for_the_splines_have_straight_lines(count):
    time, values = TIME[:count], np.arange(count) ** 2.0
    found = Between(time, values, [slice(0, count)]).earlier(0.02)
    np.testing.assert_allclose(found, np.interp(time - 0.02, time, values))


@pytest.mark.parametrize("count", [4, 40])
@pytest.mark.parametrize(
    ("broken", "words"),
    [
        (lambda t, x: t.__setitem__(3, t[2]), "sample 3: its time 0.1 s does not lie behind"),
        (lambda t, x: t.__setitem__(3, np.nan), "sample 3: time and values have to be finite"),
        (lambda t, x: x.__setitem__((2, 1), np.nan), "sample 2: time and values have to be finite"),
    ],
)
def test_times_that_do_not_rise_and_values_that_are_unknown_are_named(count, broken, words):
    time, values = TIME[:count].copy(), np.zeros((count, 2))
    broken(time, values)
    with pytest.raises(InputError, match=words):
        Between(time, values, [slice(0, count)])


@pytest.mark.parametrize("delay", [0.013, -0.0027, 0.02, -0.06, 0.0])
@pytest.mark.parametrize("jitter", [0.0, 1e-4])
def test_samples_are_read_as_the_spline_says(delay, jitter):
    """At the ends of a record too, and where samples are not even."""
    time = 3.0 + 0.004 * np.arange(300)
    time += jitter * np.sin(time)
    values = np.random.default_rng(5).standard_normal((300, 2))
    wanted = make_interp_spline(time, values, k=5)(np.clip(time - delay, time[0], time[-1]))
    found = Between(time, values, [slice(0, 300)]).earlier(delay)
    np.testing.assert_allclose(found, wanted, atol=1e-11)
