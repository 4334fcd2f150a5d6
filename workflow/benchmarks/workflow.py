"""The whole workflow: full run, nothing to do, one edit; in a scratch copy of the project.

Prints JSON.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

from jointwear.running import project

ROOT = Path(__file__).resolve().parents[2]
CORES = 2


def copy_project(target: Path) -> None:
    """Copy what a run needs."""
    project.copy_project(ROOT, target)


def seconds(arguments: list[str], folder: Path) -> float:
    """Run Snakemake and return its wall time [s]."""
    command = [str(Path(sys.executable).parent / "snakemake"), *arguments]
    start = time.perf_counter()
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    taken = time.perf_counter() - start
    if done.returncode:
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
    return taken


def size_of(folder: Path) -> int:
    """Bytes below a folder."""
    return sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy_project(folder)
        run = ["--cores", str(CORES)]
        full = seconds(run, folder)
        results = size_of(folder / "results")
        seconds(run, folder)
        version = median(seconds(["--version"], folder) for _ in range(9))
        idle = median(seconds(run, folder) for _ in range(9))
        config = folder / "config/config.yaml"
        config.write_text(config.read_text().replace("confidence: 0.95", "confidence: 0.99"))
        edit = seconds(run, folder)
    print(
        json.dumps(
            {
                "cores": CORES,
                "full_seconds": round(full, 1),
                "version_seconds": round(version, 3),
                "nothing_to_do_seconds": round(idle, 3),
                "nothing_to_do_against_version": round(idle / version, 2),
                "edit_confidence_seconds": round(edit, 1),
                "edit_confidence_share": round(edit / full, 3),
                "results_megabytes": round(results / 1e6),
            }
        )
    )


if __name__ == "__main__":
    main()
