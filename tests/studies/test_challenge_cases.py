"""The generator of the hidden-effect test: cases that are what they claim, and truth that stays out of the data."""

import ast
import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.files.errors import InputError
from jointwear.files.storage import open_dataset, read_variables
from jointwear.reproduction.wear import Wear
from jointwear.robots.inertia import reach_of_link
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import load_task
from jointwear.studies.challenge import examples, structure_forms
from jointwear.studies.challenge.arm import Arm, inertial_columns, with_one_wrong_parameter, with_wrong_parameters
from jointwear.studies.challenge.arms import ARMS, arm_of, arm_path, given_robot
from jointwear.studies.challenge.batch import generate_batch
from jointwear.studies.challenge.case_files import padded, read_truth
from jointwear.studies.challenge.generate import TEST, circumstances_of, generate
from jointwear.studies.challenge.hide import DRAW, draw_hidden
from jointwear.studies.challenge.motion import fourier_path, transfer_paths
from jointwear.studies.challenge.plan import Case, batches, cases
from jointwear.studies.challenge.scene import scene_of
from jointwear.studies.challenge.sensors import felt_noise, torque_noise
from jointwear.studies.challenge.separability import sieve_world
from jointwear.studies.challenge.surroundings import Temperatures, start_times, temperatures
from jointwear.studies.challenge.tiers import BATCH, COUNTS, EFFECTS, FULL, OUTSIDE, SEED, TIERS
from jointwear.studies.challenge.tracking import ArmLost, track, tuned_down
from jointwear.studies.challenge.world import build_world

PROJECT = Path(__file__).resolve().parents[2]
ROBOT = "config/robots/puma560.yaml"


@pytest.fixture(scope="module")
def robot():
    return load_robot(PROJECT / ROBOT)


@pytest.fixture(scope="module")
def world(robot):
    rng = np.random.default_rng(4)
    paths = [fourier_path(robot, rng, np.full(6, 1.2)) for _ in range(4)]
    return build_world(Arm(robot), paths, start_times(rng, 4, 5.0), temperatures(rng, 4, 6), samples=500, interval=0.01)


def test_counts_are_those_of_the_test_as_it_was_set():
    assert len(EFFECTS) == 19
    assert len(OUTSIDE) == 10
    assert FULL == {"single": 380, "nothing": 350, "retuned": 60, "two": 150, "outside": 120}
    singles = [c.subject for c in cases("report", "dirty", FULL) if c.kind == "single"]
    assert {singles.count(name) for name in EFFECTS} == {20}


@settings(deadline=None)
@given(st.sampled_from(sorted(COUNTS)), st.sampled_from(sorted(TIERS)), st.integers(1, 60))
def test_batches_hold_every_case_once(seed_set, tier, size):
    dealt = [c for batch in batches(seed_set, tier, COUNTS[seed_set], size) for c in batch]
    assert sorted(c.name for c in dealt) == sorted(c.name for c in cases(seed_set, tier, COUNTS[seed_set]))
    assert max(map(len, batches(seed_set, tier, COUNTS[seed_set], size))) <= size
    assert BATCH[seed_set] > 0


def test_unknown_words_are_refused():
    with pytest.raises(InputError, match="did you mean 'factory'"):
        cases("report", "factori", FULL)
    with pytest.raises(InputError, match="nearest valid value is 1"):
        batches("report", "clean", FULL, 0)


def test_the_generator_knows_nothing_of_what_searches():
    """The score would mean nothing if generator and library shared a formula."""
    folder = PROJECT / "workflow/jointwear/studies/challenge"
    for path in folder.glob("*.py"):
        imported = {
            name
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            for name in (
                [a.name for a in node.names]
                if isinstance(node, ast.Import)
                else [node.module or ""]
                if isinstance(node, ast.ImportFrom)
                else []
            )
        }
        assert not any(name.startswith("jointwear.effects") for name in imported), path.name
        if path.name != "solve.py":
            assert not any(name.startswith("jointwear.discovery") for name in imported), path.name


def test_a_case_depends_on_its_words_alone(robot):
    case = Case("choose", "factory", "nothing", 3)
    one, again = generate(case, robot, SEED), generate(case, robot, SEED)
    np.testing.assert_array_equal(one[0].torque, again[0].torque)
    other = generate(Case("sample", "factory", "nothing", 3), robot, SEED)
    assert other[0].torque.shape != one[0].torque.shape or not np.array_equal(other[0].torque, one[0].torque)


