"""The workflow as a user meets it: jobs, reruns, errors, resuming; on a tiny experiment."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from scratch_project import LONGEST, TINY, copy_project, merged
from warm_snakemake import warm_snakemake

from jointwear.files.storage import open_dataset


def numbers(path):
    with open_dataset(path) as data:
        return {name: np.array(data[name][...]) for name in data.variables}


def same_numbers(a, b):
    ours, theirs = numbers(a), numbers(b)
    assert ours.keys() == theirs.keys()
    for name, values in ours.items():
        if values.dtype.kind == "f":
            assert np.array_equal(values, theirs[name], equal_nan=True), name
        else:
            assert (values == theirs[name]).all(), name


def results(project):
    return sorted(p.relative_to(project.folder) for p in (project.folder / "results").rglob("*.nc"))


def test_one_job_for_every_cell(tmp_path):
    project = copy_project(tmp_path)
    jobs = project.planned()
    cells = len(TINY["wear"]["axes"])
    assert jobs["simulate_wear"] == cells
    assert jobs["compute_features"] == cells + 2
    assert jobs["diagnose_run"] == cells + 1
    assert jobs["simulate_training"] == jobs["simulate_normal"] == jobs["fit_normal_model"] == 1


def test_a_second_run_does_nothing(built):
    assert built.planned() == {}


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"tasks": ["T1", "T2"]}, {"simulate_wear": 2, "simulate_training": 1, "fit_normal_model": 1}),
        ({"wear": {"axes": [1, 2, 3]}}, {"simulate_wear": 1, "compute_features": 1}),
        ({"wear": {"increase_percent": [20, 5]}}, {"simulate_wear": 2, "compute_features": 2}),
    ],
)
def test_a_larger_grid_computes_only_its_new_cells(project, change, expected):
    project.write_config(merged(project.config(), change))
    jobs = project.planned()
    for rule, count in expected.items():
        assert jobs[rule] == count, rule
    if "tasks" not in change:
        assert "simulate_training" not in jobs
        assert "fit_normal_model" not in jobs


@pytest.mark.long
def test_cores_order_and_grid_do_not_change_a_number(built, tmp_path):
    other = copy_project(tmp_path)
    other.write_config(merged(other.config(), {"tasks": ["T2", "T1"], "wear": {"axes": [3]}}))
    other.snakemake("--cores", "1")
    shared = [p for p in results(other) if "T1" in p.parts]
    assert len(shared) > 8
    for path in shared:
        same_numbers(built.folder / path, other.folder / path)


def test_files_open_with_xarray_and_say_where_they_come_from(built):
    import xarray

    for path in results(built):
        with xarray.open_dataset(built.folder / path) as data:
            assert data.attrs["workflow_version"], path
            assert len(data.attrs["config_digest"]) == 64, path
            for variable in data.variables.values():
                assert variable.attrs.get("long_name"), path


def bad_config(project, change):
    before = {p: (project.folder / p).stat().st_mtime_ns for p in results(project)}
    project.write_config(merged(project.config(), change))
    done = project.snakemake("--cores", "2", ok=False)
    assert done.returncode == 1
    assert {p: (project.folder / p).stat().st_mtime_ns for p in results(project)} == before
    lines = [line for line in (done.stdout + done.stderr).splitlines() if line.startswith("jointwear:")]
    assert len(lines) == 1
    assert "Traceback" not in done.stdout + done.stderr
    return lines[0]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"replicate": 3}, "did you mean 'replicates'"),
        ({"wear": {"axes": [1, 7]}}, "nearest valid value is 6"),
        ({"reading": {"onset_rule": "never"}}, "allowed: consecutive_hours"),
        ({"tasks": ["T1", "T1"]}, "'T1' twice"),
    ],
)
def test_a_wrong_config_stops_before_any_job(project, change, words):
    assert words in bad_config(project, change)


def test_a_key_given_twice_stops_before_any_job(project):
    text = project.config_file.read_text()
    project.config_file.write_text(text + "\nseed: 3\n")
    done = project.snakemake("--cores", "2", ok=False)
    assert done.returncode == 1
    assert "'seed' is given twice" in done.stdout + done.stderr


def test_a_waypoint_beyond_a_limit_stops_before_any_job(project):
    task = project.folder / "config/tasks/T1.yaml"
    text = task.read_text()
    first = text.split("waypoints:")[1].split("[", 1)[1].split(",")[0]
    task.write_text(text.replace(f"[{first},", "[1700.0,", 1))
    done = project.snakemake("--cores", "2", ok=False)
    assert done.returncode == 1
    assert "'waypoints[0][0]' is 1700 deg" in done.stdout + done.stderr


@pytest.mark.long
def test_a_truncated_file_is_named_and_not_a_traceback(project):
    broken = project.folder / "results/features/T1/training.nc"
    broken.write_bytes(broken.read_bytes()[:2000])
    done = project.snakemake("--cores", "2", ok=False)
    assert done.returncode == 1
    output = done.stdout + done.stderr
    assert "results/features/T1/training.nc: is truncated or not a netCDF file" in output
    assert "Traceback" not in output


@pytest.mark.long
def test_a_killed_run_resumes_with_the_same_numbers(built, tmp_path):
    project = copy_project(tmp_path)
    process = subprocess.Popen(
        [sys.executable, "-m", "snakemake"], cwd=project.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    simulation = project.folder / "results/simulation/T1"
    end = time.monotonic() + 60
    while time.monotonic() < end and not list(simulation.glob("*.nc")):
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert (project.folder / ".snakemake/locks").exists()
    done = project.snakemake()
    assert "earlier run was killed" in done.stderr
    for path in results(built):
        same_numbers(built.folder / path, project.folder / path)


def test_an_edited_reading_reruns_its_stage_and_what_follows(project):
    path = project.folder / "workflow/jointwear/reproduction/readings/onset_rule.py"
    path.write_text(path.read_text() + "\n# edited\n")
    jobs = project.planned()
    assert jobs["diagnose_run"] == 3
    for rule in ("simulate_wear", "compute_features", "build_reference"):
        assert rule not in jobs


@pytest.mark.long
@pytest.mark.parametrize(
    ("module", "reruns", "stays"),
    [
        ("reproduction/wear", {"simulate_wear"}, {"fit_normal_model"}),
        (
            "reproduction/location",
            {"diagnose_run", "tabulate_results"},
            {"simulate_wear", "compute_features", "fit_normal_model"},
        ),
        ("reproduction/detection", {"diagnose_run", "fit_normal_model"}, {"simulate_wear", "compute_features"}),
        ("reproduction/control_limits", {"fit_normal_model", "diagnose_run"}, {"compute_features"}),
        ("reproduction/verdicts", {"tabulate_results"}, {"diagnose_run"}),
        ("robots/trajectory", {"simulate_wear", "simulate_normal", "compute_trajectory"}, set()),
    ],
)
def test_an_edited_module_reruns_what_imports_it(project, module, reruns, stays):
    known = set(project.snakemake("--workflow-profile", "none", "--list-rules").stdout.split())
    assert reruns | stays <= known, "a rule of this table does not exist, so the table asserts nothing"
    path = project.folder / f"workflow/jointwear/{module}.py"
    path.write_text(path.read_text() + "\n# edited\n")
    jobs = project.planned()
    assert reruns <= jobs.keys()
    assert not stays & jobs.keys()


def test_a_new_effect_leaves_the_reproduction_alone(project):
    entries = project.folder / "workflow/jointwear/effects/entries"
    text = (entries / "torque_constant_error.py").read_text()
    (entries / "another_gain.py").write_text(text.replace('"torque_constant_error"', '"another_gain"'))
    assert not {"simulate_training", "simulate_normal", "simulate_wear", "compute_features"} & project.planned().keys()


@pytest.mark.long
def test_an_edited_effect_reruns_a_robot_that_has_it(project):
    config = project.config()
    robot = (project.folder / config["robot"]).read_text()
    entry = "effects: [{effect: torque_constant_error, axis: 1, parameters: {share: 0.05}}]"
    assert "effects: []" in robot
    (project.folder / "config/robots/geared.yaml").write_text(robot.replace("effects: []", entry))
    project.write_config({**config, "robot": "config/robots/geared.yaml"})
    project.snakemake("--cores", "2", "results/simulation/T1/normal.nc")
    path = project.folder / "workflow/jointwear/effects/entries/torque_constant_error.py"
    path.write_text(path.read_text() + "\n# edited\n")
    assert project.planned("results/simulation/T1/normal.nc") == {"simulate_normal": 1}


@pytest.mark.parametrize("asked", ["--unlock", "--dag", "--summary", "--list-rules"])
@pytest.mark.parametrize("target", ["results/trajectories/T1.nc", "verify"])
def test_no_cores_are_needed_where_no_job_runs_on_this_machine(built, asked, target):
    """As of every call to a cluster that passes over the default profile."""
    done = warm_snakemake(["--workflow-profile", "none", target, asked], built.folder, LONGEST)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "WorkflowError" not in done.stdout + done.stderr
