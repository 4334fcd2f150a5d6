"""What a run of the project is made from, seen from the project's top folder."""

from __future__ import annotations

import shutil
from pathlib import Path

#: Folders and files that a run reads.
SOURCES = ("Snakefile", "workflow", "config", "report", "data")
#: Link under which Snakemake finds the profiles of workflow/.
PROFILES = "profiles"


def copy_project(source: Path, target: Path) -> None:
    """Copy what a run needs from the project in `source` into the existing folder `target`."""
    for part in (*SOURCES, PROFILES):
        found = source / part
        if found.is_dir():
            shutil.copytree(found, target / part, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        elif found.exists():
            shutil.copy2(found, target / part)
