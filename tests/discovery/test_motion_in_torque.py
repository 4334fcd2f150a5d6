"""Columns of late torque end where the nominal torque is noise, lags only turn it there, and sizes know the noise."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import butter, sosfiltfilt
from test_instruments import RATE, coarse

from jointwear import effects
from jointwear.discovery.estimates.noisy_columns import noise_share
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.noise.motion_in_torque import motion_ends, noise_in_torque
from jointwear.discovery.noise.spectra import density_of, frequencies, pieces_of
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.search.searches import pairs_of_drives
from jointwear.discovery.settings import Settings
from jointwear.effects import make_state
from jointwear.effects.order import turn_by_lag
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import split
from jointwear.robots.robot import load_robot

N, LEVEL = 8000, 0.02


@pytest.fixture(scope="module")
def robot():
    return load_robot("config/robots/puma560.yaml")


@pytest.fixture(scope="module")
def still(robot):
    """A state of 400 samples in which only the time matters."""
    return make_state(robot, *np.zeros((4, 400, 6)), time=np.arange(400) / RATE, record=np.zeros(400, dtype=int))


def _samples():
    """A torque of steps up to 10 Hz and noise of density LEVEL beside it, usable samples and records."""
    rng = np.random.default_rng(11)
    motion = sosfiltfilt(butter(8, 10.0, fs=RATE, output="sos"), rng.standard_normal((N, 1)), axis=0)
    noise = np.sqrt(LEVEL * RATE / 2) * rng.standard_normal((N, 1))
    return 20.0 * motion, noise, (np.ones((N, 1), dtype=bool), np.repeat([0, 1], N // 2), RATE)


def test_a_density_is_that_of_white_noise():
    _, noise, (usable, record, rate) = _samples()
    density = density_of(noise[:, 0][pieces_of(usable[:, 0], record, rate)], rate)
    assert np.mean(density[3:-3]) == pytest.approx(LEVEL, rel=0.05)


def test_motion_ends_where_noise_is_most_of_the_torque():
    motion, noise, samples = _samples()
    derived = np.full((1, len(frequencies(RATE))), LEVEL)
    (end,) = motion_ends(motion + noise, *samples, noise_in_torque(-noise, *samples, derived))
    assert 10.0 < end < 25.0


def test_a_floor_that_the_residual_does_not_hold_is_motion():
    motion, noise, samples = _samples()
    derived = np.full((1, len(frequencies(RATE))), LEVEL)
    held = noise_in_torque(0.1 * noise, *samples, derived)
    assert np.all(held < 0.05 * LEVEL)
    assert motion_ends(motion + noise, *samples, held) == np.inf


def test_of_short_stretches_nothing_is_said():
    motion, noise, (usable, *told) = _samples()
    usable[::20] = False
    derived = np.full((1, len(frequencies(RATE))), LEVEL)
    np.testing.assert_array_equal(noise_in_torque(0.1 * noise, usable, *told, derived), derived)
    assert motion_ends(motion + noise, usable, *told, derived) == np.inf


@settings(max_examples=25, deadline=None)
@given(st.floats(1.0, 40.0), st.floats(0.0, 0.03), st.floats(0.0, 6.0))
def test_what_turns_a_wave_is_the_part_of_a_lag_along_turning_it(still, frequency, lag, phase):
    angle = 2 * np.pi * frequency * still.time + phase
    turn = np.arctan(2 * np.pi * frequency * lag)
    middle, wave = slice(100, 300), np.sin(angle)
    along, lagged = np.sin(angle - turn) - wave, np.cos(turn) * np.sin(angle - turn) - wave
    found = turn_by_lag(still, wave, lag)[middle]
    np.testing.assert_allclose(found, (0.5 * (1 + np.cos(turn)) * along)[middle], atol=0.06)
    # A coefficient of one on it is that of the lag.
    period = slice(100, 100 + round(RATE / frequency) * max(1, round(100 * frequency / RATE)))
    if turn > 0.3:
        part = 0.5 * (1 + np.cos(turn)) * along[period]
        assert (part @ lagged[period]) / (part @ part) == pytest.approx(1.0, abs=0.15)
    assert not turn_by_lag(replace(still, record=None), wave, lag).any()


def test_noise_that_is_turned_hardly_gains_and_filtered_noise_does(still):
    noise, lag = np.random.default_rng(3).standard_normal(len(still.time)), 0.01
    turn = np.arctan(2 * np.pi * lag * np.fft.rfftfreq(len(noise), 1 / RATE))
    filtered = np.fft.irfft(np.fft.rfft(noise) * (np.cos(turn) * np.exp(-1j * turn) - 1), len(noise))
    # The residual holds the noise with the other sign; the coefficient is one.
    gains = [change @ -noise - 0.5 * change @ change for change in (turn_by_lag(still, noise, lag), filtered)]
    assert gains[1] > 0.3 * len(noise)
    assert 0.0 < gains[0] < 0.5 * gains[1]
    # Before a lag it speaks against itself.
    change = turn_by_lag(still, noise, -0.002)
    assert change @ -noise - 0.5 * change @ change < 0.0


def test_a_lag_is_filtered_below_and_turned_above_where_a_dead_time_ends(robot):
    white = filtered(robot, 15)
    delay = effects.get_effect("actuation_delay")
    ends = [(c.timing, c.late) for c in white.cutoffs]
    assert any(late > timing for timing, late in ends)
    for axis, (timing, late) in enumerate(ends):
        assert late <= max(timing, white.problem.motion_ends[axis])
        state = white.state_of(delay, axis, {"delay": 0.01, "lag": 1})
        assert (state.above is None) == (late == timing)
        if state.above is not None:
            dead = white.state_of(delay, axis, {"delay": 0.01, "lag": 0})
            np.testing.assert_allclose((state.torque + state.above)[:, axis], dead.torque[:, axis])
            with_lag = Candidate("actuation_delay", axis, None, {"delay": 0.01, "lag": 1})
            below = delay.columns(white.timing_state(axis), axis, None, with_lag.nonlinear)
            assert np.any(raw_columns(white, with_lag) != below)


def filtered(robot, bits):
    """The whitened problem of a coarse encoder whose positions, with a hole, are filtered: no splines."""
    recording = coarse(robot, seed=6, step=2 * np.pi / 2**bits)
    recording.position[700:703, 5] = np.nan
    problem = build_problem(split(recording), robot, Settings(), measure(recording))
    return whiten(problem, estimate_noise(problem))


def test_the_share_of_noise_in_a_late_torque_grows_with_the_step_of_the_encoder(robot):
    late = Candidate("actuation_delay", 1, None, {"delay": 0.01, "lag": 0})
    shares = [noise_share(w, w.fit(), late) for w in (filtered(robot, bits) for bits in (20, 15))]
    assert 0.0 <= shares[0] < 0.5 * shares[1] <= 0.5


def test_two_joints_share_a_drive_where_each_names_the_other_for_the_same_sum():
    def name(axis, source, own, other, evidence=500.0):
        return Named(Candidate("drive_coupling", axis, source, {"own": own, "other": other}), None, None, evidence)

    both = [name(4, 5, 1.0, -1.0), name(5, 4, 1.0, -1.0)]
    assert pairs_of_drives(both, 100.0) == [{4, 5}, {4, 5}]
    assert not pairs_of_drives(both[:1], 100.0)
    assert not pairs_of_drives([both[0], name(5, 4, 1.0, 1.0)], 100.0)
    assert not pairs_of_drives([both[0], name(5, 4, 0.0, -1.0)], 100.0)
    assert not pairs_of_drives([both[0], name(5, 4, 1.0, -1.0, evidence=50.0)], 100.0)
    spring = Named(Candidate("joint_spring", 5, None), None, None, 500.0)
    assert not pairs_of_drives([both[0], spring], 100.0)