@pytest.mark.long
@pytest.mark.parametrize("tier", sorted(TIERS))
@pytest.mark.parametrize("kind", ["single", "nothing", "retuned", "two", "outside"])
def test_cases_of_every_kind(tier, kind):
    case = Case("choose", tier, kind, 1)
    robot = load_robot(arm_path(arm_of(case, SEED)))
    data, truth = generate(case, robot, SEED)
    recordings = len(data.train) + 1
    assert recordings in (4, 5)
    assert data.test == (TEST,)
    how = circumstances_of(case, robot, SEED)
    assert data.torque.shape == (recordings * round(how.duration / how.interval), robot.joints)
    assert truth.torque.shape == truth.measured.shape == truth.given.shape
    assert np.isfinite(data.torque).all()
    assert np.all(data.position > robot.lower)
    assert np.all(data.position < robot.upper)
    assert np.all(np.diff(data.time) > 0)
    hidden = {"single": 1, "outside": 1, "two": 2}.get(kind, 0)
    assert len(truth.facts["effects"]) == len(truth.effects) == hidden
    assert (truth.facts["wrong_parameter"] is not None) == (kind == "retuned")
    held = data.torque[data.trajectory == TEST][::5]
    moving = np.isfinite(truth.torque)
    spread = np.abs(np.where(moving, held - truth.torque, 0)).max(axis=0)
    assert np.all(spread <= 6 * np.array(truth.facts["noise"]))


def test_clean_case_without_effect_is_the_nominal_model_and_noise(robot):
    made = (
        generate(c, robot, SEED)
        for c in cases("choose", "clean", {"nothing": 40})
        if (how := circumstances_of(c, robot, SEED)).torque == "motor" and how.interval >= 0.01
    )
    data, truth = next((d, t) for d, t in made if d.acceleration is not None)
    rest = data.torque - Arm(robot).torque(data.position, data.velocity, data.acceleration)
    moving = np.abs(data.velocity) > 0.02
    ratio = [rest[moving[:, k], k].std() / truth.facts["noise"][k] for k in range(6)]
    np.testing.assert_allclose(ratio, 1, atol=0.05)


def test_temperatures_do_not_follow_time():
    rng = np.random.default_rng(0)
    for _ in range(50):
        level = temperatures(rng, 4, 6).level.mean(axis=1)
        assert abs(np.corrcoef(level, np.arange(4))[0, 1]) < 0.75


@pytest.mark.parametrize("kind", ["fourier", "transfer"])
def test_paths_have_consistent_derivatives(robot, kind):
    rng = np.random.default_rng(1)
    path = fourier_path(robot, rng, np.ones(6)) if kind == "fourier" else transfer_paths(robot, rng, 1, 6.0)[0]
    t = np.linspace(0.5, 5.5, 200)
    h = 1e-5
    _, v, a = path.at(t)
    np.testing.assert_allclose((path.at(t + h)[0] - path.at(t - h)[0]) / (2 * h), v, atol=1e-6)
    np.testing.assert_allclose((path.at(t + h)[1] - path.at(t - h)[1]) / (2 * h), a, atol=1e-5)


def test_wrong_parameters_are_off_by_the_share_that_is_asked_for(robot):
    off = with_wrong_parameters(robot, np.random.default_rng(2), 0.05, 0.10)
    np.testing.assert_allclose(np.abs(off.viscous / robot.viscous - 1), 0.10)
    np.testing.assert_allclose(abs(off.links[1].mass / robot.links[1].mass - 1), 0.05)
    np.testing.assert_allclose(off.links[1].inertia, off.links[1].inertia.T)
    one = with_one_wrong_parameter(robot, "motor_inertia", 2, -0.3)
    np.testing.assert_allclose(one.armature / robot.armature, [1, 1, 0.7, 1, 1, 1])


def test_inertial_columns_are_the_derivatives_of_the_torque(robot, world):
    s = world.state
    columns = inertial_columns(robot, s.position[:50], s.velocity[:50], s.acceleration[:50])
    shares = np.full(len(columns), 1e-4)
    links = tuple(
        type(link)(link.mass * (1 + 1e-4), link.com * (1 + 1e-4), link.inertia * (1 + 1e-4)) for link in robot.links
    )
    arms = Arm(replace(robot, links=links)), Arm(robot)
    change = arms[0].load(s.position[:50], s.velocity[:50], s.acceleration[:50]) - arms[1].load(
        s.position[:50], s.velocity[:50], s.acceleration[:50]
    )
    np.testing.assert_allclose(np.tensordot(shares, columns, 1), change, atol=2e-3 * np.abs(change).max())


