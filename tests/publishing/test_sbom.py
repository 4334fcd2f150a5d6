"""The bill of materials names every locked package with version, licence and needs; the same bytes each time."""

import json
import re

import pytest

from jointwear.files.errors import InputError
from jointwear.publishing.sbom import locked, unstated, write_bill


def test_it_lists_every_locked_package_with_its_licence(root, tmp_path):
    locks = [root / "requirements/run.txt"]
    found = write_bill(tmp_path / "one.json", locks)
    write_bill(tmp_path / "two.json", locks)
    assert (tmp_path / "one.json").read_bytes() == (tmp_path / "two.json").read_bytes()
    assert json.loads((tmp_path / "one.json").read_text()) == found
    assert (found["bomFormat"], found["specVersion"]) == ("CycloneDX", "1.6")
    assert re.fullmatch(r"urn:uuid:[0-9a-f-]{36}", found["serialNumber"])
    parts = {part["name"]: part for part in found["components"]}
    pinned = set(re.findall(r"^([a-z0-9-]+)==", (root / "requirements/run.txt").read_text(), re.MULTILINE))
    assert pinned <= parts.keys()
    assert parts["numpy"]["purl"] == f"pkg:pypi/numpy@{parts['numpy']['version']}"
    assert "BSD" in parts["numpy"]["licenses"][0]["license"]["name"]
    references = [part["bom-ref"] for part in found["components"]]
    assert len(set(references)) == len(references)
    for entry in found["dependencies"]:
        assert set(entry["dependsOn"]) <= set(references)
    needs = {entry["ref"]: entry["dependsOn"] for entry in found["dependencies"]}
    assert parts["numpy"]["bom-ref"] in needs[parts["scipy"]["bom-ref"]]


def test_packages_without_a_stated_licence_are_told(root, tmp_path):
    lines = unstated(write_bill(tmp_path / "x.json", [root / "requirements/run.txt"]))
    assert any(line.startswith("conda-inject ") and "MIT (text of LICENSE)" in line for line in lines)
    assert not [line for line in lines if line.endswith("none found")]


def test_lock_files_that_disagree_are_refused(tmp_path):
    (tmp_path / "a.txt").write_text("numpy==2.4.0 \\\n    --hash=sha256:" + "a" * 64 + "\n")
    (tmp_path / "b.txt").write_text("numpy==2.4.1\n")
    assert locked([tmp_path / "a.txt"]) == {"numpy": ("2.4.0", ["a" * 64])}
    with pytest.raises(InputError, match=r"pins numpy 2\.4\.1, another lock file 2\.4\.0"):
        locked([tmp_path / "a.txt", tmp_path / "b.txt"])
