"""The tiny experiment, run once, and copies of it that a test may change."""

import fcntl
import os
import shutil

import pytest
from scratch_project import Project, copy_project


@pytest.fixture(scope="session")
def built(tmp_path_factory) -> Project:
    """A project whose tiny experiment has been run; tests must leave it as it is.

    Workers of one run of the tests share it: the first that asks runs it, each takes a copy.
    """
    own = tmp_path_factory.getbasetemp()
    shared = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "tiny_experiment"
    shared.mkdir(exist_ok=True)
    with open(shared / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (shared / "done").exists():
            (shared / "project").mkdir()
            copy_project(shared / "project").snakemake("--cores", "2")
            (shared / "done").touch()
    folder = tmp_path_factory.mktemp("built") / "project"
    shutil.copytree(shared / "project", folder, symlinks=True)
    return Project(folder)


@pytest.fixture
def project(built, tmp_path) -> Project:
    """A copy of the built project that a test may change."""
    shutil.copytree(built.folder, tmp_path / "project", symlinks=True)
    return Project(tmp_path / "project")
