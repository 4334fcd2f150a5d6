"""The fleet reads each log once, keeps what it read, and loses no robot to another."""

import json
import os
import shutil
from pathlib import Path

import pytest
from monitor_logs import ROBOT, START, columns, make_log, write_csv, write_parquet

from jointwear.monitor.fleet import reading, watch
from jointwear.monitor.fleet.plan import seen
from jointwear.monitor.fleet.watch import watch_robot, watch_robots
from jointwear.monitor.presentation.page import write_page
from jointwear.publishing.report import rendering

pytestmark = pytest.mark.usefixtures("surveyed_once", "no_pages")
ENTRY = {"logs": ["logs/*"], "robot": str(ROBOT), "window": "12s", "baseline": {"windows": 8}}


def day(folder, number, seconds=36.0, **scaled):
    """A log of three windows."""
    log = columns(make_log(seconds, seed=number, start=START + 60.0 * number))
    return str(write_parquet(folder / f"day_{number:02d}.parquet", log))


@pytest.fixture
def logs(tmp_path):
    (tmp_path / "logs").mkdir()
    return [day(tmp_path / "logs", number) for number in range(4)]


def watched(logs, folder, **more):
    return watch_robot("arm", more.pop("entry", ENTRY), logs, folder / "robots", **{"page": False, **more})


def test_each_log_is_read_once(logs, tmp_path):
    first = watched(logs, tmp_path)
    assert (first["result"], first["logs_read"], first["windows"]) == ("judged", 4, 12)
    state = (tmp_path / "robots/arm/state.nc").stat().st_mtime_ns
    assert watched(logs, tmp_path)["logs_read"] == 0
    assert (tmp_path / "robots/arm/state.nc").stat().st_mtime_ns == state, "nothing new, nothing judged"
    logs.append(day(tmp_path / "logs", 4))
    again = watched(logs, tmp_path)
    assert (again["logs_read"], again["windows"]) == (1, 15)


@pytest.mark.long
def test_logs_read_in_two_processes_say_what_they_say_in_one(logs, tmp_path):
    (tmp_path / "logs/day_04.parquet").write_bytes(b"no log")
    logs.append(str(tmp_path / "logs/day_04.parquet"))
    late = make_log(36.0, seed=5, start=START + 300.0)
    logs.append(str(write_csv(tmp_path / "logs/day_05.csv", columns(late))))
    alone, together = (watched(logs, tmp_path / name, processes=k) for name, k in (("alone", 1), ("together", 2)))
    assert alone == together
    assert (alone["logs_read"], alone["refused_logs"]) == (6, 1)
    one, other = (tmp_path / name / "robots/arm/windows" for name in ("alone", "together"))
    assert [p.read_bytes() for p in sorted(one.iterdir())] == [p.read_bytes() for p in sorted(other.iterdir())]


@pytest.mark.parametrize("file", ["state.nc", "alarms.csv", "history.parquet", "monitor.html"])
def test_a_file_that_is_gone_is_written_again(logs, tmp_path, monkeypatch, file):
    monkeypatch.setattr(watch, "write_page", lambda state, output, *_: output.write_text("page"))
    watched(logs, tmp_path, page=True)
    (tmp_path / "robots/arm" / file).unlink()
    assert watched(logs, tmp_path, page=True)["logs_read"] == 0
    assert (tmp_path / "robots/arm" / file).is_file()


def test_an_edit_of_a_template_writes_the_page_anew(logs, tmp_path, monkeypatch):
    written = []
    monkeypatch.setattr(watch, "write_page", lambda state, output, *_: written.append(output.write_text("page")))
    templates = shutil.copytree(rendering.TEMPLATES, tmp_path / "report")
    monkeypatch.setattr(rendering, "TEMPLATES", templates)
    watched(logs, tmp_path, page=True)
    for name, times in (("fleet.html.j2", 1), ("monitor.html.j2", 2), ("style.css", 3), ("robots.html.j2", 4)):
        (templates / name).write_text((templates / name).read_text() + "\n")
        watched(logs, tmp_path, page=True)
        assert len(written) == times, name


