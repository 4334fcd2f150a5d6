"""What an entry of a monitored robot may ask for: patterns of files, lengths of time, numbers for each axis."""

import os
import re
import time
from pathlib import Path

import pytest

from jointwear.files import patterns
from jointwear.files.errors import InputError
from jointwear.files.patterns import matches
from jointwear.measurement.log_kinds import log_format
from jointwear.monitor.days_in_names import days_of
from jointwear.monitor.found_logs import find_all_logs, find_logs, programs_without_logs, readable_files
from jointwear.monitor.lengths_of_time import window_seconds
from jointwear.monitor.order_of_logs import in_order
from jointwear.monitor.robot_entries import check_robots
from jointwear.monitor.shared_logs import check_shared_logs


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name in ("a/b/1.csv", "a/2.csv", "3.csv", ".hidden/4.csv", "a/[x]/5.csv"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    for name in ("a/up", "a/b/up", "a/b/self"):
        os.symlink(tmp_path, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("pattern", "found"),
    [
        ("**/*.csv", {"3.csv", "a/2.csv", "a/b/1.csv", "a/[x]/5.csv"}),
        ("a/**/*.csv", {"a/2.csv", "a/b/1.csv", "a/[x]/5.csv"}),
        ("a/**/b/**/*.csv", {"a/b/1.csv"}),
        ("./*.csv", {"3.csv"}),
        (".hidden/*", {".hidden/4.csv"}),
        ("none/**/*.csv", set()),
        ("a/b/**", {"a/b", "a/b/1.csv"}),
    ],
)
def test_what_a_pattern_matches(folder, pattern, found):
    begin = time.process_time()  # of this process alone, whatever else the machine does
    assert set(matches(pattern)) == found
    assert {os.path.join(folder, name) for name in found} == set(matches(os.path.join(folder, pattern)))
    # Links in circles: glob itself would take for ever.
    assert time.process_time() - begin < 2


def test_a_pattern_for_everything_is_refused(folder, monkeypatch):
    monkeypatch.setattr(patterns, "MOST_ENTRIES", 3)
    with pytest.raises(InputError, match=r"\*\*/\*\.csv: \*\* looks at more than 3 files"):
        matches("**/*.csv")


def test_names_in_any_script_are_sorted(folder):
    names = ["log_²", "log_10", "log_2", "log_٣", "log_" + "9" * 200]
    assert in_order(names)[:2] == ["log_2", "log_٣"]
    for name in names:
        (folder / f"{name}.csv").touch()
    assert len(find_logs(["log_*.csv"])) == len(names)


@pytest.mark.parametrize(
    ("length", "near"),
    [
        (1e-320, "1s"), (0.5, "1s"), (1e12, "3650d"), ("0.0001s", "1s"), ("9" * 400 + "h", "3650d"),
        ("99999d", "3650d"), (float("inf"), "3650d"),
    ],
)  # fmt: skip
def test_a_window_has_a_length_that_an_arm_lives(length, near):
    said = rf"out of range \(allowed: 1 s to 3650 d\); the nearest valid value is {near}$"
    with pytest.raises(InputError, match=said):
        window_seconds(length)


@pytest.mark.parametrize("text", ["1.2.3h", "h", "-1h", "nanh", "1e3s", "٣h"])
def test_a_window_is_a_number_and_a_unit(text):
    with pytest.raises(InputError, match="is no length of time"):
        window_seconds(text)


def test_packed_logs_are_told_and_the_others_go_on(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("day_1.csv", "day_1.csv.xz", "day_2.csv", "day_3.csv.xz", "notes.txt.gz"):
        (tmp_path / name).touch()
    logs, silent = find_all_logs({"monitor": {"robots": {"arm": {"logs": ["day_*"]}}}})
    assert logs == {"arm": ["day_1.csv", "day_2.csv"]}
    assert "matches 1 packed log, as 'day_3.csv.xz', which cannot be read; unpack" in silent["arm"]
    with pytest.raises(InputError, match=r"'day_3\.csv\.xz': is packed; unpack it"):
        find_logs(["day_3*"])
    with pytest.raises(InputError, match=r"'notes\.txt\.gz': no kind of log"):
        find_logs(["notes*"])


def test_a_link_that_leads_nowhere_is_told_and_the_others_go_on(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("day_1.csv").touch()
    Path("day_2.csv").symlink_to("day_2.csv")
    Path("day_3.csv").symlink_to("gone.csv")
    robots = {"arm": {"logs": ["day_[12]*"]}, "other": {"logs": ["day_[13]*"]}, "sound": {"logs": ["day_1*"]}}
    logs, silent = find_all_logs({"monitor": {"robots": robots}})
    assert logs == {name: ["day_1.csv"] for name in robots}
    assert set(silent) == {"arm", "other"}
    assert "'day_2.csv', which is one of symbolic links that lead in a circle; point it" in silent["arm"]
    assert "'day_3.csv', which is a symbolic link to 'gone.csv', which does not exist" in silent["other"]
    with pytest.raises(InputError, match=r"'day_2\.csv': one of symbolic links that lead in a circle"):
        find_logs(["day_2*"])


def test_a_folder_with_the_name_of_a_log_is_told(tmp_path, monkeypatch):
    """As a table that is written in parts: its day would be missing without a word."""
    monkeypatch.chdir(tmp_path)
    Path("day_1.csv").touch()
    Path("day_2.parquet").mkdir()
    Path("day_2.parquet/part_0.parquet").touch()
    logs, silent = find_all_logs({"monitor": {"robots": {"arm": {"logs": ["day_*"]}}}})
    assert logs == {"arm": ["day_1.csv"]}
    assert "1 folder with the name of a log, as 'day_2.parquet', which cannot be read; name the" in silent["arm"]
    with pytest.raises(
        InputError, match=r"'day_2\.parquet': is a folder; name the files in it, as 'day_2\.parquet/\*'"
    ):
        find_logs(["day_2*"])
    logs, silent = find_all_logs({"monitor": {"robots": {"arm": {"logs": ["**/*.*"]}}}})
    assert logs == {"arm": ["day_1.csv", "day_2.parquet/part_0.parquet"]}
    assert silent == {}


@pytest.mark.parametrize(
    ("text", "meant"), [("1 hour", "1h"), ("1w", "7d"), ("1.5 Days", "1.5d"), ("20 min.", "20min")]
)
def test_a_length_in_words_is_told_as_it_is_written(text, meant):
    with pytest.raises(InputError, match=f"; the nearest valid value is {meant}$"):
        window_seconds(text)
    window_seconds(meant)


@pytest.mark.parametrize("text", ["3600", " 3600.0 ", 3600, 3600.0])
def test_a_length_without_a_unit_is_in_seconds_as_text_too(text):
    assert window_seconds(text) == 3600.0


def test_seconds_in_quotation_marks_are_told_to_be_written_without(root):
    entry = {"logs": ["x"], "robot": str(root / "config/robots/puma560.yaml"), "baseline": {"until": "86400"}}
    with pytest.raises(InputError, match="'86400'; did you mean 86400, without quotation marks"):
        check_robots({"monitor": {"robots": {"arm": entry}}})


def test_five_m_may_be_minutes_or_months():
    with pytest.raises(InputError, match=r"as 1h\)$"):
        window_seconds("5m")


@pytest.mark.parametrize("key", ["torque_constant", "scale", "sign", "dead_band"])
def test_a_list_has_one_number_for_each_joint(root, key):
    entry = {"logs": ["x"], "robot": str(root / "config/robots/puma560.yaml"), "baseline": {"windows": 8}}
    check_robots({"monitor": {"robots": {"arm": {**entry, key: [1] * 6}}}})
    with pytest.raises(InputError, match=f"'monitor.robots.arm.{key}' has 7 values, robot 'puma560' has 6 joints"):
        check_robots({"monitor": {"robots": {"arm": {**entry, key: [1] * 7}}}})


def test_packed_logs_of_a_mixed_folder_are_found(tmp_path):
    """A logger that packs its CSV from an update on: the later half would be missing without a word."""
    names = ["log_1.parquet", "log_2.csv.gz", "log_3.CSV.GZ"]
    for name in (*names, "notes.txt", "notes.gz"):
        (tmp_path / name).touch()
    assert [Path(p).name for p in find_logs([f"{tmp_path}/*"])] == names


def test_links_do_not_lead_out_of_the_folder(tmp_path, good):
    inside = tmp_path / "logs"
    inside.mkdir()
    (inside / "a.parquet").write_bytes(good.read_bytes())
    assert find_logs([f"{inside}/*.parquet"]) == [f"{inside}/a.parquet"]
    (inside / "b.parquet").symlink_to(good)
    with pytest.raises(InputError, match=r"b\.parquet' leads outside the folder"):
        find_logs([f"{inside}/*.parquet"])
    with pytest.raises(InputError, match="matches no file"):
        find_logs([f"{inside}/*.csv"])
    (inside / "notes.txt").write_text("x")
    with pytest.raises(InputError, match="no kind of log"):
        find_logs([f"{inside}/*.txt"])


def test_logs_come_in_the_order_of_their_numbers(tmp_path):
    for k in (1, 2, 10):
        (tmp_path / f"log_{k}.csv").write_text("x")
    assert [Path(p).name for p in find_logs([f"{tmp_path}/*.csv"])] == ["log_1.csv", "log_2.csv", "log_10.csv"]


@pytest.mark.parametrize("day", ["{0:02d}{1:02d}{2}", "{0:02d}.{1:02d}.{2}", "{0:02d}-{1:02d}-{2}_0600"])
def test_days_that_are_written_day_first_follow_the_calendar(day):
    days = [(5, 1, 2026), (31, 1, 2026), (1, 2, 2026), (2, 2, 2026), (1, 1, 2027)]
    logs = [f"logs/log_{day.format(*d)}.csv" for d in days]
    assert in_order(reversed(logs)) == logs


@pytest.mark.parametrize("day", ["{1:02d}{0:02d}{2}", "{1:02d}-{0:02d}-{2}_0600"])
def test_days_that_are_written_month_first_follow_the_calendar(day):
    days = [(5, 12, 2025), (31, 12, 2025), (1, 1, 2026), (2, 2, 2026), (1, 1, 2027)]
    logs = [f"logs/log_{day.format(*d)}.csv" for d in days]
    assert in_order(reversed(logs)) == logs


@pytest.mark.parametrize(
    "names",
    [
        ["20260105", "20260131", "20260201"],  # year first
        ["01052026", "01312026", "02012026", "02132026"],  # month first, as the 31st tells
        ["01022026", "05012026"],  # either
        ["run_1_2026", "run_2_2026", "run_10_2026"],
    ],
)
def test_other_names_keep_their_natural_order(names):
    assert in_order(reversed(names)) == names


@pytest.mark.parametrize(
    ("names", "days"),
    [
        (["r_2026-10-05", "r_20261028T0600", "2026_10_28"], ["2026-10-05", "2026-10-28", "2026-10-28"]),
        (["05.10.2026.csv", "28.10.2026.csv"], ["2026-10-05", "2026-10-28"]),
        (["05102026_2359", "28102026"], ["2026-10-05", "2026-10-28"]),
        (["10-05-2026", "10-28-2026"], ["2026-10-05", "2026-10-28"]),
        (["05.10.2026", "06.10.2026"], [None, None]),  # May and June, or October
        (["28.10.2026", "10.28.2026"], [None, None]),  # two clocks, or a folder of two makers
        (["2026-10/28.10.2026", "day_7", "31022026"], ["2026-10-28", None, None]),
        (["2026-02-30", "1.csv", "123456789"], [None, None, None]),
    ],
)
def test_the_day_that_a_name_holds(names, days):
    assert [day and day.isoformat() for day in days_of(names)] == days


def test_programs_that_no_log_is_named_after_are_told():
    logs = ["logs/a/weld_1.csv", "logs/a/pick_1.csv"]
    told = programs_without_logs("cell", {"program": {"logs": {"*/wled_*": "weld"}}}, logs)
    assert "'monitor.robots.cell.program.logs' holds '*/wled_*'; no log of this robot has such a name" in told
    for quiet in ({"logs": {"*/weld_*": "weld", "*/paint_*": "paint"}}, {"columns": "task"}, None):
        assert programs_without_logs("cell", {"program": quiet}, logs) == ""
    assert programs_without_logs("cell", {"program": {"logs": {"*/weld_*": "weld"}}}, []) == ""


@pytest.mark.parametrize(
    ("pattern", "hint"),
    [
        ("logs/pres/*.csv", "there is no folder logs/pres; did you mean 'logs/press/*.csv'?"),
        ("logs\\press\\*.csv", "write folders with /, as 'logs/press/*.csv'"),
        ("elsewhere/*.csv", "there is no folder elsewhere"),
    ],
)
def test_a_pattern_in_a_folder_that_is_not_there_names_the_nearest(tmp_path, monkeypatch, pattern, hint):
    monkeypatch.chdir(tmp_path)
    Path("logs/press").mkdir(parents=True)
    with pytest.raises(InputError, match=re.escape(hint) + "$"):
        find_logs([pattern])


def shared(**robots):
    config = {"monitor": {"robots": {name: {"robot": "arm.yaml", **entry} for name, entry in robots.items()}}}
    return check_shared_logs(find_all_logs(config)[0], config)


@pytest.fixture
def presses(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder in ("press_1", "press_2"):
        Path(folder).mkdir()
        for day in range(2):
            Path(folder, f"day_{day}.csv").touch()
    Path("linked").symlink_to("press_1")
    Path("single").mkdir()
    for day in range(2):
        Path(f"single/day_{day}.csv").hardlink_to(f"press_1/day_{day}.csv")


@pytest.mark.parametrize("pattern", ["press_1/*.csv", "./press_2/../press_1/day_?.csv", "linked/*", "single/*.csv"])
def test_the_same_logs_of_two_robots_are_refused(presses, pattern):
    third = {"logs": ["press_1/*"], "variables": {"position": "left_q"}}
    with pytest.raises(InputError, match=r"'monitor\.robots\.two\.logs' holds the logs of 'one'") as error:
        shared(third=third, one={"logs": ["press_1/*"]}, two={"logs": [pattern]})
    assert "allowed: the logs of one machine for each robot" in str(error.value)


def test_some_shared_logs_are_told(presses):
    one, two = {"logs": ["press_*/*"]}, {"logs": ["press_2/*"]}
    assert shared(one=one) == shared(one={"logs": ["press_1/*"]}, two=two) == []
    told = shared(one=one, two=two)
    assert len(told) == 1
    assert "'monitor.robots.two.logs' holds 'press_2/day_0.csv', which 'one' holds too" in told[0]
    assert len(shared(one=two, two=two | {"robot": "other.yaml"})) == 1


def test_two_arms_of_one_controller_share_its_logs(presses):
    left, right = ({"logs": ["press_1/*"], "variables": {"position": f"{side}_q"}} for side in ("left", "right"))
    assert shared(left=left, right=right) == []
    assert (
        shared(left={"logs": ["press_1/*"], "topic": "/left"}, right={"logs": ["press_1/*"], "topic": "/right"}) == []
    )


def test_logs_that_are_yet_to_be_fetched_are_compared_by_their_path():
    logs = {"one": ["data/a.csv"], "two": ["data/../data/a.csv"]}
    config = {"monitor": {"robots": {name: {"robot": "arm.yaml"} for name in logs}}}
    with pytest.raises(InputError, match="holds the logs of 'one'"):
        check_shared_logs(logs, config)


def forbid(monkeypatch, name):
    """Let the system forbid to look at, list or read what has a name; root, who runs tests too, may do all of it."""
    stat, access, scandir = os.stat, os.access, os.scandir

    def forbidden(path):
        return name in Path(os.fsdecode(path)).parts

    def guarded(of):
        def asked(path=".", *more, **named):
            if isinstance(path, (str, bytes, os.PathLike)) and forbidden(path):
                raise PermissionError(13, "Permission denied", str(path))
            return of(path, *more, **named)

        return asked

    monkeypatch.setattr(os, "stat", guarded(stat))
    monkeypatch.setattr(os, "scandir", guarded(scandir))
    monkeypatch.setattr(os, "listdir", guarded(os.listdir))
    monkeypatch.setattr(os, "access", lambda path, *more, **named: not forbidden(path) and access(path, *more, **named))


def test_a_folder_that_may_not_be_looked_at_stops_no_other_robot(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder in ("open", "locked"):
        Path(folder).mkdir()
        Path(folder, "day_1.csv").touch()
    forbid(monkeypatch, "locked")
    robots = {"arm": {"logs": ["open/*"]}, "other": {"logs": ["locked/*"]}}
    assert log_format("locked/*") is None
    assert log_format("locked/day_1.csv") == "csv"
    logs, silent = find_all_logs({"monitor": {"robots": robots}})
    assert logs == {"arm": ["open/day_1.csv"], "other": []}
    assert list(silent) == ["other"]
    assert silent["other"].endswith("holds 'locked/*': Permission denied")


def test_a_log_that_may_not_be_read_is_no_input_of_a_job(tmp_path, monkeypatch):
    """Snakemake notes the sum of every input and fails on one that it cannot open; the reader refuses it alone."""
    monkeypatch.chdir(tmp_path)
    Path("bag").mkdir()
    for name in ("day_1.csv", "day_2.csv", "bag/metadata.yaml", "bag/part.mcap"):
        Path(name).touch()
    forbid(monkeypatch, "day_2.csv")
    assert in_order(["day_2.csv", "day_1.csv"]) == ["day_1.csv", "day_2.csv"]
    logs = ["day_1.csv", "day_2.csv", "yet_to_be_fetched.csv", "bag"]
    assert readable_files(logs) == ["day_1.csv", "yet_to_be_fetched.csv", "bag/metadata.yaml", "bag/part.mcap"]


def test_a_log_whose_name_is_not_utf_8_is_told_and_the_others_go_on(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in (b"day_1.csv", b"day_2_\xe9.csv", "tag_ü.csv".encode(), b"\xff.txt"):
        Path(os.fsdecode(name)).touch()
    logs, silent = find_all_logs({"monitor": {"robots": {"arm": {"logs": ["*"]}, "sound": {"logs": ["tag*"]}}}})
    assert logs == {"arm": ["day_1.csv", "tag_ü.csv"], "sound": ["tag_ü.csv"]}
    assert list(silent) == ["arm"]
    assert r"matches 1 log, as 'day_2_\xe9.csv', whose name is not UTF-8, so that it cannot be" in silent["arm"]
    silent["arm"].encode()
    with pytest.raises(InputError, match=r"'day_2_\\xe9\.csv': its name is not UTF-8; rename it"):
        find_logs(["day_2*"])
    with pytest.raises(InputError, match=r"'\\xff\.txt': no kind of log"):
        find_logs(["*.txt"])
    with pytest.raises(InputError, match=r"matches no file; did you mean 'day_1\.csv'"):
        find_logs(["day_3.csv"])
