"""What a run of the project is made from, seen from the project's top folder."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from jointwear.files.errors import InputError

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


def check_writable(folder: Path) -> None:
    """Check that a run can keep its results and Snakemake's records in `folder`.

    Raises
    ------
    InputError : if one of them cannot be written, with the way to run elsewhere.
    """
    for name in (".", ".snakemake", "results"):
        path = folder / name
        if path.exists() and not os.access(path, os.W_OK | os.X_OK):
            raise InputError(f"{path}: cannot be written to; run in a folder that can be: snakemake --directory FOLDER")
