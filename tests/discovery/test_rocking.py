"""A base that swings with the motion is no noise, and noise in the same band is no such base."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import Term
from jointwear.discovery.presentation.page import lead
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.search.rocking import SWING, Rocking, rocking, swing_in_words
from jointwear.discovery.search.standing_alone import stand_alone
from jointwear.robots.rocking_base import RockingBase

FREQUENCY, DAMPING = 6.3, 0.05


@pytest.fixture(autouse=True)
def pushes(monkeypatch):
    """The arm starts or stops every 1.1 s, which the smooth motion of the case does not."""

    def moments(self, position, velocity, acceleration):
        push = 30.0 * np.where(np.arange(len(position)) // 110 % 2, 1.0, -1.0)
        return np.stack([push, np.roll(push, 50)], axis=1)

    monkeypatch.setattr(RockingBase, "moments", moments)


def outcome_of(white, torques):
    """Return the outcome of data that hold torques (m, n) beside what they held, in which nothing is named."""
    problem = white.problem
    discrepancy = problem.discrepancy.copy()
    discrepancy[problem.train] += torques
    targets = [white.whiteners[a](discrepancy[problem.train, a]) for a in range(torques.shape[1])]
    asked = replace(white, problem=replace(problem, discrepancy=discrepancy), targets=targets)
    return Outcome(asked.problem, asked, asked.fit(), None)


def loud(white, torques):
    """Return torques (m, n) as loud on the loudest joint as a third of the noise there."""
    noise = np.array([w.marginal for w in white.whiteners])
    return torques * (1 / 3) / np.max(np.std(torques, axis=0) / noise)


def test_a_base_that_swings_is_found_with_its_frequency(white):
    swung = loud(white, Rocking(white).torques(FREQUENCY, DAMPING).sum(axis=-1))
    found = rocking(outcome_of(white, swung))
    assert {u.argument for u in found} == {SWING}
    assert found[0].low == pytest.approx(FREQUENCY, rel=0.1)
    assert "swings with the motion at 6" in swing_in_words(found)[0]


def test_neither_noise_of_one_frequency_nor_nothing_swings_with_the_motion(white):
    assert not rocking(outcome_of(white, np.zeros_like(white.problem.train_state.position)))
    shape, rate = white.problem.train_state.position.shape, white.problem.measured.rate
    band = butter(2, [0.95 * FREQUENCY, 1.05 * FREQUENCY], "bandpass", fs=rate, output="sos")
    drawn = np.random.default_rng(3).standard_normal((shape[0], 1))
    shaken = sosfilt(band, drawn, axis=0) * np.array([w.marginal for w in white.whiteners])
    assert not rocking(outcome_of(white, loud(white, shaken)))


def test_a_swing_beside_the_fastest_has_to_say_more_than_that(white):
    """A drive that chatters faster than any base was told as a base that swings at the last frequency but one."""
    swung = 1.5 * loud(white, Rocking(white).torques(19.3, 0.2).sum(axis=-1))
    assert not rocking(outcome_of(white, swung))


def test_what_hardly_swings_is_no_base(white):
    """Rates of torque of a command had been told as a base that swings at 16 Hz, beside the right name."""
    swung = loud(white, Rocking(white).torques(10.0, 0.25).sum(axis=-1))
    assert not rocking(outcome_of(white, swung))


def test_the_page_says_what_swings():
    content = {
        "verdict": "unknown",
        "effects": [],
        "suspects": [],
        "above_the_noise": [],
        "unexplained": [{"axis": a, "argument": SWING, "range": [5.2, 5.2]} for a in (2, 1)],
        "gap": {kind: [1.0] * 3 for kind in ("nominal", "retuned", "augmented", "noise_floor")},
    }
    assert "swings with the motion at 5.2 Hz on joints 1 and 2" in " ".join(lead(content))


def test_a_gear_that_says_nothing_beside_a_swinging_base_is_a_suspect(white):
    """The base shakes all joints; the first one looks as if its gear gave way."""
    swung = 3 * loud(white, Rocking(white).torques(FREQUENCY, DAMPING).sum(axis=-1))
    nonlinear = {"inertia_over_stiffness": (2 * np.pi * FREQUENCY) ** -2.0, "inertia": 2.0, "side": 1, "damping": 0.3}
    column = swung[:, [0]]
    term = Term("gear", {0: white.columns(0, column)}, np.ones(1), {0: white.raw(0, column)})
    outcome = outcome_of(white, swung)
    outcome.named = [Named(Candidate("joint_flexibility", 0, None, nonlinear), term, None, 99.0)]
    outcome.fit = outcome.white.fit([term])
    stand_alone(outcome)
    assert not outcome.named
    assert "a base that swings" in outcome.suspects[0][1]
