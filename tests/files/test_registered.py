"""References to data and models that others published."""

import pytest

from jointwear.files.errors import InputError
from jointwear.files.registered import FETCHED, locate, path_in, read_registry

REGISTRY = """
one_arm:
  title: an arm
  licence: MIT
  citation: nobody
  page: http://127.0.0.1/
  address: http://127.0.0.1/
  sources: {a.csv: null}
  convert: as_it_is
  files: {measured.nc: {}, robot.urdf: {}}
"""


@pytest.fixture
def registry(tmp_path, monkeypatch):
    monkeypatch.delenv("JOINTWEAR_DATA", raising=False)
    path = tmp_path / "registry.yaml"
    path.write_text(REGISTRY)
    return path


def test_a_file_that_is_not_here_will_be_under_results(registry):
    assert locate("registry:one_arm/measured.nc", registry) == FETCHED / "one_arm/measured.nc"


def test_an_own_folder_lends_what_it_has(registry, tmp_path, monkeypatch):
    (tmp_path / "own/one_arm").mkdir(parents=True)
    (tmp_path / "own/one_arm/robot.urdf").write_text("<robot/>")
    monkeypatch.setenv("JOINTWEAR_DATA", str(tmp_path / "own"))
    assert locate("registry:one_arm/robot.urdf", registry) == tmp_path / "own/one_arm/robot.urdf"
    assert locate("registry:one_arm/measured.nc", registry) == FETCHED / "one_arm/measured.nc"


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        ("registry:one_arn/measured.nc", "did you mean 'one_arm'"),
        ("registry:one_arm/measured.csv", "did you mean 'measured.nc'"),
        ("package:exampel-robot-data/x.urdf", "did you mean 'example-robot-data'"),
    ],
)
def test_a_wrong_reference_is_named_with_the_nearest(registry, reference, message):
    with pytest.raises(InputError, match=message):
        locate(reference, registry)


def test_a_package_that_lacks_the_file_or_is_missing_is_named():
    with pytest.raises(InputError, match=r"plants\.txt"):
        locate("package:example-robot-data/robots/none.urdf")


def test_a_plain_path_counts_from_the_document(tmp_path):
    assert path_in("arm.urdf", tmp_path) == tmp_path / "arm.urdf"


def test_every_entry_says_whose_it_is_and_how_it_is_checked():
    for name, entry in read_registry().items():
        assert entry["licence"], name
        assert entry["citation"], name
        checked = all(entry["sources"].values()) or any(file.get("rms") for file in entry["files"].values())
        assert checked, name
