"""Data sets of discovery: read in every form that a log may have, kept as netCDF and read again."""

import numpy as np
import pytest
from monitor_logs import columns, make_log, write_csv

from jointwear.files.errors import InputError
from jointwear.measurement.checks.checks import check_recording
from jointwear.measurement.recording import Recording, split
from jointwear.measurement.recording_files import load_recording, read_recording, write_recording
from jointwear.robots.robot import load_robot


@pytest.fixture
def log():
    return make_log(4.0)


@pytest.fixture
def recorded(tmp_path, log):
    """The log as a recording, stored as r.nc."""
    temperature = np.full(log.position.shape, 25.0)
    found = Recording(log.time, np.zeros(len(log.time), int), log.position, log.torque, temperature=temperature)
    write_recording(split(found), tmp_path / "r.nc", {"dataset": "x"})
    return split(found)


def load(folder, measured, **entry):
    return load_recording({"measured": measured, **entry}, "data", folder)


def test_what_is_kept_is_read_again(tmp_path, recorded):
    for again in (read_recording(tmp_path / "r.nc"), load(tmp_path, "r.nc")):
        for role in ("time", "trajectory", "position", "torque", "temperature"):
            np.testing.assert_array_equal(getattr(again, role), getattr(recorded, role))
        assert again.velocity is None
    assert (read_recording(tmp_path / "r.nc").train, recorded.test) == (recorded.train, (4,))


def test_a_table_in_other_units(tmp_path, log):
    table = columns(log)
    table |= {name: np.degrees(values) for name, values in table.items() if name.startswith("position")}
    table |= {name: 1e3 * values for name, values in table.items() if name.startswith("torque")}
    write_csv(tmp_path / "r.csv", {**table, "temperature": np.full(len(log.time), 300.0)})
    found = load(tmp_path, "r.csv", units={"position": "deg", "torque": "mN m", "temperature": "K"})
    np.testing.assert_allclose(found.position, log.position, atol=1e-12)
    np.testing.assert_allclose(found.torque, log.torque)
    np.testing.assert_allclose(found.temperature, 26.85)


def test_a_table_as_a_european_spreadsheet_writes_it(tmp_path, log):
    """Semicolons, decimal commas, a row of units, dates, and the current in place of the torque."""
    table = columns(log)
    table |= {name: 2.0 * values for name, values in table.items() if name.startswith("torque")}
    names = [name for name in table if name.partition("_")[0] in ("time", "position", "torque")]
    units = {"time": "", "position": "rad", "torque": "A"}
    lines = ["export of cell 3", ";".join(names), ";".join(units[name.partition("_")[0]] for name in names)]
    for k in range(len(log.time)):
        stamp = f"15.01.2026 06:00:{log.time[k]:06.3f}".replace(".", ",").replace("15,01,", "15.01.")
        lines.append(";".join([stamp, *(f"{table[name][k]:.12f}".replace(".", ",") for name in names[1:])]))
    (tmp_path / "r.csv").write_text("\n".join(lines) + "\n", encoding="cp1252")
    with pytest.raises(InputError, match="give 'torque_constant' in N m/A"):
        load(tmp_path, "r.csv")
    found = load(tmp_path, "r.csv", torque_constant=0.5, sign=[-1, 1, 1, 1, 1, 1])
    turned = np.array([-1, 1, 1, 1, 1, 1])
    np.testing.assert_allclose(found.torque, log.torque * turned, atol=1e-9)
    np.testing.assert_allclose(found.position, log.position * turned, atol=1e-9)
    np.testing.assert_allclose(found.time, log.time - log.time[0], atol=1e-6)


def test_a_word_among_the_numbers_is_told(tmp_path, log):
    table = {name: list(values) for name, values in columns(log).items()}
    table["torque_2"][7] = "broken"
    write_csv(tmp_path / "r.csv", table)
    found = load(tmp_path, "r.csv")
    assert np.argwhere(~np.isfinite(found.torque)).tolist() == [[7, 1]]
    told = "row 9 has 'broken' in column 'torque_2'; what cannot be read was left out as missing"
    assert told in check_recording(found, load_robot("config/robots/puma560.yaml"))
    table["time"][9] = table["position_6"][11] = "x"
    write_csv(tmp_path / "r.csv", table)
    found = load(tmp_path, "r.csv")
    assert len(found.time) == len(log.time) - 1
    assert "and 2 more rows hold such a cell" in found.unread


