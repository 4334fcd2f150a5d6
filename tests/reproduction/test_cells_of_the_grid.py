"""Which worn run a result file belongs to: it says so itself, whatever its name."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, write_dataset
from jointwear.reproduction.grid import Cell, by_cell, cell_of, run_attributes, worn_runs


def result(path, attributes):
    write_dataset(path, {"x": Variable(("x",), np.zeros(1), "x", "1")}, attributes)


def test_cells_are_ordered_as_in_the_paper(tmp_path):
    cells = [Cell(t, p, a) for p in (20.0, 10.0) for a in (2, 1) for t in ("T2", "T1")]
    paths = {cell: tmp_path / f"{number}.nc" for number, cell in enumerate(cells)}
    for cell, path in paths.items():
        result(path, cell.attributes)
    found = by_cell(paths.values())
    assert list(found)[:3] == [Cell("T1", 10.0, 1), Cell("T1", 10.0, 2), Cell("T1", 20.0, 1)]
    assert found == {cell: str(path) for cell, path in paths.items()}


@settings(max_examples=25, deadline=None)
@given(st.text("ABCabc0123456789", min_size=1), st.floats(0.001, 1e3), st.integers(1, 99))
def test_a_file_names_its_worn_run_whatever_its_own_name(task, increase, axis):
    cell = Cell(task, increase, axis)
    with TemporaryDirectory() as folder:
        first, second = Path(folder) / "first.nc", Path(folder) / "axis3_10percent.nc"
        result(first, cell.attributes)
        result(second, run_attributes(first))
        assert cell_of(second) == cell


def test_a_run_without_wear_is_no_cell(tmp_path):
    result(tmp_path / "axis3_10percent.nc", {})
    assert run_attributes(tmp_path / "axis3_10percent.nc") == {}
    assert worn_runs([tmp_path / "axis3_10percent.nc"]) == {}
    with pytest.raises(InputError, match="not the file of a worn run"):
        cell_of(tmp_path / "axis3_10percent.nc")
