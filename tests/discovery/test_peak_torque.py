"""The interval of the largest torque: where the torque vanishes, beyond the arguments that were seen, fast waves."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.estimates.fast_waves import draw_unfiltered, lost_to_speed
from jointwear.discovery.estimates.largest_torque import peak_of
from jointwear.discovery.estimates.peak_torque import DRAWS, Shape, draw_beyond, draw_form_errors, prior_of, zeros_of
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.settings import Settings
from jointwear.effects import get_effect


def test_torque_may_vanish_between_the_temperatures_of_recordings_and_beyond_them():
    temperature = np.repeat([20.0, 45.0], 200)[:, None]
    velocity = np.tile(np.linspace(-1.0, 1.0, 200), 2)[:, None]
    velocity[:200] *= 0.1
    state = SimpleNamespace(temperature=temperature, velocity=velocity, direction=np.sign(velocity))
    warm = Candidate("temperature_dependent_viscous_friction", 0, None, {"reference": 30.0, "scale": 40.0})
    zeros = np.concatenate(zeros_of(state, warm, np.ones(400, dtype=bool)))

    def at(t):
        return np.expm1(-(t - 30.0) / 40.0)

    assert np.all(np.diff(zeros) < 0)
    assert zeros[0] > at(20.0)
    assert zeros[-1] < at(45.0)
    assert np.abs(zeros - at(30.0)).min() < 0.1


def _spring(position):
    state = SimpleNamespace(position=position[:, None], velocity=np.ones((len(position), 1)))
    used = np.ones((len(position), 1), dtype=bool)
    return SimpleNamespace(state_of=lambda *a: state, problem=SimpleNamespace(usable=used)), state


def test_a_curve_through_what_was_seen_holds_there_and_says_little_elsewhere():
    white, _ = _spring(np.linspace(-1.0, 1.0, 50))
    _, test = _spring(np.array([0.0, 0.9, 1.5, 3.0]))
    spring = Candidate("joint_spring", 0, None, {"centre": 0.0, "low": -1.0, "high": 1.0})
    drawn = draw_beyond(white, spring, 10.0, test, np.random.default_rng(1))
    assert drawn.shape == (4, DRAWS)
    assert not drawn[:2].any()
    assert drawn.std(axis=1)[2:] == pytest.approx([5.0, 20.0], rel=0.1)


def _wave(taken):
    rng = np.random.default_rng(3)
    speed = np.repeat(np.linspace(0.1, 3.0, 60), 50)
    position = np.cumsum(speed) * 0.01
    drive = SimpleNamespace(gear_ratio=np.array([100.0]))
    state = SimpleNamespace(
        position=position[:, None],
        velocity=speed[:, None],
        drive=drive,
        passed=lambda axis, waves: 1.0,
        derives=None,
        waves_of=lambda axis, count: np.stack([np.sin(count * position), np.cos(count * position)], axis=1),
    )
    amplitude = 2.0 * (1 - taken * (speed / speed.max()) ** 2)
    target = amplitude * np.sin(100 * position) + 0.1 * rng.standard_normal(len(speed))
    problem = SimpleNamespace(
        train_state=state,
        usable=np.ones((len(speed), 1), dtype=bool),
        rows_used=[np.arange(len(speed))],
        settings=Settings(),
        scale=np.array([5.0]),
    )
    white = SimpleNamespace(problem=problem, state_of=lambda *a: state, columns=lambda axis, x: x)
    constant = Term("constant", {0: np.ones((len(speed), 1))}, np.ones(1), {0: np.ones((len(speed), 1))})
    return white, Fit([target], [constant])


@pytest.mark.parametrize(("taken", "low", "high"), [(0.0, 0.0, 0.02), (0.5, 0.1, 0.4)])
def test_what_a_wave_loses_with_the_speed_is_what_a_log_takes_of_it(taken, low, high):
    white, fit = _wave(taken)
    lost = lost_to_speed(white, fit, Candidate("cogging_torque", 0, None, {"order": 1.0}))
    assert low <= lost <= high


def test_what_is_no_wave_loses_nothing():
    white, fit = _wave(0.5)
    assert lost_to_speed(white, fit, Candidate("joint_spring", 0, None, {})) == 0.0


def test_a_wave_may_be_higher_than_filters_leave_it_and_is_not_lower():
    height, left = np.array([1.0, 2.0, 9.0]), np.array([1.0, 0.5, 0.001])
    effect = SimpleNamespace(left=lambda *a: left, shape=lambda *a: (height * left, None))
    draws = draw_unfiltered(
        effect, None, Candidate("cogging_torque", 0, None, {}), np.ones(3, dtype=bool), 500, np.random.default_rng(2)
    )
    assert draws.min() >= 1.0
    assert 1.9 < draws.max() <= 2.0


def test_a_peak_beside_reversals_may_be_higher_not_lower():
    settings, rng = Settings(), np.random.default_rng(4)
    sharp = draw_form_errors(get_effect("presliding_hysteresis"), settings, rng)
    plain = draw_form_errors(get_effect("joint_spring"), settings, rng)
    either = draw_form_errors(get_effect("actuation_delay"), settings, rng)
    assert np.quantile(either, 0.025) < 0.5 < 2.0 < np.quantile(either, 0.975)
    assert np.quantile(sharp, 0.975) > 2.0
    assert np.quantile(sharp, 0.025) > 0.8
    assert abs(np.median(plain) - 1.0) < 0.02


def _coupled(velocity):
    """Return a problem of two axes whose drives turn at velocities (m, 2), and its samples."""
    state = SimpleNamespace(
        velocity=velocity,
        acceleration=np.gradient(velocity, axis=0),
        direction=np.sign(velocity),
        record=None,
        rests_of=lambda *a: [],
    )
    problem = SimpleNamespace(
        usable=np.ones(velocity.shape, bool),
        rows_used=[np.arange(len(velocity))] * 2,
        settings=Settings(),
        scale=np.array([5.0, 5.0]),
    )
    return SimpleNamespace(problem=problem, state_of=lambda *a: state), state


@pytest.mark.parametrize("share", [0.0, 0.01])
def test_friction_that_training_never_turns_is_no_more_than_that_of_its_drive(share):
    """Where this axis is always the faster one, what the other changes of its sense is nothing in training."""
    wave = np.sin(np.linspace(0.0, 60.0, 2000))
    other = 0.3 * wave
    other[: int(share * len(other))] *= -10.0
    white, state = _coupled(np.stack([other, wave], axis=1))
    coupling = Candidate("drive_coupling", 1, 0, {"own": 1.0, "other": 1.0})
    shape = Shape(coupling, drive="own")
    columns = shape.columns(state)
    assert np.any(columns[:, 0]) == (share > 0)
    std = prior_of(white, shape, columns)
    assert 0 < std[0] <= 1.01 * Settings().usual * 5.0


def test_a_column_that_training_never_moves_has_no_coefficient():
    velocity = np.stack([np.zeros(500), np.sin(np.linspace(0.0, 30.0, 500))], axis=1)
    white, state = _coupled(velocity)
    shape = Shape(Candidate("drive_coupling", 1, 0, {"own": 1.0, "other": 1.0}))
    assert list(prior_of(white, shape, shape.columns(state)) > 0) == [True, False, False]


def test_the_largest_torque_lies_within_its_interval_and_an_end_that_was_moved_is_told():
    drawn = np.linspace(10.0, 12.0, 401)
    inside = peak_of(11.5, drawn)
    assert (inside.value, inside.beyond) == (11.5, None)
    assert 10.0 < inside.low < inside.value < inside.high < 12.0
    for fitted in (18.6, 2.5):
        outside = peak_of(fitted, drawn)
        assert outside.low < outside.value == 11.0 < outside.high
        assert outside.beyond == fitted
        assert fitted in (outside.low, outside.high)
