"""The tiny reproduction on a real Slurm: same numbers, job ids, one job killed and the node drained in the middle.

`make test-slurm` runs this; it needs Debian's slurm-wlm and munge and says so if they are missing.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import yaml
from cluster import APT, Cluster, cluster, missing, wait_for
from scratch_project import Project, copy_project

from jointwear.files.storage import open_dataset

pytestmark = pytest.mark.slurm
# Asks often, because the cluster is small and near; a real one is asked at the executor's own pace.
OPTIONS = (
    "--profile",
    "workflow/profiles/slurm",
    "--slurm-status-command",
    "squeue",
    "--slurm-init-seconds-before-status-checks",
    "1",
    "--slurm-keep-successful-logs",
    "--seconds-between-status-checks",
    "1",
    "--latency-wait",
    "30",
)


@dataclass(frozen=True)
class Done:
    """What is known after a run on the cluster that was disturbed twice."""

    project: Project
    output: str
    jobs: list[dict[str, str]]
    killed: str
    state_while_drained: str
    waiting_while_drained: list[str]
    pids: list[int]


def disturb(slurm: Cluster, process: subprocess.Popen) -> tuple[str, str, list[str]]:
    """Kill the first job that runs; when the next one runs, drain the node until nothing runs, then give it back."""

    def running() -> list[str]:
        assert process.poll() is None, "the run ended before it was disturbed"
        return [job for job, state in slurm.jobs().items() if state == "RUNNING"]

    (killed, *_) = wait_for(running, 120, "a first job")
    slurm.call("scancel", killed)
    wait_for(lambda: [job for job in running() if job != killed], 120, "a job after the killed one")
    slurm.call("scontrol", "update", f"NodeName={slurm.node}", "State=DRAIN", "Reason=test")
    wait_for(lambda: not running() and "PENDING" in slurm.jobs().values(), 240, "only waiting jobs")
    state = slurm.call("sinfo", "--noheader", "--format=%T").strip()
    waiting = [job for job, now in slurm.jobs().items() if now == "PENDING"]
    slurm.call("scontrol", "update", f"NodeName={slurm.node}", "State=RESUME")
    return killed, state, waiting


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    if gone := missing():
        pytest.fail(f"{', '.join(gone)} not found; on Debian: {APT}")
    project = copy_project(tmp_path_factory.mktemp("project"))
    log = project.folder / "slurm_run.txt"
    # A short path: that of munge's socket is limited to a hundred characters.
    with (
        tempfile.TemporaryDirectory(prefix="slurm-") as folder,
        cluster(Path(folder), cpus=os.cpu_count() or 1) as slurm,
    ):
        with log.open("w") as file:
            process = subprocess.Popen(
                [sys.executable, "-m", "snakemake", *OPTIONS],
                cwd=project.folder,
                env=slurm.environment,
                stdout=file,
                stderr=subprocess.STDOUT,
            )
        try:
            killed, state, waiting = disturb(slurm, process)
            code = process.wait(900)
        finally:
            if process.poll() is None:
                process.terminate()
                process.wait(60)
        output, jobs, pids = log.read_text(), slurm.finished(), slurm.pids
    assert code == 0, output[-6000:]
    return Done(project, output, jobs, killed, state, waiting, pids)


@pytest.fixture(scope="module")
def local(tmp_path_factory):
    project = copy_project(tmp_path_factory.mktemp("local"))
    project.snakemake("--cores", "2")
    return project


def test_every_result_equals_the_local_one_number_for_number(done, local):
    files = sorted(p.relative_to(local.folder) for p in (local.folder / "results").rglob("*.nc"))
    assert len(files) > 20
    assert files == sorted(p.relative_to(done.project.folder) for p in (done.project.folder / "results").rglob("*.nc"))
    for path in files:
        with open_dataset(local.folder / path) as ours, open_dataset(done.project.folder / path) as theirs:
            assert ours.variables.keys() == theirs.variables.keys()
            for name in ours.variables:
                np.testing.assert_array_equal(ours[name][...], theirs[name][...], err_msg=f"{path}: {name}")
    for path in sorted((local.folder / "results/tables").glob("*.csv")):
        assert path.read_bytes() == (done.project.folder / path.relative_to(local.folder)).read_bytes()


def test_job_ids_prove_who_ran_them(done):
    submitted = set(re.findall(r"SLURM jobid '?(\d+)'?", done.output))
    ended = {job["JobId"]: job["JobState"] for job in done.jobs}
    assert len(submitted) >= 10
    assert submitted == ended.keys()
    assert {state for job, state in ended.items() if job != done.killed} == {"COMPLETED"}


def test_few_submissions_carry_many_jobs(done):
    # Counted anew: the logger of the default profile does not say how many there were.
    jobs = done.project.planned("--forceall")
    profile = yaml.safe_load((done.project.folder / "workflow/profiles/slurm/config.yaml").read_text())
    held = Counter()
    for rule, count in jobs.items():
        held[profile["groups"].get(rule, f"{rule} alone")] += count
    expected = sum(math.ceil(count / profile["group-components"].get(group, 1)) for group, count in held.items())
    # The job that was killed was submitted twice.
    assert len(done.jobs) - 1 <= min(expected, 0.7 * sum(jobs.values()))


def test_a_killed_job_was_submitted_again(done):
    assert {job["JobId"]: job["JobState"] for job in done.jobs}[done.killed] == "CANCELLED"
    assert "Trying to restart" in done.output


def test_jobs_waited_while_the_node_was_drained(done):
    assert done.state_while_drained == "drained"
    ended = {job["JobId"]: job["JobState"] for job in done.jobs}
    assert done.waiting_while_drained
    assert {ended[job] for job in done.waiting_while_drained} == {"COMPLETED"}


def test_the_daemons_are_gone(done):
    assert len(done.pids) == 3
    assert not [pid for pid in done.pids if Path(f"/proc/{pid}").exists()]
