"""Units that a log tells, in the names of its columns or in a row, and currents: read, or refused with the key."""

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from written_logs import HEADER, one, write

from jointwear.files.errors import InputError
from jointwear.measurement.formats import layout_of, read_log


def two(path, **entry):
    return next(iter(read_log(path, layout_of(entry, ["joint_1", "joint_2"]))))


def test_a_row_of_units_holds_one_for_each_column(tmp_path):
    lines = ["time,position_1,position_2,torque_1,torque_2", "s,rad,deg,Nm,N cm", "0,1,90,2,300", "0.01,1.1,91,2,310"]
    chunk = two(write(tmp_path / "a.csv", lines))
    assert np.allclose(chunk.position[0], [1.0, np.pi / 2])
    assert np.allclose(chunk.torque[0], [2.0, 3.0])
    assert (chunk.units["position"], chunk.units["torque"]) == ("rad", "N m")
    with pytest.raises(
        InputError, match="says 'rad' and 'deg' for position, 'units' of the configuration 'deg' for all"
    ):
        two(tmp_path / "a.csv", units={"position": "deg"})
    # A cell of a spreadsheet that spans all columns of a role.
    lines[1] = "s,deg,,Nm,"
    assert np.allclose(two(write(tmp_path / "b.csv", lines)).position[0], np.radians([1, 90]))
    lines[1] = "s,rad,degrees,Nm,A"
    with pytest.raises(InputError, match="says 'Nm' and 'A' for torque; write all columns in N m, or all as currents"):
        two(write(tmp_path / "c.csv", lines))


def named(**units):
    """Names of the columns of a log of one joint with units in brackets."""
    return {role: f"{role} {said}" for role, said in units.items()}


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_units_in_the_names_of_columns(tmp_path, suffix):
    """Milliseconds had been read as seconds, and degrees as radians."""
    names = named(time="[ms]", position="(deg)", torque="( mNm )")
    values = [[0.0, 20.0], [90.0, 180.0], [1000.0, 2000.0]]
    path = tmp_path / f"a.{suffix}"
    if suffix == "csv":
        write(path, [",".join(names.values()), *(",".join(map(str, row)) for row in zip(*values, strict=True))])
    else:
        parquet.write_table(pa.table(dict(zip(names.values(), values, strict=True))), path)
    lists = {role: name if role == "time" else [name] for role, name in names.items()}
    chunk = one(path, variables=lists)
    assert np.allclose(chunk.time, [0.0, 0.02])
    assert np.allclose(chunk.position[:, 0], np.radians([90, 180]))
    assert np.allclose(chunk.torque[:, 0], [1.0, 2.0])
    # The configuration states what a log says wrong.
    assert one(path, variables=lists, units={"torque": "N m"}).torque[0, 0] == 1000.0


@pytest.mark.parametrize("named", [{}, {"torque": ["torque_1"], "time": "time"}])
def test_a_column_with_its_unit_in_brackets_needs_no_other_name(tmp_path, named):
    """Logs of one robot may come with units in their names and without, under one configuration."""
    lines = ["time [ms],position_1 [deg],torque_1 (mNm)", "0,90,1000", "20,180,2000"]
    chunk = one(write(tmp_path / "a.csv", lines), variables=named)
    assert np.allclose(chunk.time, [0.0, 0.02])
    assert np.allclose(chunk.position[:, 0], np.radians([90, 180]))
    assert np.allclose(chunk.torque[:, 0], [1.0, 2.0])
    # The name as it is goes before one with a unit, and of two with a unit none is taken.
    lines[0] = "time [ms],position_1,torque_1 (mNm),position_1 [deg]"
    lines[1:] = ["0,0.5,1000,90", "20,0.6,2000,180"]
    assert np.allclose(one(write(tmp_path / "b.csv", lines), variables=named).position[:, 0], [0.5, 0.6])
    lines[0] = "time [ms],position_1 [rad],torque_1 (mNm),position_1 [deg]"
    with pytest.raises(InputError, match="has no position"):
        one(write(tmp_path / "c.csv", lines), variables=named)


def test_a_row_of_units_that_says_other_than_the_names_is_refused(tmp_path):
    lists = {"position": ["position [deg]"], "torque": ["torque (raw)"]}
    lines = ["time,position [deg],torque (raw)", "s,degrees,Nm", "0,90,1", "0.02,91,2"]
    assert np.allclose(one(write(tmp_path / "a.csv", lines), variables=lists).position[0], np.pi / 2)
    lines[1] = "s,rad,Nm"
    with pytest.raises(InputError, match=r"column 'position \[deg\]' says 'deg', the row of units 'rad'; state which"):
        one(write(tmp_path / "b.csv", lines), variables=lists)
    assert one(tmp_path / "b.csv", variables=lists, units={"position": "rad"}).position[0, 0] == 90


def test_a_row_of_units_above_the_header(tmp_path):
    lines = ["s,deg,mNm", ",".join(HEADER), "0,90,1000", "0.02,91,2000"]
    chunk = one(write(tmp_path / "a.csv", lines))
    assert np.allclose([chunk.position[0, 0], chunk.torque[0, 0]], [np.pi / 2, 1.0])
    lines[0] = "log,of,cell"
    assert one(write(tmp_path / "b.csv", lines)).position[0, 0] == 90


def test_currents_need_a_torque_constant(tmp_path):
    path = write(tmp_path / "a.csv", [",".join(HEADER), "s,rad,A", "0,0.1,2.0", "1,0.2,-9999"])
    with pytest.raises(InputError, match="'torque_constant' in N m/A"):
        one(path)
    chunk = one(path, torque_constant=[10.0], scale=0.5, sign=[-1])
    assert chunk.torque[0, 0] == pytest.approx(-10.0)
    assert chunk.position[0, 0] == pytest.approx(-0.1)
    assert np.isnan(chunk.torque[1, 0])


@pytest.mark.parametrize("unit", ["A", "Ampere", "amps", "amperes", "mA"])
def test_currents_are_known_by_all_names(tmp_path, unit):
    rows, size = ["0,0.1,2.0", "1,0.2,3.0"], 1e-3 if unit == "mA" else 1.0
    with_row = write(tmp_path / "a.csv", [",".join(HEADER), f"s,rad,{unit}", *rows])
    without = write(tmp_path / "b.csv", [",".join(HEADER), *rows])
    for chunk in (
        one(with_row, torque_constant=[10.0]),
        one(without, torque_constant=[10.0], units={"torque": unit}),
    ):
        assert chunk.torque[:, 0] == pytest.approx([20.0 * size, 30.0 * size])
        assert chunk.units["torque"] == ("mA" if unit == "mA" else "A")
    with pytest.raises(InputError, match="'torque_constant' in N m/A"):
        one(with_row)
