"""The workflow from a folder of the user's own, from a read-only checkout, and as a module of another workflow."""

import csv
import os
import stat

import pytest
from scratch_project import ROOT, Project, copy_project

MODULE = """
module jointwear:
    snakefile: "{snakefile}"
    config: config

use rule * from jointwear as jointwear_*

rule all:
    default_target: True
    input: rules.jointwear_all.input
"""


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """A checkout that nobody may write to."""
    project = copy_project(tmp_path_factory.mktemp("clone"))
    for folder, _, files in os.walk(project.folder):
        for name in (folder, *(os.path.join(folder, file) for file in files)):
            if not os.path.islink(name):
                os.chmod(name, os.stat(name).st_mode & ~(stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH))
    yield project
    for folder, _, _ in os.walk(project.folder):
        os.chmod(folder, 0o755)


def test_an_own_folder_needs_nothing_but_its_own_values(clone, tmp_path):
    (tmp_path / "my.yaml").write_text("replicates: 5\n")
    jobs = Project(tmp_path).planned("--snakefile", str(clone.folder / "Snakefile"), "--configfile", "my.yaml")
    assert jobs["simulate_wear"] == 2
    assert jobs["build_report"] == 1
    assert [p.name for p in tmp_path.iterdir() if not p.name.startswith(".")] == ["my.yaml"]


def test_a_call_from_within_another_checkout_takes_its_own_library(clone, tmp_path_factory):
    """The profile of the folder that is called from had brought its library along."""
    other = copy_project(tmp_path_factory.mktemp("other"))
    (other.folder / "workflow/jointwear/running/closing.py").write_text("raise RuntimeError('of the other checkout')\n")
    done = other.snakemake("-n", "--snakefile", str(clone.folder / "Snakefile"), ok=False)
    assert "of the other checkout" not in done.stdout + done.stderr
    assert done.returncode == 0, done.stderr


@pytest.mark.long
def test_own_files_hide_the_shipped_ones(clone, tmp_path):
    (tmp_path / "config/tasks").mkdir(parents=True)
    text = (ROOT / "config/tasks/T1.yaml").read_text().replace("name: T1", "name: mine")
    (tmp_path / "config/tasks/mine.yaml").write_text(text)
    (tmp_path / "config/config.yaml").write_text("tasks: [mine]\n")
    project = Project(tmp_path)
    jobs = project.planned("--snakefile", str(clone.folder / "Snakefile"))
    assert jobs["simulate_wear"] == 2
    listed = project.snakemake(
        "--workflow-profile", "none", "-n", "--snakefile", str(clone.folder / "Snakefile")
    ).stdout
    assert "config/tasks/mine.yaml" in listed
    assert str(clone.folder / "config/tasks/mine.yaml") not in listed


def test_a_misspelt_robot_is_named_as_the_user_wrote_it(clone, tmp_path):
    (tmp_path / "my.yaml").write_text("robot: config/robots/puma56.yaml\n")
    done = Project(tmp_path).snakemake(
        "-n", "--snakefile", str(clone.folder / "Snakefile"), "--configfile", "my.yaml", ok=False
    )
    assert done.returncode != 0
    assert "config/robots/puma56.yaml: no such file; did you mean 'puma560.yaml'?" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_robot_file_may_leave_out_effects(clone, tmp_path):
    robot = (ROOT / "config/robots/puma560.yaml").read_text()
    assert "effects: []\n" in robot
    (tmp_path / "arm.yaml").write_text(robot.replace("effects: []\n", ""))
    (tmp_path / "my.yaml").write_text("robot: arm.yaml\n")
    jobs = Project(tmp_path).planned("--snakefile", str(clone.folder / "Snakefile"), "--configfile", "my.yaml")
    assert jobs["simulate_wear"] == 2


def test_another_workflow_takes_it_as_a_module(clone, tmp_path):
    (tmp_path / "Snakefile").write_text(MODULE.format(snakefile=clone.folder / "Snakefile"))
    jobs = Project(tmp_path).planned("--config", "replicates=4")
    assert jobs["jointwear_simulate_wear"] == 2
    assert jobs["jointwear_build_report"] == 1


def test_a_read_only_checkout_runs_a_job(clone, tmp_path):
    done = Project(tmp_path).snakemake(
        "--cores", "1", "--snakefile", str(clone.folder / "Snakefile"), "results/trajectories/T1.nc"
    )
    assert (tmp_path / "results/trajectories/T1.nc").is_file(), done.stderr
    assert not (clone.folder / "results").exists()


@pytest.mark.long
@pytest.mark.parametrize(
    "target",
    [
        "write_crate",
        "adopt_recovered",
        "results/challenge/report/kept.txt",
        "results/challenge/world/report/kept.txt",
    ],
)
def test_what_works_on_the_checkout_is_refused_elsewhere_before_any_job(clone, tmp_path, target):
    done = Project(tmp_path).plan("--snakefile", str(clone.folder / "Snakefile"), target, ok=False)
    assert done.returncode != 0
    told = [line for line in (done.stdout + done.stderr).splitlines() if line.startswith("jointwear: ")]
    assert len(told) == 1
    assert f"the checkout; run it in {clone.folder}" in told[0] or f"results; run it in {clone.folder}" in told[0]
    assert "Traceback" not in done.stdout + done.stderr
    assert not (tmp_path / "results").exists()


@pytest.mark.long
def test_the_tables_are_what_they_were(built):
    """The rooms of the library moved no number of the reproduction."""
    for path in sorted((ROOT / "tests/data/before").glob("*.csv")):
        with path.open() as before, (built.folder / "results/tables" / path.name).open() as now:
            assert list(csv.reader(now)) == list(csv.reader(before)), path.name