def test_a_torn_row_costs_itself_and_is_told(tmp_path, log):
    lines = write_csv(tmp_path / "r.csv", columns(log)).read_text().splitlines()
    (tmp_path / "r.csv").write_text("\n".join([*lines[:9], lines[9][:20], *lines[10:]]) + "\n")
    found = load(tmp_path, "r.csv")
    np.testing.assert_allclose(found.position, np.delete(log.position, 8, axis=0), atol=1e-9)
    assert found.unread.startswith("row 10 has ")
    assert found.unread.endswith("; it was left out")
    assert found.unread in check_recording(found, load_robot("config/robots/puma560.yaml"))
    (tmp_path / "r.csv").write_text("\n".join([*lines[:9], *["1,2"] * 10, *lines[10:]]) + "\n")
    assert load(tmp_path, "r.csv").unread.endswith("; it and 9 more rows of a wrong length were left out")
    (tmp_path / "r.csv").write_text("\n".join([*lines[:9], *["1,2"] * 11, *lines[10:]]) + "\n")
    with pytest.raises(InputError, match="row 10 has 2 cells"):
        load(tmp_path, "r.csv")


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"measured": "none.nc"}, "no such file"),
        ({"measured": "r.nc", "variables": {"torque": "tau"}}, "has no variable 'tau'"),
        ({"measured": "r.nc", "variables": {"torqe": "torque"}}, "did you mean 'torque'"),
        ({"measured": "r.nc", "units": {"position": "grad"}}, "unit 'grad' of position"),
        ({"measured": "r.txt"}, "no kind of log"),
    ],
)
def test_wrong_entries_are_named(tmp_path, recorded, entry, words):
    with pytest.raises(InputError, match=words):
        load(tmp_path, **entry)


def test_times_that_do_not_rise_are_told_with_their_place(tmp_path, log):
    table = {name: list(values) for name, values in columns(log).items()}
    # Three rows of 200: which of two rows of one time holds is not known.
    table["time"][31], table["time"][61], table["time"][91] = (table["time"][k] for k in (30, 60, 90))
    write_csv(tmp_path / "r.csv", table)
    with pytest.raises(InputError, match=r"time of sample 32 .* is that of the sample before it, as of 3 of"):
        load(tmp_path, "r.csv")


@pytest.mark.parametrize("order", ["backwards", "mixed"])
def test_rows_in_another_order_are_to_be_sorted(tmp_path, log, order):
    rows = np.arange(len(log.time))[::-1] if order == "backwards" else np.roll(np.arange(len(log.time)), 40)
    table = {name: np.array(values)[rows] for name, values in columns(log).items()}
    write_csv(tmp_path / "r.csv", table)
    told = {
        "backwards": "its rows run from the newest to the oldest; turn them round",
        "mixed": "the time has to rise: sort the rows by time, or label the trajectories",
    }
    with pytest.raises(InputError, match=told[order]):
        load(tmp_path, "r.csv")
    if order == "backwards":
        return
    table["time"][-10] = table["time"][30]
    write_csv(tmp_path / "r.csv", table)
    with pytest.raises(InputError, match="the time has to rise: leave out rows that come twice, or label"):
        load(tmp_path, "r.csv")


def test_rows_that_a_logger_wrote_twice_are_left_out_and_told(tmp_path, log):
    lines = write_csv(tmp_path / "r.csv", columns(log)).read_text().splitlines()
    twice = [*lines[:9], lines[8], *lines[9:30], lines[29], lines[29], *lines[30:]]
    (tmp_path / "r.csv").write_text("\n".join(twice) + "\n")
    found = load(tmp_path, "r.csv")
    np.testing.assert_allclose(found.position, log.position, atol=1e-9)
    assert found.unread == "3 rows were left out as copies of the row before, time and all"
    assert found.unread in check_recording(found, load_robot("config/robots/puma560.yaml"))


def test_the_fewest_rows_without_which_time_rises_are_left_out(tmp_path, log):
    disordered, repeated = "out of order in time", "stamped with the repeated time of another row"
    # Of two rows of one time the step before tells that the first is in its place.
    cases = ((log.time[30], 31, repeated), (log.time[28] + 1e-4, 31, disordered), (log.time[60], 31, disordered))
    for stamp, gone, why in cases:
        table = {name: np.array(values) for name, values in columns(log).items()}
        table["time"][31] = stamp
        write_csv(tmp_path / "r.csv", table)
        found = load(tmp_path, "r.csv")
        np.testing.assert_allclose(found.position, np.delete(log.position, gone, axis=0), atol=1e-9)
        assert found.unread == f"1 row was left out as {why}"


@pytest.mark.parametrize("written", [False, True])
def test_of_rows_of_one_time_the_one_in_its_place_stays(tmp_path, log, written):
    """A clock that stands still leaves the first in its place; rows that are stamped when written the last."""
    table = {name: np.array(values) for name, values in columns(log).items()}
    table["time"][30:33] = log.time[32 if written else 30]
    write_csv(tmp_path / "r.csv", table)
    found = load(tmp_path, "r.csv")
    gone = [30, 31] if written else [31, 32]
    np.testing.assert_allclose(found.position, np.delete(log.position, gone, axis=0), atol=1e-9)
    assert found.unread == "2 rows were left out as stamped with the repeated time of another row"
