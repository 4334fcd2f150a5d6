"""The tiny experiment with its crate, built once a session."""

import shutil
from importlib.util import find_spec

import pytest
from scratch_project import ROOT, copy_project

# What checks what is published lives in an environment of its own (make test-publish); elsewhere these tests cannot
# be imported. There, a run that finds none of them fails.
collect_ignore_glob = [] if find_spec("compliance_checker") else ["test_*.py"]


FURTHER = ("requirements", "pyproject.toml", "README.md", "LICENSE", "CITATION.cff", "docs")


@pytest.fixture(scope="session")
def published(tmp_path_factory):
    """A project with its results, its crate and its site; tests leave it as it is."""
    project = copy_project(tmp_path_factory.mktemp("published"))
    for name in FURTHER:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, project.folder / name)
        elif source.exists():
            shutil.copy2(source, project.folder / name)
    project.snakemake("--cores", "2", "crate", "site")
    return project
