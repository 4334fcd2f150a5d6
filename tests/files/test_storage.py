"""Files appear whole or not at all, and a broken one is named."""

import netCDF4
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
    with pytest.raises(InputError, match=r"broken\.nc: is truncated or not a netCDF file \([^)]+\)$"):
        read_variables(path, "x")


def test_only_a_result_is_to_be_deleted_and_made_again(tmp_path):
    path = tmp_path / "results/broken.nc"
    small(path)
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(InputError, match=r"\); delete it and run again$"):
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


def test_a_flipped_bit_is_found(tmp_path):
    path = tmp_path / "a.nc"
    values = np.random.default_rng(1).normal(size=4000)
    write_dataset(path, {"x": Variable(("n",), values, "x", "m")}, {"title": "t"})
    whole = bytearray(path.read_bytes())
    place = whole.find(values[:8].tobytes())
    assert place > 0
    for offset in (0, 5, 12_345):
        damaged = bytearray(whole)
        damaged[place + offset] ^= 4
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"a\.nc: is truncated or not a netCDF file \(NetCDF: HDF error"):
            read_variables(path, "x")


def test_numbers_that_stop_being_finite_are_found(tmp_path):
    path = tmp_path / "a.nc"
    gaps = np.array([1.0, np.nan])
    write_dataset(path, {"x": Variable(("n",), np.ones(2), "x"), "y": Variable(("n",), gaps, "y")}, {})
    assert np.isnan(read_variables(path, "y")[0][1])
    with netCDF4.Dataset(path, "a") as data:
        data["x"][0] = np.nan
    with pytest.raises(InputError, match="'x' holds numbers that are not finite"):
        read_variables(path, "x")


def test_a_result_is_read_under_its_own_name_only(tmp_path):
    first, second = (tmp_path / f"results/simulation/T1/{name}.nc" for name in ("training", "normal"))
    small(first)
    small(second)
    read_variables(first, "x")
    second.write_bytes(first.read_bytes())
    with pytest.raises(InputError, match=r"holds the result 'simulation/T1/training\.nc', not its own"):
        read_variables(second, "x")
    # A copy outside the results, and a copy of all results elsewhere, may be read.
    for other in (tmp_path / "copy.nc", tmp_path / "else/results/simulation/T1/training.nc"):
        other.parent.mkdir(parents=True, exist_ok=True)
        other.write_bytes(first.read_bytes())
        read_variables(other, "x")


def test_a_file_that_declares_more_than_it_can_hold_is_refused(tmp_path):
    with netCDF4.Dataset(tmp_path / "a.nc", "w") as data:
        data.createDimension("n", 10**12)
        data.createVariable("x", "f8", ("n",), chunksizes=(1000,))
    with pytest.raises(InputError, match="'x' declares 8000000000000 bytes"):
        read_variables(tmp_path / "a.nc", "x")


def test_what_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    for write in (small, lambda path: replace_text(path, "x")):
        with pytest.raises(InputError, match=r"cannot be written"):
            write(tmp_path / "file" / "a.nc")


def test_a_full_disk_is_one_line(tmp_path, monkeypatch):
    import shutil
    from types import SimpleNamespace

    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=0))
    words = r"a\.nc: cannot be written \(NetCDF: HDF error; the disk is full\)"
    with pytest.raises(InputError, match=words), create_dataset(tmp_path / "a.nc", {}, {}, {}):
        raise RuntimeError("NetCDF: HDF error")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("how", ["attribute", "unit", "word", "name"])
def test_text_and_attributes_that_were_changed_are_found(tmp_path, how):
    path = tmp_path / "results/a.nc"
    variables = {
        "x": Variable(("n",), np.arange(2.0), "x", "m"),
        "w": Variable(("n",), np.array(["a", "bc"]), "words"),
    }
    write_dataset(path, variables, {"title": "t", "count": 3, "labels": [1, 2]})
    assert read_variables(path, "w")[0].tolist() == ["a", "bc"]
    with netCDF4.Dataset(path, "a") as data:
        if how == "attribute":
            data.count = np.int64(4)
        elif how == "unit":
            data["x"].units = "km"
        elif how == "word":
            data["w"][0] = "b"
        else:
            data.renameVariable("w", "v")
    with pytest.raises(InputError, match=r"a\.nc: was changed or damaged since it was written; delete it"):
        read_variables(path, "x")
