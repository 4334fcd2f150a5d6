"""What the baseline tells is kept from day to day, and only while everything that determines it is the same."""

import numpy as np
import pytest
from monitor_logs import ROBOT, START, columns, make_log, write_parquet

from jointwear.monitor import stages
from jointwear.monitor.fleet import watch
from jointwear.monitor.normal import learning
from jointwear.monitor.normal.recall import Recall, key_of, read_recall, write_recall
from jointwear.monitor.reading import reading_stages
from jointwear.monitor.watching import watching


@pytest.fixture
def days_of_an_arm(tmp_path):
    """The entry of a robot and its logs, one a day, the first three days of them its baseline."""
    logs = []
    for number in range(6):
        log = make_log(36.0, seed=number, start=START + 86400.0 * number, noise=0.02)
        warm = {"temperature": 30.0 + np.linspace(0, 3, len(log.time))}
        logs.append(str(write_parquet(tmp_path / f"day_{number}.parquet", columns(log) | warm)))
    entry = {"logs": ["day_*"], "robot": str(ROBOT), "window": "12s", "baseline": {"until": START + 86400.0 * 3}}
    return entry, logs


def test_an_entry_is_made_once_and_only_what_was_asked_for_is_kept(tmp_path):
    path, row = tmp_path / "recall.json", [[0.1 + 0.2, None, 3.0], []]
    first = Recall({"old": [[1.0]]})
    assert first("new", lambda: row) == row
    assert first("new", list) == row
    write_recall(path, first, "code")
    assert read_recall(path, "code").used == {}
    assert read_recall(path, "code")("new", list) == row
    assert read_recall(path, "code")("old", list) == []
    assert read_recall(path, "other code")("new", list) == []


@pytest.mark.parametrize("text", ["", "{", "[]", '{"made_with": "x", "entries": {"k": 3}}', '{"entries": {}}'])
def test_a_broken_file_keeps_nothing(tmp_path, text):
    path = tmp_path / "recall.json"
    path.write_text(text)
    assert read_recall(path, "code")("k", lambda: [[7.0]]) == [[7.0]]


def test_a_key_tells_values_shapes_and_types_apart():
    one = np.arange(4.0)
    keys = [key_of(one), key_of(one.astype(np.float32)), key_of(one.reshape(2, 2)), key_of(one, 1), key_of(one, None)]
    keys.append(key_of(np.nextafter(one, 9.0)))
    assert len(set(keys)) == len(keys)
    assert key_of(one) == key_of(np.arange(8.0)[:4])


@pytest.mark.long
def test_a_new_day_learns_and_simulates_nothing_again(monkeypatch, days_of_an_arm, tmp_path):
    entry, logs = days_of_an_arm
    monkeypatch.setattr(watch, "write_page", lambda *_: None)
    watch.watch_robot("arm", entry, logs[:-1], tmp_path / "pieces")
    made = []
    for module, name in ((learning, "_choose"), (watching, "null_thresholds")):
        whole = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *given, whole=whole, name=name: made.append(name) or whole(*given))
    row = watch.watch_robot("arm", entry, logs, tmp_path / "pieces")
    assert row["logs_read"] == 1
    assert made == []
    watch.watch_robot("arm", entry, logs, tmp_path / "anew")
    assert set(made) == {"_choose", "null_thresholds"}
    said = [(tmp_path / kind / "arm/alarms.csv").read_text() for kind in ("pieces", "anew")]
    assert said[0] == said[1]
    kept = [(tmp_path / kind / "arm/recall.json").read_bytes() for kind in ("pieces", "anew")]
    assert kept[0] == kept[1]


@pytest.mark.long
def test_the_rule_of_one_robot_learns_nothing_again(monkeypatch, days_of_an_arm, tmp_path):
    entry, logs = days_of_an_arm
    survey, windows = tmp_path / "survey.json", tmp_path / "windows.nc"
    reading_stages.survey_logs(logs[0], entry["robot"], entry, survey)
    reading_stages.accumulate_windows(logs, survey, entry["robot"], entry, windows)

    def judged(name):
        (tmp_path / name).mkdir(exist_ok=True)
        state, alarms = tmp_path / name / "state.nc", tmp_path / name / "alarms.csv"
        recall = tmp_path / name / "recall.json"
        stages.judge_windows([windows], entry["robot"], entry, state, alarms, recall, "arm")
        return state.read_bytes(), alarms.read_bytes()

    first = judged("kept")
    made, whole = [], learning._choose
    monkeypatch.setattr(learning, "_choose", lambda *given: made.append(1) or whole(*given))
    assert judged("kept") == first
    assert made == []
    assert judged("anew") == first
    assert made
