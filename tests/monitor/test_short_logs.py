"""Logs cut off in the middle are judged by what is left of them, and said so where all others last equally long."""

from types import SimpleNamespace

import pytest

from jointwear.monitor.findings.short_logs import short_log_findings


def history(lasted, length=3600.0, copies=()):
    pieces = [
        SimpleNamespace(
            log=f"{k}.csv",
            first=3600.0 * k,
            last=3600.0 * k + seconds,
            copy_of="0.csv" if k in copies else "",
            statistics=SimpleNamespace(windows=1),
        )
        for k, seconds in enumerate(lasted)
    ]
    return SimpleNamespace(pieces=pieces, statistics=SimpleNamespace(length=length))


def test_logs_that_end_early_are_told_with_the_shortest():
    lasted = [30.0] * 10 + [28.0, 15.0] + [29.9] * 6 + [22.0, 30.0]
    (found,) = short_log_findings(history(lasted))
    assert (found["time"], found["end"]) == (11 * 3600.0, 18 * 3600.0 + 22.0)
    assert found["words"].startswith("2 logs end early, the shortest, 11.csv, after 15 s of 30 s")
    (found,) = short_log_findings(history(lasted, copies=[18]))
    assert found["words"].startswith("1 log ends early, 11.csv, after 15 s of 30 s")


@pytest.mark.parametrize(
    "lasted",
    [
        [30.0] * 12,
        [30.0] * 12 + [15.0],  # is still being written
        [30.0] * 8 + [15.0],  # too few to tell
        [30.0, 20.0, 40.0] * 5 + [30.0],  # never as long
        [3600.0] * 12 + [1800.0, 3600.0],  # the work ends
    ],
)
def test_logs_that_need_not_be_as_long_are_not_told(lasted):
    assert short_log_findings(history(lasted)) == []
