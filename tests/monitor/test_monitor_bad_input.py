"""Bad logs end in one clear line or in flagged windows: never in a traceback, never in a silent wrong answer."""

import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from monitor_logs import (
    LENGTH,
    START,
    columns,
    flagged,
    layout,
    make_log,
    model,
    read,
    write_bag,
    write_csv,
    write_netcdf,
    write_parquet,
)

from jointwear.files.errors import InputError
from jointwear.measurement.flags import DISQUALIFYING, Flag
from jointwear.monitor.findings import reading_findings
from jointwear.monitor.logs import log_statistics
from jointwear.monitor.plan import find_logs
from jointwear.monitor.survey import survey_log
from jointwear.running.script import with_suggestion


def broken(log, kind):
    """A log with one thing wrong."""
    position, torque = log.position.copy(), log.torque.copy()
    velocity, acceleration = log.velocity.copy(), log.acceleration.copy()
    match kind:
        case "degrees":
            position = np.degrees(position)
        case "swapped":
            position, torque = (x[:, [1, 0, 2, 3, 4, 5]] for x in (position, torque))
        case "sign":
            position[:, 1] *= -1
            torque[:, 1] *= -1
        case "torque sign":
            torque[:, 2] *= -1
        case "motor torque":
            torque[:, 1] /= model().robot.gear_ratio[1]
    return replace(log, position=position, torque=torque, velocity=velocity, acceleration=acceleration)


WRONG = {
    "degrees": r"look like degrees.*units",
    "swapped": r"joints 1 and 2 look swapped",
    "sign": r"the sign of joint 2 looks flipped",
    "torque sign": r"the sign of the torque of joint 3 looks flipped",
    "motor torque": r"torque of joint 2 looks like that of the motor",
}


def test_revolutions_in_the_first_log_are_named(tmp_path):
    path = tmp_path / "log.nc"
    with xr.open_dataset("data/examples/monitor_puma560/day_1.nc") as shipped:
        shipped.assign(position=shipped["position"] / (2 * np.pi)).to_netcdf(path)
    with pytest.raises(InputError, match="look like revolutions"):
        read(path)
    assert read(path, units={"position": "rev"}).statistics.count[:, :5].any()


@pytest.mark.parametrize("kind", WRONG)
def test_wrong_values_in_the_first_log_are_named(tmp_path, kind):
    path = write_parquet(tmp_path / "log.parquet", columns(broken(make_log(48.0), kind)))
    with pytest.raises(InputError) as error:
        read(path)
    assert re.search(WRONG[kind], with_suggestion(error.value))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", WRONG)
def test_wrong_values_in_a_later_log_refuse_its_windows(tmp_path, good, kind):
    path = write_parquet(tmp_path / "log.parquet", columns(broken(make_log(48.0, seed=2), kind)))
    found = read(path, good)
    assert len(found.refused) == 1
    assert WRONG[kind].split(".*")[0] in found.refused[0]
    assert (found.statistics.count == 0).all()
    assert not found.statistics.judgeable.any()


def test_wrong_values_from_the_middle_of_a_log_on(tmp_path, good):
    log, bad = make_log(96.0, seed=3), broken(make_log(96.0, seed=3), "sign")
    half = np.arange(len(log.time))[:, None] >= len(log.time) // 2
    both = {name: np.where(half, getattr(bad, name), getattr(log, name)) for name in ("position", "torque")}
    mixed = replace(log, **both)
    path = write_parquet(tmp_path / "log.parquet", columns(mixed))
    survey = survey_log(str(good), layout(), model(), LENGTH)
    found = log_statistics(str(path), layout(), model(), survey, LENGTH, block=2400)
    assert "joint 2" in found.refused[0]
    assert (found.statistics.count[:3, :5] > 0).all()
    assert (found.statistics.count[5:] == 0).all()


