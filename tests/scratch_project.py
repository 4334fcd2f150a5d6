"""A scratch copy of the project with a tiny experiment, and Snakemake run in it as a user would."""

import re
import subprocess
import sys
from pathlib import Path

import yaml
from warm_snakemake import warm_snakemake

from jointwear.running import project as project_files

ROOT = Path(__file__).resolve().parents[1]
TINY = {
    "replicates": 3,
    "tasks": ["T1"],
    "wear": {"axes": [1, 3], "increase_percent": [20], "hours": 24},
    "normal": {"test_hours": 24},
}
#: Seconds after which a run is given up.
LONGEST = 600


def succeeded(done: subprocess.CompletedProcess) -> subprocess.CompletedProcess:
    """Fail the test with the output of `done` if it failed."""
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-5000:]
    return done


class Project:
    """A copy of the project in `folder`."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def snakemake(self, *arguments: str, ok: bool = True) -> subprocess.CompletedProcess:
        """Run Snakemake; fail the test with its output if it fails though `ok`."""
        command = [sys.executable, "-m", "snakemake", *arguments]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=LONGEST, check=False)
        return succeeded(done) if ok else done

    def plan(self, *arguments: str, ok: bool = True) -> subprocess.CompletedProcess:
        """Ask what a run would do; as :meth:`snakemake`, of a process that has Snakemake loaded."""
        done = warm_snakemake(["--dry-run", *arguments], self.folder, LONGEST)
        return succeeded(done) if ok else done

    def planned(self, *arguments: str) -> dict[str, int]:
        """Rules that a run would execute now, with their number of jobs."""
        # The plain logger: its table of jobs is made for programs, that of the default profile for people.
        done = self.plan("--workflow-profile", "none", *arguments)
        table = re.search(r"Job stats:\njob +count\n-+ +-+\n(.*?)\ntotal", done.stdout + done.stderr, re.DOTALL)
        if table is None:
            assert "Nothing to be done" in done.stdout + done.stderr
            return {}
        rows = [line.split() for line in table[1].splitlines()]
        return {name: int(count) for name, count in rows if name != "all"}

    @property
    def config_file(self) -> Path:
        return self.folder / "config/config.yaml"

    def config(self) -> dict:
        return yaml.safe_load(self.config_file.read_text())

    def write_config(self, config: dict) -> None:
        self.config_file.write_text(yaml.safe_dump(config))


def merged(base: dict, change: dict) -> dict:
    """Merge nested mappings."""
    result = dict(base)
    for key, value in change.items():
        result[key] = merged(base[key], value) if isinstance(value, dict) and key in base else value
    return result


def copy_project(folder: Path) -> Project:
    """Copy the project with the tiny experiment."""
    project_files.copy_project(ROOT, folder)
    project = Project(folder)
    project.write_config(merged(project.config(), TINY))
    return project
