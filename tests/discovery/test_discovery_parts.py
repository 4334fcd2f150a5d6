"""Parts of discovery: splitting, differentiation, noise, evidence, files, inertial parameters."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.discovery.estimates.scan import gain_about_one
from jointwear.discovery.linear import Fit, Term, gain
from jointwear.discovery.noise.noise import WIDE, Whitener, estimate, simulate, stable, whitenable
from jointwear.discovery.settings import Settings
from jointwear.effects.tables import hats
from jointwear.files.errors import InputError
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import Recording, elapsed_time, split
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import (
    bodies,
    inertial_regressor,
    links_from_parameters,
    mass_direction,
    prior_factor,
    to_joint_frame,
)
from jointwear.robots.robot import Link, load_robot, robot_from_data


def motion(rate=100.0, seconds=12.0):
    time = np.arange(0, seconds, 1 / rate)
    q = np.stack([np.sin(1.3 * time), 0.5 * np.cos(2.1 * time)], axis=1)
    v = np.stack([1.3 * np.cos(1.3 * time), -1.05 * np.sin(2.1 * time)], axis=1)
    a = np.stack([-1.69 * np.sin(1.3 * time), -2.205 * np.cos(2.1 * time)], axis=1)
    return time, q, v, a


def recording(rate=100.0, step=1e-5):
    time, q, _, _ = motion(rate)
    return Recording(time, np.zeros(len(time), int), step * np.round(q / step), np.ones_like(q))


def test_a_single_recording_is_split_into_blocks_of_time():
    found = split(recording())
    assert found.train == (0, 1, 2, 3)
    assert found.test == (4,)
    assert np.all(np.diff(found.trajectory) >= 0)


def test_wrong_labels_are_named():
    with pytest.raises(InputError, match=r"trajectory 9.*nearest valid value is 4"):
        split(replace(split(recording()), train=(0, 1), test=(9,)))
    with pytest.raises(InputError, match="in 'train' and in 'test'"):
        split(replace(split(recording()), train=(0, 1), test=(1,)))


def test_time_never_runs_backwards():
    time = np.tile(np.arange(5) * 0.1, 3)
    found = elapsed_time(time, np.repeat([0, 1, 2], 5))
    assert np.all(np.diff(found) > 0)


@pytest.mark.parametrize("rate", [100.0, 1000.0])
def test_derivatives_of_quantised_positions(rate):
    found = measure(split(recording(rate)))
    _, _, v, a = motion(100.0)
    keep = found.usable.all(axis=1)
    time = found.time[keep]
    for j, (w, size) in enumerate(((1.3, 1.0), (2.1, 0.5))):
        q = np.sin(w * time) if j == 0 else np.cos(w * time)
        assert np.sqrt(np.mean((found.acceleration[keep, j] + size * w**2 * q) ** 2)) < 0.02 * np.std(a[:, j])
    assert found.rate == pytest.approx(100.0)
    assert np.std(v) > 0


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.5, 0.9), st.integers(0, 1000))
def test_noise_colour_is_recovered(lag, seed):
    label = np.repeat([0, 1, 2], 1500)
    everything = np.arange(len(label))
    series = simulate(Whitener(everything, np.array([lag]), 0.3), label, 1, np.random.default_rng(seed))[:, 0]
    white = estimate(series, np.ones(len(label), bool), label)
    flat = white(series)
    assert np.std(flat) == pytest.approx(1.0, abs=0.06)
    assert abs(np.corrcoef(flat[1:], flat[:-1])[0, 1]) < 0.08


def test_whitening_never_reaches_across_records():
    rows = whitenable(np.ones(10, bool), np.repeat([0, 1], 5), 2)
    assert rows.tolist() == [2, 3, 4, 7, 8, 9]


def test_poles_are_kept_inside():
    lags = stable(np.array([1.8, -0.81]), 0.8)
    assert np.max(np.abs(np.roots([1.0, *(-lags)]))) == pytest.approx(0.8)


def test_gain_is_the_change_of_evidence():
    rng = np.random.default_rng(1)
    base, x = rng.standard_normal((200, 3)), rng.standard_normal((200, 2))
    y = base @ [1.0, 0.5, -0.2] + x @ [0.3, 0.1] + rng.standard_normal(200)
    first = Term("base", {0: base}, np.full(3, 2.0))
    extra = Term("extra", {0: x}, np.full(2, 0.7))
    plain, full = Fit([y], [first]), Fit([y], [first, extra])
    b, gram = plain.gram({0: x})
    assert gain(b, gram, extra.std) == pytest.approx(full.evidence - plain.evidence)


@given(st.lists(st.floats(-3, 3), min_size=1, max_size=30))
def test_hats_sum_to_one(values):
    columns = hats(np.array(values), np.linspace(-1, 1, 6))
    np.testing.assert_allclose(columns.sum(axis=1), 1.0)


def test_inertial_regressor_reproduces_changed_links():
    robot = load_robot("config/robots/puma560.yaml")
    rng = np.random.default_rng(2)
    q, v, a = rng.standard_normal((3, 5, 6))
    factor = prior_factor(robot, 0.05)
    delta = factor @ rng.standard_normal(factor.shape[1]) + 0.1 * mass_direction(robot, 2)
    links = links_from_parameters(robot, delta)
    data = {
        "name": "changed",
        "gravity": list(robot.gravity),
        "dh": [vars(r) for r in robot.dh],
        "links": links,
        "joints": [
            {
                "name": n,
                "limits": [robot.lower[i], robot.upper[i]],
                "gear_ratio": robot.gear_ratio[i],
                "motor_inertia": robot.armature[i] / robot.gear_ratio[i] ** 2,
                "viscous": 0.0,
                "coulomb": {"positive": 0.0, "negative": 0.0},
                "torque_limit": None,
            }
            for i, n in enumerate(robot.joint_names)
        ],
    }
    changed = robot_from_data(data)
    before, after = (np.array(Dynamics(r).rigid_body_torque(q, v, a)) for r in (robot, changed))
    np.testing.assert_allclose(after - before, inertial_regressor(Dynamics(robot), q, v, a) @ delta, atol=1e-8)
    assert bodies(changed)[2][0] > bodies(robot)[2][0]


@pytest.mark.parametrize("distance", [0.0, 0.01, 0.3])
def test_a_centre_of_mass_that_is_given_as_zero_is_not_exact(distance):
    """Else its error becomes a payload. It may be off by a share of the size of its link, or of its lever if longer."""
    robot = load_robot("config/robots/puma560.yaml")
    mass, gyration = 2.0, 0.05
    # A shell: its mean square distance from the centre is half the trace of its inertia over its mass.
    link = Link(mass, np.array([0.0, 0.0, distance]), mass * gyration**2 * np.eye(3) * 2 / 3)
    robot = replace(robot, links=(*robot.links[:-1], link))
    factor = np.linalg.solve(to_joint_frame(robot, 5), prior_factor(robot, 0.05)[50:])
    across = np.linalg.norm(factor[1]) / mass
    assert across == pytest.approx(0.05 * 0.25 * max(distance, gyration), rel=1e-6)


def test_links_of_an_estimate_are_bodies():
    robot = load_robot("config/robots/puma560.yaml")
    count = 10 * robot.joints
    for delta in (np.zeros(count), 1e-17 * np.ones(count), np.random.default_rng(0).normal(0, 0.3, count)):
        links = links_from_parameters(robot, delta)
        bodies_of_it = tuple(Link(b["mass"], np.array(b["com"]), inertia_matrix(b["inertia"])) for b in links)
        model = Dynamics(replace(robot, links=bodies_of_it))
        assert np.isfinite(model.rigid_body_torque(*np.zeros((3, 1, robot.joints)))).all()


def inertia_matrix(six):
    xx, yy, zz, xy, yz, xz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def test_many_columns_are_whitened_as_each_of_them_is():
    rng = np.random.default_rng(4)
    columns = rng.standard_normal((300, 2 * WIDE))
    white = Whitener(np.flatnonzero(rng.random(300) > 0.2)[3:], np.array([0.5, -0.2, 0.1]), 0.7)
    alone = np.stack([white(column) for column in columns.T], axis=1)
    np.testing.assert_allclose(white(columns), alone, atol=1e-12)
    np.testing.assert_allclose(white(columns[:, :4]), alone[:, :4], atol=1e-12)


def test_columns_that_would_have_to_turn_round_have_no_evidence():
    white = SimpleNamespace(problem=SimpleNamespace(settings=Settings()))
    gram = np.array([[300.0]])
    right, turned = (gain_about_one(white, size * gram[0], gram) for size in (1.0, -5.0))
    assert right == pytest.approx(150.0, rel=0.05)
    assert turned == -np.inf


@pytest.mark.parametrize(("size", "counts"), [(0.5, False), (0.8, True), (1.3, True), (2.0, False)])
def test_columns_of_another_size_have_no_evidence(size, counts):
    white = SimpleNamespace(problem=SimpleNamespace(settings=Settings()))
    gram = np.array([[3000.0]])
    assert np.isfinite(gain_about_one(white, size * gram[0], gram, Settings().off_scale)) == counts