@pytest.mark.parametrize("name", sorted(DRAW))
def test_every_hidden_thing_acts_where_it_says(world, name):
    rng = np.random.default_rng(5)
    for _ in range(3):
        hidden = draw_hidden(name, scene_of(world), rng)
        torque = hidden.term(world)
        assert torque.shape == world.state.torque.shape
        assert np.isfinite(torque).all()
        assert np.abs(torque).max() > 0
        if hidden.axis is not None:
            assert set(np.flatnonzero(np.abs(torque).max(axis=0))) <= {hidden.axis, *hidden.also}


@pytest.mark.parametrize("form", sorted(structure_forms.FORMS))
@settings(max_examples=25, deadline=None)
@given(steps=st.lists(st.floats(-0.02, 0.02), min_size=2, max_size=80))
def test_presliding_stays_within_coulomb_friction_and_saturates(form, steps):
    state = structure_forms.FORMS[form](np.array(steps), 0.03, 0.0)
    assert np.all(np.abs(state) <= 1 + 1e-9)
    slid = structure_forms.FORMS[form](np.array([*steps, *[0.02] * 60]), 0.03, 0.0)
    assert slid[-1] == pytest.approx(1, abs=1e-6)


def test_a_stiff_joint_is_a_rigid_joint(world):
    rng = np.random.default_rng(0)
    scene = scene_of(world)
    draws = [structure_forms.flexibility(scene, rng, 1) for _ in range(12)]
    draws.sort(key=lambda h: h.size)
    # The mean, not the largest: near a reversal friction may still meet the motor before the link.
    size = [np.abs(h.term(world)[:, 1]).mean() for h in draws]
    assert size[-1] < 0.3 * size[0]


def test_a_short_delay_is_the_derivative_of_the_torque(world):
    late = world.torque_before(0.001)
    ahead = world.torque_before(-0.001)
    now = world.torque_before(0.0)
    # Away from reversals the torque is smooth: what a delay takes, an advance gives.
    smooth = np.abs(world.state.velocity) > 0.1
    np.testing.assert_allclose((late - now)[smooth], -(ahead - now)[smooth], atol=2e-3 * np.abs(now).max())


def test_a_lag_makes_no_steps_of_a_jump(world):
    """Friction that turns shows behind a current filter as an exponential, not as a staircase."""
    scene, clock = scene_of(world), np.linspace(-0.02, 0.15, 3401)
    draws = (structure_forms.delay(scene, np.random.default_rng(k), 0) for k in range(20))
    lag = next(h for h in draws if h.form == "lag")
    jump = SimpleNamespace(torque_before=lambda delay: np.outer(clock > delay, np.ones(scene.joints)))
    after = np.maximum(clock, 0.0) / lag.size
    np.testing.assert_allclose(lag.term(jump)[:, 0], 1 - np.exp(-after) - (clock > 0), atol=0.01)


def test_closed_loop_obeys_its_own_dynamics(robot):
    rng = np.random.default_rng(3)
    arm = Arm(with_wrong_parameters(robot, rng, 0.05, 0.1))
    paths = [fourier_path(robot, rng, np.full(6, 1.0))]
    (moved,) = track(arm, Arm(robot), paths, np.zeros(1), _steady(), 1.0, 4.0)
    moving = np.all(np.abs(moved.velocity) > 0.05, axis=1)
    expected = arm.torque(moved.position, moved.velocity, moved.acceleration)
    np.testing.assert_allclose(moved.torque[moving], expected[moving], rtol=1e-3, atol=1e-3)
    error = np.abs(moved.position - paths[0].at(np.arange(len(moved.position)) * moved.step)[0]).max()
    assert 1e-6 < error < 0.1


def test_a_loop_that_is_tuned_too_high_is_tuned_down(robot, monkeypatch):
    arm = Arm(robot)
    paths = [fourier_path(robot, np.random.default_rng(3), np.full(6, 1.0))]
    drive = partial(track, arm, arm, paths, np.zeros(1), _steady(), 0.3)
    (moved,) = tuned_down(drive, paths, 160.0, "puma560")
    error = moved.position - paths[0].at(np.arange(len(moved.position)) * moved.step)[0]
    assert np.abs(error).max() < 0.1
    monkeypatch.setattr("jointwear.studies.challenge.tracking._TRIES", 1)
    with pytest.raises(ArithmeticError, match="the controller loses 'puma560' even at 160 Hz"):
        tuned_down(drive, paths, 160.0, "puma560")


