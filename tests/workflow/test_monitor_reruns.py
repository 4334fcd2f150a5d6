"""New logs cost their own windows alone; what does not concern reading costs no window at all."""

import shutil

import pytest
from monitor_logs import columns, make_log, write_bag, write_parquet
from scratch_project import Project, copy_project

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json
from jointwear.monitor.batches import batches_of, log_key
from jointwear.monitor.found_logs import find_all_logs, find_logs
from jointwear.monitor.order_of_logs import in_order
from jointwear.monitor.robot_entries import check_robots
from jointwear.running.configuration import prepare

ENTRY = {
    "logs": ["logs/*.parquet", "logs/bag_*"],
    "robot": "config/robots/puma560.yaml",
    "window": "12s",
    "baseline": {"windows": 8},
    "files_per_job": 1,
}


def monitored(project: Project, **change) -> None:
    config = project.config()
    config["monitor"] = {"robots": {"arm": ENTRY | change}}
    project.write_config(config)


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Project:
    """A project whose two logs have been turned into windows."""
    project = copy_project(tmp_path_factory.mktemp("monitored"))
    logs = project.folder / "logs"
    logs.mkdir()
    write_parquet(logs / "day_1.parquet", columns(make_log(24.0, seed=1)))
    write_bag(logs / "bag_1", make_log(24.0, seed=2))
    monitored(project)
    project.snakemake("--cores", "2", *windows(project))
    return project


def windows(project: Project) -> list[str]:
    names = ("bag_1", "day_1.parquet", "day_2.parquet")
    there = [f"logs/{n}" for n in names if (project.folder / "logs" / n).exists()]
    return [f"results/monitor/arm/windows/{log_key(log)}.nc" for log in there]


def test_a_new_log_costs_its_own_windows(project):
    before = {path: (project.folder / path).stat().st_mtime_ns for path in windows(project)}
    assert "accumulate_windows" not in project.planned("monitor")
    write_parquet(project.folder / "logs/day_2.parquet", columns(make_log(24.0, seed=3)))
    jobs = project.planned("monitor")
    assert jobs["accumulate_windows"] == 1
    assert "survey_logs" not in jobs
    assert jobs["judge_windows"] == jobs["report_monitoring"] == 1
    project.snakemake("--cores", "1", *windows(project))
    assert all((project.folder / path).stat().st_mtime_ns == old for path, old in before.items())
    assert "accumulate_windows" not in project.planned("monitor")


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "jobs"),
    [
        ({"false_alarms_per_1000_h": 2}, 0),
        ({"limits": {"coulomb_increase_percent": 30}}, 0),
        ({"baseline": {"windows": 9}}, 0),
        ({"units": {"torque": "kN m"}}, 2),
        ({"window": "6s"}, 2),
    ],
)
def test_only_what_concerns_reading_reads_again(project, change, jobs):
    logs = len(windows(project))
    monitored(project, **change)
    planned = project.planned("monitor")
    monitored(project)
    assert planned.get("accumulate_windows", 0) == (logs if jobs else 0)
    assert planned["judge_windows"] == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"robot": "config/robots/puma56.yaml"}, "did you mean 'puma560.yaml'"),
        ({"window": "1 fortnight"}, "is no length of time"),
        ({"baseline": {"until": "tomorrow"}}, "ISO 8601"),
        ({"baseline": {"windows": 2}}, "the nearest valid value is 8"),
        ({"joints": ["a", "b"]}, "names 2 joints, robot 'puma560' has 6"),
        ({"widow": "1h"}, "did you mean 'window'"),
        ({"time_zone": "Europe/Berln"}, "arm.time_zone' is 'Europe/Berln'; did you mean 'Europe/Berlin'"),
        ({"robot": "x" * 5000}, "no such file"),
        ({"scale": 1e18}, "the nearest valid value is 1000000"),
        ({"torque_constant": [1e-18] * 6}, "the nearest valid value is 1e-06"),
        ({"torque_constant": [-11.2] * 6}, "without its sign it is 11.2: 'scale' turns a torque"),
        ({"dead_band": 1e3}, "the nearest valid value is 10"),
        ({"limits": {"coulomb_increase": 20}}, "did you mean 'coulomb_increase_percent'"),
    ],
)
def test_a_wrong_entry_is_named(project, monkeypatch, change, words):
    monkeypatch.chdir(project.folder)
    config = project.config() | {"monitor": {"robots": {"arm": ENTRY | change}}}
    with pytest.raises(InputError, match=words) as error:
        check_robots(prepare(config))
    assert "\n" not in str(error.value)


def test_a_wrong_entry_stops_before_any_job(project):
    monitored(project, window="1 fortnight")
    done = project.plan("monitor", ok=False)
    monitored(project)
    assert done.returncode == 1
    assert "is no length of time" in done.stderr
    assert "Traceback" not in done.stderr


