"""A folder that cannot be written is named before Snakemake fails on it, with the way out."""

import os

import pytest

from jointwear.files.errors import InputError
from jointwear.running import project


@pytest.mark.parametrize("name", [".", ".snakemake", "results"])
def test_a_folder_that_cannot_be_written_is_named(tmp_path, monkeypatch, name):
    (tmp_path / "results").mkdir()
    (tmp_path / ".snakemake").mkdir()
    project.check_writable(tmp_path)
    # The user of the tests may be root, whom no permission stops.
    monkeypatch.setattr(os, "access", lambda path, mode: path != tmp_path / name)
    with pytest.raises(InputError, match="cannot be written to; run in a folder that can be: snakemake --directory"):
        project.check_writable(tmp_path)
