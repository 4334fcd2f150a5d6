"""A later torque in another unit, without sign or at a limit is told and not judged; wear and gains are judged."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from monitor_logs import (
    LENGTH,
    ROOT,
    TASK,
    Log,
    columns,
    flagged,
    layout,
    make_log,
    model,
    read,
    survey_of,
    write_parquet,
)

from jointwear.measurement.checks.torque_scale import off_scale, shared_scale
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats import layout_of, read_log
from jointwear.measurement.refused import Refused
from jointwear.monitor.findings.read_findings import reading_findings
from jointwear.monitor.reading import misreadings, other_scales
from jointwear.monitor.reading.derivation import derive_motion
from jointwear.monitor.reading.later_check import LaterCheck
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.other_readings import OtherReadings
from jointwear.monitor.reading.other_scales import OtherScales, beyond_loads, largest_torque
from jointwear.monitor.reading.survey import survey_log
from jointwear.monitor.reading.windows import blank_statistics
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Link, load_robot
from jointwear.robots.trajectory import Task

SCALES = {
    "current": -1.0 / np.array([11.8, -23.6, 10.8, -5.7, -4.7, -5.1]),
    "share of a rating": 100 / np.array([97.6, 186.4, 89.4, 24.2, 20.1, 21.3]),
    "N mm": np.full(6, 1e3),
    "kgf m": np.full(6, 1 / 9.80665),
}
#: How it is told; a unit that is a power of ten of N m by what the robot had before.
TOLD = dict.fromkeys(SCALES, "another multiple") | {"N mm": "about 1000 times those of the first log"}


@pytest.mark.parametrize("kind", SCALES)
def test_a_later_torque_in_another_unit_is_refused(tmp_path, good, kind):
    log = make_log(48.0, seed=12)
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=log.torque * SCALES[kind])))
    found = read(path, good)
    assert len(found.refused) == 1
    assert TOLD[kind] in found.refused[0]
    assert "write the torque of this log" in found.refused[0]
    assert (found.statistics.count == 0).all()


@pytest.mark.parametrize("role", ["torque", "position"])
def test_a_later_column_of_another_joint_is_refused(tmp_path, good, role):
    log = make_log(48.0, seed=12)
    values = getattr(log, role).copy()
    values[:, 4] = values[:, 3]
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, **{role: values})))
    found = read(path, good)
    assert f"the {role} of joint 5 is that of joint 4 in most samples in which one of them moves" in found.refused[0]
    assert (found.statistics.count == 0).all()
    with pytest.raises(Refused, match=f"the {role} of joint 5 is that of joint 4"):
        survey_of(path)


def test_a_later_torque_of_one_joint_that_is_held_is_refused(tmp_path, good):
    log = make_log(48.0, seed=12)
    torque = log.torque.copy()
    torque[:, 2] = torque[np.arange(len(torque)) // 5 * 5, 2]
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=torque)))
    found = read(path, good)
    assert "rows repeat the torque of joint 3 before 100 % of its changes in motion" in found.refused[0]
    assert (found.statistics.count == 0).all()
    with pytest.raises(Refused, match="the torque of joint 3 before 100 %"):
        survey_of(path)


def test_later_radians_where_degrees_are_stated_are_refused_and_an_arm_at_rest_is_not(tmp_path):
    """Read as degrees nothing seems to move, and no torque contradicts the model."""
    entry = {"units": {"position": "deg"}}
    log, later, rng = make_log(48.0, seed=11), make_log(48.0, seed=12), np.random.default_rng(3)
    first = write_parquet(tmp_path / "first.parquet", columns(replace(log, position=np.degrees(log.position))))
    (refused,) = read(write_parquet(tmp_path / "rad.parquet", columns(later)), first, **entry).refused
    assert "they look like rad" in refused
    held = np.degrees(later.position[:1]) + 1e-3 * rng.standard_normal(later.position.shape)
    torque = later.torque[:1] + 0.01 * rng.standard_normal(later.torque.shape)
    rest = write_parquet(tmp_path / "rest.parquet", columns(replace(later, position=held, torque=torque)))
    found = read(rest, first, **entry)
    assert found.refused == ()
    assert (found.statistics.count == 0).all()


def hurried(log, times):
    """A log in which all moves of another take so many times less, over and over."""
    motion = TASK.motion((times * (log.time - log.time[0])) % (log.time[-1] - log.time[0]))
    speed, change = times * motion.velocity, times**2 * motion.acceleration
    return replace(log, position=motion.position, torque=model()(motion.position, speed, change).total)


@pytest.mark.parametrize("times", [1.1, 1.2, 2.0])
def test_fast_radians_that_are_above_the_dead_bands_now_and_then_are_refused_too(tmp_path, times):
    """A robot that turned by 1.9 rad/s seemed to turn by 0.03, for 5 % of the time: nothing was said."""
    log, entry = make_log(48.0, seed=11), {"units": {"position": "deg"}}
    first = write_parquet(tmp_path / "first.parquet", columns(replace(log, position=np.degrees(log.position))))
    fast = hurried(make_log(48.0, seed=12), times)
    (refused,) = read(write_parquet(tmp_path / "rad.parquet", columns(fast)), first, **entry).refused
    assert "they look like rad" in refused


@pytest.mark.long
def test_a_flipped_axis_is_told_though_the_model_fits_the_others_better_than_in_the_first_log(tmp_path):
    first, rng = make_log(48.0, seed=11), np.random.default_rng(2)
    first.torque[:, [0, 2, 3, 4, 5]] *= 1 + 0.5 * rng.standard_normal((len(first.time), 5))
    first = write_parquet(tmp_path / "first.parquet", columns(first))
    log = make_log(48.0, seed=12)
    log.torque[:, 1] *= -1
    (refused,) = read(write_parquet(tmp_path / "log.parquet", columns(log)), first).refused
    assert "the sign of the torque of joint 2 looks flipped" in refused


@pytest.mark.parametrize(
    ("roles", "told", "key"),
    [
        (["torque"], "sign of the torque of", "give 'scale' with -1 for each"),
        (["position"], "sign of the position of", "give 'sign' and 'scale' with -1 for each"),
        (["position", "torque"], "sign of", "give 'sign' with -1 for each"),
    ],
)
def test_a_later_log_in_which_every_joint_is_turned_is_refused(tmp_path, good, roles, told, key):
    log = make_log(48.0, seed=12)
    turned = {role: -getattr(log, role) for role in roles}
    found = read(write_parquet(tmp_path / "log.parquet", columns(replace(log, **turned))), good)
    (refused,) = found.refused
    assert f"the {told} joints 1, 2, 3, 4, 5 and 6 looks flipped against the first log" in refused
    assert key in refused
    assert (found.statistics.count == 0).all()


@pytest.mark.parametrize("axes", [slice(2, 3), slice(None)])
@pytest.mark.parametrize("factor", [0.74, 1.05, 1.15, 1.3])
def test_a_gain_is_no_other_unit(tmp_path, good, axes, factor):
    log = make_log(48.0, seed=13)
    log.torque[:, axes] *= factor
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert found.refused == ()
    assert found.statistics.judgeable[:, :5].all()


@pytest.mark.parametrize(("axes", "times"), [([2], 5.0), ([0], 3.0), (slice(None), 3.0)])
def test_friction_that_multiplied_is_judged(tmp_path, good, axes, times):
    log = make_log(48.0, seed=14)
    robot = model().robot
    log.torque[:, axes] += (times - 1) * (np.sign(log.velocity) * np.abs(robot.coulomb_positive))[:, axes]
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert found.refused == ()
    assert found.statistics.judgeable[:, :5].all()


@pytest.mark.long
def test_a_torque_that_the_model_does_not_know_is_not_judged(tmp_path, good):
    log = make_log(48.0, seed=15)
    whole = np.abs(log.torque)
    found = read(write_parquet(tmp_path / "abs.parquet", columns(replace(log, torque=whole))), good)
    assert not found.statistics.judgeable[:, :5].any()
    log.torque[:, 2] = np.random.default_rng(0).permutation(log.torque[:, 2])
    found = read(write_parquet(tmp_path / "log.parquet", columns(log)), good)
    assert found.refused == ()
    assert flagged(found, Flag.CONTRADICTED, 2)
    assert not found.statistics.judgeable[:, 2].any()
    assert found.statistics.judgeable[:, :2].all()
    (told,) = reading_findings(found.statistics)
    assert told["axes"] == [3]
    assert "fits neither the model nor the first log" in told["words"]
    assert told["kind"] == "contradicted"


def test_a_torque_that_was_never_explained_in_a_program_is_told_once_and_is_no_fault():
    program, baseline = np.tile([0, 1], 20), np.arange(40) < 16
    s = blank_statistics(3600.0 * np.arange(40), 3600.0, np.ones(3))
    s.flags[program == 1, 2] = int(Flag.CONTRADICTED)
    (told,) = reading_findings(s, baseline, None, program)
    assert (told["kind"], told["axes"], told["time"]) == ("contradicted_since", [3], s.start[1])
    assert "20 windows of programs that were so in the normal period already (1 of its 2 programs)," in told["words"]
    assert "one 'payload', which holds in all programs" in told["words"]
    assert "end" not in told
    # What comes later in another program is told as before.
    s.flags[30, 2] = int(Flag.CONTRADICTED)
    assert [f["kind"] for f in reading_findings(s, baseline, None, program)] == ["contradicted_since", "contradicted"]
    labels = np.where(program == 1, '{"weld": 9}', '{"pick": 9}').astype(object)
    (named, _) = reading_findings(replace(s, labels=labels), baseline, None, program)
    assert "already (program 'weld'), the torque of axis 3" in named["words"]
    s.flags[program == 1, 2] = np.where(baseline[program == 1], 0, int(Flag.CONTRADICTED))
    assert {f["kind"] for f in reading_findings(s, baseline, None, program)} == {"contradicted"}


def test_another_unit_from_the_middle_of_a_log_on(tmp_path, good):
    log = make_log(96.0, seed=3)
    log.torque[len(log.time) // 2 :] *= 1000.0
    path = write_parquet(tmp_path / "log.parquet", columns(log))
    found = log_statistics(str(path), layout(), model(), survey_of(good), LENGTH)
    assert TOLD["N mm"] in found.refused[0]
    assert (found.statistics.count[:3, :5] > 0).all()
    assert (found.statistics.count[4:] == 0).all()


def test_what_lies_at_a_limit_of_the_torque_is_left_out(tmp_path, good):
    log = make_log(48.0, seed=16)
    limit = 0.7 * np.abs(log.torque[:, 1]).max()
    log.torque[:, 1] = np.clip(log.torque[:, 1], -limit, limit)
    path = write_parquet(tmp_path / "log.parquet", columns(log))
    found = read(path)
    at_limit = np.abs(log.torque[:, 1]) == np.abs(log.torque[:, 1]).max()
    assert at_limit.sum() > 50
    assert found.statistics.count[:, 1].sum() < (~at_limit).sum()
    assert flagged(found, Flag.SATURATED, 1)
    assert not flagged(found, Flag.SATURATED, 0)
    assert found.statistics.judgeable[:, 1].all()
    (told,) = reading_findings(found.statistics)
    assert told["axes"] == [2]
    assert "limit" in told["words"]


ARM = load_robot(ROOT / "data/arms/ur10.yaml")
#: Points of two programs [deg], time from one to the next [s], and where the centre of their products lies [m].
FAR = (
    [
        [-70, -111, 99, -20, 12, -27], [83, -76, 61, 7, 54, -27], [37, -111, 115, 13, -12, -39],
        [32, -79, 39, -74, 8, 72], [-57, -84, 49, -79, 49, 14],
    ], 1.5, [0.0, 0.1, 0.25],
)  # fmt: skip
NEAR = (
    [
        [62, -106, 80, -46, -46, -21], [-13, -65, 96, -88, -39, 19], [-75, -30, 105, -86, 11, 20],
        [-89, -104, 45, -35, 11, -9], [76, -47, 66, -66, -23, 65],
    ], 3.0, [0.0, 0.0, 0.05],
)  # fmt: skip


def with_product(mass, centre):
    return replace(ARM, payload=Link(mass, np.array(centre), 0.001 * mass * np.eye(3)))


def log_with_product(path, program, mass, scale=1.0, drives=0.0, part=0.0, seconds=24.0, stretched=1.0):
    """A log of an arm with `mass` at its flange, and with a `part` more on the moves from its second to its fourth
    point; its time is `stretched` by a factor."""
    points, pace, centre = program
    motion = Task("product", np.radians(points), np.full(5, pace)).motion(np.arange(round(50 * seconds)) / 50.0)
    free, held = (
        Dynamics(with_product(m, centre)).rigid_body_torque(motion.position, motion.velocity, motion.acceleration)
        for m in (mass, mass + part)
    )
    torque = np.where(np.isin(motion.time // pace % 5, (1, 2))[:, None], held, free)
    torque = torque + Dynamics(ARM).friction_torque(motion.velocity) + drives * motion.acceleration
    torque += 0.02 * torque.std(axis=0) * np.random.default_rng(round(10 * mass)).standard_normal(torque.shape)
    log = Log(stretched * motion.time, motion.position, motion.velocity, motion.acceleration, scale * torque)
    return str(write_parquet(path / f"log_{mass}.parquet", columns(log)))


#: The arm as a URDF has it: no friction, no motor inertia, no load.
BARE = replace(
    ARM, viscous=np.zeros(6), coulomb_positive=np.zeros(6), coulomb_negative=np.zeros(6), armature=np.zeros(6)
)


@pytest.mark.long
@pytest.mark.parametrize(
    ("program", "first", "later", "inertia"),
    [(FAR, 2.0, 10.0, 0.0), (FAR, 2.0, 10.0, 0.3), (NEAR, 6.0, 2.0, 0.3), (NEAR, 10.0, 2.0, 0.3)],
)
def test_a_file_without_friction_and_load_costs_no_log_and_another_unit_is_told(
    tmp_path, program, first, later, inertia
):
    reading = layout_of({}, ARM.joint_names), TorqueModel(BARE)
    drives = inertia * np.array([3.0, 3.0, 3.0, 1.0, 1.0, 1.0])
    survey = survey_log(log_with_product(tmp_path, program, first, drives=drives), *reading, LENGTH)
    path = log_with_product(tmp_path, program, later, drives=drives)
    assert log_statistics(path, *reading, survey, LENGTH).refused == ()
    for kind in ("current", "N mm", "kgf m"):
        wrong = log_with_product(tmp_path, program, first, SCALES[kind], drives)
        with pytest.raises(Refused, match=r"multiple of the model's|looks like mN m"):
            survey_log(wrong, *reading, LENGTH)


@pytest.mark.parametrize("factor", [190.0, -273.0])
def test_a_factor_is_one_only_where_the_torque_is_as_large_as_it_says(factor):
    """Bodies that ask next to nothing of a wrist, beside friction that no file has, fit a part by a factor."""
    motion = Task("product", np.radians(FAR[0]), np.full(5, FAR[1])).motion(np.arange(1200) / 50.0)
    robot = replace(BARE, links=[replace(k, mass=1e-3 * k.mass, inertia=1e-3 * k.inertia) for k in BARE.links])
    torque = Dynamics(robot).rigid_body_torque(motion.position, motion.velocity, motion.acceleration)
    torque[:, 4] *= factor
    torque += Dynamics(ARM).friction_torque(motion.velocity)
    values = {name: getattr(motion, name) for name in ("position", "velocity", "acceleration")}
    measured = SimpleNamespace(**values, torque=torque, usable=np.abs(motion.velocity) > 0.02)
    largest = largest_torque(measured)
    for first, told in ((largest, None), (largest / abs(factor), factor), (np.full(6, np.nan), factor)):
        scale = OtherScales(Dynamics(robot), "log", first, lambda *_: np.zeros(6), measured, "N m").off_scale(measured)
        assert (scale is None) if told is None else scale[4] == pytest.approx(told, rel=0.05)


@pytest.mark.long
@pytest.mark.parametrize("seconds", [44.0, 56.0])
def test_a_part_on_some_moves_is_a_load_in_a_log_that_is_looked_at_in_parts_too(tmp_path, seconds):
    """From 48 s on a log with another load is looked at in parts of a few seconds, which need not show it."""
    reading = layout_of({}, ARM.joint_names), TorqueModel(BARE)
    survey = survey_log(log_with_product(tmp_path, NEAR, 0.0, seconds=seconds), *reading, LENGTH)
    path = log_with_product(tmp_path, NEAR, 0.0, part=8.0, seconds=seconds)
    found = log_statistics(path, *reading, survey, LENGTH)
    assert found.refused == ()
    assert not flagged(found, Flag.CONTRADICTED)


@pytest.mark.long
def test_a_part_on_some_moves_is_no_factor_of_all_torques(tmp_path):
    """It loads most joints alike, and a load that is carried all the time explains it no better than a factor."""
    reading = layout_of({}, ARM.joint_names), TorqueModel(BARE)
    survey = survey_log(log_with_product(tmp_path, NEAR, 2.0, seconds=30.0), *reading, LENGTH)

    def refused(scale):
        path = log_with_product(tmp_path, NEAR, 2.0, scale, part=3.5, seconds=30.0)
        return "".join(log_statistics(path, *reading, survey, LENGTH).refused)

    assert not refused(1.0)
    assert "gravity and inertial torques of all joints are about" in refused(2.0)


def test_a_clock_is_asked_again_without_the_part_that_a_first_log_shows(tmp_path, monkeypatch):
    def refuse(*_):
        raise Refused("time looks stretched", "divide the times")

    monkeypatch.setattr(misreadings, "check_time_scale", refuse)
    reading = layout_of({}, ARM.joint_names), TorqueModel(ARM)
    survey_log(log_with_product(tmp_path, FAR, 0.0, part=5.0), *reading, LENGTH)
    for more in ({"part": 5.0, "stretched": 1.25}, {}):  # without a load that shows nothing acquits it
        with pytest.raises(Refused, match="time looks stretched"):
            survey_log(log_with_product(tmp_path, FAR, 0.0, **more), *reading, LENGTH)


def test_a_torque_that_the_model_does_not_follow_is_refused_for_its_size(tmp_path):
    log = make_log(40.0)
    noise = 0.5 * log.torque.std(axis=0) * np.random.default_rng(0).standard_normal(log.torque.shape)
    # The factors of the axes are not clear then.
    path = write_parquet(tmp_path / "log.parquet", columns(replace(log, torque=1e3 * (log.torque + noise))))
    with pytest.raises(Refused, match=r"the torque of joint 2 is about 1320 times what the bodies") as refused:
        survey_log(str(path), layout(), model(), LENGTH)
    assert "units" in refused.value.suggestion


@pytest.mark.long
@pytest.mark.parametrize("mass", [0.1, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("program", [FAR, NEAR])
def test_another_product_is_no_other_unit_and_another_unit_is_told_beside_it(tmp_path, program, mass):
    reading = layout_of({}, ARM.joint_names), TorqueModel(with_product(6.0, program[2]))
    survey = survey_log(log_with_product(tmp_path, program, 6.0), *reading, LENGTH)

    def found(scale):
        return log_statistics(log_with_product(tmp_path, program, mass, scale), *reading, survey, LENGTH)

    assert found(1.0).refused == ()
    for kind in ("current", "N mm", "kgf m"):
        wrong = found(SCALES[kind])
        assert any(words in "".join(wrong.refused) for words in ("another multiple", TOLD[kind])), kind
        assert (wrong.statistics.count == 0).all()


def test_torques_that_are_all_halved_are_told_where_no_factor_is_clear(good):
    """Joint by joint the factors of halved torques lie about two, beside a load that is picked up in between too."""
    log, robot = make_log(48.0, seed=12), model().robot
    body = Link(1.0, np.array([0.05, -0.03, 0.1]), np.eye(3) * 0.003)
    carried = TorqueModel(replace(robot, payload=body))(log.position, log.velocity, log.acceleration).total
    torque = np.where((np.floor(log.time / 3) % 2 == 1)[:, None], carried, log.torque)
    parts = np.stack([log.position, log.velocity, log.acceleration, torque], axis=1)
    usable = np.abs(log.velocity) > 0.02
    for factor, told in ((0.5, 0.5), (2.0, 2.0), (1.0, None), (1.3, None)):
        scaled = parts * np.array([1, 1, 1, factor])[:, None]
        found = shared_scale(Dynamics(robot), scaled, usable)
        assert found == (told and pytest.approx(told, rel=0.25))


@pytest.mark.parametrize(("damping", "coulomb"), [(4.0, 0.0), (6.0, 0.0), (0.2, 3.0), (1.0, 1.0)])
def test_friction_of_the_file_that_is_far_off_is_no_factor_of_all_torques_and_hides_none(damping, coulomb):
    """A URDF states friction as its author guessed it, so that the ratio of torques changes with the speed."""
    log, robot = make_log(48.0, seed=12), model().robot
    levels = {k: coulomb * getattr(robot, k) for k in ("coulomb_positive", "coulomb_negative")}
    stated = Dynamics(replace(robot, viscous=damping * robot.viscous, **levels))
    parts = np.stack([log.position, log.velocity, log.acceleration, log.torque], axis=1)
    usable = np.abs(log.velocity) > 0.02
    for factor, told in ((0.1, 0.1), (0.5, 0.5), (1.0, None), (1.3, None), (2.0, 2.0), (10.0, 10.0)):
        found = shared_scale(stated, parts * np.array([1, 1, 1, factor])[:, None], usable)
        assert found == (told and pytest.approx(told, rel=0.25)), factor


def test_gravity_and_inertia_that_are_too_small_beside_friction_tell_no_factor():
    log, robot = make_log(48.0, seed=12), model().robot
    light = replace(robot, links=[replace(k, mass=1e-6, inertia=1e-6 * k.inertia) for k in robot.links])
    light = replace(light, armature=np.full(6, 1e-6))
    torque = Dynamics(robot).friction_torque(log.velocity)
    parts = np.stack([log.position, log.velocity, log.acceleration, 2.0 * torque], axis=1)
    usable = np.abs(log.velocity) > 0.02
    assert shared_scale(Dynamics(light), parts, usable) is None
    assert shared_scale(Dynamics(light), parts, usable, nominal_friction=True) == pytest.approx(2.0, rel=0.25)


def test_factors_beside_a_load_are_none_where_those_without_one_are_about_one():
    """Of a few seconds of a slow arm that carries a part, and of torques in mN m of the same arm."""
    beside = np.array([138.0, -6.9, 26.9, 6.2, 43.3, 1.0])
    assert not beyond_loads(beside, np.array([1.15, 1.36, 0.97, 1.04, 1.0, -2.3]), 6)
    assert beyond_loads(1e3 * np.ones(6), np.array([1.0, 870.0, 1060.0, 918.0, 1.0, 940.0]), 6)


def test_one_move_with_a_part_is_no_other_unit_where_the_part_shows_in_the_moves_beside_it(tmp_path, monkeypatch):
    """Factors of a wrist explain six seconds with a part as well; those of a wrist without it may be anything."""
    path = log_with_product(tmp_path, NEAR, 0.0, part=8.0, seconds=12.0)
    chunk = next(iter(read_log(path, layout_of({}, ARM.joint_names), 10_000)))
    stretch, bare = np.zeros(len(chunk.time), dtype=int), TorqueModel(BARE)
    motion = derive_motion(chunk, stretch, np.full(6, 10.0))
    free = bare(motion.position, motion.velocity, motion.acceleration).total + Dynamics(ARM).friction_torque(
        motion.velocity
    )
    found = [np.array([1.5, 1.5, 13.0, 3.5, 1.0, 1.0])] * 2

    def off(samples, robot, load_free=False, asked=None):
        if found:
            return found.pop()
        assert asked.tolist() == [False, False, True, True, False, False]
        return off_scale(samples, robot, load_free, asked)

    monkeypatch.setattr(other_scales, "off_scale", off)
    monkeypatch.setattr(other_scales, "without_load", lambda *_: None)
    monkeypatch.setattr(other_scales, "gained_by", lambda *_: 100.0)
    monkeypatch.setattr(OtherScales, "_explains", lambda *_: True)
    monkeypatch.setattr(OtherScales, "left_over", lambda *_: 0.5)
    monkeypatch.setattr(OtherReadings, "find", lambda *_: [])
    for torque, fits in ((free, True), (None, False)):
        found[:] = [np.array([1.5, 1.5, 13.0, 3.5, 1.0, 1.0])] * 2
        check = LaterCheck(bare.dynamics, np.full(6, 0.02), [0.02] * 6, "log")
        if fits:
            check(chunk, stretch, motion, False, lambda torque=torque: torque)
        else:
            with pytest.raises(Refused, match="another multiple"):
                check(chunk, stretch, motion, False, lambda torque=torque: torque)
