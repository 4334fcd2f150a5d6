"""CSV logs as loggers of plants write them: read, or refused with the key that mends it."""

import gzip

import numpy as np
import pytest
from written_logs import HEADER, one, write

from jointwear.files.errors import InputError
from jointwear.measurement.formats import layout_of, read_log
from jointwear.measurement.formats.text import MOST_TORN
from jointwear.measurement.recording_files import load_recording


def test_preamble_units_row_decimal_commas_and_code_page(tmp_path):
    lines = ["Roboter: Zelle 3 für Türen", "Export 12", "time;position_1;torque_1", "ms;degree;Nm"]
    lines += ["0;90;1", "20;180,5;-1,25"]
    chunk = one(write(tmp_path / "a.csv", lines, "cp1252"))
    assert np.allclose(chunk.time, [0.0, 0.02])
    assert np.allclose(chunk.position[:, 0], np.radians([90, 180.5]))
    assert np.allclose(chunk.torque[:, 0], [1.0, -1.25])


@pytest.mark.parametrize(("delimiter", "cell"), [(";", "0,1"), (",", '"0,1"'), ("\t", "-3,5e2")])
def test_a_comma_in_a_column_that_is_not_read_says_nothing_of_the_decimals(tmp_path, delimiter, cell):
    rows = [[*HEADER, "limits", "step"], ["0.00", "0.5", "1.25", cell, "weld"], ["0.01", "0.6", "1.5", cell, cell]]
    path = write(tmp_path / "a.csv", [delimiter.join(row) for row in rows])
    assert one(path).torque[:, 0].tolist() == [1.25, 1.5]
    assert one(path, program={"columns": ["step"]}).torque[:, 0].tolist() == [1.25, 1.5]


def test_bars_between_columns_are_read(tmp_path):
    rows = [HEADER, ["0.00", "0.5", "1.25"], ["0.01", "0.6", "1.5"]]
    assert one(write(tmp_path / "a.csv", ["|".join(row) for row in rows])).torque[:, 0].tolist() == [1.25, 1.5]


@pytest.mark.parametrize(("header", "row"), [("", ";"), (";", ""), (";", ";")])
def test_a_delimiter_at_the_end_of_a_line_makes_no_column(tmp_path, header, row):
    lines = [";".join(HEADER) + header, "0,00;0,5;1,25" + row, "0,01;0,6;1,5" + row]
    assert one(write(tmp_path / "a.csv", lines)).torque[:, 0].tolist() == [1.25, 1.5]


def test_numbers_with_two_decimal_signs_name_the_columns(tmp_path):
    lines = [",".join(HEADER), *(f'{0.01 * k:.2f},0.5,"16,87{k % 10}"' for k in range(50))]
    with pytest.raises(InputError, match=r"column 'torque_1' holds '16,870' and column 'time' '0\.00'"):
        one(write(tmp_path / "a.csv", lines))


def test_points_between_thousands_are_told(tmp_path):
    lines = [";".join(HEADER), *(f"{k};0;{f'{850 + 9 * k:,}'.replace(',', '.')}" for k in range(50))]
    with pytest.raises(InputError, match=r"column 'torque_1' holds '1\.003' beside '994'"):
        one(write(tmp_path / "a.csv", lines), units={"time": "ms"})
    # A joint that stands at a whole number says nothing.
    lines = [";".join(HEADER), *(f"{k};0;{90 if k < 25 else 90.001 + 0.013 * k:.6g}" for k in range(30))]
    assert one(write(tmp_path / "b.csv", lines), units={"time": "ms"}).torque[0, 0] == 90


def test_rows_from_the_newest_to_the_oldest_are_told(tmp_path):
    lines = [",".join(HEADER), *(f"{0.02 * k:.2f},0.1,{k}" for k in range(50, 0, -1))]
    with pytest.raises(InputError, match="its rows run from the newest to the oldest; turn them round"):
        one(write(tmp_path / "a.csv", lines))


