"""The crate of a run: valid, complete, the same for the same run, and verified by computing it again."""

import hashlib
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml
from offline_validator import fill_cache, problems
from scratch_project import Project
from small_crate import sign

from jointwear.files.storage import open_dataset
from jointwear.publishing.verification.comparison import CLOSE, DIFFERENT, EQUAL, MISSING, compare_files

pytestmark = pytest.mark.publish
# The metadata cannot hold their own checksum; the time stamp is Snakemake's mark on a folder that it made.
OWN = ("ro-crate-metadata.json", ".snakemake_timestamp")


@pytest.fixture(scope="module")
def crate(published):
    return published.folder / "crate"


@pytest.fixture(scope="module")
def graph(crate):
    document = json.loads((crate / "ro-crate-metadata.json").read_text())
    return {entity["@id"]: entity for entity in document["@graph"]}


def identifiers(value):
    return [v["@id"] for v in (value if isinstance(value, list) else [value])]


def test_the_public_validator_passes_it(crate, tmp_path):
    fill_cache(tmp_path / "cache")
    assert problems(crate, tmp_path / "cache") == []


def test_the_validator_is_awake(crate, tmp_path):
    """A crate without its run must not pass."""
    broken = tmp_path / "broken"
    shutil.copytree(crate, broken)
    path = broken / "ro-crate-metadata.json"
    document = json.loads(path.read_text())
    for entity in document["@graph"]:
        if entity["@id"] == "#run":
            del entity["instrument"]
    path.write_text(json.dumps(document))
    fill_cache(tmp_path / "cache")
    assert problems(broken, tmp_path / "cache")


def test_it_holds_workflow_config_inputs_results_software_seed_and_agent(crate, graph):
    run = graph["#run"]
    results, inputs = identifiers(run["result"]), identifiers(run["object"])
    assert {"results/report/index.html", "results/tables/table_iv.csv"} <= set(results)
    assert {"run/config.yaml", "config/paper/published.yaml", "config/robots/puma560_paper.yaml"} <= set(inputs)
    assert graph["#value-seed"]["value"] == 20150824
    assert identifiers(run["instrument"]) == ["Snakefile"]
    assert graph[identifiers(run["agent"])[0]]["@type"] == "Person"
    software = {
        graph[i]["name"]: graph[i]["softwareVersion"] for i in identifiers(graph["Snakefile"]["softwareRequirements"])
    }
    assert {"python", "numpy", "pin", "snakemake", "netcdf4"} <= software.keys()
    assert all(re.match(r"\d", version) for version in software.values())
    made = {p.relative_to(crate).as_posix() for p in (crate / "results").rglob("*") if p.is_file()}
    assert made == set(results)


