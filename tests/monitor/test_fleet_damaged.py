"""Files that the fleet keeps for itself, damaged or written by somebody else: read anew, or one line."""

import json
import os
import shutil

import pyarrow as pa
import pytest
from monitor_logs import ROBOT, START, columns, make_log, write_parquet
from pyarrow import parquet

from jointwear.files.errors import InputError
from jointwear.monitor.events import events_of
from jointwear.monitor.fleet.history import SCHEMA, join_histories
from jointwear.monitor.fleet.watch import watch_robot
from jointwear.monitor.notify.outbox import Outbox
from jointwear.monitor.presentation.standing import NOTHING, rows_of

pytestmark = pytest.mark.usefixtures("surveyed_once")
ENTRY = {"logs": ["logs/*"], "robot": str(ROBOT), "window": "12s", "baseline": {"windows": 8}}


@pytest.fixture(scope="module")
def watched(tmp_path_factory):
    """A fleet of one robot, judged once; returns its folder, its logs and the row."""
    folder = tmp_path_factory.mktemp("fleet")
    logs = [
        str(write_parquet(folder / f"day_{k}.parquet", columns(make_log(36.0, seed=k, start=START + 60.0 * k))))
        for k in range(3)
    ]
    return folder, logs, watch_robot("arm", ENTRY, logs, folder / "robots", page=False)


def emptied(path):
    path.unlink()
    path.touch()


def piped(path):
    path.unlink()
    os.mkfifo(path)


def made_a_folder(path):
    path.unlink()
    path.mkdir()


def redirected(path):
    """A record that names statistics elsewhere."""
    record = json.loads(path.read_text())
    del record["checksum"]
    for kept in record["logs"].values():
        kept["file"] = "../../../elsewhere.nc"
    path.write_text(json.dumps(record))


@pytest.mark.parametrize(
    ("name", "damage"),
    [
        ("read.json", emptied),
        ("read.json", piped),
        ("read.json", lambda path: path.write_text('{"logs": []}')),
        ("read.json", lambda path: path.write_text('{"settings": 1, "code": [], "judged": "", "logs": {"x": 5}}')),
        ("read.json", redirected),
        ("survey.json", emptied),
        ("survey.json", piped),
    ],
)
def test_what_tells_how_logs_were_read_is_made_anew(watched, tmp_path, name, damage):
    folder, logs, row = watched
    shutil.copytree(folder / "robots", tmp_path / "robots")
    damage(tmp_path / "robots/arm" / name)
    again = watch_robot("arm", ENTRY, logs, tmp_path / "robots", page=False)
    moved = {"logs_read", "folder"}
    assert {k: v for k, v in again.items() if k not in moved} == {k: v for k, v in row.items() if k not in moved}
    assert again["logs_read"] == len(logs)


@pytest.mark.parametrize(
    "damage",
    [
        emptied,
        piped,
        lambda path: path.write_bytes(b"\xff\xfe"),
        lambda path: path.write_text(path.read_text()[:40]),
        lambda path: path.write_text(path.read_text().translate(str.maketrans("01", "10"))),
    ],
)
def test_a_damaged_mark_of_whose_a_folder_is_forks_no_robot(watched, tmp_path, damage):
    folder, logs, row = watched
    shutil.copytree(folder / "robots", tmp_path / "robots")
    mark = tmp_path / "robots/arm/whose.txt"
    sound = mark.read_text()
    damage(mark)
    assert watch_robot("arm", ENTRY, logs, tmp_path / "robots", page=False) == row | {"logs_read": 0}
    assert mark.read_text() == sound
    assert [path.name for path in (tmp_path / "robots").iterdir()] == ["arm"]


def test_a_damaged_mark_gives_nobody_the_history_of_another_robot(watched, tmp_path):
    folder, _, _ = watched
    shutil.copytree(folder / "robots", tmp_path / "robots")
    emptied(tmp_path / "robots/arm/whose.txt")
    other = [str(write_parquet(tmp_path / "other.parquet", columns(make_log(36.0, seed=9, start=START))))]
    found = watch_robot("arm", ENTRY | {"logs": ["other/*"]}, other, tmp_path / "robots", page=False)
    assert found["folder"] != "arm"
    assert any(f["kind"] == "robot" for f in found["findings"])