def test_a_log_that_sorts_first_costs_itself(logs, tmp_path):
    watched(logs, tmp_path)
    survey = (tmp_path / "robots/arm/survey.json").read_bytes()
    early = columns(make_log(36.0, seed=9, start=START - 600.0))
    logs.insert(0, str(write_parquet(tmp_path / "logs/a.parquet", early)))
    assert watched(logs, tmp_path)["logs_read"] == 1
    assert (tmp_path / "robots/arm/survey.json").read_bytes() == survey


def test_a_log_that_changes_is_read_again(logs, tmp_path):
    watched(logs, tmp_path)
    day(tmp_path / "logs", 2, seconds=48.0)
    found = watched(logs, tmp_path)
    assert (found["logs_read"], found["windows"]) == (1, 13)


@pytest.mark.long
def test_settings_of_the_judgement_read_nothing_and_those_of_reading_all(logs, tmp_path):
    watched(logs, tmp_path)
    assert watched(logs, tmp_path, entry=ENTRY | {"limits": {"coulomb_increase_percent": 30.0}})["logs_read"] == 0
    assert watched(logs, tmp_path, entry=ENTRY | {"window": "6s", "baseline": {"windows": 8}})["logs_read"] == 4


def test_what_was_read_of_logs_that_are_gone_counts_on(logs, tmp_path):
    watched(logs, tmp_path)
    found = watched(logs[2:], tmp_path)
    assert (found["logs"], found["kept_logs"], found["windows"]) == (4, 2, 12)
    lost = watched([], tmp_path, unreachable="config: there is no folder logs")
    assert (lost["result"], lost["windows"], lost["kept_logs"]) == ("judged", 12, 4)
    assert lost["reason"] == "config: there is no folder logs"


def own_robot(tmp_path):
    """A robot file of the test alone, and the entry that names it."""
    robot = tmp_path / "robot.yaml"
    robot.write_bytes(ROBOT.read_bytes())
    return robot, ENTRY | {"robot": str(robot)}


def test_a_comment_and_other_words_lose_nothing(logs, tmp_path):
    robot, entry = own_robot(tmp_path)
    watched(logs, tmp_path, entry=entry)
    robot.write_text(robot.read_text() + "# moved to cell 4\n")
    found = watched(logs[2:], tmp_path, entry=entry | {"window": 12, "scale": 1.0})
    assert (found["result"], found["logs_read"], found["kept_logs"]) == ("judged", 0, 2)


@pytest.mark.parametrize("there", [slice(2, None), slice(0, 0)])
def test_another_model_does_not_take_logs_that_are_gone_away(logs, tmp_path, there):
    robot, entry = own_robot(tmp_path)
    before = watched(logs, tmp_path, entry=entry)
    given = robot.read_text()
    robot.write_text(given.replace("mass: ", "mass: 1"))
    for _ in range(2):
        found = watched(logs[there], tmp_path, entry=entry)
        assert found["result"] == "refused"
        assert f"{4 - len(logs[there])} logs that can no longer be reached" in found["reason"]
        assert f"move {tmp_path / 'robots/arm'} away" in found["reason"]
    robot.write_text(given)
    assert watched(logs[there], tmp_path, entry=entry)["windows"] == before["windows"]