def _steady():
    return Temperatures(np.full((1, 6), 30.0), np.zeros((1, 6)), np.ones((1, 6)))


def test_noise_has_the_deviation_and_colour_that_are_asked_for():
    noise = torque_noise(np.random.default_rng(0), np.array([2.0, 0.1]), 0.9, 20, 2000)
    np.testing.assert_allclose(noise.std(axis=0), [2.0, 0.1], rtol=0.05)
    lagged = np.corrcoef(noise[:-1, 0], noise[1:, 0])[0, 1]
    assert lagged == pytest.approx(0.9, abs=0.01)


def test_sieve_removes_what_the_model_can_retune_and_keeps_the_rest(robot, world):
    train = world.state.recording != 2
    sieve = sieve_world(world, robot, train, np.full(6, 0.1), 0.0, 0.05)
    s = world.state
    retuned = Arm(with_one_wrong_parameter(robot, "coulomb_friction", 0, 0.3))
    change = retuned.torque(s.position, s.velocity, s.acceleration) - s.torque
    assert sieve.energy(change) < 1e-3 * np.sum((change[train] / 0.1) ** 2)
    wave = np.zeros_like(change)
    wave[:, 3] = np.sin(40 * s.time)
    raw = np.sum((wave[train & (np.abs(s.velocity[:, 3]) > 0.01)] / 0.1) ** 2)
    assert sieve.energy(wave) == pytest.approx(raw, rel=0.1)
    assert sieve.energy(wave, [2 * wave]) < 1e-6 * raw


def test_what_links_may_be_off_by_cannot_be_seen_zeros_among_them(robot, world):
    """The tiers judge what can be seen as the tier "world" does: links are known as well as discovery takes them."""
    train = world.state.recording != 2
    sieve = sieve_world(world, robot, train, np.full(6, 0.01), 0.0, 0.05)
    s, links = world.state, list(robot.links)
    wrist = links[3]
    one_deviation = 0.05 * 0.25 * reach_of_link(wrist.mass, wrist.com, wrist.inertia)
    assert not wrist.com.all()
    links[3] = replace(wrist, com=wrist.com + one_deviation * (wrist.com == 0))
    moved = Arm(replace(robot, links=tuple(links)))
    change = moved.torque(s.position, s.velocity, s.acceleration) - s.torque
    assert sieve.energy(change) <= np.count_nonzero(wrist.com == 0)
    assert np.sum((change[train] / 0.01) ** 2) > 100.0


@pytest.mark.long
def test_batch_files_keep_the_truth_apart(tmp_path, monkeypatch):
    monkeypatch.chdir(PROJECT)
    listed = [
        Case("choose", "clean", "single", 7),
        Case("choose", "clean", "two", 0),
        Case("choose", "clean", "nothing", 0),
    ]
    generate_batch(listed, SEED, tmp_path / "data", tmp_path / "truth.json", tmp_path / "truth.nc")
    truths = read_truth(tmp_path / "truth.json", tmp_path / "truth.nc")
    assert [len(t.effects) for t in truths] == [1, 2, 0]
    for path in (tmp_path / "data").iterdir():
        if path.suffix == ".json":
            text = path.read_text()
        else:
            with open_dataset(path) as dataset:
                text = json.dumps({k: str(dataset.getncattr(k)) for k in dataset.ncattrs()}) + " ".join(
                    dataset.variables
                )
        assert not any(name in text for name in (*EFFECTS, *OUTSIDE, "nothing", "two"))


def test_arrays_of_several_shapes_are_filled_up():
    stacked = padded([np.ones((2, 3)), np.zeros((4, 1))])
    assert stacked.shape == (2, 4, 3)
    assert np.nansum(stacked) == 6
    assert np.isnan(stacked).sum() == 6 + 8
    assert padded([], (5, 2)).shape == (0, 5, 2)


def test_six_arms_take_turns_and_their_files_hold_a_robot():
    drawn = [arm_of(c, SEED) for c in cases("report", "clean", {"nothing": 300})]
    assert {name: drawn.count(name) > 30 for name in ARMS} == dict.fromkeys(ARMS, True)
    assert len(ARMS) >= 6
    for name in ARMS:
        robot = load_robot(arm_path(name))
        assert robot.name == name
        assert robot.dh is not None


