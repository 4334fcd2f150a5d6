"""Results are opened before they are packed: what is cut, damaged, missing or changed since stops the packing."""

import base64
import hashlib
import json

import numpy as np
import pytest

from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, write_dataset
from jointwear.publishing.crate.records import trace
from jointwear.publishing.site.writing import write_site
from jointwear.publishing.soundness import check_results, check_whole

PAGE = "results/report/index.html"


@pytest.fixture
def project(tmp_path):
    """A project with three results and Snakemake's records of them."""
    root = tmp_path / "project"
    write_dataset(root / "results/simulation/a.nc", {"x": Variable(("n",), np.arange(5000.0), "x")}, {"title": "t"})
    (root / "results/report").mkdir()
    (root / "results/tables").mkdir()
    (root / "results/tables/a.csv").write_text("a,b\n1,2\n")
    (root / PAGE).write_text("<html></html>\n")
    (root / "results/report/summary.json").write_text('{"a": 1}')
    write_dataset(root / "results/tables/a.nc", {"x": Variable(("n",), np.zeros(3), "x")}, {"title": "t"})
    tables = ["results/tables/a.csv", "results/tables/a.nc"]
    record(root, "results/simulation/a.nc", "simulate", [])
    for name in tables:
        record(root, name, "tabulate", ["results/simulation/a.nc"])
    for name in (PAGE, "results/report/summary.json"):
        record(root, name, "report", tables)
    return root


def record(root, name, rule, inputs):
    path = root / ".snakemake/metadata" / base64.b64encode(name.encode()).decode()
    path.parent.mkdir(parents=True, exist_ok=True)
    sums = {i: f"sha256:{hashlib.sha256((root / i).read_bytes()).hexdigest()}" for i in inputs}
    entry = {"rule": rule, "input": inputs, "log": [f"{rule}.log"], "starttime": 1.0, "endtime": 2.0}
    path.write_text(json.dumps({**entry, "input_checksums": sums}))


def site(root, tmp_path):
    write_site(tmp_path / "site", edits=[], wanted=[PAGE], root=root)
    return tmp_path / "site"


def test_whole_results_are_published(project, tmp_path):
    assert (site(project, tmp_path) / PAGE).is_file()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda r: (r / "results/simulation/a.nc").unlink(), r"results/simulation/a\.nc: is not there"),
        (lambda r: cut(r / "results/simulation/a.nc", 500), "truncated"),
        (lambda r: flip(r / "results/simulation/a.nc"), "HDF error"),
        (lambda r: (r / "results/tables/a.nc").unlink(), r"tables/a\.nc: is not there"),
        (lambda r: (r / "results/tables/a.csv").write_text("a,b\n1,3\n"), "changed after later jobs had read it"),
        (lambda r: cut(r / "results/tables/a.csv", 7), "cut or damaged"),
        (lambda r: cut(r / PAGE, 5), "its end is missing"),
        (lambda r: unrecorded(r, "results/tables/a.csv"), r"a\.csv: there is no sound record"),
        (lambda r: unrecorded(r, PAGE), "there is no sound record"),
        (lambda r: cut(r / "results/report/summary.json", 4), "cannot be read as JSON"),
    ],
)
def test_damaged_results_are_not_packed(project, tmp_path, change, words):
    change(project)
    with pytest.raises(InputError, match=words):
        site(project, tmp_path)
    assert not (tmp_path / "site").exists()
    with pytest.raises(InputError, match=words):
        crate_checks(project)


def crate_checks(project):
    run = trace([PAGE], project)
    check_results(project, run.results, run.checksums)


def cut(path, size):
    path.write_bytes(path.read_bytes()[:size])


def unrecorded(root, name):
    """Damage the record of how a result was made."""
    cut(root / ".snakemake/metadata" / base64.b64encode(name.encode()).decode(), 20)


def flip(path):
    data = bytearray(path.read_bytes())
    place = data.find(np.arange(5000.0).tobytes()[800:880])
    assert place > 0
    data[place] ^= 1
    path.write_bytes(data)


def test_results_of_other_runs_of_the_same_rule_are_left_out(project):
    """What an earlier configuration made from the same inputs does not belong to this run."""
    record(project, "results/simulation/old.nc", "simulate", [])
    path = project / ".snakemake/metadata" / base64.b64encode(b"results/simulation/old.nc").decode()
    path.write_text(path.read_text().replace("simulate.log", "simulate_old.log"))
    assert "results/simulation/old.nc" not in trace([PAGE], project).results


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.svg", "<svg><g></svg>", "not valid XML"),
        ("a.csv", "a,b\n1\n", "differ in length"),
        ("a.csv", "", "empty"),
        ("a.html", "<html>", "end is missing"),
        ("a.html", b"\xff\xfe", "not text in UTF-8"),
    ],
)
def test_what_a_whole_file_is(tmp_path, name, text, words):
    (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError, match=words):
        check_whole(tmp_path / name)
