"""The recovered experiment, through the whole workflow: Tables V and VI at the published hours against the paper."""

import csv

import numpy as np
import pytest
from scratch_project import copy_project

@pytest.fixture(scope="module")
def tables(root, tmp_path_factory):
    """Tables V and VI of the default grid with few replicates, as lists of rows."""
    project = copy_project(tmp_path_factory.mktemp("grid"))
    shipped = (root / "config/config.yaml").read_text(encoding="utf-8")
    project.config_file.write_text(shipped, encoding="utf-8")
    files = [f"results/tables/{name}.csv" for name in ("table_v", "table_vi")]
    project.snakemake("--cores", "2", *files, "--config", "replicates=16")

    def read(name):
        with open(project.folder / name, encoding="utf-8", newline="") as file:
            return [
                {k: v if k in ("task", "verdict") else float(v) for k, v in row.items()} for row in csv.DictReader(file)
            ]

    return [read(name) for name in files]


def test_largest_torque_at_the_published_hours(tables):
    rows = tables[0]
    assert len(rows) == 36
    error = [abs(r["at_published_hour"] / r["published"] - 1) for r in rows if r["published"] > 0]
    assert np.median(error) <= 0.01
    assert max(error) <= 0.05
    assert all(r["at_published_hour"] <= 5e-4 for r in rows if r["published"] == 0)


def test_coefficient_of_variation_at_the_published_hours(tables):
    rows = tables[1]
    moving = [r for r in rows if (r["task"], r["axis"]) != ("T1", 6)]
    error = [abs(r["at_published_hour"] - r["published"]) for r in moving]
    assert len(moving) == 34
    assert np.median(error) <= 0.01
    assert max(error) <= 0.05


def test_axis_at_rest_shows_the_variation_of_noise_alone(tables):
    # |Gaussian| has sqrt(pi / 2 - 1) = 0.756; 60 values scatter by 0.07.
    for row in tables[1]:
        if (row["task"], row["axis"]) == ("T1", 6):
            assert abs(row["published"] - np.sqrt(np.pi / 2 - 1)) <= 2 * 0.07
            assert abs(row["at_published_hour"] - np.sqrt(np.pi / 2 - 1)) <= 2 * 0.07
