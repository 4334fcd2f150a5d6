"""Logs with wrong values end in one clear line or in flagged windows: never in a silent wrong answer."""

import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from monitor_logs import LENGTH, START, columns, flagged, layout, make_log, model, read, survey_of, write_parquet

from jointwear.files.errors import InputError
from jointwear.measurement.checks import axes_check
from jointwear.measurement.flags import DISQUALIFYING, Flag
from jointwear.measurement.refused import Refused
from jointwear.monitor.findings.read_findings import reading_findings
from jointwear.monitor.reading.inspection import ALL_LOGS, Inspector
from jointwear.monitor.reading.later_check import LaterCheck
from jointwear.monitor.reading.logs import log_statistics
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


def test_torques_without_their_sign_in_the_first_log_are_named(tmp_path):
    log = make_log(48.0)
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=np.abs(log.torque))))
    with pytest.raises(Refused, match="recorded without their sign") as error:
        read(path)
    assert with_suggestion(error.value).endswith("record torques, or currents, with their sign")


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
    assert found.refused[0].endswith(ALL_LOGS)
    assert (found.statistics.count == 0).all()
    assert not found.statistics.judgeable.any()


def test_wrong_values_from_the_middle_of_a_log_on(tmp_path, good):
    log, bad = make_log(96.0, seed=3), broken(make_log(96.0, seed=3), "sign")
    half = np.arange(len(log.time))[:, None] >= len(log.time) // 2
    both = {name: np.where(half, getattr(bad, name), getattr(log, name)) for name in ("position", "torque")}
    mixed = replace(log, **both)
    path = write_parquet(tmp_path / "log.parquet", columns(mixed))
    found = log_statistics(str(path), layout(), model(), survey_of(good), LENGTH, block=2400)
    assert "joint 2" in found.refused[0]
    # The key that it names would turn round the logs that are right.
    assert found.refused[0].endswith("where the others are right, mend this log alone")
    assert (found.statistics.count[:3, :5] > 0).all()
    assert (found.statistics.count[5:] == 0).all()


def test_a_remedy_that_is_no_key_is_told_as_it_is(good):
    inspector = Inspector(model(), survey_of(good), "log.csv")
    for remedy in ("write 'torque' of this log as the first log has it", "record longer"):
        inspector.tell(Refused("reason", remedy))
        assert inspector.refused[-1] == f"reason; {remedy}"


def test_one_fault_of_many_parts_is_told_once(tmp_path, good):
    path = write_parquet(tmp_path / "log.parquet", columns(broken(make_log(480.0, seed=6), "degrees")))
    found = log_statistics(str(path), layout(), model(), survey_of(good), LENGTH, block=4800)
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


def test_readings_that_mend_nothing_are_asked_of_some_of_the_samples(tmp_path, good, monkeypatch):
    log, survey = make_log(48.0, seed=6), survey_of(good)
    more = 2.0 * model().dynamics.gravity_torque(log.position)
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=log.torque + more)))
    asked, explained = [], axes_check.explained
    monkeypatch.setattr(
        axes_check, "explained", lambda model, parts, *x: asked.append(len(parts)) or explained(model, parts, *x)
    )
    assert log_statistics(str(path), layout(), model(), survey, LENGTH).refused == ()
    assert asked.count(max(asked)) < 0.2 * len(asked)


@pytest.mark.long
def test_another_load_is_marked_in_every_block(tmp_path, good):
    log = make_log(120.0, seed=7)
    more = 2.0 * model().dynamics.gravity_torque(log.position)
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=log.torque + more)))
    found = log_statistics(str(path), layout(), model(), survey_of(good), LENGTH, block=1500)
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


def test_a_torque_that_is_missing_is_told_unless_it_always_was(tmp_path, good):
    log = make_log(48.0)
    log.torque[:, 3] = np.nan
    s = read(write_parquet(tmp_path / "log.parquet", columns(log)), good).statistics
    count = s.count.copy()
    count[0] = 100
    (told,) = reading_findings(replace(s, count=count), np.arange(s.windows) == 0)
    assert (told["kind"], told["axes"], told["time"]) == ("missing", [4], s.start[1])
    assert not reading_findings(s, np.arange(s.windows) == 0)
    # An odd hour of a shift is counted, not told.
    whole = np.repeat([0, 1], [s.windows - 1, 1])
    assert not reading_findings(replace(s, count=count), np.arange(s.windows) == 0, np.zeros(s.windows, dtype=int))
    (told,) = reading_findings(replace(s, count=count), np.arange(s.windows) == 0, whole)
    assert told["end"] == s.end[-1]


def test_a_frozen_torque_is_not_judged(tmp_path, good):
    log = make_log(48.0)
    log.torque[:, 3] = 1.25
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert flagged(found, Flag.TORQUE_FROZEN, 3)
    assert not found.statistics.judgeable[:, 3].any()
    (told,) = reading_findings(found.statistics)
    assert (told["kind"], told["axes"]) == ("frozen", [4])