@pytest.mark.parametrize("name", ["state.nc", "whose.txt"])
def test_what_is_a_folder_is_a_refusal_of_its_robot(watched, tmp_path, name):
    folder, logs, _ = watched
    shutil.copytree(folder / "robots", tmp_path / "robots")
    made_a_folder(tmp_path / "robots/arm" / name)
    found = watch_robot("arm", ENTRY, logs, tmp_path / "robots", page=False)
    assert found["result"] == "refused"
    assert name in found["reason"]
    assert "internal" not in found["reason"]


def history(watched):
    return parquet.read_table(watched[0] / "robots/arm/history.parquet")


@pytest.mark.parametrize(
    "change",
    [
        lambda table: table.drop(["status"]),
        lambda table: table.append_column("more", pa.nulls(len(table))),
        lambda table: table.set_column(1, "axis", pa.array(["x"] * len(table))),
        lambda table: table.set_column(9, "temperature", pa.array([[1.0]] * len(table))),
        lambda table: table.select(table.column_names[::-1]),
    ],
)
def test_a_history_with_other_columns_is_named(watched, tmp_path, change):
    parquet.write_table(change(history(watched)), tmp_path / "a.parquet")
    with pytest.raises(InputError, match=r"a\.parquet: is no history of this version"):
        join_histories([tmp_path / "a.parquet"], tmp_path / "all.parquet")
    assert not (tmp_path / "all.parquet").exists()


def test_a_sound_history_is_joined_and_a_pipe_is_named(watched, tmp_path):
    parts = [watched[0] / "robots/arm/history.parquet"] * 2
    join_histories(parts, tmp_path / "all.parquet")
    joined = parquet.read_table(tmp_path / "all.parquet")
    assert joined.schema.equals(SCHEMA)
    assert len(joined) == 2 * len(history(watched))
    os.mkfifo(tmp_path / "pipe.parquet")
    with pytest.raises(InputError, match="named pipe"):
        join_histories([tmp_path / "pipe.parquet"], tmp_path / "all.parquet")


ROW = {"robot": "arm", "folder": "arm", "result": "judged", "logs_read": 0, **NOTHING}


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (None, "has no rows"),
        ({}, "has no rows"),
        ([ROW, None], "row 2 is None"),
        ([{}], "row 1 has no sound 'robot'"),
        ([{**ROW, "axes": 5}], "row 1 has no sound 'axes'"),
        ([{**ROW, "reason": None}], "row 1 has no sound 'reason'"),
        ([{**ROW, "folder": "../../elsewhere"}], "row 1: 'folder' is '../../elsewhere'"),
    ],
)
def test_a_row_that_is_none_is_named(tmp_path, rows, words):
    path = tmp_path / "batch.json"
    path.write_text(json.dumps({"robots": [ROW]}))
    assert rows_of(path) == [ROW]
    path.write_text(json.dumps({"robots": rows}))
    with pytest.raises(InputError, match=words):
        rows_of(path)


@pytest.mark.parametrize(
    "content",
    [
        {"told": [], "waiting": []},
        {"told": {"a": 5}, "waiting": []},
        {"told": {"a": {"arm|1": 5}}, "waiting": []},
        {"told": {}, "waiting": [{}]},
        {"told": {}, "waiting": [5]},
        {"told": {}, "waiting": {}},
    ],
)
def test_an_outbox_of_another_layout_is_left_as_it_is(tmp_path, content):
    path = tmp_path / "outbox.json"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match="is damaged or was changed"):
        Outbox.open(path)
    assert json.loads(path.read_text()) == content


@pytest.mark.parametrize(
    "time", [1e17, -1e17, "0001-01-01", "9999-12-31T23:59:59-12:00", "2026-02-30", "nan", "x" * 500]
)
def test_an_event_at_a_time_that_no_page_can_show_is_refused(time):
    with pytest.raises(InputError, match=r"events\[0\]\.time' is .*allowed: ISO 8601") as error:
        events_of({"events": [{"time": time, "kind": "service"}]})
    assert len(str(error.value)) < 300
    assert events_of({"events": [{"time": "2026-02-01T06:00:00Z", "kind": "service"}]})
