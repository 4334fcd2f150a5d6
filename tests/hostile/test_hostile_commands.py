"""A share of the hostile inputs through the real command: one line, no traceback, and nothing left behind."""

import os
import subprocess
import sys

import pytest
import yaml
from scratch_project import ROOT

from jointwear.running.project import copy_project

pytestmark = pytest.mark.hostile
#: Seconds for one call: Snakemake itself takes one or two.
LIMIT = 60


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    folder = tmp_path_factory.mktemp("project")
    copy_project(ROOT, folder)
    return folder


def run(project, *arguments):
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--dry-run", *arguments]
    return subprocess.run(command, cwd=project, capture_output=True, text=True, timeout=LIMIT, check=False)


def last_line(done):
    said = done.stdout + done.stderr
    assert "Traceback" not in said, said[-2000:]
    return [line for line in said.splitlines() if line.strip()][-1]


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("noise={encoder: .inf}", "noise.encoder"),
        ("seed=1e400", "'seed' is inf"),
        ("wear={shape: 1e308}", "'wear.shape'"),
        ("detection={confidence: nan}", "detection.confidence"),
        ("robot=/dev/zero", "is a device"),
        ("robot=.", "is a folder"),
        ("tasks=[../T1]", "'tasks[0]'"),
        ("discover={datasets: {x: null}}", "'discover.datasets.x'"),
        ("discover={datasets: {x: {measured: /dev/null, robot: config/robots/puma560.yaml}}}", "is a device"),
        ("monitor={robots: {x: null}}", "'monitor.robots.x'"),
        ("monitor={robots: {x: {logs: ['/dev/zero'], robot: a, baseline: {windows: 9}}}}", "monitor.robots.x"),
    ],
)
def test_a_hostile_value_on_the_command_line(project, value, words):
    before = sorted(os.listdir(project))
    done = run(project, "--config", value)
    assert done.returncode == 1
    line = last_line(done)
    assert line.startswith("jointwear: ")
    assert words in line
    assert sorted(set(os.listdir(project)) - {".snakemake"}) == sorted(set(before) - {".snakemake"})


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("noise: {encoder: .nan}\n", "'noise.encoder' is nan"),
        ("seed: 1" + "0" * 400 + "\n", "'seed' is 1000"),
        ("a: &a [1,1,1,1,1,1,1,1,1]\n" + "".join(
            f"a{i}: &a{i} [{', '.join([f'*a{i - 1}' if i else '*a'] * 9)}]\n" for i in range(9)), "200000 values"),
        ("a: &a {x: 1, y: 1, z: 1, v: 1, w: 1}\n" + "".join(
            f"a{i}: &a{i} {{{', '.join(f'{k}: *a{i - 1 if i else str()}' for k in 'xyzvw')}}}\n" for i in range(12)),
         "200000 values"),
        ("wear: &w {shape: *w}\n", "an anchor holds itself"),
        ("seed: " + "9" * 5000 + "\n", "not valid YAML"),
        ("__use_yte__: true\nseed: ?__import__('os').system('touch executed')\n", "runs code"),
        ("wear: {shape: 2}\nwear: {shape: 3}\n", "given twice"),
    ],
)  # fmt: skip
def test_a_hostile_file_beside_the_command(project, tmp_path, text, words):
    (tmp_path / "mine.yaml").write_text(text)
    done = run(project, "--configfile", str(tmp_path / "mine.yaml"))
    assert done.returncode == 1
    assert words in last_line(done)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--configfile", "mine.yaml"], "runs code"),
        (["--configfile", "mine.yaml", "--directory", "elsewhere"], "runs code"),
        (["--config", "seed=1_0"], "digits 0 to 9"),
        (["--config", "seed=\u0667"], "digits 0 to 9"),
    ],
)
def test_without_the_default_profile_the_snakefile_refuses(project, arguments, words):
    (project / "mine.yaml").write_text("__use_yte__: true\nseed: 7\n")
    done = run(project, "--workflow-profile", "none", *arguments)
    assert done.returncode == 1
    assert words in last_line(done)


def test_the_configuration_of_the_folder_is_read_by_this_workflow_alone(project, tmp_path):
    """Snakemake would evaluate templates; here they are a key that is not known."""
    path = project / "config/config.yaml"
    kept = path.read_text()
    bomb = {"?import os; os.system('touch executed')": 1, "__use_yte__": True}
    path.write_text(kept + yaml.safe_dump(bomb))
    try:
        done = run(project)
    finally:
        path.write_text(kept)
    assert done.returncode == 1
    assert "unknown key" in last_line(done)
    assert not list(project.glob("**/executed"))


@pytest.mark.parametrize(
    ("text", "words"),
    [("", "config.yaml: is empty"), ("seed: 7\nwear:\n\tshape: 1\n", "config.yaml: line 3: begins with")],
)
@pytest.mark.parametrize("profile", [(), ("--workflow-profile", "none")])
def test_a_slip_in_the_configuration_of_the_folder_is_told_with_its_file(project, profile, text, words):
    """Of a file that is given as --configfile Snakemake says it before this workflow is asked, without a name."""
    path = project / "config/config.yaml"
    kept = path.read_text()
    path.write_text(text)
    try:
        done = run(project, *profile)
    finally:
        path.write_text(kept)
    assert done.returncode == 1
    assert words in last_line(done)


def test_a_pipe_for_a_robot_does_not_hang(project):
    os.mkfifo(project / "pipe.yaml")
    (project / "mine.yaml").write_text("name: mine\nurdf: pipe.yaml\n")
    for name in ("pipe.yaml", "mine.yaml"):
        done = run(project, "--config", f"robot={name}")
        assert done.returncode == 1
        assert "is a named pipe" in last_line(done)
    done = run(project, "--configfile", "pipe.yaml")
    assert "is a named pipe" in last_line(done)
