"""Shaking whose rate changes, in the mean of all records."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.search.residual_lines import strongest_line

RATE, SAMPLES, RECORDS = 100.0, 1100, 3


def test_a_sweep_that_starts_with_every_record_is_found_in_all_before_it_is_in_one():
    rng = np.random.default_rng(7)
    clock = np.arange(SAMPLES) / RATE
    wave = 0.3 * np.sin(2 * np.pi * (0.7 * clock + 0.4 * clock**2))
    state = SimpleNamespace(record=np.repeat(np.arange(RECORDS), SAMPLES))
    noise = rng.standard_normal(RECORDS * SAMPLES)
    shaken = noise + np.tile(wave, RECORDS)
    rows = np.arange(len(noise))
    line = strongest_line(shaken, rows, state, RATE)
    assert line.p_value < 1e-8
    assert (line.record, line.rate) == (-1, pytest.approx(0.8, abs=0.03))
    # One record alone does not tell, nor do records of which each is another sweep.
    one = SimpleNamespace(record=np.zeros(SAMPLES, int))
    assert strongest_line(shaken[:SAMPLES], rows[:SAMPLES], one, RATE).p_value > 1e-8
    others = [0.3 * np.sin(2 * np.pi * (0.7 * clock + 0.5 * c * clock**2)) for c in (0.3, 0.8, 1.3)]
    assert strongest_line(noise + np.concatenate(others), rows, state, RATE).p_value > 1e-8


def test_a_slow_push_in_one_record_is_no_wave_at_the_end_of_the_band_of_chirps():
    """Pages told of shaking at 20.46 Hz where a hose, a push or a brake was slow: sweeps that begin below zero end up
    at the top of the band that is turned back."""
    rate, count = 200.0, 5000
    clock, rng = np.arange(count) / rate, np.random.default_rng(0)
    state = SimpleNamespace(record=np.repeat(np.arange(RECORDS), count))
    pushes = [a * np.exp(-0.5 * ((clock - at) / 0.6) ** 2) for a, at in ((2.5, 8.0), (0.0, 15.0), (0.0, 4.0))]
    line = strongest_line(
        rng.standard_normal(RECORDS * count) + np.concatenate(pushes), np.arange(3 * count), state, rate
    )
    assert line.frequency < 1.0


def test_what_is_slow_in_every_record_is_no_sweep():
    """Of slow noise a sweep that begins below zero holds a part in each record, and more of it in all."""
    rng = np.random.default_rng(3)
    state = SimpleNamespace(record=np.repeat(np.arange(RECORDS), SAMPLES))
    slow = 0.6 * np.cumsum(rng.standard_normal((RECORDS, SAMPLES)), axis=1) / np.sqrt(SAMPLES / 2)
    line = strongest_line(slow.ravel() + rng.standard_normal(slow.size), np.arange(slow.size), state, RATE)
    assert line.frequency < 1.0
