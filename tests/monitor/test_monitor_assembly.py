"""Logs of one robot put together."""

from dataclasses import replace
from datetime import datetime
from zoneinfo import ZoneInfo

import numpy as np
import pyarrow as pa
import pytest

from jointwear.measurement.formats.local_stamps import LocalStamps
from jointwear.monitor.findings.clocks import clock_findings
from jointwear.monitor.reading.assembly import Piece, assemble
from jointwear.monitor.reading.windows import blank_statistics


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


def of_torques(log: str, hour: int, seed: int, dated: bool = True) -> Piece:
    """A log of two hours whose torques are drawn by a seed, spread over the windows in another way each time."""
    drawn = np.abs(np.random.default_rng(seed).normal(0, 20, (2, 288)))
    found, whole = piece(log, hour), drawn.astype(int)
    found.statistics.torque_histogram[0] = whole // (2 + hour % 7)
    found.statistics.torque_histogram[1] = whole - found.statistics.torque_histogram[0]
    found.statistics.torque_peak[hour // 24 % 2] = drawn.max(axis=1)
    return found if dated else replace(found, statistics=replace(found.statistics, dated=False))


def test_torques_of_another_day_under_new_stamps_are_told_and_count_once():
    """Four days of replayed samples had been four healthy days."""
    days = [of_torques(f"{k}.csv", 24 * k, seed=min(k, 3)) for k in range(6)]
    history = assemble(days)
    assert [bool(p.refused) for p in history.pieces] == [False] * 4 + [True] * 2
    assert "4.csv: holds the torques of 3.csv to the last sample" in history.pieces[4].refused[0]
    assert "2 days later" in history.pieces[5].refused[0]
    assert history.statistics.windows == 8
    # The first in time is the measurement, whatever its name.
    history = assemble([replace(days[5], log="0.csv"), *days[1:5]])
    assert [bool(p.refused) for p in history.pieces] == [True, False, False, False, True]


def test_logs_without_dates_go_on_by_their_own_clock():
    logs = [of_torques(f"{k}.csv", 0, seed=0, dated=False) for k in range(3)]
    assert not any(p.refused for p in assemble(logs).pieces)


def test_torques_at_rest_may_be_those_of_yesterday():
    rest = [of_torques(f"{k}.csv", 24 * k, seed=0) for k in range(2)]
    for one in rest:
        one.statistics.count[:] = 0
    assert not any(p.refused for p in assemble(rest).pieces)


def part(log: str, first: float, last: float, **more) -> Piece:
    """A log of some hours, with samples in each."""
    hours = np.arange(first // 3600, last // 3600 + 1)
    statistics = blank_statistics(3600.0 * hours, 3600.0, np.ones(2), dated=True)
    statistics.count[:], statistics.samples[:] = 50, 60
    statistics.square[:] = 1.0 + first
    statistics.labels[:] = more.pop("labels", "")
    return Piece(log, statistics, first, last, **more)


def test_logs_of_one_hour_that_follow_each_other_add_up():
    history = assemble([part("a.csv", 0, 1800), part("b.csv", 1799.5, 3000)])
    assert (history.statistics.samples == 120).all()


@pytest.mark.parametrize(
    ("first", "last"), [(0.001, 86399.001), (43200, 86399), (1200, 87599), (-90, 3000), (20_000, 40_000)]
)
def test_logs_that_one_arm_cannot_have_written_are_not_added_up(first, last):
    day = part("a.csv", 0, 86399)
    history = assemble([day, part("b.csv", first, last), part("c.csv", 90_000, 95_000)])
    assert [bool(p.refused) for p in history.pieces] == [False, True, False]
    assert "b.csv: its samples lie between those of a.csv" in history.pieces[1].refused[0]
    assert history.statistics.windows == 24 + 2
    gone = assemble([replace(day, gone=True), part("b.csv", first, last)])
    assert [bool(p.refused) for p in gone.pieces] == [True, False]


def test_programs_that_take_turns_and_logs_in_a_pause_are_sound():
    weld, pick = part("weld.csv", 0, 9000, labels='{"weld": 60}'), part("pick.csv", 100, 9100, labels='{"pick": 60}')
    assert not any(p.refused for p in assemble([weld, pick]).pieces)
    night = part("a.csv", 0, 40_000)
    pause = np.array([3600.0 * 4 <= t < 3600.0 * 8 for t in night.statistics.start])
    night = replace(night, statistics=night.statistics.part(~pause))
    assert not any(p.refused for p in assemble([night, part("b.csv", 3600 * 5, 3600 * 7)]).pieces)


def test_logs_of_a_clock_that_was_set_back_are_told():
    year = 365 * 24
    days = [piece(f"{k}.csv", year + 24 * k) for k in range(4)]
    assert clock_findings(assemble(days)) == []
    (found,) = clock_findings(assemble([*days[:3], piece("3.csv", 72)]))
    assert "Of 1 log, from 1970-01-04" in found["words"]
    assert "was a clock set back" in found["words"]


def test_a_robot_that_rested_for_months_has_no_wrong_clock():
    assert clock_findings(assemble([piece("a.csv", 0), piece("b.csv", 24), *(piece(x, 5000) for x in "cde")])) == []


@pytest.mark.parametrize(("days", "words"), [(365, "364 days after"), (-366, "365 days before")])
def test_a_log_of_another_year_that_stands_between_others_by_name_is_refused(days, words):
    year = 2 * 365 * 24
    logs = [piece(f"{k}.csv", year + 24 * k) for k in range(8)]
    logs[3] = piece("3.csv", year + 24 * (3 + days))
    history = assemble(logs)
    assert [bool(p.refused) for p in history.pieces] == [k == 3 for k in range(8)]
    assert history.statistics.windows == 14
    assert f"3.csv: its dates lie {words} those of 2.csv and 4.csv" in history.pieces[3].refused[0]
    assert clock_findings(history) == []


def test_names_that_do_not_follow_time_tell_no_wrong_date():
    year = 2 * 365 * 24
    hours = [year + 24 * k for k in (0, 2, 1, 3, 4, 5, 6)]
    hours.insert(4, 0)
    logs = [piece(f"{k}.csv", hour) for k, hour in enumerate(hours)]
    assert not any(p.refused for p in assemble(logs).pieces)
    # The last by name may be the first of what comes, and few logs are in order by chance.
    last = [piece(f"{k}.csv", 24 * k) for k in range(7)] + [piece("7.csv", year)]
    assert not any(p.refused for p in assemble(last).pieces)
    few = [piece("0.csv", 0), piece("1.csv", year), piece("2.csv", 24), piece("3.csv", 48)]
    assert not any(p.refused for p in assemble(few).pieces)


DAY = 86400.0
#: A Monday of a month without a change of the clock.
MONDAY = datetime(2026, 6, 1, tzinfo=ZoneInfo("UTC")).timestamp()


def days(hours: float, wrong: int, off: float, count: int = 9, name: str = "log_{k:02d}.csv") -> list[Piece]:
    """Logs of `hours` from six o'clock on; one of them is dated `off` [s] wrong."""
    begin = [MONDAY + DAY * k + 6 * 3600 + (off if k == wrong else 0) for k in range(count)]
    named = [name.format(k=k, day=k + 1) for k in range(count)]
    return [part(log, t + 60.0 * k, t + 3600 * hours) for k, (log, t) in enumerate(zip(named, begin, strict=True))]


def refused(logs: list[Piece], zone: str | None = None) -> list[int]:
    return [k for k, p in enumerate(assemble(logs, zone).pieces) if p.refused]


@pytest.mark.parametrize("count", [3, 5, 8])
@pytest.mark.parametrize("off", [3653 * DAY, -3653 * DAY])
def test_among_few_logs_the_days_in_their_names_tell_which_one_is_dated_years_off(count, off):
    """The fourth of five days, dated ten years ahead, had been the state of now."""
    wrong = count - 2
    named = days(16, wrong, off, count, "arm_2026-06-{day:02d}.csv")
    assert refused(named) == [wrong]
    assert f"days {'after' if off > 0 else 'before'} those of" in assemble(named).pieces[wrong].refused[0]
    # All as many days off say the same; names that do not fit their dates say nothing.
    assert refused(days(16, wrong, off, count, "arm_2026-07-{day:02d}.csv")) == [wrong]
    mixed = [replace(p, log=p.log.replace("06-01", "05-01")) for p in named]
    assert refused(mixed) == ([wrong] if count == 8 else [])
    # Without days in the names, few logs are in order by chance.
    assert refused(days(16, wrong, off, count)) == ([wrong] if count == 8 else [])


@pytest.mark.parametrize("name", ["log_{k:02d}.csv", "2026-06-{day:02d}.csv", "r4_202606{day:02d}0600.csv"])
@pytest.mark.parametrize(("hours", "off"), [(9, DAY), (16, DAY), (9, -DAY), (16, -DAY), (23.9, 5 * 3600)])
def test_of_two_days_of_one_date_the_wrong_one_is_refused(name, hours, off):
    logs = days(hours, 4, off, name=name)
    assert refused(logs) == [4]
    words = assemble(logs).pieces[4].refused[0]
    assert "which one arm cannot do" in words
    assert "its dates are wrong" in words
    assert ("by the order of the names" in words) == (name.startswith("log") or abs(off) < DAY)


@pytest.mark.parametrize("off", [DAY, 400 * DAY])
def test_a_copy_of_a_log_with_wrong_dates_is_refused_as_well(off):
    logs = days(16, 4, off)
    logs.insert(5, replace(logs[4], log="log_04_copy.csv"))
    history = assemble(logs)
    assert [k for k, p in enumerate(history.pieces) if p.refused] == [4, 5]
    assert history.pieces[5].refused == (
        "log_04_copy.csv: holds the samples of log_04.csv, whose dates are wrong; leave it out",
    )


def test_of_the_newest_two_days_only_a_date_in_the_name_tells_which_is_wrong():
    assert refused(days(16, 7, DAY, name="2026-06-{day:02d}.csv")) == [7]
    (words,) = assemble(days(16, 7, DAY)).pieces[8].refused
    assert "dated a day or some hours off" in words
    # In the spelling of the cell, once one day is beyond the twelfth.
    assert refused(days(16, 12, DAY, count=14, name="{day:02d}.06.2026.csv")) == [12]
    assert refused(days(16, 12, DAY, count=14, name="06-{day:02d}-2026_0600.csv")) == [12]
    # Names that all hold one date tell nothing, nor do few logs.
    assert refused(days(16, 7, DAY, name="2026-06-01_{k}.csv")) == [8]
    assert refused(days(16, 1, DAY, count=4)) == [2]


def test_hours_of_a_day_that_are_dated_as_the_next_one_are_refused():
    logs = [
        part(f"2026-06-{d + 1:02d}_{h:02d}.csv", t := MONDAY + DAY * (d + (d == 4)) + 3600 * h + d, t + 60)
        for d in range(8)
        for h in range(6, 10)
    ]
    assert refused(logs) == [16, 17, 18, 19]
    numbered = [replace(p, log=f"{k:03d}.csv") for k, p in enumerate(logs)]
    assert refused(numbered) == [16, 17, 18, 19]
    # One of them alone is out of order.
    alone = [replace(p, log=f"{k:03d}.csv") for k, p in enumerate(logs) if k not in (16, 17, 19)]
    assert refused(alone) == [16]


#: Two o'clock of the last Sunday of October 2026 in Berlin, which comes twice.
TWICE = datetime(2026, 10, 25, 2, tzinfo=ZoneInfo("Europe/Berlin")).timestamp()


def night(second: float = 7.0, hours: tuple[int, ...] = (-1, 0, 0, 2, 3)) -> list[Piece]:
    """Logs of a minute an hour about the one that comes twice, whose stamps are read as of the first time."""
    logs = [part(f"{k}.csv", TWICE + 3600 * h + k, TWICE + 3600 * h + 60 + k) for k, h in enumerate(hours)]
    logs[2] = part("2.csv", TWICE + second, TWICE + second + 60)
    return logs


def test_the_second_log_of_the_hour_that_comes_twice_is_an_hour_later():
    history = assemble(night(), "Europe/Berlin")
    assert not any(p.refused for p in history.pieces)
    assert (history.statistics.start - TWICE).tolist() == [-3600, 0, 3600, 7200, 10800]
    assert (history.statistics.samples == 60).all()
    assert history.pieces[2].first == TWICE + 3600 + 7


def test_the_hour_that_comes_twice_is_told_where_it_is_not_known():
    # The zone is not stated; the hour after it is there.
    (words,) = assemble(night()).pieces[2].refused
    assert "State the zone of the stamps as 'time_zone'" in words
    (words,) = assemble(night(hours=(-1, 0, 0, 1, 2)), "Europe/Berlin").pieces[2].refused
    assert "comes twice where summer time ends" in words
    # A copy is none, and on any other day nothing comes twice.
    copy = night()
    copy[2] = replace(copy[1], log="2.csv")
    assert [p.copy_of for p in assemble(copy, "Europe/Berlin").pieces] == ["", "", "1.csv", "", ""]
    later = [replace(p, first=p.first + DAY, last=p.last + DAY) for p in night()]
    for p in later:
        p.statistics.start[:] += DAY
        p.statistics.end[:] += DAY
    (words,) = assemble(later, "Europe/Berlin").pieces[2].refused
    assert "of another robot, or a second export" in words


def test_a_logger_that_does_not_turn_its_clock_is_told_once_for_the_robot():
    local = LocalStamps("Europe/Berlin")
    local.seconds(pa.array(np.datetime64("2026-03-29T02:10:00", "s") + np.arange(100)))
    told = [f"{name}.csv: 100 rows left out: {local.none_such[1]}" for name in "bc"]
    days = [piece("a.csv", 0), *(replace(piece(t[:5], 24 * k), refused=(t,)) for k, t in enumerate(told, 1))]
    (found,) = clock_findings(assemble(days))
    assert found["kind"] == "clock"
    assert found["words"] == told[0] + "."
    assert clock_findings(assemble(days[:1])) == []