@pytest.mark.parametrize("name", ["a.csv.gz", "a.TSV.GZ"])
def test_logs_that_a_logger_packs(tmp_path, name):
    rows = [f"{0.02 * k:.2f},{0.001 * k:.3f},{k}" for k in range(5000)]
    text = "\n".join([",".join(HEADER), *rows]).encode()
    path = tmp_path / name
    path.write_bytes(gzip.compress(text + b"\n"))
    chunks = list(read_log(path, layout_of({}, ["joint_1"]), rows=1000))
    assert np.array_equal(np.concatenate([c.torque[:, 0] for c in chunks]), np.arange(5000.0))
    # A logger that appends writes several packed parts one after another.
    half = text.index(b"\n50.00,") + 1
    path.write_bytes(gzip.compress(text[:half]) + gzip.compress(text[half:] + b"\n"))
    chunks = list(read_log(path, layout_of({}, ["joint_1"]), rows=1000))
    assert sum(len(c.time) for c in chunks) == 5000
    # The last row was cut while it was being written: left out, as of a file that is not packed.
    path.write_bytes(gzip.compress(text + b"\n100.00,5.0"))
    chunks = list(read_log(path, layout_of({}, ["joint_1"]), rows=1000))
    assert sum(len(c.time) for c in chunks) == 5000
    # The file itself was cut: what comes before counts, and the reason is told.
    packed = gzip.compress(text)
    for damaged, rows in ((packed[:-9], 4900), (packed[: len(packed) // 2], 2000)):
        path.write_bytes(damaged)
        found = []
        with pytest.raises(InputError, match="its packing was cut or is damaged"):
            found.extend(read_log(path, layout_of({}, ["joint_1"]), rows=100_000))
        torque = np.concatenate([c.torque[:, 0] for c in found])
        assert np.array_equal(torque, np.arange(float(len(torque))))
        assert len(torque) > rows
    path.write_bytes(b"no gzip at all")
    with pytest.raises(InputError, match="cannot be read"):
        one(path)


@pytest.mark.parametrize(
    ("stamp", "decimal"), [("2026-01-15 06:{:02}:00Z", "."), ("15.01.2026 06:{:02}:00", ","), ("{}", ",")]
)
def test_cells_that_cannot_be_read_are_left_out_alone(tmp_path, stamp, decimal):
    rows = [f"{stamp.format(k)};0{decimal}{k};{k}{decimal}5" for k in range(40)]
    rows[5], rows[7] = rows[5].rpartition(";")[0] + ";#REF!", "later;" + rows[7].partition(";")[2]
    chunk = one(write(tmp_path / "a.csv", [";".join(HEADER), *rows]))
    assert len(chunk.time) == 39
    assert np.flatnonzero(np.isnan(chunk.torque[:, 0])).tolist() == [5]
    assert chunk.torque[-1, 0] == 39.5
    assert chunk.unread == (2, "row 7 has '#REF!' in column 'torque_1'")


def test_what_stands_for_a_missing_value_is_missing(tmp_path):
    chunk = one(write(tmp_path / "a.csv", [",".join(HEADER), "0,0.1,-9999", "1,0.2,3"]))
    assert np.isnan(chunk.torque[0, 0])
    assert chunk.torque[1, 0] == 3.0


def test_shares_of_a_rating_and_decimal_commas_between_commas_are_refused(tmp_path):
    for unit in ("%", "Prozent", "percent"):
        with pytest.raises(InputError, match="'scale' the torque in N m"):
            one(write(tmp_path / "a.csv", [",".join(HEADER), f"s,rad,{unit}", "0,0.1,2.0"]))
    with pytest.raises(InputError, match="are its decimals commas"):
        one(write(tmp_path / "b.csv", [",".join(HEADER), "0,0,1,2,0", "1,0,2,2,0"]))


def test_a_row_cut_while_it_was_written_is_left_out(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(",".join(HEADER) + "\n0,0.1,1\n1,0.2,2\n2,0.")
    assert one(path).time.tolist() == [0.0, 1.0]


@pytest.mark.parametrize(
    ("rows", "times"),
    [
        ("0,0.1,1\n1,0.2\n2,0.3,3", [0, 2]),
        ("0,0.1,1\n1,0.2\n", [0]),
        ("0,0.1,1\n1,0.2,3,4", [0]),
        # What is read again as text, for the sake of one cell, tells of it too.
        ("0,0.1,1\n1,0.2\n2,0.3,3\n3,x,3" + "\n4,0.2,3" * 9, [0, 2, 3, *[4] * 9]),
    ],
)
def test_any_other_row_of_a_wrong_length_is_named_once_the_others_have_been_read(tmp_path, rows, times):
    path, found = tmp_path / "a.csv", []
    path.write_text(",".join(HEADER) + "\n" + rows)

    def read():
        for chunk in read_log(path, layout_of({}, ["joint_1"])):
            found.extend(chunk.time.tolist())

    with pytest.raises(InputError, match=r"a\.csv: row 3 has [24] cells, the header names 3 columns: '1,0\.2"):
        read()
    assert found == times


def test_a_cell_behind_a_row_of_a_wrong_length_is_told_with_its_row_in_the_file(tmp_path):
    path = write(tmp_path / "a.csv", [",".join(HEADER), "0,0.1,1", "1,0.2", *["2,0.3,3"] * 20, "3,x,3", "4,1,1"])
    chunks = read_log(path, layout_of({}, ["joint_1"]))
    assert next(chunks).unread == (1, "row 24 has 'x' in column 'position_1'")


@pytest.mark.parametrize("stamp", ["2026-01-15 06:00:{:05.2f}", "{:.2f}"])
@pytest.mark.parametrize("at", [0, 30])
def test_the_header_once_more_says_nothing(tmp_path, stamp, at):
    rows = [f"{stamp.format(0.02 * k)},{0.1 * k:.1f},{k}" for k in range(50)]
    path = write(tmp_path / "a.csv", [",".join(HEADER), *rows[:at], " , ".join(HEADER), *rows[at:]])
    chunks = list(read_log(path, layout_of({}, ["joint_1"])))
    assert np.concatenate([c.torque[:, 0] for c in chunks]).tolist() == list(range(50))
    assert not any(c.unread[0] for c in chunks)


def test_a_log_ends_at_a_header_in_another_order(tmp_path):
    """The values below it had been read under the names of the first one."""
    first = [f"{0.02 * k:.2f},{0.1 * k:.1f},{k}" for k in range(30)]
    then = [f"{0.02 * k:.2f},{k},{0.1 * k:.1f}" for k in range(30, 60)]
    path = write(tmp_path / "a.csv", [",".join(HEADER), *first, "time,torque_1,position_1", *then])
    read = read_log(path, layout_of({}, ["joint_1"]))
    assert next(read).torque[:, 0].tolist() == list(range(30))
    with pytest.raises(InputError, match="row 32 names the columns anew, in another order: 'torque_1' where 'position"):
        list(read)


def test_many_rows_of_a_wrong_length_are_another_layout(tmp_path):
    path = write(tmp_path / "a.csv", [",".join(HEADER), *["0,0.1"] * (MOST_TORN + 1), "1,0.1,2"])
    with pytest.raises(InputError, match=r"row 2 has 2 cells"):
        one(path)


@pytest.mark.parametrize("header", ["time,tag,value", "_time,_field,_value,robot"])
def test_one_row_for_each_value_is_told_with_the_way_out(tmp_path, header):
    label = header.split(",")[1]
    path = write(
        tmp_path / "a.csv", [header, *(f"{k},position_1,{k}" + ",x" * header.count("robot") for k in range(9))]
    )
    with pytest.raises(
        InputError, match=rf"named in '{label}', which is not read: .*pivot\(index=\.\.\., columns='{label}'"
    ):
        one(path, variables={"time": header.split(",")[0]})


def test_trajectories_with_names_are_told_with_the_way_out(tmp_path):
    rows = [f"{0.01 * k:.2f},{k},1,{'weld' if k < 30 else 'pick'}" for k in range(60)]
    path = write(tmp_path / "a.csv", [",".join([*HEADER, "trajectory"]), *rows])
    with pytest.raises(
        InputError, match=r"'weld' in column 'trajectory', .*; labels of trajectories are whole numbers: count"
    ):
        one(path)


def streams(positions=100.0, torques=100.0, late=0.005, together=0):
    """Lines of two streams of one joint, put together by their times; the first rows of both in one row."""
    place, feel = np.arange(0, 4, 1 / positions), np.arange(0, 4, 1 / torques) + late
    rows = [(t, f"{t:.4f},{np.sin(3 * t):.6f},") for t in place[together:]]
    rows += [(t, f"{t:.4f},,{5 * np.cos(3 * t):.4f}") for t in feel[together:]]
    rows += [(t, f"{t:.4f},{np.sin(3 * t):.6f},{5 * np.cos(3 * t):.4f}") for t in place[:together]]
    return [",".join(HEADER), *(line for _, line in sorted(rows))], feel[together:]


@pytest.mark.parametrize(("positions", "torques"), [(100.0, 100.0), (100.0, 50.0), (50.0, 100.0)])
def test_positions_and_torques_in_rows_of_their_own(tmp_path, positions, torques):
    lines, feel = streams(positions, torques)
    chunk = one(write(tmp_path / "a.csv", lines))
    assert np.allclose(chunk.time, feel)
    inside = feel < feel[-1] - 1 / positions
    assert np.allclose(chunk.position[inside, 0], np.sin(3 * feel[inside]), atol=5e-6)
    assert np.allclose(chunk.torque[:, 0], 5 * np.cos(3 * feel), atol=1e-4)
    found = load_recording({"measured": str(tmp_path / "a.csv")})
    assert np.isfinite(found.position[inside]).all()


def test_a_hole_of_the_positions_stays_one(tmp_path):
    lines, _ = streams()
    lines = [line for line in lines if not (",," not in line and "1.0" <= line < "1.5")]
    chunk = one(write(tmp_path / "a.csv", lines))
    hole = (chunk.time > 0.99) & (chunk.time < 1.5)
    assert np.isnan(chunk.position[hole]).all()
    assert np.isfinite(chunk.position[~hole][:-1]).all()


def test_rows_that_hold_both_are_left_as_they_are(tmp_path):
    for lines in (streams(together=50)[0], streams(10.0, 200.0)[0], streams(200.0, 10.0)[0]):
        chunk = one(write(tmp_path / "a.csv", lines))
        assert len(chunk.time) == len(lines) - 1


@pytest.mark.parametrize(
    ("rows", "lines"), [(["0.06,0.06,1", '0.08,"0.08,1'], 57), (['0.06,"0.06,1', '0.08,0.1",1'], 1)]
)
def test_a_quotation_mark_that_is_not_closed_is_told_with_the_lines_that_it_takes(tmp_path, rows, lines):
    begin = [",".join(HEADER), *(f"{k / 50:.2f},{k / 50:.2f},1" for k in range(3))]
    rest = [f"{k / 50:.2f},{k / 50:.2f},1" for k in range(5, 62)]
    path, told = write(tmp_path / "a.csv", [*begin, *rows, *rest, ""]), []
    try:
        told += [chunk.unread[1] for chunk in read_log(path, layout_of({}, ["joint_1"]))]
    except InputError as error:
        told.append(str(error))
    assert f"row {6 if lines > 1 else 5} has" in told[-1]
    assert f"not closed in its line takes {lines} more line{'s' * (lines > 1)} with it" in told[-1]


@pytest.mark.parametrize(
    "begun",
    [
        "time,position_1,torque_1",
        "time,posi",
        "t",
        "Robot 7\ntime,position_1,torque_1",
        "time,position_1,torque_1\ns,rad,Nm",
    ],
)
@pytest.mark.parametrize("name", ["a.csv", "a.csv.gz"])
def test_a_log_whose_header_is_just_being_written_holds_no_samples(tmp_path, begun, name):
    """It was said to lack columns, which no logger mends: the fleet raised an alarm of a log that had just begun."""
    path = tmp_path / name
    path.write_bytes(gzip.compress(begun.encode()) if name.endswith("gz") else begun.encode())
    with pytest.raises(InputError, match=f"{name}: holds no samples"):
        one(path)
    for ended in (f"{HEADER[0]},{HEADER[1]}\n", f"{HEADER[0]},{HEADER[1]}\n0.0,1.0"):
        with pytest.raises(InputError, match="has no torque"):
            one(write(tmp_path / "b.csv", [ended]))
