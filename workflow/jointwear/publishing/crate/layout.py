"""Names inside a crate; `verify` needs no more than these."""

from __future__ import annotations

from jointwear.running.project import SOURCES

METADATA = "ro-crate-metadata.json"
CONFIG = "run/config.yaml"
FILES = "run/files.json"
# Folders and files of the project that a run is made from.
PROJECT = (*SOURCES, "requirements")
PROJECT_FILES = ("pyproject.toml", "CITATION.cff", "LICENSE", "README.md")
COMMIT = "commit.json"
