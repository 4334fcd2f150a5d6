"""Names inside a crate; `verify` needs no more than these."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from jointwear.running.project import SOURCES

METADATA = "ro-crate-metadata.json"
CONFIG = "run/config.yaml"
FILES = "run/files.json"
# Folders and files of the project that a run is made from.
PROJECT = (*SOURCES, "requirements")
PROJECT_FILES = ("pyproject.toml", "CITATION.cff", "LICENSE", "README.md")
COMMIT = "commit.json"
#: What runs when the workflow runs: rules, scripts, library, templates, which may hold expressions, and the registry,
#: which names addresses to load from and files to write.
CODE = ("Snakefile", "workflow", "report", "data/registry.yaml")
#: The page and its results, without which there is nothing to verify.
REPORT = ("results/report/index.html", "results/report/summary.json")
#: Snakemake's mark on a folder that it made.
STAMP = ".snakemake_timestamp"


def files_of(root: Path, parts: tuple[str, ...]) -> Iterator[str]:
    """Yield the names of the files in folders (or files) of a project, sorted, without what Python or a kill left."""
    for part in parts:
        whole = root / part
        for path in sorted(whole.rglob("*")) if whole.is_dir() else [whole]:
            if path.is_file() and "__pycache__" not in path.parts and path.suffix != ".part":
                yield path.relative_to(root).as_posix()
