"""Tests of the speed of the core that studies run on."""

import pytest

from jointwear.studies import core_speed
from jointwear.studies.challenge import solve


def test_a_loop_that_takes_twice_as_long_is_a_core_twice_as_slow(monkeypatch):
    clock = iter([10.0, 10.0 + 2 * core_speed.USUAL_SECONDS])
    monkeypatch.setattr(core_speed.time, "process_time", lambda: next(clock))
    assert core_speed.slowness() == pytest.approx(2.0)


def test_times_of_verdicts_are_those_of_a_usual_core(monkeypatch):
    monkeypatch.setattr(solve, "slowness", lambda: 5.0)
    monkeypatch.setattr(solve.time, "process_time", lambda: 113.0)
    assert solve._usual_time(100.0, before=3.0) == 13.0 / 4.0
