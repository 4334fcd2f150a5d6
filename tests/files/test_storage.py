"""Files appear whole or not at all, and a broken one is named."""

import numpy as np
import pytest

from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, create_dataset, read_variables, write_dataset
from jointwear.files.text_files import replace_text


def small(path, size=1000):
    write_dataset(path, {"x": Variable(("n",), np.arange(size, dtype=float), "x", "m")}, {"title": "t"})


def test_round_trip_with_text(tmp_path):
    words = np.array(["a", "bc"])
    write_dataset(tmp_path / "a.nc", {"w": Variable(("n",), words, "words")}, {"title": "t"})
    assert read_variables(tmp_path / "a.nc", "w")[0].tolist() == ["a", "bc"]


def test_dimensions_must_agree(tmp_path):
    with pytest.raises(ValueError, match="dimension n"):
        write_dataset(
            tmp_path / "a.nc",
            {"x": Variable(("n",), np.zeros(2), "x"), "y": Variable(("n",), np.zeros(3), "y")},
            {},
        )


@pytest.mark.parametrize("keep", [0, 100, 3000, 8000])
def test_a_truncated_file_is_named(tmp_path, keep):
    path = tmp_path / "broken.nc"
    small(path)
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(InputError, match=r"broken\.nc: is truncated or not a netCDF file"):
        read_variables(path, "x")


def test_a_missing_file_and_a_missing_variable_are_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.nc: no such file"):
        read_variables(tmp_path / "none.nc", "x")
    small(tmp_path / "a.nc")
    with pytest.raises(InputError, match="no variable 'y'"):
        read_variables(tmp_path / "a.nc", "y")


def test_a_failed_write_leaves_the_earlier_file(tmp_path):
    path = tmp_path / "a.nc"
    small(path)
    before = path.read_bytes()
    with pytest.raises(RuntimeError, match="stop"), create_dataset(path, {}, {}, {}):
        raise RuntimeError("stop")
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["a.nc"]


def test_text_is_replaced_at_once(tmp_path):
    replace_text(tmp_path / "sub" / "a.txt", "one")
    replace_text(tmp_path / "sub" / "a.txt", "two")
    assert (tmp_path / "sub" / "a.txt").read_text() == "two"
    assert len(list((tmp_path / "sub").iterdir())) == 1


def test_what_the_cf_conventions_ask_is_added(tmp_path):
    import netCDF4

    variables = {
        "n": Variable(("n",), np.arange(3), "number", "1"),
        "flag": Variable(("n",), np.array([True, False, True]), "flag", "1"),
    }
    write_dataset(tmp_path / "a.nc", variables, {"title": "t"})
    with netCDF4.Dataset(tmp_path / "a.nc") as data:
        assert data.Conventions == "CF-1.8"
        assert data.history
        assert data["n"].dtype == np.int32
        assert data["flag"].dtype == np.int8
        assert data["flag"][...].tolist() == [1, 0, 1]


def test_integers_beyond_32_bits_are_not_cut(tmp_path):
    with pytest.raises(ValueError, match="beyond 32 bits"):
        write_dataset(tmp_path / "a.nc", {"n": Variable(("n",), np.array([2**40]), "n")}, {})
