"""The noise model where a flexible fit takes most of the slow noise, and structure that is too small to matter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import cho_factor, cho_solve

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.noise.noise import (
    HIGHEST_ORDER_DERIVED,
    LEFT_BY_ORDER,
    ORDER_BESIDE_GAPS,
    Whitener,
    estimate,
    highest_order,
    simulate,
    whitenable,
)
from jointwear.discovery.noise.noise_spectrum import (
    POINTS,
    corrected,
    of_density,
    slowest_pole,
    without_slow_torque,
)
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.search.leftovers import unexplained
from jointwear.discovery.search.slow_noise import PRICE
from jointwear.discovery.settings import Settings
from jointwear.measurement.recording import Recording, split
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot

RATE, RECORDS, LENGTH = 50.0, 6, 250


def slow_fit(label):
    """Return the function that takes 40 slow waves off each record, and those below 4 Hz with it."""
    time = np.arange(LENGTH) / RATE
    waves = np.stack([np.cos(np.pi * k * time * RATE / LENGTH) for k in range(40)], axis=1)
    columns = np.kron(np.eye(RECORDS), waves)
    factor = cho_factor(columns.T @ columns + 1e-3 * np.eye(columns.shape[1]))
    return lambda series: series - columns @ cho_solve(factor, columns.T @ series)


@pytest.mark.parametrize(("lag", "factor"), [(0.0, 1.3), (0.7, 3.0)])
def test_what_a_fit_took_off_slow_noise_is_put_back(lag, factor):
    """Of coloured noise all that is slow was taken: what is left tells less of it."""
    label = np.repeat(np.arange(RECORDS), LENGTH)
    used = np.ones(len(label), bool)
    lags = np.array([lag]) if lag else np.zeros(0)
    truth = Whitener(np.arange(len(label)), lags, 1.0)
    take_off = slow_fit(label)
    left = take_off(simulate(truth, label, 1, np.random.default_rng(3)))[:, 0]
    slow = np.array([0.5, 1.0, 2.0])
    learnt = estimate(left, used, label)
    mended = corrected(estimate(left, used, label, 2), left, take_off, used, label, RATE)
    wanted = truth.density(slow, RATE)
    assert np.all(learnt.density(slow, RATE) < 0.45 * wanted)
    assert np.all(mended.density(slow, RATE) > 2.0 * learnt.density(slow, RATE))
    assert np.all(np.abs(np.log(mended.density(slow, RATE) / wanted)) < np.log(factor))


@pytest.mark.long
def test_structure_that_is_a_thousandth_of_the_torque_is_no_finding():
    """A wave over position, surely there in a log without noise to speak of: 0.03 % of the torque, then 3 %."""
    robot = load_robot("config/robots/puma560.yaml")
    time = np.tile(np.arange(0, 8, 0.01), RECORDS)
    label = np.repeat(np.arange(RECORDS), 800)
    rng = np.random.default_rng(5)
    q, v, a = np.zeros((3, len(time), 6))
    for j in range(6):
        for k in range(1, 4):
            size, phase = rng.uniform(0.2, 0.5, RECORDS)[label] / k, rng.uniform(0, 6, RECORDS)[label]
            w = 2 * np.pi * k / 8.0
            q[:, j] += size * np.sin(w * time + phase)
            v[:, j] += size * w * np.cos(w * time + phase)
            a[:, j] -= size * w**2 * np.sin(w * time + phase)
    torque = Dynamics(robot).inverse_dynamics(q, v, a)
    scale = float(np.sqrt(np.mean(torque[:, 1] ** 2)))
    noise = 5e-4 * scale * rng.standard_normal(torque.shape)

    def structure(share):
        extra = np.zeros_like(torque)
        extra[:, 1] = np.sqrt(2) * share * scale * np.sin(25 * q[:, 1])
        recording = split(Recording(time, label, q, torque + noise + extra, v, a))
        problem = build_problem(recording, robot, Settings())
        white = whiten(problem, estimate_noise(problem))
        found, profile = unexplained(Outcome(problem, white, white.fit(), None))
        surest = min((u.p_value for u in profile if u.axis == 1), default=1.0)
        return {u.axis for u in found}, surest

    found, surest = structure(4e-4)
    assert surest < 1e-8
    assert 1 not in found
    assert 1 in structure(0.03)[0]


def test_a_residual_that_no_sensor_makes_is_not_put_back_by_bands():
    """Of what falls so steeply a fit has not taken noise alone."""
    rng = np.random.default_rng(4)
    trajectory = np.repeat(np.arange(4), 600)
    usable = np.ones(len(trajectory), bool)
    time = np.tile(np.arange(600) / 100.0, 4)
    slow = np.sin(2 * np.pi * 0.7 * time + 0.5 * trajectory) + 0.5 * np.sin(2 * np.pi * 2.3 * time + trajectory)
    residual = slow + 0.001 * rng.standard_normal(len(trajectory))
    start = estimate(residual, usable, trajectory, 2)
    ends = start.density(np.array([0.0, 50.0]), 100.0)
    assert ends[0] > assumed.REDDEST * ends[1]

    plain = estimate(residual, usable, trajectory)
    kept = corrected(start, residual, lambda series: 0.3 * series, usable, trajectory, 100.0)
    assert len(kept.lags) == len(plain.lags)
    assert kept.sigma == pytest.approx(plain.sigma / 0.3, rel=0.5)


def gusty(rng, label, slow):
    """Return white noise with a torque below 1.6 Hz that is new in every record, `slow` times as large."""
    time = np.tile(np.arange(LENGTH * 4), len(label) // (LENGTH * 4)) / 100.0
    records = label.max() + 1
    waves = [
        np.sin(2 * np.pi * rng.uniform(0.15, 1.6, records)[label] * time + rng.uniform(0, 6, records)[label])
        for _ in range(6)
    ]
    return rng.standard_normal(len(label)) + slow * np.sum(waves, axis=0) / np.sqrt(3)


def test_a_torque_that_comes_and_goes_with_the_wind_is_no_noise():
    """A slow torque three times the noise is there in every record; noise forgets within a tenth of a second."""
    label = np.repeat(np.arange(RECORDS), LENGTH * 4)
    used, rng = np.ones(len(label), bool), np.random.default_rng(11)

    def mended(series):
        return corrected(estimate(series, used, label, 2), series, lambda x: x, used, label, 100.0)

    frequency = np.array([0.3, 0.6, 1.0, 1.4])
    level = 2.0 / 100.0
    assert np.all(mended(gusty(rng, label, 3.0)).density(frequency, 100.0) < 30 * level)
    lags = np.array([np.exp(-1.0 / (100.0 * 0.1))])
    red = Whitener(np.arange(len(label)), lags, 1.0)
    kept = mended(simulate(red, label, 1, rng)[:, 0])
    assert np.all(np.abs(np.log(kept.density(frequency, 100.0) / red.density(frequency, 100.0))) < np.log(1.5))


def test_slow_noise_beside_quick_noise_is_held_at_a_high_rate():
    """A sensor whose noise forgets within 0.27 s, as any may, looked like structure over time in logs of 250 Hz."""
    rate, everything = 250.0, np.arange(18000)
    frequency = np.linspace(0.0, 0.5 * rate, POINTS + 1)
    truth = np.full(len(frequency), 2 * 0.5**2 / rate)
    for size, corner in ((0.8, 8.0), (0.3, 0.6)):
        pole = np.exp(-2 * np.pi * corner / rate)
        truth += Whitener(everything, np.array([pole]), size * np.sqrt(1 - pole**2)).density(frequency, rate)

    def short(order):
        """Return which part of the noise below 1 Hz a model lacks."""
        model = of_density(truth, rate, order, len(everything), slowest_pole(rate), PRICE)
        slow = frequency < 1.0
        return 1.0 - np.mean(model.density(frequency, rate)[slow]) / np.mean(truth[slow])

    highest = highest_order(np.ones(len(everything), bool), np.repeat(np.arange(3), 6000))
    assert short(highest) < 0.25 < short(ORDER_BESIDE_GAPS)


@given(st.integers(0, 2**32 - 1), st.integers(1, 400))
@settings(max_examples=20, deadline=None)
def test_a_high_order_leaves_half_of_the_samples_that_a_low_one_leaves(seed, gap):
    rng = np.random.default_rng(seed)
    label = np.repeat(np.arange(3), 1500)
    used = rng.random(len(label)) > 1.0 / gap
    order = highest_order(used, label)
    left, least = (len(whitenable(used, label, k)) for k in (order, ORDER_BESIDE_GAPS))
    assert ORDER_BESIDE_GAPS <= order <= HIGHEST_ORDER_DERIVED
    assert left >= LEFT_BY_ORDER * least
    if order < HIGHEST_ORDER_DERIVED and least:
        assert len(whitenable(used, label, order + 1)) < LEFT_BY_ORDER * least


def test_slow_noise_of_most_joints_is_what_the_model_lacks():
    """A smoothed torque and a rough model make every joint slow: nothing outside pushes; one slow joint is pushed."""
    label = np.repeat(np.arange(RECORDS), LENGTH * 4)
    used = np.ones((len(label), 3), bool)
    rows = np.arange(len(label))
    slow, white = Whitener(rows, np.array([1.8, -0.81]), 0.1), Whitener(rows, np.zeros(0), 1.0)
    frequency = np.array([0.5, 1.0])

    def changed(whites):
        mended = without_slow_torque(whites, used, label, 100.0)
        return [
            not np.allclose(a.density(frequency, 100.0), b.density(frequency, 100.0))
            for a, b in zip(mended, whites, strict=True)
        ]

    assert changed([slow, white, white]) == [True, False, False]
    assert changed([slow, slow, white]) == [False, False, False]
    assert without_slow_torque([None, white, slow], used, label, 100.0)[0] is None