def test_keys_of_logs_are_safe_and_different():
    keys = {log_key(path) for path in ("a/x.csv", "b/x.csv", "a/x.nc", "a/../x.csv", "a/<b> {c}.csv")}
    assert len(keys) == 5
    assert all(set(key) <= set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") for key in keys)


@pytest.mark.parametrize("new", ["logs/.csv", "logs/0b.csv", "logs/50b.csv", "logs/99.csv"])
def test_small_logs_share_a_job_and_a_new_one_changes_its_own(new):
    logs = [f"logs/{k}.csv" for k in range(60)]
    groups = batches_of(logs, {"files_per_job": 4})
    assert [log for group in groups.values() for log in group] == logs
    assert 8 <= len(groups) <= 30
    more = batches_of(in_order([*logs, new]), {"files_per_job": 4})
    changed = [key for key, group in more.items() if groups.get(key) != group]
    assert len(changed) <= 2
    assert any(new in more[key] for key in changed)


def test_logs_share_a_job_by_their_size(tmp_path):
    small, large = ([str(tmp_path / f"{kind}_{k}.csv") for k in range(200)] for kind in ("small", "large"))
    for path, size in [*((p, 400_000) for p in small), *((p, 9_000_000) for p in large)]:
        with open(path, "wb") as file:
            file.truncate(size)
    assert 4 <= len(batches_of(small, {})) <= 20
    assert batches_of(large, {}) == {log_key(log): [log] for log in large}
    absent = ["logs/a.csv", "logs/b.csv"]
    assert batches_of(absent, {}) == {log_key(log): [log] for log in absent}
    assert len(batches_of(small, {"files_per_job": 1})) == 200


def test_a_folder_that_cannot_be_reached_concerns_its_robot_alone(project, monkeypatch):
    monkeypatch.chdir(project.folder)
    robots = {"arm": ENTRY, "typo": ENTRY | {"logs": ["logs/*.parqet", "logs/bag_*"]}}
    robots["gone"] = ENTRY | {"logs": ["nowhere/*.csv"]}
    logs, silent = find_all_logs({"monitor": {"robots": robots}})
    assert logs["arm"][:2] == ["logs/bag_1", "logs/day_1.parquet"]
    assert logs["typo"] == ["logs/bag_1"]
    assert logs["gone"] == []
    assert "matches no file" in silent["typo"]
    assert "there is no folder nowhere" in silent["gone"]
    assert "arm" not in silent
    config = project.config()
    config["monitor"] = {"robots": robots}
    project.write_config(config)
    done = project.plan("monitor")
    monitored(project)
    assert "jointwear: config/config.yaml: 'monitor.robots." in done.stderr
    assert "there is no folder nowhere; the other robots go on" in done.stderr


@pytest.mark.long
def test_a_fleet_is_planned_though_a_folder_is_lost(project):
    config = project.config()
    config["monitor"] = {"robots": {"arm": ENTRY, "gone": ENTRY | {"logs": ["nowhere/*.csv"]}}}
    project.write_config(config)
    jobs = project.planned("notify")
    learning = project.planned("learn_normal")
    monitored(project)
    assert jobs == {"watch_fleet": 1, "summarise_fleet": 1, "notify": 1}
    assert learning == {"learn_robot": 1, "learn_normal": 1}


@pytest.mark.long
@pytest.mark.parametrize("target", ["fleet", "notify", "results/fleet/fleet.csv"])
def test_a_fleet_without_a_robot_is_refused_and_keeps_what_there_is(tmp_path, target):
    project = copy_project(tmp_path)
    table = project.folder / "results/fleet/fleet.csv"
    table.parent.mkdir(parents=True)
    table.write_text("of earlier\n")
    done = project.snakemake(target, "--workflow-profile", "none", "--cores", "1", "--quiet", "all", ok=False)
    assert done.returncode == 1
    # Nothing else, so that cron sends a mail only where something is wrong.
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith("jointwear: the configuration names no robot under 'monitor.robots'")
    assert "--configfile" in done.stderr
    assert table.read_text() == "of earlier\n"
    assert [path.name for path in table.parent.iterdir()] == ["fleet.csv"]


@pytest.mark.long
def test_a_robot_whose_folder_is_gone_is_judged_again(project):
    """Also where the folders of all robots are; a further call has nothing to judge."""
    folders = project.folder / "results/fleet/robots"
    project.snakemake("--cores", "1", "fleet")
    assert "watch_fleet" not in project.planned("fleet")
    for gone in (folders / "arm", folders):
        shutil.rmtree(gone)
        for _ in range(2):  # a dry run changes nothing
            assert project.planned("fleet")["watch_fleet"] == 1
        project.snakemake("--cores", "1", "fleet")
        assert (folders / "arm" / "read.json").is_file()
        assert "watch_fleet" not in project.planned("fleet")


@pytest.mark.long
@pytest.mark.parametrize("target", ["monitor", "learn_normal"])
def test_the_example_says_that_no_robot_is_named(tmp_path, target):
    project = copy_project(tmp_path)
    done = project.plan(target)
    told = "the configuration names no robot under 'monitor.robots'; this is the shipped example, puma560_example"
    assert done.stderr.count(told) == 1
    assert told not in project.plan().stderr


def test_the_survey_stays_with_its_log(project):
    """A file that sorts before all others costs its own windows."""
    before = project.folder / "logs/a_first.parquet"
    write_parquet(before, columns(make_log(24.0, seed=4)))
    jobs = project.planned("monitor")
    before.unlink()
    assert jobs["accumulate_windows"] == 1
    assert "survey_logs" not in jobs


def test_a_bag_is_one_log(project, monkeypatch):
    monkeypatch.chdir(project.folder)
    assert find_logs(["logs/bag_*", "logs/**/*.mcap"]) == ["logs/bag_1"]


@pytest.mark.long
def test_a_mistyped_key_does_not_cost_the_survey_of_a_log_that_is_gone(project):
    survey = project.folder / "results/monitor/arm/survey.json"
    before, first = read_json(survey), project.folder / "logs/bag_1"
    assert before["log"] == "logs/bag_1"
    first.rename(project.folder / "kept_elsewhere")
    monitored(project, variables={"position": "q"})
    done = project.snakemake("--cores", "1", "results/monitor/arm/survey.json", ok=False)
    assert done.returncode == 1
    assert not survey.exists()
    monitored(project)
    project.snakemake("--cores", "1", "results/monitor/arm/survey.json")
    assert read_json(survey) == before
    assert "survey_logs" not in project.planned("monitor")
    (project.folder / "kept_elsewhere").rename(first)
