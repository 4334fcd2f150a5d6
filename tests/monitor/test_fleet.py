"""A batch of robots in one job: every robot judged like alone, a refused one told and left."""

import csv
import json
import shutil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.files.json_documents import write_json
from jointwear.files.storage import Variable, write_dataset
from jointwear.monitor.fleet.plan import (
    FEWEST_PER_JOB,
    JOBS,
    MOST_PROCESSES,
    ROBOTS_PER_JOB,
    WHOSE,
    batches,
    begun,
    noted,
    processes_of_job,
)
from jointwear.monitor.fleet.summary import summarise_fleet
from jointwear.monitor.fleet.watch import watch_robots
from jointwear.monitor.reading.reading_stages import accumulate_windows, survey_logs
from jointwear.monitor.stages import judge_windows
from jointwear.robots.robot import load_robot
from jointwear.statistics.randomness import generator
from jointwear.studies.monitor_study.example import real_arm, simulate_day


def test_every_robot_is_in_one_batch():
    robots = [f"r{n}" for n in range(12)]
    found = batches(robots)
    assert [name for batch in found.values() for name in batch] == robots
    assert [len(batch) for batch in found.values()] == [5, 5, 2]
    assert batches([]) == {}


@given(st.integers(1, 3000))
def test_a_job_has_few_robots_while_cores_may_be_idle_and_never_many(count):
    found = [len(batch) for batch in batches([f"r{n}" for n in range(count)]).values()]
    assert sum(found) == count
    assert max(found) <= ROBOTS_PER_JOB
    assert min(found[:-1], default=FEWEST_PER_JOB) >= FEWEST_PER_JOB
    assert len(found) <= JOBS or max(found) == ROBOTS_PER_JOB


@given(st.integers(0, 100), st.integers(1, 64) | st.none())
def test_a_job_reads_with_cores_that_no_other_job_needs(jobs, cores):
    processes = processes_of_job(jobs, cores)
    assert 1 <= processes <= MOST_PROCESSES
    assert processes == 1 or processes * jobs <= cores


def test_batches_of_two_configurations_have_names_of_their_own():
    ours, theirs = batches(["a", "b"]), batches(["a", "c"])
    assert not ours.keys() & theirs.keys()
    assert next(iter(batches([*"abcdefg"]))) == next(iter(batches([*"abcdexy"])))


@pytest.fixture(scope="module")
def log(tmp_path_factory, root):
    """One day of a healthy arm."""
    time, position, torque = simulate_day(
        real_arm(load_robot(root / "config/robots/puma560.yaml"), generator(1, "fleet", replicate=0)), 0
    )
    path = tmp_path_factory.mktemp("log") / "day.nc"
    pair = ("time", "joint")
    variables = {
        "joint": Variable(("joint",), np.arange(1, 7), "number of the joint", "1"),
        "time": Variable(("time",), time, "time", "seconds since 1970-01-01T00:00:00Z"),
        "position": Variable(pair, position, "joint position", "rad"),
        "torque": Variable(pair, torque, "joint torque", "N m"),
    }
    write_dataset(path, variables, {"title": "a log"})
    return str(path)


def test_a_fleet_says_what_single_robots_say(log, root, tmp_path):
    entry = {"robot": str(root / "config/robots/puma560.yaml"), "baseline": {"windows": 12}, "window": "1h"}
    broken = {**entry, "robot": str(root / "config/robots/kinova_gen3.yaml")}
    entries = {"one": entry, "two": entry, "wrong_arm": broken}
    watch_robots(entries, {name: [log] for name in entries}, tmp_path / "robots", tmp_path / "batch.json")
    rows = {row["robot"]: row for row in json.loads((tmp_path / "batch.json").read_text())["robots"]}
    assert rows["one"]["result"] == rows["two"]["result"] == "judged"
    assert rows["wrong_arm"]["result"] == "refused"
    assert rows["wrong_arm"]["reason"]

    survey_logs(log, entry["robot"], {"window": "1h"}, tmp_path / "survey.json")
    accumulate_windows([log], tmp_path / "survey.json", entry["robot"], {"window": "1h"}, tmp_path / "windows.nc")
    outputs = (tmp_path / name for name in ("state.nc", "alarms.csv", "recall.json"))
    judge_windows([tmp_path / "windows.nc"], entry["robot"], entry, *outputs)
    assert (tmp_path / "alarms.csv").read_bytes() == (tmp_path / "robots/one/alarms.csv").read_bytes()

    names = ("fleet.csv", "index.html", "metrics.prom", "history.parquet", "rows.json")
    summarise_fleet([tmp_path / "batch.json"], tmp_path / "robots", *(tmp_path / name for name in names))
    with (tmp_path / "fleet.csv").open() as file:
        table = {row["robot"]: row for row in csv.DictReader(file)}
    assert table.keys() == entries.keys()
    assert list(next(iter(table.values())))[:5] == ["robot", "result", "alarms", "axes_changed", "reason"]
    assert table["wrong_arm"]["refused_logs"] == "1"
    text = (tmp_path / "index.html").read_text()
    assert text.index("wrong_arm") < text.index('href="robots/one/monitor.html"')
    assert (tmp_path / "robots/one/monitor.html").is_file()


def test_a_folder_that_is_gone_is_counted_until_it_is_there_again(tmp_path):
    """Before the job, after it, and after the folder is gone: a change of the parameter only where one is gone."""
    notes = tmp_path / "notes.json"
    rows = [{"robot": "arm", "folder": "arm"}, {"robot": "two", "folder": "two_12345678"}]

    def ran(counts):
        for row in rows:
            (tmp_path / row["folder"]).mkdir(exist_ok=True)
            (tmp_path / row["folder"] / WHOSE).touch()
        write_json(notes, noted(rows, counts))

    assert begun(notes, tmp_path) == {}
    ran({})
    assert begun(notes, tmp_path) == {}
    for times in (1, 2):
        shutil.rmtree(tmp_path / "two_12345678")
        assert begun(notes, tmp_path) == {"two": times}
        ran(begun(notes, tmp_path))
        assert begun(notes, tmp_path) == {"two": times}


@pytest.mark.parametrize("file", ["state.nc", "alarms.csv", "history.parquet", "monitor.html"])
def test_a_file_of_a_judgement_that_is_gone_asks_for_the_job(tmp_path, file):
    rows = [{"robot": "arm", "folder": "arm", "result": "judged", "page": "monitor.html"}]
    (tmp_path / "arm").mkdir()
    for name in (WHOSE, "state.nc", "alarms.csv", "history.parquet", "monitor.html"):
        (tmp_path / "arm" / name).touch()
    write_json(tmp_path / "notes.json", noted(rows, {}))
    assert begun(tmp_path / "notes.json", tmp_path) == {}
    (tmp_path / "arm" / file).unlink()
    assert begun(tmp_path / "notes.json", tmp_path) == {"arm": 1}
    write_json(tmp_path / "notes.json", noted([{**rows[0], "result": "refused", "page": None}], {}))
    assert begun(tmp_path / "notes.json", tmp_path) == {}, "a robot that is refused has no such files"


@pytest.mark.parametrize(
    "text", ["", "[1]", '{"begun": 3, "folders": {}}', '{"begun": {"a": "x"}, "folders": {}}', "{}"]
)
def test_of_damaged_notes_nothing_is_known(tmp_path, text):
    (tmp_path / "notes.json").write_text(text)
    assert begun(tmp_path / "notes.json", tmp_path) == {}
