"""The paper's detector beside the model's: programs it never saw, events, limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from monitor_windows import SETTINGS, residuals, statistics_of

from jointwear.monitor.events import Event
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.watching import paper_detector
from jointwear.monitor.watching.paper_detector import paper_alarms, raised_limit


def test_the_paper_detector_alarms_on_a_changed_distribution(monkeypatch):
    # Three axes need all their components for 75 % of the variance, which leaves no residual.
    monkeypatch.setattr(paper_detector, "VARIANCE_SHARE", 0.5)
    growth = np.zeros((200, 3))
    growth[150:, 0] = 0.5
    alarms = judge(statistics_of(residuals(200, growth, 19)), 120, SETTINGS).alarms
    paper = [a for a in alarms if a["detector"] == "paper"]
    assert paper
    assert all(a["time"] > 150 * 3600 for a in paper)
    assert paper[0]["axis"] == 1


def test_the_paper_detector_passes_over_a_program_that_it_never_saw(monkeypatch):
    monkeypatch.setattr(paper_detector, "VARIANCE_SHARE", 0.5)
    growth = np.zeros((200, 3))
    growth[150:, 0] = 0.5
    statistics, program = statistics_of(residuals(200, growth, 19)), np.zeros(200, dtype=int)
    assert paper_alarms(statistics, 120, 1e-3, program).alarm.any()
    program[150:] = 1
    verdict = paper_alarms(statistics, 120, 1e-3, program)
    assert not verdict.alarm.any()
    assert np.isnan(verdict.q[150:]).all()


@pytest.mark.long
def test_an_event_explains_what_the_paper_detector_saw_and_it_learns_anew(monkeypatch):
    monkeypatch.setattr(paper_detector, "VARIANCE_SHARE", 0.5)
    growth = np.zeros((400, 3))
    growth[150:, 0] = 0.5
    statistics = statistics_of(residuals(400, growth, 19))
    paper = [a["time"] for a in judge(statistics, 120, SETTINGS).alarms if a["detector"] == "paper"]
    assert max(paper) > 300 * 3600
    told = replace(SETTINGS, events=(Event(150 * 3600.0, (0,), "sensor"),))
    assert not [a for a in judge(statistics, 120, told).alarms if a["detector"] == "paper"]
    growth[300:, 0] = 1.2
    again = judge(statistics_of(residuals(400, growth, 19)), 120, told).alarms
    assert min(a["time"] for a in again if a["detector"] == "paper") > 300 * 3600


def test_a_fall_that_was_found_begins_anew_for_the_paper_detector_too(monkeypatch):
    monkeypatch.setattr(paper_detector, "VARIANCE_SHARE", 0.5)
    growth = np.zeros((400, 3))
    growth[150:, 0] = -0.3
    statistics = statistics_of(residuals(400, growth, 19))
    assert paper_alarms(statistics, 120, 1e-3, None).alarm[150:].any()
    judgement = judge(statistics, 120, SETTINGS)
    assert [f["kind"] for f in judgement.findings].count("proposed_service") == 1
    assert not [a for a in judgement.alarms if a["detector"] == "paper"]


def test_raised_limits():
    random = np.random.default_rng(20)
    quiet = random.uniform(0, 0.5, 200)
    assert raised_limit(quiet, 1e-3) == 1.0
    assert raised_limit(4 * random.exponential(1, 200), 1e-3) > 1.0
    assert raised_limit(np.ones(3), 1e-3) == 1.0


def test_a_condition_that_lasts_a_shift_is_no_change_of_the_torque_pattern():
    """Programs change by the hour in the normal period, by the shift after it; the torques of one are wild."""
    random = np.random.default_rng(5)
    size = np.array([0.2, 6.0, 0.4])
    normal = random.integers(0, 3, 90)
    crossed = size[normal] * random.exponential(1, 90)
    later = size[np.repeat(random.integers(0, 3, 60), 8)] * random.exponential(1, 480)
    runs = np.lib.stride_tricks.sliding_window_view(later, 5).min(axis=-1)
    assert (runs > raised_limit(crossed, 1e-3)).any()
    assert not (runs > raised_limit(crossed, 1e-3, mixed=True)).any()