def test_every_file_is_listed_with_its_checksum(crate, graph):
    for path in (p for p in crate.rglob("*") if p.is_file()):
        name = path.relative_to(crate).as_posix()
        if name not in OWN:
            assert graph[name]["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest(), name


def test_same_run_same_bytes_but_for_dates(published, crate, tmp_path):
    before = (crate / "ro-crate-metadata.json").read_text()
    again = Project(tmp_path / "again")
    shutil.copytree(published.folder, again.folder, symlinks=True)
    again.snakemake("--cores", "1", "--force", "crate")
    after = (again.folder / "crate/ro-crate-metadata.json").read_text()
    date = re.compile(r'"(datePublished|startTime|endTime)": "[^"]*"')
    assert date.sub(r'"\1"', before) == date.sub(r'"\1"', after)
    files = [p.relative_to(crate) for p in crate.rglob("*") if p.is_file() and p.name not in OWN]
    assert all((crate / f).read_bytes() == (again.folder / "crate" / f).read_bytes() for f in files)


def test_verify_finds_every_file_equal(published):
    done = published.snakemake("--cores", "2", "verify", "--config", "crate=crate")
    output = done.stdout + done.stderr
    listed = re.search(r"verify: (\d+) files: (\d+) equal\n", output)
    assert listed, output[-3000:]
    assert listed[1] == listed[2]
    assert int(listed[1]) > 30


PLANT = """
monitor:
  notify: [{name: night, env: SECRET_SLACK}]
  robots:
    SecretCell:
      logs: ["plant/*.parquet"]
      robot: config/robots/puma560.yaml
      baseline: {windows: 24}
"""


@pytest.mark.parametrize("place", ["plant.yaml", "config/config.yaml"])
def test_the_crate_knows_nothing_of_the_robots_of_the_user(published, tmp_path, place):
    """Nor does who verifies it have their logs, nor does an edit of theirs pack it anew."""
    project = Project(tmp_path / "project")
    shutil.copytree(published.folder, project.folder, symlinks=True)
    shutil.rmtree(project.folder / "crate")
    shutil.copytree(project.folder / "data/examples/monitor_puma560", project.folder / "plant")
    given = project.folder / place
    before = yaml.safe_load(given.read_text()) if given.exists() else {}
    given.write_text(yaml.safe_dump({**before, **yaml.safe_load(PLANT)}))
    files = ["--configfile", "config/examples/tiny.yaml", *([place] if place == "plant.yaml" else [])]
    project.snakemake("--cores", "2", "write_crate", *files)
    for path in sorted((project.folder / "crate").rglob("*")):
        if path.is_file() and path.suffix in (".yaml", ".json"):
            assert "SECRET_SLACK" not in path.read_text(), path
            assert "SecretCell" not in path.read_text(), path
    given.write_text(given.read_text().replace("windows: 24", "windows: 48"))
    assert "write_crate" not in project.planned("write_crate", *files)
    shutil.rmtree(project.folder / "plant")
    done = published.snakemake("--cores", "2", "verify", "--config", f"crate={project.folder / 'crate'}")
    assert re.search(r"verify: (\d+) files: \1 equal\n", done.stdout + done.stderr)


def test_verify_names_what_differs_and_fails(published, crate, tmp_path):
    forged = tmp_path / "forged"
    shutil.copytree(crate, forged)
    table = forged / "results/tables/table_v.csv"
    table.write_text(re.sub(r"(\d)\.(\d)", r"\g<1>9.\g<2>", table.read_text(), count=1))
    done = published.snakemake("--cores", "2", "verify", "--config", f"crate={forged}", ok=False)
    assert done.returncode != 0
    assert "table_v.csv" in done.stdout + done.stderr
    (forged / ".snakemake_timestamp").unlink(
        missing_ok=True
    )  # Snakemake's own mark on a folder, which no archive holds
    sign(forged)
    archive = shutil.make_archive(str(tmp_path / "forged"), "zip", forged)
    done = published.snakemake("--cores", "2", "verify", "--config", f"crate={archive}", ok=False)
    assert done.returncode != 0
    assert re.search(r"different +results/tables/table_v\.csv", done.stdout + done.stderr)


def test_verify_without_a_crate_says_what_is_missing(published):
    done = published.snakemake("--cores", "1", "verify", ok=False)
    assert done.returncode != 0
    assert "'crate' is missing" in done.stdout + done.stderr


def test_a_small_change_of_a_number_is_within_tolerance_and_a_large_one_is_not(crate, tmp_path):
    source = next((crate / "results/features").rglob("axis1*.nc"))
    for change, verdict in ((1e-9, CLOSE), (1e-3, DIFFERENT)):
        other = tmp_path / f"{verdict}.nc"
        shutil.copy2(source, other)
        import netCDF4

        with netCDF4.Dataset(other, "a") as data:
            values = data["maximum_torque"][...]
            data["maximum_torque"][...] = np.asarray(values) * (1 + change)
        assert compare_files(other, source).verdict == verdict
    assert compare_files(source, source).verdict == EQUAL
    assert compare_files(Path("none.nc"), source).verdict == MISSING
    with open_dataset(source) as data:
        assert data.Conventions.startswith("CF-")