def test_one_fault_of_many_parts_is_told_once(tmp_path, good):
    path = write_parquet(tmp_path / "log.parquet", columns(broken(make_log(480.0, seed=6), "degrees")))
    survey = survey_log(str(good), layout(), model(), LENGTH)
    found = log_statistics(str(path), layout(), model(), survey, LENGTH, block=4800)
    assert len(found.refused) == 1
    assert (found.statistics.count == 0).all()


def test_a_good_later_log_is_not_refused(tmp_path, good):
    for seed, change in ((4, 1.0), (5, 1.3)):
        log = make_log(48.0, seed=seed)
        worn = log.torque + (change - 1) * np.sign(log.velocity) * model().robot.coulomb_positive
        found = read(write_parquet(tmp_path / f"{seed}.parquet", columns(replace(log, torque=worn))), good)
        assert found.refused == ()
        assert (found.statistics.count[:, :5] > 0).all()


def test_another_load_is_marked_but_not_refused(tmp_path, good):
    log = make_log(48.0, seed=6)
    more = 2.0 * model().dynamics.gravity_torque(log.position)
    found = read(write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=log.torque + more))), good)
    assert found.refused == ()
    assert flagged(found, Flag.UNEXPLAINED)
    assert not Flag.UNEXPLAINED & DISQUALIFYING


def test_another_load_is_marked_in_every_block(tmp_path, good):
    log = make_log(120.0, seed=7)
    more = 2.0 * model().dynamics.gravity_torque(log.position)
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=log.torque + more)))
    survey = survey_log(str(good), layout(), model(), LENGTH)
    found = log_statistics(str(path), layout(), model(), survey, LENGTH, block=1500)
    assert found.refused == ()
    assert (found.statistics.flags[:, :5] & int(Flag.UNEXPLAINED) != 0).all()


def test_a_torque_that_is_never_finite_concerns_its_axis_alone(tmp_path):
    table = columns(make_log(48.0))
    table["torque_2"][:] = np.nan
    found = read(write_parquet(tmp_path / "log.parquet", table))
    assert (found.statistics.count[:, 1] == 0).all()
    assert (found.statistics.count[:, 0] > 0).all()
    assert flagged(found, Flag.NOT_FINITE, 1)
    assert not flagged(found, Flag.NOT_FINITE, 0)


def test_a_position_that_is_never_finite_is_refused(tmp_path, good):
    table = columns(make_log(48.0))
    table["position_3"] = np.full_like(table["position_3"], np.nan)
    path = write_parquet(tmp_path / "log.parquet", table)
    with pytest.raises(InputError, match="position of joint 3 is never a finite number"):
        read(path)
    found = read(path, good)
    assert (found.statistics.count == 0).all()
    assert flagged(found, Flag.NOT_FINITE, 2)


