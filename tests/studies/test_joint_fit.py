"""One experiment for the whole paper: its engine against those of the workflow, its search, its papers, its scores."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.reproduction.control_limits import q_limit
from jointwear.reproduction.detection import onset
from jointwear.reproduction.readings import ambiguities
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import load_task
from jointwear.studies.joint_fit import figures
from jointwear.studies.joint_fit.arm_evidence import region_evidence, walk
from jointwear.studies.joint_fit.confirmation import full_reading, pose_set
from jointwear.studies.joint_fit.detection import READINGS, Grid, PcaReading, TaskOutcome, detect, limits, onsets
from jointwear.studies.joint_fit.distance import Weights, agreeing_cells, detection_cost, same_signs, table_cost
from jointwear.studies.joint_fit.divergence import Divergence, cumulative_counts
from jointwear.studies.joint_fit.levels import Noise, task_levels
from jointwear.studies.joint_fit.noise_bank import draw_bank
from jointwear.studies.joint_fit.paper import Prior, read_paper, shuffled_paper, synthetic_paper
from jointwear.studies.joint_fit.paper_fit import JointExperiment, PaperFit, Plan, choose_reading
from jointwear.studies.joint_fit.pose_search import Arm, LocalSearch, improve
from jointwear.studies.joint_fit.posterior import closest, nearest
from jointwear.studies.joint_fit.records import read_experiments, write_experiments
from jointwear.studies.joint_fit.scores import Scores, score
from jointwear.studies.joint_fit.summary import pairs
from jointwear.studies.joint_fit.trade import Emphasis, bases, search_on
from jointwear.studies.multiverse.evaluation import Analysis, evaluate
from jointwear.studies.multiverse.shared_torque import SharedExperiment

ROOT = Path(__file__).resolve().parents[2]
SMALL = Plan(
    strata=2,
    first_starts=6,
    first_keep=2,
    descent=4,
    walk=4,
    starts=8,
    keep=3,
    members=2,
    local=LocalSearch(rounds=4),
    replicates=3,
)


@pytest.fixture(scope="module")
def paper():
    return read_paper(ROOT / "config/paper/published.yaml")


@pytest.fixture(scope="module")
def unloaded():
    return load_robot(ROOT / "config/robots/puma560.yaml")


@pytest.fixture(scope="module")
def experiment():
    """The shipped arm and tasks T1 and T2 twice, there and back in half a cycle each."""
    robot = load_robot(ROOT / "config/robots/puma560_paper.yaml")
    tasks = [load_task(ROOT / f"config/tasks/{name}.yaml") for name in ("T1", "T2", "T2")]
    arm = Arm(float(robot.payload.mass), float(robot.payload.com[2]), 1.0)
    start, stop = (np.array([t.waypoints[k] for t in tasks]) for k in range(2))
    phase = np.array([t.phase for t in tasks])
    return JointExperiment(arm, PcaReading("centred", "four", 5), start, stop, phase, np.zeros(3))


@pytest.fixture(scope="module")
def levels(unloaded, experiment):
    dynamics = pose_set(unloaded, experiment, ("T1", "T2", "T3"), "test").dynamics
    return task_levels(dynamics, experiment.start, experiment.stop, experiment.phase, Noise())


# The engine


def test_levels_are_the_torque_of_the_sampled_motion(unloaded, experiment, levels):
    poses = pose_set(unloaded, experiment, ("T1", "T2", "T3"), "test")
    for task, found in zip(poses.tasks[:2], levels, strict=False):
        motion, cycle = task.samples(10.0, 6), task.grid(0.5)
        torque = poses.dynamics.inverse_dynamics(motion.position, motion.velocity, motion.acceleration)
        assert found.torque == pytest.approx(torque.T, abs=1e-9)
        whole = poses.dynamics.inverse_dynamics(cycle.position, cycle.velocity, cycle.acceleration)
        moving = np.abs(whole).mean(axis=0) > 1e-3
        assert found.spread[moving] == pytest.approx(0.01 * np.abs(whole).mean(axis=0)[moving], rel=0.01)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_counts_below_the_edges_are_those_of_the_samples(seed):
    random = np.random.default_rng(seed)
    bins, r, h = int(random.integers(2, 13)), 3, 4
    level = random.uniform(-1, 1, (6, 1)) * random.choice([0.0, 1.0], (6, 1)) + random.uniform(0, 0.2, (1, h))
    spread = random.uniform(0.005, 0.3, h)
    maximum = random.uniform(0.5, 1.5, r)
    samples = random.standard_normal((6, 5, r, h)).astype(np.float32)
    size = np.abs(level[:, None, None] + spread * samples)
    edges = np.arange(1, bins + 1)[:, None] / bins * maximum
    expected = (size[None] < edges[:, None, None, :, None]).sum(axis=(1, 2))
    found = cumulative_counts(level, spread, maximum, bins, samples)
    # An edge that a sample meets to single precision may fall either way.
    assert np.abs(found[1:].astype(int) - expected).max() <= 1
    assert (found[1:] != expected).mean() < 0.01
    assert not found[0].any()


@given(
    st.lists(st.floats(1e-9, 1e3), min_size=1, max_size=5),
    st.floats(0.8, 0.999),
)
def test_limits_of_many_replicates_are_those_of_one(values, confidence):
    one = np.sort(np.array(values))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = limits(np.stack([one, np.zeros_like(one)]), confidence)
    assert found[0] == pytest.approx(q_limit(one, confidence), rel=1e-9)
    assert found[1] == 0.0


@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 3, 5, 8]))
def test_onsets_are_those_of_the_workflow(seed, consecutive):
    above = np.random.default_rng(seed).random((4, 30)) < 0.7
    expected = onset(above, "consecutive_hours", consecutive)
    assert np.array_equal(onsets(above, consecutive), expected, equal_nan=True)


def test_detections_are_those_of_the_engine_with_all_noise(unloaded, experiment, levels):
    base = {a.name: a.default for a in ambiguities().values()}
    replicates = 24
    poses = pose_set(unloaded, experiment, ("T1", "T2", "T3"), "engine")
    full = evaluate(
        [full_reading(experiment, base)],
        replace(poses, tasks=poses.tasks[:2]),
        SharedExperiment(5, replicates),
        Analysis(),
    )
    for t in range(2):
        bank = draw_bank(6, f"engine {t}", 6, replicates)
        fast = detect(levels[t], bank, experiment.arm.shape, Grid(), [experiment.reading]).onset[experiment.reading]
        share, other = np.isfinite(fast).mean(axis=-1), np.isfinite(full.onset[0, t]).mean(axis=-1)
        # Four standard errors of the difference of two shares.
        middle = (share + other) / 2
        assert (np.abs(share - other) <= 4 * np.sqrt(middle * (1 - middle) * 2 / replicates) + 0.05).all()
        both = (share > 0.9) & (other > 0.9)
        hours = np.abs(np.nanmedian(fast[both], axis=-1) - np.nanmedian(full.onset[0, t][both], axis=-1))
        assert both.sum() >= 4
        assert np.median(hours) <= 3.0


def test_an_axis_without_wear_keeps_its_divergence(levels):
    bank = draw_bank(1, "wear", 6, 3)
    axis = Divergence(levels[1], 2, bank, 12)
    hours = np.arange(20, 140)
    assert axis.worn(np.zeros(120), hours) == pytest.approx(axis.normal[:, hours], abs=1e-12)
    assert (axis.training >= 0).all()
    assert axis.training[:, 0] == pytest.approx(0.0, abs=1e-12)


def test_all_readings_at_once_are_each_alone(levels):
    bank = draw_bank(2, "readings", 6, 3)
    together = detect(levels[1], bank, 1.0, Grid()).onset
    for reading in READINGS[::5]:
        alone = detect(levels[1], bank, 1.0, Grid(), [reading]).onset[reading]
        assert np.array_equal(together[reading], alone, equal_nan=True)


# What is compared


def test_cost_of_the_paper_itself_is_nothing(paper):
    target = paper.target(1)
    reading = READINGS[0]
    outcome = TaskOutcome({reading: np.repeat(target.hours[..., None], 4, axis=-1)}, {reading: np.array([3, 4, 4, 3])})
    assert detection_cost(outcome, target, Weights())[reading] == 0.0
    assert agreeing_cells(outcome, target)[reading] == 12
    later = TaskOutcome({reading: outcome.onset[reading] + 5}, outcome.kept)
    more = TaskOutcome(outcome.onset, {reading: np.array([5, 5, 5, 5])})
    assert detection_cost(later, target, Weights())[reading] > 0
    assert detection_cost(more, target, Weights())[reading] == pytest.approx(Weights().components)


def test_cost_of_tables_rises_with_each_error():
    zero = np.zeros((1, 4))
    assert table_cost(zero, zero, Weights())[0] == 0.0
    sizes = np.array([0.001, 0.01, 0.03, 0.06, 0.1])[:, None]
    for order in ((sizes, 0 * sizes), (0 * sizes, sizes)):
        assert (np.diff(table_cost(*order, Weights())) > 0).all()


def test_signs_of_table_two_count_pairs_once(paper):
    lag = 7 * paper.lag_sign
    assert same_signs(np.stack([lag, -lag]), paper.lag_sign).tolist() == [
        15,
        int((lag[np.triu_indices(6, 1)] == 0).sum()),
    ]


def test_shuffling_moves_cells_and_nothing_else(paper):
    other = shuffled_paper(paper, np.random.default_rng(3))
    assert not np.array_equal(other.tables.hours, paper.tables.hours, equal_nan=True)
    assert np.array_equal(np.sort(other.tables.hours.ravel()), np.sort(paper.tables.hours.ravel()), equal_nan=True)
    assert np.array_equal(other.tables.maximum, paper.tables.maximum)


@pytest.mark.parametrize("number", range(3))
def test_a_paper_of_known_origin_prints_what_a_paper_prints(unloaded, number):
    def draw():
        random = np.random.default_rng(number)
        return synthetic_paper(unloaded, 1, str(number), random, Grid(), Noise(), Prior())

    (first, truth), (second, _) = draw(), draw()
    assert np.array_equal(first.tables.hours, second.tables.hours, equal_nan=True)
    assert np.array_equal(first.tables.maximum, second.tables.maximum)
    resting = np.argwhere(first.tables.at_rest).tolist()
    assert resting == [[0, 5]]
    hours = first.tables.hours[np.isfinite(first.tables.hours)]
    assert ((hours >= 1) & (hours <= 120)).all()
    assert Prior().mass[0] <= truth.arm.mass <= Prior().mass[1]
    assert np.array_equal(first.lag_sign, -first.lag_sign.T)


# The search


def test_a_local_search_never_ends_worse(unloaded, paper):
    fit = PaperFit(unloaded, paper, 1, "test", SMALL)
    arm = Arm(2.5, 0.12, 0.8)
    screened = fit.screen(arm, 0)
    place = choose_reading([screened])
    reading = READINGS[place]
    alone = fit.task(2, arm)
    before = screened.costs[2][:2, place]
    u, cost = improve(alone, screened.poses[2][:2], before, reading, fit.random("test"), SMALL.local)
    assert (cost <= before).all()
    assert alone.costs(u, [reading])[0][:, 0] == pytest.approx(cost)
    found = fit.search(screened, reading, place, 0)
    assert len(found) == 2
    assert found[0].cost.sum() <= found[1].cost.sum()
    again = fit.search(screened, reading, place, 0)
    assert np.array_equal(found[0].start, again[0].start)


def test_a_walk_over_arms_stays_where_the_evidence_is():
    best = Arm(2.0, 0.1, 1.0)

    def evidence(arm):
        ratios = np.log([arm.mass / best.mass, arm.offset / best.offset, arm.shape / best.shape])
        return -0.5 * float((ratios**2).sum()) / 0.1**2

    start = Arm(3.0, 0.15, 1.5)
    arms, values = walk(evidence, start, np.random.default_rng(1), 400, 0.1, (0.1, 5.0))
    assert len(arms) == len(values) == 401
    assert values.max() > values[0] + 10
    moments = np.array([a.moment for a in arms[200:]])
    assert abs(np.log(moments / best.moment).mean()) < 0.15


def test_a_region_counts_less_the_steeper_its_tables(unloaded, paper):
    fit = PaperFit(unloaded, paper, 1, "test", SMALL).task(1, Arm(2.5, 0.12, 0.8))
    u = fit.table_solutions(np.random.default_rng(1), 6, 2)
    found = region_evidence(fit, u)
    cost = 0.5 * (fit.problem.residuals(u) ** 2).sum(axis=1)
    assert (found < -cost).all()


def test_arms_are_drawn_around_those_fitted(unloaded, paper):
    fit = PaperFit(unloaded, paper, 1, "test", SMALL)
    fitted, evidence = fit.fitted_arms()
    assert 1 <= len(fitted) <= SMALL.walk + 1
    assert (np.diff(evidence) <= 0).all()
    arms = fit.drawn_arms(fitted[:1], 12)
    assert arms[0] == fitted[0]
    moments = np.array([a.moment for a in arms]) / fitted[0].moment
    assert 0.6 < moments.min() <= 1.0 <= moments.max() < 1.7


def test_experiments_survive_their_file(tmp_path, experiment):
    path = tmp_path / "experiments.nc"
    write_experiments(path, [experiment, experiment], "test", {"seed": 1})
    found = read_experiments(path)
    assert len(found) == 2
    assert found[1].arm == experiment.arm
    assert found[1].reading == experiment.reading
    assert np.array_equal(found[0].stop, experiment.stop)


def test_scores_of_the_paper_itself(paper):
    tables = paper.tables
    hours = tables.hours.swapaxes(1, 2)
    found = {
        "probability": np.isfinite(hours).astype(float)[None],
        "hour": hours[None],
        "maximum": np.stack([tables.maximum.swapaxes(1, 2)] * 2)[None],
        "variation": np.stack([tables.variation.swapaxes(1, 2)] * 2)[None],
        "signs": np.full((1, 5), 15),
        "kl_maximum": np.full((1, 5), 10.0),
    }
    scores = score(found, paper)
    assert scores.cells[0] == 36
    assert scores.hour_error[0] == scores.torque_worst[0] == scores.variation_worst[0] == 0.0
    assert nearest(np.array([3.0, 1.0, 2.0]), 2).tolist() == [1, 2]


def test_the_closest_experiment_meets_most_aims():
    fields = {name: np.zeros(3) for name in Scores.__dataclass_fields__}
    fields |= {"cells": np.array([36, 33, 33]), "kl": np.array([10.0, 10.0, 10.0]), "signs": np.array([7, 11, 11])}
    assert closest(Scores(**fields), np.array([1.0, 5.0, 4.0])) == 2


def test_experiments_are_searched_on_from_the_nearest_arms(experiment):
    heavier = replace(experiment, arm=replace(experiment.arm, mass=9.0))
    found = bases([experiment, heavier, experiment, heavier], np.array([4.0, 1.0, 2.0, 3.0]), 2)
    assert found == [[1, 3], [2, 0]]


def test_a_table_weighs_what_its_emphasis_says(unloaded, paper):
    plan = replace(SMALL, local=LocalSearch(rounds=2))
    fit = PaperFit(unloaded, paper, 1, "paper", plan)
    screened = fit.screen(Arm(2.5, 0.12, 0.8), 0)
    members = fit.search(screened, READINGS[0], 0, 0)
    usual, more = search_on(
        unloaded, paper, 1, plan, fit.grid, fit.noise, members, [Emphasis(), Emphasis(signs=50.0)], 0
    )
    # From where the search ended, under the same weights and noise, no task gets worse; Table II is of T1 alone.
    assert (usual.cost <= np.min([m.cost for m in members], axis=0) * (1 + 1e-6)).all()
    assert np.array_equal(usual.start[1:], more.start[1:])
    assert more.cost[0] > usual.cost[0]


def test_kinds_of_pairs_are_those_of_table_two(paper):
    found = pairs(np.ones(15), paper)
    assert {name: kind["count"] for name, kind in found.items()} == {"worn": 5, "tied": 4, "apart": 6}
    assert sum(kind["right"] for kind in found.values()) == pytest.approx(15.0)


# What is stored


@pytest.fixture(scope="module")
def stored():
    return ROOT / "data/studies/joint_fit"


@pytest.mark.parametrize("picture", sorted(p.stem for p in (ROOT / "data/studies/joint_fit").glob("*.svg")))
def test_stored_figures_are_drawn_from_the_stored_chapter(stored, picture, tmp_path):
    figures.draw(picture, stored / "chapter.json", tmp_path / "figure.svg")
    assert (tmp_path / "figure.svg").read_bytes() == (stored / f"{picture}.svg").read_bytes()


def test_stored_study_holds_a_posterior(stored):
    found = json.loads((stored / "chapter.json").read_text(encoding="utf-8"))
    assert found["kept"] >= 30
    assert found["check"]["replicates"] >= 100
    assert found["met"] == all(c["low"] <= c["value"] <= c["high"] for c in found["checks"])
