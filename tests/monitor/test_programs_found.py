"""Programs that the motion shows, in the baseline and after it."""

from types import SimpleNamespace

import numpy as np
from monitor_windows import residuals, statistics_of

from jointwear.monitor.findings import findings
from jointwear.monitor.reading.logs_of_windows import LogsOfWindows
from jointwear.monitor.reading.regimes import find_regimes, parts_of_known


def test_programs_are_told_apart_and_an_unseen_one_is_said_so():
    first, second, third = np.zeros(6), np.full(6, 1.0), np.full(6, -1.0)
    signature = np.stack([*[first] * 10, *[second] * 10, *[third] * 3])
    regime = find_regimes(signature, np.arange(23) < 20)
    assert len(set(regime[:20])) == 2
    assert (regime[20:] == -1).all()
    # From the fourth window on it is a program of its own.
    longer = find_regimes(np.concatenate([signature, third[None]]), np.arange(24) < 20)
    assert np.array_equal(longer[:20], regime[:20])
    assert (longer[20:] == 2).all()
    mixed = np.random.default_rng(4).uniform(-3, 3, (20, 6))
    assert find_regimes(mixed, np.ones(20, dtype=bool)) is None


def test_a_later_program_near_a_known_one_is_no_part_of_it():
    random = np.random.default_rng(3)
    one, other = np.zeros(6), np.full(6, 1.0)
    baseline = np.arange(48) < 40
    # Windows differ by 0.03 about their program, and its neighbour is 0.22 away.
    signature = np.repeat([one, other, one], [20, 20, 8], axis=0) + 0.03 * random.uniform(-1, 1, (48, 6))
    signature[40:, 2] += 0.22
    regime = find_regimes(signature, baseline)
    assert set(regime[:40]) == {0, 1}
    assert (regime[40:] == 2).all()
    # Three of them may be windows of the known one that hold a part of its cycle, as may more that do not follow each
    # other, or that lie on both sides.
    assert (find_regimes(signature[:43], baseline[:43])[40:] == 0).all()
    apart = signature.copy()
    apart[[42, 45]] = one
    assert (find_regimes(apart, baseline)[40:] == 0).all()
    about = signature.copy()
    about[41::2, 2] -= 0.44
    assert (find_regimes(about, baseline)[40:] == 0).all()


def test_an_axis_without_a_torque_makes_no_new_program():
    speed = np.array([[1.0, 2.0, 0.5], [0.6, 0.7, 2.0]])
    hidden = np.zeros((28, 3), dtype=bool)
    hidden[20:, 1] = True
    which = np.array([0, 1] * 14)

    def told(logs):
        share = logs - np.nan_to_num(logs).mean(axis=1, keepdims=True)
        return np.concatenate([share, np.where(np.isnan(logs), np.nan, 0.2)], axis=1)

    logs = np.where(hidden, np.nan, np.log(speed[which]))
    baseline = np.arange(28) < 20
    regime = find_regimes(told(logs), baseline, hidden)
    assert np.array_equal(regime[20:], regime[:8])
    assert set(regime) == {0, 1}
    # At rest it is another program.
    assert not set(find_regimes(told(logs), baseline)[20:]) & {0, 1}
    # One that never shows a torque is like one that always rests.
    never = np.zeros((28, 3), dtype=bool)
    never[:, 1] = True
    logs = np.where(never, np.nan, np.log(speed[which]))
    assert np.array_equal(find_regimes(told(logs), baseline, never), find_regimes(told(logs), baseline))


def test_a_rare_part_of_a_known_cycle_is_no_new_program():
    """Logs of 20 s of a cycle of 15 s: a part that three logs of the baseline caught came again after it."""
    random = np.random.default_rng(5)
    cycle, rare, new = np.zeros(6), np.full(6, 0.5), np.full(6, -0.8)
    late = [rare, cycle, cycle] * 4
    signature = np.stack([*[cycle] * 17, *[rare] * 3, *late]) + 0.02 * random.uniform(-1, 1, (32, 6))
    baseline = np.arange(32) < 20
    regime = find_regimes(signature, baseline)
    assert len(set(regime[20:])) == 2
    assert parts_of_known(signature, regime, baseline) == [regime[20]]
    # Somewhat off those of the baseline they may still be of its cycle, unless they follow each other.
    off = signature.copy()
    off[20::3, 0] += 0.2
    assert parts_of_known(off, regime, baseline) == [regime[20]]
    order = [*range(20), *range(20, 32, 3), *(k for k in range(20, 32) if (k - 20) % 3)]
    assert parts_of_known(off[order], regime[order], baseline) == []
    # Another program is as far from every window of the baseline as from its programs.
    signature[20::3] += new - rare
    regime = find_regimes(signature, baseline)
    assert len(set(regime[20:])) == 2
    assert parts_of_known(signature, regime, baseline) == []


def test_a_program_that_is_over_is_told_with_its_end_and_its_log(monkeypatch):
    """The log of another robot of the same type, twelve days ago, was a program "in its 14 h so far"."""
    s = statistics_of(residuals(30, np.zeros((30, 3)), 3))
    shown, shift, first = np.repeat([0, 7, 0], [12, 6, 12]), np.arange(30) // 6, np.arange(30) < 12
    monkeypatch.setattr(findings, "signatures", lambda _: None)
    monkeypatch.setattr(findings, "parts_of_known", lambda *_: [])
    level = SimpleNamespace(residual=np.full((30, 3), np.nan))
    logs = LogsOfWindows(("a.csv", "b.csv", "c.csv"), np.repeat([0, 1, 2], [12, 6, 12]), first, s.flags)

    def told(windows):
        part = slice(0, windows)
        own = LogsOfWindows(logs.names, logs.number[part], first[part], s.flags[part])
        seen = SimpleNamespace(residual=level.residual[part])
        return findings._programs(s.part(part), shift[part], shown[part], first[part], seen, own)

    (over,) = told(30)
    assert "in its 6 h most axes could not be judged" in over["words"]
    last = findings.moment_words(s, s.end[17])
    assert f"It ran until {last}, in b.csv alone: a trial, or the log of another robot" in over["words"]
    (runs,) = told(18)
    assert runs["words"].endswith("in its 6 h so far most axes could not be judged.")
