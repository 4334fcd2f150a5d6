"""What a change of one parameter costs: time and jobs of every rerun that the site lists, from a finished run.

Prints JSON.
"""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from jointwear.publishing.site.edits import EDITS
from workflow import CORES, copy_project, seconds


def copy_run(source: Path, target: Path) -> None:
    """Copy a finished run; results as links, because Snakemake replaces files and never writes into them."""
    shutil.copytree(source, target, symlinks=True, ignore=shutil.ignore_patterns("results"))
    subprocess.run(["cp", "--archive", "--link", str(source / "results"), str(target / "results")], check=True)


def measure(folder: Path, command: str) -> dict:
    """Run one command in a finished run; return its time [s], number of jobs and the rules that ran."""
    arguments = shlex.split(command)[1:]
    call = [str(Path(sys.executable).parent / "snakemake"), "--cores", str(CORES), *arguments]
    start = time.perf_counter()
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)
    taken = time.perf_counter() - start
    if done.returncode:
        sys.exit(f"{command} failed:\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
    table = re.search(r"Job stats:\njob +count\n-+ +-+\n(.*?)\ntotal +(\d+)", done.stdout + done.stderr, re.DOTALL)
    rules = [line.split()[0] for line in table[1].splitlines()] if table else []
    jobs = int(table[2]) - ("all" in rules) if table else 0
    return {"command": command, "seconds": round(taken, 1), "jobs": jobs, "rules": [r for r in rules if r != "all"]}


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as name:
        base = Path(name) / "base"
        base.mkdir()
        copy_project(base)
        full = seconds(["--cores", str(CORES)], base)
        found = []
        for index, edit in enumerate(EDITS):
            folder = Path(name) / f"edit{index}"
            copy_run(base, folder)
            found.append(measure(folder, edit["command"]))
            shutil.rmtree(folder)
    print(json.dumps({"cores": CORES, "full_seconds": round(full, 1), "edits": found}))


if __name__ == "__main__":
    main()
