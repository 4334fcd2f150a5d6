"""Noise that moves the arm is told from a sensor's."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.linear import chi_square
from jointwear.discovery.noise.shaken import shaken_shares
from jointwear.discovery.noise.spectra import frequencies, piece_of
from jointwear.discovery.pipeline import split
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.search import carried, searches
from jointwear.discovery.settings import Settings
from jointwear.measurement.recording import Recording
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot

RATE, N, JOINTS = 200.0, 8000, 3
SIGMAS = Settings().noise_sigmas


def _arm(seed):
    """Torques of a motion that ends at 3 Hz, (N, JOINTS), and white noise."""
    rng = np.random.default_rng(np.random.SeedSequence([5, seed]))
    motion = sosfiltfilt(butter(4, 3.0, fs=RATE, output="sos"), rng.standard_normal((N, JOINTS)), axis=0)
    return 20.0 * motion, 0.1 * rng.standard_normal((N, JOINTS))


def _shares(residual, torque):
    derived = np.zeros((JOINTS, len(frequencies(RATE))))
    usable = np.ones((N, JOINTS), dtype=bool)
    return shaken_shares(residual, torque, usable, np.repeat([0, 1], N // 2), RATE, derived, SIGMAS)


def test_noise_of_a_sensor_moves_nothing():
    motion, noise = _arm(0)
    assert _shares(noise, motion).max() < 0.1


def test_what_disturbs_a_commanded_drive_moves_the_arm():
    motion, noise = _arm(1)
    assert _shares(-noise, motion + noise).min() > 0.9


def test_half_of_either():
    motion, noise = _arm(2)
    _, other = _arm(3)
    assert np.all(np.abs(_shares(other - noise, motion + noise) - 0.5) < 0.1)


def test_derived_motion_that_ends_does_not_hide_what_moves_the_arm():
    motion, noise = _arm(8)
    _, sensor = _arm(9)
    low = butter(4, 20.0, fs=RATE, output="sos")
    moved = sosfiltfilt(low, noise, axis=0)
    assert _shares(0.5 * sensor - moved, motion + moved).min() > 0.4
    assert _shares(0.5 * sensor, motion + moved).max() < 0.1


def test_pieces_are_as_long_in_time_at_any_rate():
    assert [piece_of(rate) for rate in (30.0, 100.0, 125.0, 200.0, 1000.0)] == [16, 64, 64, 128, 128]


def test_a_late_torque_is_no_shaken_arm():
    motion, noise = _arm(4)
    late = np.roll(motion, 2, axis=0) - motion + noise
    assert _shares(late, motion).max() < 0.2


def test_no_axis_is_more_shaken_than_the_next():
    motion, noise = _arm(6)
    alone = noise.copy()
    alone[:, 0] *= -1.0
    moved = motion.copy()
    moved[:, 0] += noise[:, 0]
    assert _shares(alone, moved).max() < 0.1


def test_short_stretches_say_nothing():
    motion, noise = _arm(7)
    usable = np.ones((N, JOINTS), dtype=bool)
    usable[:: piece_of(RATE) // 2] = False
    derived = np.zeros((JOINTS, len(frequencies(RATE))))
    shares = shaken_shares(-noise, motion + noise, usable, np.zeros(N, dtype=int), RATE, derived, SIGMAS)
    assert shares.max() == 0.0


@pytest.fixture(scope="module")
def disturbed():
    """Commands of a PUMA whose drives are disturbed: the torque of the motion without what shakes it."""
    robot = load_robot("config/robots/puma560.yaml")
    dynamics, time = Dynamics(robot), np.arange(0, 10.0, 1 / RATE)
    parts = []
    for k in range(4):
        rng = np.random.default_rng(np.random.SeedSequence([9, k]))
        # All joints start and stop together, at speeds of their own.
        slow = 2 * np.pi * np.array([0.21, 0.37])[:, None, None] * rng.uniform(0.8, 1.2)
        calm = _waves(time, slow, np.array([0.6, 0.3])[:, None, None] * rng.uniform(0.5, 1.0, (1, 1, 6)), 0.0)
        quick = 2 * np.pi * np.sort(rng.uniform(3.0, 40.0, (60, 1, 6)), axis=0)
        shaken = _waves(time, quick, 0.4 / quick**2, rng.uniform(0, 6, quick.shape))
        moved = [c + s for c, s in zip(calm, shaken, strict=True)]
        parts.append((time + 11 * k, np.full(len(time), k), moved[0], dynamics.inverse_dynamics(*calm)))
    time, label, q, torque = (np.concatenate(x) for x in zip(*parts, strict=True))
    problem = build_problem(split(Recording(time, label, q, torque, name="disturbed")), robot, Settings())
    return whiten(problem, estimate_noise(problem))


def _waves(time, speed, size, phase):
    x = speed * time[:, None] + phase
    terms = size * np.sin(x), size * speed * np.cos(x), -size * speed**2 * np.sin(x)
    return tuple(np.sum(t, axis=0) for t in terms)


def test_noise_that_moves_the_arm_is_noise(disturbed):
    problem, left = disturbed.problem, disturbed.fit().residual
    assert problem.shaken.min() > 0.5
    for axis in problem.judged:
        used = problem.usable[:, axis]
        noise = np.std(problem.discrepancy[problem.train, axis][used])
        assert disturbed.whiteners[axis].marginal == pytest.approx(noise, rel=0.25)
        assert np.mean(left[axis] ** 2) < 1.1


def test_a_problem_in_which_nothing_shakes_the_arm(disturbed):
    assert not replace(disturbed.problem, still=True).shaken.any()


SWING = Candidate("joint_flexibility", 1, None, {"inertia_over_stiffness": 1e-4, "inertia": 2.0, "side": 1})
SHARED = Candidate("drive_coupling", 1, 2, {})
LATE = Candidate("actuation_delay", 1, None, {"delay": 0.01})


@pytest.mark.long
@pytest.mark.parametrize(
    ("found", "nats", "unexplained", "stands"),
    [
        ([SWING], 5000.0, [1], True),
        ([SWING], 50.0, [0], True),
        # Structure on the joint of a gear of little evidence: the gear may be noise.
        ([SWING], 50.0, [1], False),
        # Noise that feigns as much of a delay feigns that of a gear; next to a strong gear a delay may stand.
        ([SWING, LATE], 50.0, [0], False),
        ([SWING, LATE], 5000.0, [0], True),
        ([SHARED], 50.0, [], True),
        ([SHARED], 5000.0, [0], False),
        ([SHARED, LATE], 50.0, [], False),
        ([], 0.0, [], False),
    ],
)
def test_what_shakes_the_arm_is_noise_unless_what_was_found_explains_it(
    disturbed, monkeypatch, found, nats, unexplained, stands
):
    asked, left = [], [SimpleNamespace(axis=axis) for axis in unexplained]

    def search(white):
        shaken = bool(white.problem.shaken.any())
        asked.append(shaken)
        named = [] if shaken else [SimpleNamespace(candidate=c, evidence=nats) for c in found]
        return Outcome(white.problem, white, None, None, named=named, unexplained=left)

    monkeypatch.setattr(searches, "_search", search)
    assert len(searches.search(disturbed).named) == (len(found) if stands else 0)
    assert asked == ([False] if stands else [False, True])


@pytest.mark.long
def test_a_body_that_is_carried_takes_the_explanation_away(disturbed, monkeypatch):
    """With a body in the load the gear may be gone for whose sake nothing was noise, and a feigned delay may stay."""
    asked, loaded = [], replace(disturbed.problem, still=True)

    def ask(white, search):
        asked.append(white.problem.still)
        named = [SimpleNamespace(candidate=LATE, evidence=900.0)] if white.problem.still else []
        return Outcome(white.problem, white, None, None, named=named)

    monkeypatch.setattr(carried, "carrying", lambda found: loaded)
    monkeypatch.setattr(carried, "beside_slow_noise", ask)
    assert not carried.search_beside(Outcome(loaded, disturbed, None, None)).named
    assert asked == [True, False]


def test_noise_that_moves_the_arm_is_no_structure(disturbed):
    fit = disturbed.fit(disturbed.attenuation)
    for axis in disturbed.problem.judged:
        for basis in disturbed.bases(axis):
            columns = disturbed.columns(axis, basis.columns)
            columns = columns[:, np.sum(columns**2, axis=0) > 1e-9]
            if columns.shape[1]:
                statistic, freedom = chi_square(*fit.gram({axis: columns}), columns.T @ columns)
                assert 0.5 * (statistic - freedom) < 25.0, (axis, basis.argument)
