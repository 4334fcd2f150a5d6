"""Broken files of the fleet's own: the robot is judged as if they were sound, or refused in one line."""

import shutil
from pathlib import Path

import pytest
from hypothesis import given
from isolation import held, outcome_of
from monitor_logs import ROBOT, START, columns, make_log, write_parquet
from mutations import broken_bytes, finite_numbers, seeds

from jointwear.monitor.fleet.history import join_histories
from jointwear.monitor.fleet.watch import watch_robot

pytestmark = pytest.mark.hostile
ENTRY = {"logs": ["logs/*"], "robot": str(ROBOT), "window": "12s", "baseline": {"windows": 8}}
#: Of a row, what depends on which logs had to be read again.
VARYING = ("logs_read", "folder")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A robot that was judged once: the folder of the fleet, the logs, and its row."""
    folder = tmp_path_factory.mktemp("fleet")
    logs = [str(folder / f"day_{k}.parquet") for k in range(3)]

    def judge():
        for k, path in enumerate(logs):
            write_parquet(Path(path), columns(make_log(36.0, seed=k, start=START + 60.0 * k)))
        return watched(folder / "robots", logs)

    found = outcome_of(judge, limit=60.0)
    assert found.kind == "accepted", found.value
    return folder / "robots", logs, found.value


def watched(folder, logs):
    row = watch_robot("arm", ENTRY, logs, folder, page=False)
    assert "internal error" not in row["reason"], row["reason"]
    assert finite_numbers(row)
    return {key: value for key, value in row.items() if key not in VARYING}


@pytest.mark.parametrize("name", ["whose.txt", "read.json", "survey.json", "state.nc", "windows"])
def test_broken_bytes_of_what_is_kept(whole, tmp_path, name):
    folder, logs, expected = whole
    kept = folder / "arm" / name
    place = next(kept.iterdir()).relative_to(folder) if kept.is_dir() else kept.relative_to(folder)

    @given(broken_bytes((folder / place).read_bytes()))
    @seeds(12)
    def check(data):
        shutil.rmtree(tmp_path / "robots", ignore_errors=True)
        shutil.copytree(folder, tmp_path / "robots")
        (tmp_path / "robots" / place).write_bytes(data)
        found = held(outcome_of(lambda: watched(tmp_path / "robots", logs)))
        assert found.kind == "accepted"
        assert found.value == expected or found.value["result"] == "refused"

    check()


def test_broken_bytes_of_a_history(whole, tmp_path):
    sound = whole[0] / "arm/history.parquet"
    path = tmp_path / "history.parquet"

    @given(broken_bytes(sound.read_bytes()))
    @seeds(100)
    def check(data):
        path.write_bytes(data)
        held(outcome_of(lambda: join_histories([path], tmp_path / "all.parquet")))

    check()
