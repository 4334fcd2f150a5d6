"""Recovery of what the paper left out: statistics, derivatives, search, choice."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, read_variables, write_dataset
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Link, load_robot
from jointwear.robots.trajectory import Task, load_task
from jointwear.studies.recovery.bound import QUASI_STATIC, dynamic_bound, reachable_from, static_bound
from jointwear.studies.recovery.candidates import COMPONENTS, Coefficients, candidate, payload_monomials
from jointwear.studies.recovery.choice import choose, finalists, runner_up
from jointwear.studies.recovery.ensemble import (
    Ensemble,
    Tolerance,
    distance,
    distinct,
    unknown_growth,
    within,
    write_ensemble,
)
from jointwear.studies.recovery.export import export_experiment, typical_solution
from jointwear.studies.recovery.fit import ExplanationFit, describe, extended, read_fit, write_fit
from jointwear.studies.recovery.least_squares import minimise
from jointwear.studies.recovery.plan import NOT_TOLD_APART, NOTHING, candidate_names
from jointwear.studies.recovery.prediction import agreement
from jointwear.studies.recovery.problem import TableProblem, TableSettings, pauses_at_instants
from jointwear.studies.recovery.sample_statistics import coefficient_of_variation, expected_maximum
from jointwear.studies.recovery.sampled_motion import INSTANTS, INTERVAL, progress, states
from jointwear.studies.recovery.sampled_torque import RigidBodyParts
from jointwear.studies.recovery.tables import read_tables, tables_from_data
from jointwear.studies.recovery.validation import summarise_validation, synthetic_case
from jointwear.studies.recovery.verdict import build_verdict, contradictions

ROOT = Path(__file__).resolve().parents[2]
PUBLISHED = ROOT / "config/paper/published.yaml"


@pytest.fixture(scope="module")
def robot():
    return load_robot(ROOT / "config/robots/puma560.yaml")


@pytest.fixture(scope="module")
def tables():
    return read_tables(PUBLISHED)


def test_tables_hold_the_printed_numbers(tables):
    assert tables.tasks == ("T1", "T2", "T3")
    assert tables.maximum[1, 4].tolist() == [3.183, 3.231]
    assert tables.reading_hours[2, 0].tolist() == [120, 40]
    assert np.argwhere(tables.at_rest).tolist() == [[0, 5]]
    assert np.isnan(tables.hours).sum() == 36 - 19


def test_tables_of_another_layout_are_refused():
    with pytest.raises(InputError, match="table_v"):
        tables_from_data({"table_iv_detection_hours": {"T1": {10: [1.0]}}}, "x.yaml")


def test_task_one_rests_at_instants_the_others_do_not(tables):
    assert pauses_at_instants(tables).tolist() == [True, False, False]


@settings(max_examples=20, deadline=None)
@given(st.lists(st.floats(0.0, 30.0), min_size=6, max_size=6), st.floats(0.05, 2.0))
def test_expected_maximum_agrees_with_simulation(level, noise):
    level, noise = np.array(level), np.array(noise)
    top = level.max()
    draws = np.random.default_rng(0).standard_normal((4000, 10, 6)) * noise + level
    simulated = draws.max(axis=(1, 2))
    expected = expected_maximum(level, noise, 10)
    assert abs(expected.value - simulated.mean()) < 0.05 * noise
    assert expected.value > top


@pytest.mark.parametrize("ddof", [0, 1])
def test_coefficient_of_variation_agrees_with_numpy(ddof):
    level, noise = np.array([0.0, 26.1, 25.9, 0.0, 28.6, 28.4]), np.array(0.28)
    draws = np.abs(np.random.default_rng(1).standard_normal((4000, 10, 6)) * noise + level).reshape(4000, -1)
    simulated = (draws.std(axis=1, ddof=ddof) / draws.mean(axis=1)).mean()
    assert coefficient_of_variation(level, noise, 10, ddof).value == pytest.approx(simulated, abs=2e-4)


@pytest.mark.parametrize("statistic", [expected_maximum, lambda a, b, c: coefficient_of_variation(a, b, c, 1)])
def test_derivatives_of_the_statistics(statistic):
    level, noise, h = np.array([1.0, 2.5, 2.4, 0.1, 1.9, 2.45]), np.array(0.2), 1e-5
    found = statistic(level, noise, 10)
    for k in range(6):
        up, down = level + h * np.eye(6)[k], level - h * np.eye(6)[k]
        slope = (statistic(up, noise, 10).value - statistic(down, noise, 10).value) / (2 * h)
        assert found.by_level[k] == pytest.approx(slope, rel=1e-4, abs=1e-7)
    slope = (statistic(level, noise + h, 10).value - statistic(level, noise - h, 10).value) / (2 * h)
    assert found.by_noise == pytest.approx(slope, rel=1e-3)


@pytest.mark.parametrize("outward", [30.0, 50.0])
@pytest.mark.parametrize("phase", [0.0, 3.7])
def test_states_are_those_of_the_task(outward, phase):
    random = np.random.default_rng(2)
    start, stop = random.uniform(-1, 1, (2, 1, 6))
    task = Task("T", np.array([start[0], stop[0]]), np.array([outward, 60 - outward]), phase)
    motion = task.samples(INTERVAL, INSTANTS)
    found = states(start, stop, np.array([phase]), np.array([outward]), np.ones(1))
    for name in ("position", "velocity", "acceleration"):
        np.testing.assert_allclose(getattr(found, name)[0], getattr(motion, name), atol=1e-12)


def test_rest_at_both_ends_is_exact():
    rate = progress(np.zeros(1), np.array([30.0]))[1][0]
    assert np.flatnonzero(rate == 0).tolist() == [0, 3]


def test_a_payload_by_monomials_is_the_payload_of_the_dynamics(robot):
    random = np.random.default_rng(3)
    q, v, a = random.uniform(-1, 1, (3, 1, 2, 6, 6))
    com, mass = np.array([0.02, -0.05, 0.11]), 2.3
    coefficients = Coefficients.nominal(1)
    coefficients.payload = payload_monomials(np.array([mass]), com[None])
    found = RigidBodyParts(robot, candidate("payload+gravity_scale")).torque(_States(q, v, a), coefficients)
    loaded = Dynamics(replace(robot, payload=Link(mass, com, np.zeros((3, 3)))))
    np.testing.assert_allclose(found, loaded.rigid_body_torque(q, v, a), atol=1e-9)


class _States:
    def __init__(self, q, v, a):
        self.position, self.velocity, self.acceleration = q, v, a


@pytest.mark.parametrize(
    "name", ["payload+gravity_scale", "torque_constant_error+faster_segments", "coulomb_scale+motor_inertia_scale"]
)
def test_jacobian(robot, tables, name):
    problem = TableProblem(robot, tables, candidate(name), TableSettings())
    u = problem.random_start(np.random.default_rng(4), 2)
    residual, jacobian = problem.residuals_and_jacobian(u)
    np.testing.assert_allclose(residual, problem.residuals(u), atol=1e-9)
    np.testing.assert_allclose(problem.cost_by_task(u).sum(axis=1), 0.5 * (residual**2).sum(axis=1))
    h = 1e-5
    for k in range(problem.size):
        step = h * np.eye(problem.size)[k]
        slope = (problem.residuals(u + step) - problem.residuals(u - step)) / (2 * h)
        np.testing.assert_allclose(jacobian[..., k], slope, atol=2e-5 * np.abs(jacobian).max())


def test_many_starts_descend_to_the_same_minimum():
    def residuals(u):
        return np.stack([10 * (u[:, 1] - u[:, 0] ** 2), 1 - u[:, 0]], axis=1)

    def both(u):
        jacobian = np.zeros((len(u), 2, 2))
        jacobian[:, 0, 0], jacobian[:, 0, 1], jacobian[:, 1, 0] = -20 * u[:, 0], 10, -1
        return residuals(u), jacobian

    found = minimise(residuals, both, np.random.default_rng(5).uniform(-2, 2, (8, 2)), 300)
    np.testing.assert_allclose(found.point, 1.0, atol=1e-5)
    assert found.converged.all()


def test_static_bound_and_search_agree_and_tables_lie_beyond(robot, tables):
    proof = static_bound(robot, 0.2)
    times = np.array([2.0, 30.0, QUASI_STATIC])
    found = dynamic_bound(robot, times, 0.2, np.full(6, np.inf), np.random.default_rng(6), draws=500, climbers=6)
    assert np.all(found.free[-1] <= proof * (1 + 1e-4))
    np.testing.assert_allclose(found.free[-1, 1:5], proof[1:5], rtol=2e-3)
    assert np.all(np.diff(found.free, axis=0) <= 0)
    # Axes 2 to 5 of the published tables, noise allowed for, are beyond what any slow motion reaches.
    assert np.all(tables.maximum.max(axis=(0, 2))[1:5] / 1.036 > proof[1:5])


def test_segment_time_from_which_a_torque_is_reachable():
    times, bound = np.array([1.0, 2.0, 4.0]), np.array([[16.0], [4.0], [1.0]])
    found = reachable_from(np.array([[0.5], [20.0], [4.0], [2.0]]), times, bound)[:, 0]
    assert found[0] == np.inf
    assert found[1] == 0
    assert found[2] == pytest.approx(2.0)
    assert 2.0 < found[3] < 4.0


def test_names_need_no_numpy_and_match_the_components():
    assert list(NOT_TOLD_APART) == list(COMPONENTS)
    assert len(candidate_names()) == len(set(candidate_names())) == 1 + 8 + 27
    code = "import sys, jointwear.studies.recovery.plan; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT / "workflow", check=False).returncode == 0


def _fit(name, cost, parameters, tables):
    t, n, _c = tables.maximum.shape
    p = len(candidate(name).parameters)
    pose = np.zeros((t, n))
    return ExplanationFit(
        name, pose, pose, np.zeros(t), np.full(t, 30.0), 1.5, np.ones(p), np.full(p, 0.1), tables.maximum,
        tables.variation, cost, 72, parameters, np.array([cost]),
    )  # fmt: skip


def test_choice_takes_the_simplest_that_is_not_clearly_beaten(tables):
    fits = {
        NOTHING: _fit(NOTHING, 20000, 38, tables),
        "gravity_scale": _fit("gravity_scale", 18000, 39, tables),
        "payload": _fit("payload", 60, 42, tables),
        "payload+viscous_scale": _fit("payload+viscous_scale", 55, 48, tables),
        "gravity_scale+viscous_scale": _fit("gravity_scale+viscous_scale", 10, 45, tables),
    }
    assert choose(fits) == "payload"
    assert (
        runner_up({k: v for k, v in fits.items() if k != "gravity_scale+viscous_scale"}, "payload") == "gravity_scale"
    )
    assert finalists(fits, 1, 1) == [NOTHING, "payload", "payload+viscous_scale"]
    # A candidate that does worse on the tasks that it has not seen is not taken.
    rejected = {NOTHING: 1.0, "payload": 2.0, "gravity_scale": 3.0}
    assert choose(fits, rejected) == NOTHING


def test_verdict_names_the_payload_and_the_contradiction(tables, robot):
    fits = {
        NOTHING: _fit(NOTHING, 20000, 38, tables),
        "gravity_scale": _fit("gravity_scale", 18000, 39, tables),
        "payload": _fit("payload", 60, 42, tables),
    }
    coulomb = np.maximum(robot.coulomb_positive, -robot.coulomb_negative)
    ensemble = {"mass": np.array([2.0, 2.5, 3.0]), "com_z": np.array([0.12, 0.1, 0.08])}
    found = build_verdict(tables, fits, {NOTHING: 500.0, "payload": 2.0}, coulomb, ensemble)
    assert found["verdict"] == "effects"
    assert found["effects"][0]["effect"] == "payload"
    assert found["effects"][0]["cross_validated_gain"] == pytest.approx(0.996)
    assert len(found["gap"]["cells"]) == len(found["gap"]["augmented"]) == 36
    assert found["runner_up"]["candidate"] == "gravity_scale"
    spread = found["not_identifiable"][0]["relative_spread"]
    assert spread["product"] < spread["mass"]
    assert contradictions(tables, coulomb)[0]["tasks"] == ["T1", "T2"]


def test_unknown_hours_widen_with_the_increase(tables):
    mean, spread = unknown_growth(tables, np.array([1.5]))
    np.testing.assert_allclose(mean[..., 1], 2 * mean[..., 0])
    assert np.all(spread > 0.0)
    assert np.all(mean < tables.increase_percent / 100 + 1e-12)


def test_solutions_are_distinct_only_if_every_task_differs():
    start = np.zeros((3, 2, 6))
    stop = np.ones((3, 2, 6))
    stop[1, 0, 3] += 0.5  # one task only
    stop[2, :, 4] += 0.5
    assert distinct(start, stop, 0.2) == [0, 2]
    # Start and stop swapped is the same task, and so is another position of axis 1.
    turned = start[0].copy(), stop[0].copy()
    assert distance(*turned, turned[1] + [2, 0, 0, 0, 0, 0], turned[0] + [2, 0, 0, 0, 0, 0]).max() == pytest.approx(0)


def test_tolerance(tables):
    maximum, variation = tables.maximum[None].copy(), tables.variation[None].copy()
    assert within(tables, maximum, variation, Tolerance()).all()
    maximum[0, 0, 0, 0] *= 1.06
    assert not within(tables, maximum, variation, Tolerance()).any()
    widened = np.full(tables.maximum.shape, 1.5)
    assert within(tables, maximum, variation, Tolerance(), (widened, widened)).all()


def test_a_fit_survives_its_file(tables, tmp_path):
    fit = _fit("payload", 60, 42, tables)
    write_fit(tmp_path / "fit.nc", fit, tables, {"seed": 1})
    again = read_fit(tmp_path / "fit.nc")
    assert (again.candidate, again.cost, again.bic) == (fit.candidate, fit.cost, fit.bic)
    np.testing.assert_array_equal(again.effect, fit.effect)


def test_frozen_payload_gives_the_same_residuals(robot, tables):
    problem = TableProblem(robot, tables, candidate("payload"), TableSettings())
    point = problem.random_start(np.random.default_rng(7), 1)[0]
    cost = problem.cost_by_task(point[None])[0]
    for task, columns in enumerate(problem.columns_by_task):
        alone = problem.task_alone(task, point)
        assert alone.cost_by_task(point[None, columns])[0, 0] == pytest.approx(cost[task], rel=1e-6)


def test_the_truth_of_a_synthetic_case_fits_its_tables(robot, tables):
    case = synthetic_case(robot, tables, "payload", TableSettings(), np.random.default_rng(8))
    assert 1 <= case.truth[0] <= 4
    assert case.tables.at_rest.tolist() == tables.at_rest.tolist()
    problem = TableProblem(robot, case.tables, candidate(NOTHING), TableSettings())
    fit = describe(problem, problem.random_start(np.random.default_rng(9), 1)[0], np.zeros(1))
    assert fit.data == 70
    assert fit.variance > 1


def test_a_free_vector_survives_split_and_join(robot, tables):
    problem = TableProblem(robot, tables, candidate("payload"), TableSettings())
    point = 0.9 * problem.random_start(np.random.default_rng(10), 1)
    parts = [value[0] for value in problem.split(problem.physical(point))]
    np.testing.assert_allclose(problem.join(*parts), point[0], atol=1e-9)


def test_a_pair_is_never_worse_than_its_parts(robot, tables):
    problem = TableProblem(robot, tables, candidate("gravity_scale"), TableSettings())
    point = problem.random_start(np.random.default_rng(11), 1)[0]
    single = describe(problem, point, np.zeros(1))
    pair = extended(robot, tables, candidate("payload+gravity_scale"), TableSettings(), 3, single)
    assert pair.cost <= single.cost
    assert pair.parameters == single.parameters + 4


def test_validation_marks_what_no_comparison_can_name(tmp_path):
    rows = [("payload", "payload", [50.0, 0.1]), ("gravity_scale", NOTHING, [0.1]), (NOTHING, NOTHING, [0.1])]
    for k, (cause, chosen, mean_square) in enumerate(rows):
        names = np.array([NOTHING, "payload"][: len(mean_square)])
        values = np.array(mean_square)
        variables = {
            "candidate": Variable(("candidate",), names, "candidate"),
            "bic": Variable(("candidate",), 70 * np.log(values), "criterion", "1"),
            "mean_square": Variable(("candidate",), values, "misfit", "1"),
        }
        write_dataset(tmp_path / f"{k}.nc", variables, {"cause": cause, "chosen": chosen})
    summarise_validation([tmp_path / f"{k}.nc" for k in range(3)], tmp_path / "all.nc")
    assert read_variables(tmp_path / "all.nc", "right")[0].tolist() == [1, 0, 1]
    assert read_variables(tmp_path / "all.nc", "needless")[0].tolist() == [0, 1, 0]


def test_the_typical_solution_is_a_good_one_near_the_middle():
    cost = np.array([50.0, 52.0, 51.0, 90.0])
    assert typical_solution(cost, np.array([[1.0], [2.1], [5.0], [2.2]])) == 1


def test_exported_files_are_read_back(robot, tables, tmp_path):
    t, n = tables.at_rest.shape
    pose = np.zeros((2, t, n))
    ensemble = Ensemble(
        pose - 0.1, pose + 0.1, np.full((2, t), 5.0), np.full(t, 50.0), np.full(2, 1.5),
        np.tile([2.5, 0.0, 0.0, 0.1], (2, 1)), np.array([1.0, 2.0]),
        np.tile(tables.maximum, (2, 1, 1, 1)), np.tile(tables.variation, (2, 1, 1, 1)),
    )  # fmt: skip
    write_ensemble(tmp_path / "e.nc", ensemble, tables, _fit("payload", 60, 42, tables), {"seed": 1})
    files = [tmp_path / f"{name}.yaml" for name in tables.tasks]
    wear = tmp_path / "wear.yaml"
    export_experiment(ROOT / "config/robots/puma560.yaml", tmp_path / "e.nc", tmp_path / "robot.yaml", files, wear)
    arm = load_robot(tmp_path / "robot.yaml")
    assert arm.payload.mass == 2.5
    assert arm.payload.com[2] == pytest.approx(0.1)
    task = load_task(files[0])
    assert task.durations.tolist() == [50.0, 10.0]
    assert task.phase == 5.0


def test_agreement_with_table_four(tables):
    truth = ~np.isnan(tables.hours)
    perfect = agreement(truth.astype(float), np.nan_to_num(tables.hours) + 4.0, tables.hours)
    assert (perfect.plain, perfect.balanced, perfect.brier, perfect.hour_error) == (1.0, 1.0, 0.0, 4.0)
    assert agreement(np.full(truth.shape, truth.mean()), tables.hours, tables.hours).brier == pytest.approx(
        perfect.base_brier
    )