def kept_files(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def stopped_at(group, monkeypatch):
    """Let the reading of logs be stopped at a group of one log; return how to let it go on."""
    read, groups = reading.log_pieces, []

    def stopped(logs, *more):
        groups.append(logs)
        if len(groups) == group:
            raise KeyboardInterrupt
        return read(logs, *more)

    monkeypatch.setattr(reading, "SAVE_EVERY", 1)
    monkeypatch.setattr(reading, "log_pieces", stopped)
    return lambda: monkeypatch.setattr(reading, "log_pieces", read)


def surveys(monkeypatch):
    """Return the list of the logs that are surveyed from now on."""
    survey, found = reading.survey_logs, []
    monkeypatch.setattr(reading, "survey_logs", lambda log, *more: (found.append(log), survey(log, *more)))
    return found


def test_another_version_of_the_library_surveys_the_first_log_anew(logs, tmp_path, monkeypatch):
    """As `monitor` does: how all logs are read comes from it."""
    watched(logs, tmp_path)
    found = surveys(monkeypatch)
    early = columns(make_log(36.0, seed=9, start=START - 600.0))
    logs.insert(0, str(write_parquet(tmp_path / "logs/a.parquet", early)))
    monkeypatch.setattr(watch, "code_of", lambda script: f"another {script}")
    assert watched(logs, tmp_path)["logs_read"] == 5
    assert found == [logs[1]], "a log that sorts first is not the first that was read"
    assert watched(logs, tmp_path)["logs_read"] == 0
    assert len(found) == 1


def test_windows_of_logs_that_are_gone_keep_their_survey(logs, tmp_path, monkeypatch):
    watched(logs, tmp_path)
    found = surveys(monkeypatch)
    monkeypatch.setattr(watch, "code_of", lambda script: f"another {script}")
    for there, read in ((logs[1:], 3), (logs[:3], 1)):
        row = watched(there, tmp_path)
        assert (row["result"], row["logs_read"], row["kept_logs"], found) == ("judged", read, 1, [])
    assert watched(logs, tmp_path)["logs_read"] == 4, "all are read with the new survey once all are back"
    assert found == [logs[0]]


def test_an_upgrade_that_is_stopped_reads_the_other_logs_at_the_next_call(logs, tmp_path, monkeypatch):
    watched(logs, tmp_path)
    go_on = stopped_at(3, monkeypatch)
    monkeypatch.setattr(watch, "code_of", lambda script: f"another {script}")
    with pytest.raises(KeyboardInterrupt):
        watched(logs, tmp_path)
    go_on()
    assert watched(logs[:3], tmp_path)["logs_read"] == 1
    assert watched(logs, tmp_path)["logs_read"] == 1, "a log that was away is read once it is back"
    assert watched(logs, tmp_path)["logs_read"] == 0


@pytest.mark.long
def test_an_edit_that_is_refused_and_undone_leaves_all_as_it_was(logs, tmp_path):
    watched(logs, tmp_path)
    own = tmp_path / "robots/arm"
    (own / "baseline.nc").write_bytes(b"kept for months")
    names = ["baseline.nc", "survey.json", "read.json", *(f"windows/{p.name}" for p in (own / "windows").iterdir())]
    before = {name: (own / name).read_bytes() for name in names}
    edited = watched(logs, tmp_path, entry=ENTRY | {"units": {"torque": "mN m"}})
    assert (edited["result"], "units" in edited["reason"]) == ("refused", True)
    assert {name: (own / name).read_bytes() for name in names} == before
    assert watched(logs, tmp_path)["logs_read"] == 0
    assert not (own / reading.ANEW).exists()


@pytest.mark.long
@pytest.mark.parametrize("undone", [True, False])
def test_an_edit_that_is_stopped_is_undone_or_goes_on(logs, tmp_path, monkeypatch, undone):
    edited = ENTRY | {"window": "6s"}
    watched(logs, tmp_path)
    watched(logs, tmp_path / "alone", entry=edited)
    own = tmp_path / "robots/arm"
    before = kept_files(own)
    go_on = stopped_at(3, monkeypatch)
    with pytest.raises(KeyboardInterrupt):
        watched(logs, tmp_path, entry=edited)
    go_on()
    assert {name: content for name, content in kept_files(own).items() if name in before} == before
    found = watched(logs, tmp_path, entry=ENTRY if undone else edited)
    assert (found["result"], found["logs_read"]) == ("judged", 0 if undone else 2)
    assert not (own / reading.ANEW).exists()
    if not undone:
        assert (own / "survey.json").read_bytes() == (tmp_path / "alone/robots/arm/survey.json").read_bytes()
        assert found["windows"] == 24


def test_an_edit_that_is_stopped_as_it_takes_its_place_is_read_again(logs, tmp_path, monkeypatch):
    watched(logs, tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(reading.shutil, "move", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            watched(logs, tmp_path, entry=ENTRY | {"window": "6s"})
    assert watched(logs, tmp_path)["windows"] == 12


@pytest.mark.long
def test_another_model_reads_logs_that_moved_again(logs, tmp_path):
    robot, entry = own_robot(tmp_path)
    watched(logs, tmp_path, entry=entry)
    (tmp_path / "logs/moved").mkdir()
    logs = [shutil.move(log, tmp_path / "logs/moved") for log in logs]
    assert watched([str(log) for log in logs], tmp_path, entry=entry)["copied_logs"] == 4
    robot.write_text(robot.read_text().replace("torque_limit: null", "torque_limit: 1000"))
    robot.write_text(robot.read_text().replace("viscous: ", "viscous: 0"))
    assert watched([str(log) for log in logs], tmp_path, entry=entry | {"window": "6s"})["logs"] == 4


@pytest.mark.parametrize("file", ["survey.json", "read.json"])
def test_what_is_kept_is_not_forgotten_because_a_file_beside_it_broke(logs, tmp_path, file):
    whole = watched(logs, tmp_path)
    (tmp_path / "robots/arm" / file).write_text("{")
    found = watched(logs[2:], tmp_path)
    assert (found["result"], "cannot be read any more" in found["reason"]) == ("refused", True)
    assert watched(logs, tmp_path)["windows"] == whole["windows"]


def test_a_folder_that_was_never_reached_is_a_refusal_with_its_reason(tmp_path):
    found = watched([], tmp_path, unreachable="config: there is no folder logs")
    assert (found["result"], found["reason"]) == ("refused", "config: there is no folder logs")


def test_many_small_files_become_one(logs, tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "SAVE_EVERY", 1)
    monkeypatch.setattr(reading, "MOST_FILES", 2)
    whole = watched(logs, tmp_path)
    assert len(list((tmp_path / "robots/arm/windows").glob("*.nc"))) == 1
    logs.append(day(tmp_path / "logs", 4))
    assert watched(logs, tmp_path)["windows"] == whole["windows"] + 3


def test_a_log_that_cannot_be_read_is_counted_and_stops_nothing(logs, tmp_path):
    logs.append(str(write_csv(tmp_path / "logs/bad.csv", {"time": [0.0], "what": [1.0]})))
    logs.insert(0, str(tmp_path / "logs/a_broken.parquet"))
    (tmp_path / "logs/a_broken.parquet").write_bytes(b"PAR1")
    found = watched(logs, tmp_path)
    assert (found["result"], found["logs"], found["refused_logs"]) == ("judged", 6, 2)
    assert any("bad.csv" in told for told in found["refusals"])


@pytest.mark.long
def test_a_first_log_that_is_refused_is_not_read_as_a_later_one(logs, tmp_path, monkeypatch):
    table = columns(make_log(36.0, seed=7, start=START - 60.0))
    first = tmp_path / "logs/a.parquet"
    write_parquet(first, table | {f"torque_{j}": 1e3 * table[f"torque_{j}"] for j in range(1, 7)})
    for _ in range(2):
        found = watched([str(first), *logs], tmp_path)
        assert (found["result"], found["logs"], found["refused_logs"], found["windows"]) == ("judged", 5, 1, 12)
        assert found["refusals"][0].count("state units: {torque: mN m}") == 1
        monkeypatch.setattr(watch, "code_of", lambda script: f"another {script}")
    write_parquet(first, table)
    mended = watched([str(first), *logs], tmp_path)
    assert (mended["logs_read"], mended["refused_logs"], mended["windows"]) == (1, 0, 15)


def test_copies_of_logs_count_once_and_are_told_apart_from_refused_ones(logs, tmp_path, monkeypatch):
    monkeypatch.setattr(watch, "write_page", write_page)
    plain = watched(logs, tmp_path)
    copies = [shutil.copy(log, Path(log).with_name(f"copy_{Path(log).name}")) for log in logs]
    found = watched([*logs, *map(str, copies)], tmp_path, page=True)
    assert (found["logs"], found["copied_logs"], found["refused_logs"]) == (8, 4, 0)
    assert found["windows"] == plain["windows"]
    assert "4 logs with the same samples as another" in (tmp_path / "robots/arm/monitor.html").read_text()


def test_robots_of_one_name_and_different_logs_do_not_mix(logs, tmp_path):
    ours = watched(logs, tmp_path)
    theirs = watched(logs[:3], tmp_path, entry=ENTRY | {"logs": ["elsewhere/*"]})
    assert ours["folder"] == "arm"
    assert theirs["folder"].startswith("arm_")
    assert watched(logs, tmp_path)["logs_read"] == 0


def test_other_patterns_for_the_same_logs_go_on(logs, tmp_path):
    watched(logs, tmp_path, configuration="a")
    Path(logs[0]).unlink()
    found = watched(logs[1:], tmp_path, entry=ENTRY | {"logs": ["logs/*.parquet"]}, configuration="a")
    assert (found["folder"], found["logs_read"], found["kept_logs"], found["windows"]) == ("arm", 0, 1, 12)
    fewer = watched(logs[2:], tmp_path, entry=ENTRY | {"logs": ["logs/day_0[23]*"]}, configuration="a")
    assert (fewer["folder"], fewer["logs"], fewer["kept_logs"]) == ("arm", 3, 1), "one is left out, one is gone"


@pytest.mark.long
def test_another_configuration_with_some_of_the_logs_has_its_own_history_and_says_so(logs, tmp_path):
    watched(logs, tmp_path, configuration="a")
    other = {"entry": ENTRY | {"logs": ["logs/day_0[123]*"]}, "configuration": "b"}
    for read in (3, 0):
        theirs = watched(logs[1:], tmp_path, **other)
        assert (theirs["folder"] != "arm", theirs["logs_read"]) == (True, read)
        assert any("learnt what is normal anew" in found["words"] for found in theirs["findings"])
    ours = watched(logs, tmp_path, configuration="a")
    assert (ours["folder"], ours["logs_read"], ours["logs"]) == ("arm", 0, 4)
    assert not any("learnt what is normal anew" in found["words"] for found in ours["findings"])


def test_a_robot_that_breaks_does_not_stop_the_others(logs, tmp_path, monkeypatch, capsys):
    judge = watch.judge_pieces

    def broken(pieces, robot, entry, state, alarms, name, **how):
        if name == "two":
            raise KeyError("nobody thought of this")
        judge(pieces, robot, entry, state, alarms, name, **how)

    monkeypatch.setattr(watch, "judge_pieces", broken)
    entries = dict.fromkeys(("one", "two", "three"), ENTRY)
    watch_robots(entries, dict.fromkeys(entries, logs), tmp_path / "robots", tmp_path / "b.json", robots=1000)
    rows = {row["robot"]: row for row in json.loads((tmp_path / "b.json").read_text())["robots"]}
    assert [rows[name]["result"] for name in entries] == ["judged", "refused", "judged"]
    assert "nobody thought of this" in rows["two"]["reason"]
    assert "Traceback" in capsys.readouterr().err
    assert not (tmp_path / "robots/two/alarms.csv").exists()


def test_what_a_batch_has_seen_changes_with_its_logs_alone(logs, tmp_path):
    before = seen(logs)
    assert seen(logs) == before
    os.utime(logs[0], ns=(1, 1))
    assert seen(logs) != before
    assert seen(logs, "lost") != seen(logs)
    assert seen([*logs, str(tmp_path / "nowhere.nc")]) != seen(logs)
