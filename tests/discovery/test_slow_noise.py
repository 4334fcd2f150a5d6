"""Torque noise with a slow part beside a white one: of few seconds it is neither structure nor an effect."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from jointwear.discovery.estimates.outcome import Unexplained
from jointwear.discovery.linear import chance, least_nats
from jointwear.discovery.pipeline import discover
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.search.leftovers import LINE
from jointwear.discovery.search.searches import search, whitened
from jointwear.discovery.search.slow_noise import slower_noise, times_needed
from jointwear.discovery.settings import Settings
from jointwear.measurement.recording import Recording, split
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot

RATE, SECONDS, RECORDS, MEMORY, SLOW = 80.0, 15.0, 4, 0.9, 0.36


def recording(seed, wave=0.0, rate=RATE, slowly=SLOW, joints=6):
    """Return a log of the PUMA 560 in which nothing is hidden but a `wave` of torque over the position of joint 2.

    The share `slowly` of the noise of its first `joints` is slow, that of the others is white.
    """
    robot = load_robot("config/robots/puma560.yaml")
    rng = np.random.default_rng(np.random.SeedSequence([57, seed]))
    one = np.arange(0.0, SECONDS, 1 / rate)
    time, label = np.tile(one, RECORDS), np.repeat(np.arange(RECORDS), len(one))
    q, v, a = np.zeros((3, len(time), 6))
    for j in range(6):
        for k in range(1, 5):
            size, phase = rng.uniform(0.1, 0.4, RECORDS)[label] / k, rng.uniform(0, 6, RECORDS)[label]
            w = 2 * np.pi * k / 12.0
            q[:, j] += size * np.sin(w * time + phase)
            v[:, j] += size * w * np.cos(w * time + phase)
            a[:, j] -= size * w**2 * np.sin(w * time + phase)
    torque = Dynamics(robot).inverse_dynamics(q, v, a)
    scale = torque.std(axis=0)
    white, drive = rng.standard_normal((2, *torque.shape))
    slow = lfilter([np.sqrt(1 - MEMORY**2)], [1, -MEMORY], drive, axis=0)
    share = np.where(np.arange(6) < joints, slowly, 0.0)
    noise = 0.01 * scale * (np.sqrt(1 - share) * white + np.sqrt(share) * slow)
    noise[:, 1] += wave * scale[1] * np.sin(9 * q[:, 1])
    return robot, Recording(time + 20.0 * SECONDS * label, label, q, torque + noise, v, a)


def density(frequency):
    """Return the density of the noise over that of white noise of its variance at frequencies [Hz]."""
    turn = np.exp(-2j * np.pi * frequency / RATE)
    return (1 - SLOW) + SLOW * (1 - MEMORY**2) / np.abs(1 - MEMORY * turn) ** 2


@pytest.mark.long
def test_slow_noise_is_no_structure():
    """The saturated fit leaves so little of it that structure over position had p of 2e-10."""
    robot, log = recording(0)
    problem = build_problem(split(log), robot, Settings())
    outcome = search(whitened(problem))
    axes = {u.axis for u in outcome.unexplained}
    assert axes
    slower = slower_noise(outcome)
    frequency = np.array([0.3, 0.6, 1.0])
    for axis in axes:
        truth = density(frequency) * 2 * (0.01 * problem.measured.torque[:, axis].std()) ** 2 / RATE
        before, after = (w[axis].density(frequency, RATE) / truth for w in (outcome.white.whiteners, slower))
        assert np.all(before < 0.5)
        assert np.all((after > 1.5 * before) & (after < 2.0))
    assert discover(log, robot).verdict == "none"


@pytest.mark.long
def test_a_torque_over_position_stays_one_in_such_noise():
    """A wave as strong as all of the noise is the same in all records."""
    robot, log = recording(0, wave=0.01)
    found = discover(log, robot)
    assert found.verdict in ("effects", "unknown")
    assert {e["axis"] for e in found.effects} | {u.axis + 1 for u in found.final.outcome.unexplained} == {2}


@pytest.mark.long
def test_noise_of_all_joints_may_forget_as_slowly_as_any():
    """At 30 Hz a coefficient of 0.9 is 0.32 s, and 70 times as dense below 1 Hz as from 3 to 6 Hz."""
    robot, log = recording(0, rate=30.0, slowly=1.0)
    outcome = search(whitened(build_problem(split(log), robot, Settings())))
    assert outcome.unexplained
    assert not discover(log, robot).final.outcome.unexplained


def test_slow_torque_of_one_joint_is_no_noise():
    """What the others have not pushes that joint: its noise stays ten times as dense at most."""
    robot, log = recording(0, rate=30.0, slowly=1.0, joints=1)
    found = discover(log, robot).final.outcome
    assert {u.axis for u in found.unexplained} == {0}


@pytest.mark.parametrize(("freedom", "by_logarithm"), [(1, 3.7), (8, 5.1), (64, 10.9)])
def test_structure_of_many_columns_needs_little_more_noise_to_be_noise(freedom, by_logarithm):
    """The logarithm of a p-value had been taken to fall as a chi-square does."""
    settings, samples = Settings(), 5000
    white = SimpleNamespace(problem=SimpleNamespace(settings=settings), targets=[np.zeros(samples)])
    statistic = 4.0 * (2.0 * least_nats(settings.unexplained_p, freedom, samples) + freedom)
    p, nats = chance(statistic, freedom, samples)
    assert times_needed(white, Unexplained(0, "time", "s", 0.0, 1.0, p, nats, 1.0, freedom)) == pytest.approx(4.0, 0.02)
    line = Unexplained(0, LINE, "Hz", 0.0, 1.0, p, nats)
    assert times_needed(white, line) == pytest.approx(by_logarithm, rel=0.05)
