"""Logs cut off in the middle are judged by what is left of them, and said so where all others last equally long."""

import gzip
from types import SimpleNamespace

import netCDF4
import pytest
from monitor_logs import columns, make_log, read, write_csv

from jointwear.files.storage import CHECKSUM
from jointwear.monitor.findings.short_logs import short_log_findings
from jointwear.monitor.reading.assembly import Piece
from jointwear.monitor.reading.piece_files import read_pieces, write_pieces


def history(lasted, length=3600.0, copies=(), cut=()):
    pieces = [
        SimpleNamespace(
            log=f"{k}.csv",
            first=3600.0 * k,
            last=3600.0 * k + seconds,
            copy_of="0.csv" if k in copies else "",
            cut=k in cut,
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


def test_a_log_that_ends_within_a_row_is_told_but_the_newest():
    """However long logs are: half a day of a daily log was judged, and nothing said."""
    days = [30000.0, 31000.0, 16000.0, 30500.0]
    (found,) = short_log_findings(history(days, cut=[2]))
    assert (found["kind"], found["time"], found["end"]) == ("cut_logs", 2 * 3600.0, 2 * 3600.0 + 16000.0)
    assert found["words"].startswith("2.csv ends within a row: cut off while written or copied?")
    (found,) = short_log_findings(history(days, cut=[0, 2, 3]))
    assert found["words"].startswith("2 logs end, the latest of them 2.csv, within a row")
    assert short_log_findings(history(days, cut=[3])) == []
    # Of one that is short, too, that is enough.
    assert [f["kind"] for f in short_log_findings(history([30.0] * 10 + [15.0, 30.0], cut=[10]))] == ["cut_logs"]


@pytest.mark.parametrize("packed", [False, True])
def test_the_end_of_a_log_is_kept_with_its_windows(tmp_path, good, packed):
    text = write_csv(tmp_path / "whole.csv", columns(make_log(48.0))).read_bytes()
    short = text.rstrip(b"\r\n")
    ends = {"whole": (text, False), "no_line_end": (short, False), "torn": (short.rpartition(b",")[0], True)}
    pieces = []
    for name, (content, cut) in ends.items():
        path = tmp_path / f"{name}.csv{'.gz' * packed}"
        path.write_bytes(gzip.compress(content) if packed else content)
        found = read(path, good)
        assert (found.cut, found.refused) == (cut, ())
        pieces.append(Piece(str(path), found.statistics, found.first, found.last, cut=found.cut))
    write_pieces(pieces, tmp_path / "pieces.nc", {})
    assert [p.cut for p in read_pieces(tmp_path / "pieces.nc")] == [False, False, True]
    with netCDF4.Dataset(tmp_path / "pieces.nc", "a") as dataset:
        dataset.delncattr("cut")
        dataset.delncattr(CHECKSUM)
    assert not any(p.cut for p in read_pieces(tmp_path / "pieces.nc"))