def test_holes_in_the_positions_cost_their_surroundings(tmp_path, good):
    table = columns(make_log(48.0))
    table["position_1"] = np.where((np.arange(2400) // 20) % 30 == 5, np.nan, table["position_1"])
    found, whole = read(write_parquet(tmp_path / "log.parquet", table), good), read(good)
    assert found.statistics.count[:, 0].sum() < 0.95 * whole.statistics.count[:, 0].sum()
    assert found.statistics.count[:, 0].sum() > 0.5 * whole.statistics.count[:, 0].sum()


@pytest.mark.parametrize(("factor", "words"), [(-1.0, "-1 times"), (57.29578, "looks like degrees"), (2.0, "2 times")])
def test_a_velocity_that_is_none_of_the_position(tmp_path, good, factor, words):
    log = make_log(48.0)
    log.velocity[:, 2] *= factor
    path = write_parquet(tmp_path / "log.parquet", columns(log, "position", "velocity", "torque"))
    with pytest.raises(InputError, match=f"velocity of joint 3 .*{words}"):
        read(path)
    found = read(path, good)
    assert words in found.refused[0]
    assert (found.statistics.count == 0).all()


@pytest.mark.parametrize("roles", [("position", "torque"), ("position", "velocity", "torque")])
def test_positions_counted_within_one_turn(tmp_path, roles):
    log = make_log(48.0)
    turned = replace(log, position=log.position + np.array([2.4, 0, 0, 0, 0, 0]))
    within = replace(turned, position=np.mod(turned.position + np.pi, 2 * np.pi) - np.pi)
    assert np.abs(np.diff(within.position[:, 0])).max() > 6
    found = [read(write_parquet(tmp_path / f"{k}.parquet", columns(x, *roles))) for k, x in enumerate((turned, within))]
    assert found[1].refused == ()
    whole = [f.statistics for f in found]
    np.testing.assert_allclose(whole[1].count, whole[0].count, atol=4)
    np.testing.assert_allclose(whole[1].moment, whole[0].moment, atol=0.02 * np.abs(whole[0].moment).max())


def test_a_second_rate_in_the_rows_is_bridged(tmp_path, good):
    log = make_log(48.0, rate=200.0)
    table = columns(log)
    for j in range(6):
        table[f"position_{j + 1}"] = np.where(np.arange(len(log.time)) % 4, np.nan, table[f"position_{j + 1}"])
    found = read(write_parquet(tmp_path / "log.parquet", table), good)
    assert found.statistics.share_used[0, 0] > 0.8


def test_a_clock_that_goes_back_flags_its_window(tmp_path, good):
    log = make_log(48.0)
    found = read(write_parquet(tmp_path / "log.parquet", columns(replace(log, time=np.tile(log.time[:1200], 2)))), good)
    assert flagged(found, Flag.CLOCK_RESET)
    assert found.statistics.samples.sum() == 2400
    assert found.statistics.windows == 4


def test_an_hour_that_comes_twice_is_told(tmp_path):
    log = make_log(48.0, start=START)
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, time=np.tile(log.time[:1200], 2))))
    (told,) = reading_findings(read(path).statistics)
    assert told["kind"] == "set_back"
    assert "summer time" in told["words"]


def test_a_frozen_torque_is_not_judged(tmp_path, good):
    log = make_log(48.0)
    log.torque[:, 3] = 1.25
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert flagged(found, Flag.TORQUE_FROZEN, 3)
    assert not found.statistics.judgeable[:, 3].any()


def test_positions_outside_the_limits_are_not_judged(tmp_path, good):
    log = make_log(48.0)
    log.position[:, 3] += 40.0
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert flagged(found, Flag.OUTSIDE_LIMITS, 3) or found.refused
    assert (found.statistics.count == 0).all()


