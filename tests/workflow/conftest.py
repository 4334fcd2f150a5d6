"""The tiny experiment, run once a session, and copies of it that a test may change."""

import shutil

import pytest
from scratch_project import Project, copy_project


@pytest.fixture(scope="session")
def built(tmp_path_factory) -> Project:
    """A project whose tiny experiment has been run; tests must leave it as it is."""
    project = copy_project(tmp_path_factory.mktemp("built"))
    project.snakemake("--cores", "2")
    return project


@pytest.fixture
def project(built, tmp_path) -> Project:
    """A copy of the built project that a test may change."""
    shutil.copytree(built.folder, tmp_path / "project", symlinks=True)
    return Project(tmp_path / "project")