def test_logs_differ_in_rate_side_and_torque(robot):
    hows = [circumstances_of(c, robot, SEED) for c in cases("report", "dirty", {"nothing": 200})]
    assert {round(1 / h.interval) for h in hows} == {30, 50, 100, 125, 200, 250, 500, 1000}
    assert {h.torque for h in hows} == {"motor", "command", "link_sensor"}
    assert {h.link_side for h in hows} == {True, False}
    assert {h.controller for h in hows} == {None, "pd", "pid"}
    singles = [(c, circumstances_of(c, robot, SEED)) for c in cases("report", "dirty", {"single": 380})]
    sensed = {c.subject for c, h in singles if h.torque == "link_sensor"}
    assert sensed <= {"payload", "mounting_tilt", "torque_constant_error", "torque_constant_temperature"}


def test_a_sensor_behind_the_gears_knows_no_drive():
    case = {"robot": ROBOT, "told": {"torque_kind": "link_sensor"}}
    robot = given_robot(case)
    assert not robot.armature.any()
    assert not robot.coulomb_positive.any()


def test_encoder_steps_are_felt_through_the_inertia():
    quiet = felt_noise(np.array([0.1]), np.array([0.0]), np.array([5.0]), 125)
    coarse = felt_noise(np.array([0.1]), np.array([2 * np.pi / 2**13]), np.array([5.0]), 125)
    assert quiet == pytest.approx(0.1)
    assert coarse > 5 * quiet


def test_shipped_example_is_what_the_generator_makes(robot):
    data, truth, facts = examples.hidden_example(robot)
    path = PROJECT / "data/examples/puma560_hidden.nc"
    time, position, torque, temperature = read_variables(path, "time", "position", "torque", "temperature")
    np.testing.assert_allclose(time, data.time)
    np.testing.assert_allclose(position, data.position, atol=1e-4)
    np.testing.assert_allclose(torque, data.torque, rtol=1e-5, atol=1e-3)
    np.testing.assert_allclose(temperature, data.temperature, atol=0.11)
    assert facts["effect"] == examples.EXAMPLE["effect"]
    assert path.stat().st_size < 400_000
    assert np.abs(truth).max() < 500


def test_warm_task_hides_the_temperature_in_one_axis(robot):
    task = load_task(PROJECT / "config/tasks/T2.yaml")
    told = examples.WarmTask(hours=24, every=4, interval=0.5, axis=1, wear=Wear(20, 1.5, 24.0), wear_axis=2, noise=0.0)
    data, torque = examples.warm_task_data(robot, task, told, seed=1)
    rest = torque - Arm(robot).torque(data.position, data.velocity, data.acceleration)
    assert np.abs(rest[:, 2:]).max() < 1e-9
    assert np.abs(rest[:, 0]).max() > 0.05
    moving = np.abs(data.velocity[:, 0]) > 1e-3
    share = rest[moving, 0] / (robot.viscous[0] * data.velocity[moving, 0])
    assert np.corrcoef(share, data.temperature[moving, 0])[0, 1] < -0.95
    last = data.trajectory == data.trajectory.max()
    moving = np.abs(data.velocity[:, 1]) > 1e-3
    level = np.where(data.velocity[:, 1] > 0, robot.coulomb_positive[1], robot.coulomb_negative[1])
    growth = (rest[:, 1] / level)[last & moving]
    assert 0.05 < growth.mean() < 0.21
    assert set(data.train).isdisjoint(data.test)


def test_a_case_whose_arm_no_controller_holds_is_left_out_and_told(tmp_path, monkeypatch, capsys):
    def held_or_lost(case, nominal, seed):
        if case.index == 1:
            raise ArmLost("the controller loses 'panda' even at 0.5 Hz")
        return generate(case, nominal, seed)

    monkeypatch.setattr("jointwear.studies.challenge.batch.generate", held_or_lost)
    held, lost = (Case("choose", "dirty", "nothing", index) for index in (0, 1))
    generate_batch([held, lost], SEED, tmp_path / "data", tmp_path / "truth.json", tmp_path / "truth.nc")
    for listed in (tmp_path / "data/cases.json", tmp_path / "truth.json"):
        assert [case["case"] for case in json.loads(listed.read_text())["cases"]] == [held.name]
    assert f"{lost.name} is no case: the controller loses 'panda'" in capsys.readouterr().err