FILES = {
    "empty.csv": (lambda p: p.write_text(""), "is empty"),
    "header.csv": (lambda p: p.write_text(",".join(columns(make_log(1.0))) + "\n"), "holds no samples"),
    "numbers.csv": (lambda p: p.write_text("1,2,3\n4,5,6\n"), "header line"),
    "words.csv": (
        lambda p: write_csv(p, columns(make_log(1.0)) | {"torque_2": np.full(50, "=cmd()")}),
        "cannot be read as CSV",
    ),
    "ragged.csv": (
        lambda p: p.write_text(write_csv(p, columns(make_log(1.0))).read_text() + "1,2,3\n"),
        "row 52 has 3 cells",
    ),
    "date.csv": (lambda p: write_csv(p, columns(make_log(1.0)) | {"time": np.full(50, "yesterday")}), "ISO 8601"),
    "binary.csv": (lambda p: p.write_bytes(bytes(range(256)) * 20), "UTF-8"),
    "empty.parquet": (lambda p: p.write_bytes(b""), "not a Parquet file"),
    "text.parquet": (lambda p: p.write_text("time,position_1\n" * 50), "not a Parquet file"),
    "cut.parquet": (
        lambda p: p.write_bytes(write_parquet(p, columns(make_log(2.0))).read_bytes()[:-600]),
        "truncated or not a Parquet file",
    ),
    "empty.nc": (lambda p: p.write_bytes(b""), "netCDF"),
    "cut.nc": (lambda p: p.write_bytes(write_netcdf(p, make_log(9.0)).read_bytes()[:9000]), r"cut\.nc"),
    "empty.mcap": (lambda p: p.write_bytes(b""), "is empty"),
    "noise.mcap": (lambda p: p.write_bytes(os.urandom(5000)), "not a ROS 2 bag"),
    "noise.db3": (lambda p: p.write_bytes(b"SQLite format 3\0" + bytes(500)), "ROS 2 bag|damaged"),
    "few.csv": (lambda p: write_csv(p, {k: v for k, v in columns(make_log(1.0)).items() if k != "torque_6"}), "5 col"),
    "gap.csv": (lambda p: write_csv(p, {k: v for k, v in columns(make_log(1.0)).items() if k != "torque_3"}), "gaps"),
    "none.csv": (
        lambda p: write_csv(p, {k: v for k, v in columns(make_log(1.0)).items() if "torq" not in k}),
        "torque",
    ),
    "slow.csv": (lambda p: write_csv(p, columns(make_log(300.0, rate=2.0))), "log velocity and acceleration"),
    "twice.csv": (lambda p: p.write_text("time,time\n1,2\n"), "twice"),
    "words.parquet": (
        lambda p: write_parquet(p, columns(make_log(1.0)) | {"position_1": np.full(50, "x")}),
        "'position_1' holds string",
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_what_cannot_be_read_ends_in_one_line(tmp_path, good, name):
    make, words = FILES[name]
    path = tmp_path / name
    make(path)
    with pytest.raises(InputError, match=words) as error:
        read(path)
    assert "\n" not in str(error.value)
    assert name in str(error.value)
    if name != "slow.csv":
        later = read(path, good)
        assert len(later.refused) == 1
        assert name in later.refused[0]


def test_one_cell_that_cannot_be_read_costs_no_window(tmp_path, good):
    table = {name: list(values) for name, values in columns(make_log(48.0)).items()}
    table["position_1"][1000] = "?"
    found = read(write_csv(tmp_path / "log.csv", table), good)
    (words,) = found.refused
    assert "log.csv: row 1002 has '?' in column 'position_1'" in words
    assert len(found.statistics.count) == 4
    assert found.statistics.judgeable[:, :5].all()


def test_cells_that_cannot_be_read_for_long_end_the_log_with_row_and_column(tmp_path, good):
    table = {name: list(values) for name, values in columns(make_log(48.0)).items()}
    table["torque_2"][500:] = ["?"] * (len(table["time"]) - 500)
    (words,) = read(write_csv(tmp_path / "log.csv", table), good).refused
    assert "row 502 has '?' in column 'torque_2', which is not a number" in words


def test_a_bag_without_effort_says_so(tmp_path):
    with pytest.raises(InputError, match="carry no effort"):
        read(write_bag(tmp_path / "bag", make_log(2.0), effort=False))


def test_a_bag_without_joint_states_says_what_it_has(tmp_path):
    folder = write_bag(tmp_path / "bag", make_log(2.0))
    with pytest.raises(InputError, match=r"topic '/joint_stats'; did you mean '/joint_states'"):
        read(folder, topic="/joint_stats")


def test_a_cut_bag_ends_in_one_line(tmp_path):
    file = next(write_bag(tmp_path / "bag", make_log(20.0)).glob("*.mcap"))
    file.write_bytes(file.read_bytes()[:-3000])
    with pytest.raises(InputError, match=r"\.mcap: is (truncated|damaged)"):
        read(file)


def test_unknown_roles_and_units_are_named(tmp_path, good):
    with pytest.raises(InputError, match=r"'variables' has the role 'torqe'; did you mean 'torque'"):
        read(good, variables={"torqe": "x"})
    with pytest.raises(InputError, match=r"unit 'degre' of position is not known; did you mean 'deg'"):
        read(good, units={"position": "degre"})


def test_dates_and_no_dates_do_not_mix(tmp_path, good):
    found = read(write_parquet(tmp_path / "log.parquet", columns(make_log(24.0, start=START))), good)
    assert "cannot be put in order" in found.refused[0]
    assert found.statistics.windows == 0


def test_links_do_not_lead_out_of_the_folder(tmp_path, good):
    inside = tmp_path / "logs"
    inside.mkdir()
    (inside / "a.parquet").write_bytes(good.read_bytes())
    assert find_logs([f"{inside}/*.parquet"]) == [f"{inside}/a.parquet"]
    (inside / "b.parquet").symlink_to(good)
    with pytest.raises(InputError, match=r"b\.parquet' leads outside the folder"):
        find_logs([f"{inside}/*.parquet"])
    with pytest.raises(InputError, match="matches no file"):
        find_logs([f"{inside}/*.csv"])
    (inside / "notes.txt").write_text("x")
    with pytest.raises(InputError, match="no kind of log"):
        find_logs([f"{inside}/*.txt"])


def test_logs_come_in_the_order_of_their_numbers(tmp_path):
    for k in (1, 2, 10):
        (tmp_path / f"log_{k}.csv").write_text("x")
    assert [Path(p).name for p in find_logs([f"{tmp_path}/*.csv"])] == ["log_1.csv", "log_2.csv", "log_10.csv"]


def outcome(path, first):
    """Statistics, or the line that says why there are none."""
    try:
        return read(path, first)
    except InputError as error:
        return str(error)


def ends_well(path, good):
    """A log ends in an InputError of one line, or in statistics without nonsense."""
    for first in (None, good):
        found = outcome(path, first)
        if isinstance(found, str):
            assert "\n" not in found
            continue
        statistics = found.statistics
        for name in ("gram", "moment", "square", "residual_square", "score", "lag_square", "travel"):
            assert np.isfinite(getattr(statistics, name)).all(), name
        assert (statistics.square >= 0).all()
        assert (statistics.count <= statistics.samples[:, None]).all()
        assert all("\n" not in line for line in found.refused)


FUZZ = settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture(scope="module")
def whole_files(tmp_path_factory):
    """Content of one log in every format, the same for every example."""
    folder, log = tmp_path_factory.mktemp("whole"), make_log(10.0)
    paths = [
        write_csv(folder / "x.csv", columns(log)),
        write_parquet(folder / "x.parquet", columns(log)),
        write_netcdf(folder / "x.nc", log),
        next(write_bag(folder / "bag", log).glob("*.mcap")),
    ]
    return {f"x{path.suffix}": path.read_bytes() for path in paths}


@FUZZ
@given(data=st.data(), name=st.sampled_from(["x.csv", "x.parquet", "x.nc", "x.mcap"]))
def test_flipped_bytes(tmp_path, good, whole_files, data, name):
    path = tmp_path / name
    content = bytearray(whole_files[name])
    for _ in range(data.draw(st.integers(1, 12))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(bytes(content[: data.draw(st.integers(0, len(content)))]))
    ends_well(path, good)


@FUZZ
@given(data=st.data())
def test_mangled_columns(tmp_path, good, data):
    table = columns(make_log(20.0), "position", "torque", "velocity")
    wild = st.sampled_from([np.nan, np.inf, -np.inf, 1e300, -1e300, 0.0, 1e-300])
    for name in data.draw(st.lists(st.sampled_from(list(table)), max_size=5)):
        values = table[name].copy()
        how = data.draw(st.sampled_from(["all", "some", "scale", "shuffle", "reverse"]))
        if how == "all":
            values[:] = data.draw(wild)
        elif how == "some":
            start = data.draw(st.integers(0, len(values) - 1))
            values[start : start + data.draw(st.integers(1, 400))] = data.draw(wild)
        elif how == "scale":
            with np.errstate(all="ignore"):
                values *= data.draw(st.sampled_from([-1.0, 57.3, 1e6, 1e-6, 0.0]))
        elif how == "shuffle":
            np.random.default_rng(0).shuffle(values)
        else:
            values = values[::-1].copy()
        table[name] = values
    with np.errstate(all="ignore"):
        ends_well(write_parquet(tmp_path / "mangled.parquet", table), good)
