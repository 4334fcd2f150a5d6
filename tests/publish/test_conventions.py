"""Every kind of netCDF file that a run leaves, by the public checker of the CF conventions; and CITATION.cff."""

import json
from importlib.util import find_spec
from pathlib import Path

import jsonschema
import pytest
import yaml
from compliance_checker.cf.cf import CF1_8Check
from compliance_checker.runner import CheckSuite
from scratch_project import ROOT

pytestmark = pytest.mark.publish


def kinds(results):
    """One file of every kind: the first of those that share stage and role."""
    found = {}
    for path in sorted(results.rglob("*.nc")):
        parts = path.relative_to(results).parts
        role = "cell" if path.stem.startswith("axis") else path.stem
        found.setdefault((parts[0], role), path)
    return found


def findings(path):
    """Return what the checker finds against the CF conventions 1.8, of any severity."""
    suite = CheckSuite()
    suite.checkers = {"cf:1.8": CF1_8Check}
    dataset = suite.load_dataset(str(path))
    try:
        groups = suite.run_all(dataset, ["cf:1.8"])["cf:1.8"][0]
    finally:
        dataset.close()
    return [f"{group.name}: {message}" for group in groups for message in group.msgs or ()]


def test_the_checker_is_awake(tmp_path):
    import netCDF4

    with netCDF4.Dataset(tmp_path / "bad.nc", "w") as data:
        data.createDimension("x", 2)
        data.createVariable("torque", "i8", ("x",)).units = "furlong per blink"
    assert len(findings(tmp_path / "bad.nc")) > 2


def test_one_file_of_every_kind_has_no_finding(published):
    files = kinds(published.folder / "results")
    assert len(files) > 12
    found = {path.name: messages for path in files.values() if (messages := findings(path))}
    assert found == {}


def test_the_citation_file_is_valid():
    package = Path(find_spec("check_jsonschema").submodule_search_locations[0])
    schema = json.loads((package / "builtin_schemas/vendor/citation-file-format.json").read_text())
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    jsonschema.Draft7Validator(schema).validate(citation)
    from jointwear import __version__

    assert citation["version"] == __version__