@pytest.mark.parametrize("value", [1.25, 0.0])
@pytest.mark.parametrize("axis", [1, 3])
def test_a_torque_that_stands_still_is_told_as_that_and_the_others_go_on(tmp_path, good, axis, value):
    """It looked like a torque of the motor, or a current, of the whole arm."""
    log = make_log(480.0, seed=8)
    log.torque[:, axis] = value
    path = write_parquet(tmp_path / "log.parquet", columns(log))
    found = log_statistics(str(path), layout(), model(), survey_of(good), LENGTH, block=4800)
    assert found.refused == ()
    assert flagged(found, Flag.TORQUE_FROZEN, axis)
    others = np.delete(np.arange(5), axis)
    assert not (found.statistics.flags[:, others] & int(DISQUALIFYING)).any()
    assert found.statistics.judgeable[:, others].all()


@pytest.mark.long
@pytest.mark.parametrize(("factor", "unit"), [(100.0, "N cm"), (1000.0, "mN m"), (1e-3, "kN m")])
def test_a_unit_is_told_by_what_the_robot_itself_had_before(tmp_path, good, factor, unit):
    """A model that lacks most of what turns the wrists: no factor makes it explain these as before."""
    log = make_log(480.0, seed=9)
    more = 0.25 * np.abs(log.torque).max(axis=0) * np.sin(7 * log.time)[:, None]
    quicker = np.array([1, 1, 1, 1, 2.0, 1])
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=factor * quicker * (log.torque + more))))
    found = log_statistics(str(path), layout(), model(), survey_of(good), LENGTH, block=4800)
    (told,) = found.refused
    assert f"about {factor:g} times those of the first log; it looks like {unit}" in told
    assert not found.statistics.judgeable.any()
    # Twice as much of what the model lacks is none.
    path = write_parquet(tmp_path / "other.parquet", columns(replace(log, torque=quicker * (log.torque + more))))
    assert log_statistics(str(path), layout(), model(), survey_of(good), LENGTH, block=4800).refused == ()


def test_what_shows_in_a_whole_block_alone_is_refused_there(tmp_path, good, monkeypatch):
    """Parts just below what is no chance said nothing: a log was told as refused, and all of it judged."""

    def check(self, chunk, stretch, motion, whole, relieved):
        if whole:
            raise Refused("the torques of joints 4 and 5 look swapped", "exchange them")
        return np.zeros(6, dtype=np.int64)

    survey = survey_of(good)
    monkeypatch.setattr(LaterCheck, "__call__", check)
    path = write_parquet(tmp_path / "log.parquet", columns(make_log(480.0, seed=10)))
    found = log_statistics(str(path), layout(), model(), survey, LENGTH, block=4800)
    assert len(found.refused) == 1
    assert (found.statistics.flags & int(Flag.REFUSED) != 0).all()
    assert not found.statistics.judgeable.any()


def test_positions_outside_the_limits_are_not_judged(tmp_path, good):
    log = make_log(48.0)
    log.position[:, 3] += 40.0
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert flagged(found, Flag.OUTSIDE_LIMITS, 3) or found.refused
    # Samples that are refused are told as that, others as positions.
    assert [f["kind"] for f in reading_findings(found.statistics)] == ["refused"]
    plain = replace(found.statistics, flags=found.statistics.flags & ~int(Flag.REFUSED))
    (told,) = reading_findings(plain)
    assert (told["kind"], told["axes"]) == ("outside", [4])
    assert (found.statistics.count == 0).all()


def test_torques_that_stand_far_out_cost_no_window_and_say_so(tmp_path):
    right, log = write_parquet(tmp_path / "right.parquet", columns(make_log(48.0))), make_log(48.0, seed=2)
    torque = log.torque.copy()
    torque[100::200, 1] *= 500.0
    sound, wrong = (
        read(write_parquet(tmp_path / name, columns(replace(log, torque=each))), right)
        for name, each in (("sound.parquet", log.torque), ("wrong.parquet", torque))
    )
    assert flagged(wrong, Flag.NOT_FINITE, 1)
    assert not flagged(wrong, DISQUALIFYING)
    lost = sound.statistics.count - wrong.statistics.count
    assert 0 < lost[:, 1].max() < 20
    assert not np.delete(lost, 1, axis=1).any()


@pytest.mark.parametrize("kind", ["spikes", "stops"])
def test_positions_that_jump_cost_no_window_and_say_so(tmp_path, kind):
    right, log = write_parquet(tmp_path / "right.parquet", columns(make_log(48.0))), make_log(48.0, seed=2)
    position = log.position.copy()
    if kind == "spikes":
        position[100::200, 1] += 0.7
    else:
        # Stopped for a second of its fastest move.
        first = int(np.argmax(np.abs(position[50:, 1] - position[:-50, 1])))
        position[first : first + 50, 1] = position[first, 1]
    wrong = write_parquet(tmp_path / "log.parquet", columns(replace(log, position=position)))
    found = read(wrong, right)
    assert flagged(found, Flag.NOT_FINITE, 1)
    assert not flagged(found, DISQUALIFYING)
    assert found.statistics.count[:, :3].all()
