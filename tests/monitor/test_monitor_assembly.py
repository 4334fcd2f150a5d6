"""Logs of one robot put together."""

from dataclasses import replace

import numpy as np

from jointwear.monitor.assembly import Piece, assemble
from jointwear.monitor.clocks import clock_findings
from jointwear.monitor.windows import blank_statistics


def piece(log: str, hour: int) -> Piece:
    statistics = blank_statistics(3600.0 * np.arange(hour, hour + 2), 3600.0, np.ones(2), dated=True)
    statistics.count[:], statistics.samples[:] = 50, 60
    statistics.square[:] = 1.0 + hour
    return Piece(log, statistics, 3600.0 * hour, 3600.0 * (hour + 2) - 1)


def test_a_log_that_is_there_twice_counts_once_and_says_so():
    history = assemble([piece("a.csv", 0), piece("b.csv", 2), replace(piece("a.csv", 0), log="copy/a.parquet")])
    assert history.statistics.windows == 4
    assert (history.statistics.samples == 60).all()
    assert [p.copy_of for p in history.pieces] == ["", "", "a.csv"]
    assert not history.pieces[2].refused


def test_logs_of_one_hour_that_differ_add_up():
    history = assemble([piece("a.csv", 0), replace(piece("b.csv", 0), last=7000.0)])
    assert (history.statistics.samples == 120).all()


def test_logs_of_a_clock_that_was_set_back_are_told():
    year = 365 * 24
    days = [piece(f"{k}.csv", year + 24 * k) for k in range(4)]
    assert clock_findings(assemble(days)) == []
    (found,) = clock_findings(assemble([*days[:3], piece("3.csv", 72)]))
    assert "Of 1 log, from 1970-01-04" in found["words"]
    assert "was a clock set back" in found["words"]


def test_a_robot_that_rested_for_months_has_no_wrong_clock():
    assert clock_findings(assemble([piece("a.csv", 0), piece("b.csv", 24), *(piece(x, 5000) for x in "cde")])) == []
