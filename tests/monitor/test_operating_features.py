"""The features of operation that the normal state of friction is regressed on."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.monitor.normal.conditions import operating_features
from jointwear.monitor.normal.estimate import Sums, change_columns
from jointwear.monitor.normal.payload import VARIES, GravityTorque, gravity_share, of_load
from jointwear.monitor.reading.windows import blank_statistics

SAMPLES = 400


def moved(gravity: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Regressors (samples, 5) of an axis: both sides of Coulomb friction, velocity, gravity and inertial torque."""
    rows = np.stack([velocity > 0, -1.0 * (velocity < 0), velocity, gravity, np.gradient(velocity)], axis=1)
    return rows[velocity != 0]


def features_of(rows: np.ndarray, share: float, constant: float) -> np.ndarray:
    statistics = blank_statistics(np.zeros(1), 3600.0, np.ones(1), False)
    statistics.gram[0, 0] = rows.T @ rows
    statistics.count[0, 0] = len(rows)
    static = GravityTorque(np.array([[share]]), np.array([[constant]]))
    return operating_features(statistics, np.array([2.0]), static)[0][0, 0]


@given(
    st.floats(-60, 60), st.floats(0, 20), st.floats(-0.5, 0.5), st.floats(-10, 10), st.floats(-0.5, 0.5)
)  # fmt: skip
def test_gravity_is_what_the_share_and_the_constant_tell_together(middle, swing, share, constant, shifted):
    time = np.linspace(0, 7, SAMPLES)
    velocity, gravity = np.sin(time) + shifted, middle + swing * np.cos(time)
    told = features_of(moved(gravity, velocity), share, constant)
    torque, velocity = ((1 + share) * gravity + constant)[velocity != 0], velocity[velocity != 0]
    assert told[2] == pytest.approx(np.sqrt(np.mean(torque**2)) / 2.0, abs=1e-6)
    assert told[4] == pytest.approx(np.mean(np.sign(velocity) * torque) / 2.0, abs=1e-6)


@given(st.floats(0.3, 0.7))
def test_a_share_that_the_constant_takes_back_is_no_other_load(growth):
    """Coulomb friction that grows, with a torque that gravity hardly changes, moves share and constant against each
    other (fleet 23)."""
    time = np.linspace(0, 7, SAMPLES)
    velocity = np.sin(time)
    rows = moved(np.full(SAMPLES, -40.0), velocity)
    assert features_of(rows, growth, 40.0 * growth) == pytest.approx(features_of(rows, 0.0, 0.0))


def test_what_gravity_differs_by_is_read_with_the_constant_beside_it():
    time = np.linspace(0, 7, SAMPLES)
    velocity, gravity = np.sin(time), 20.0 * np.cos(0.5 * time) - 5.0
    columns = np.stack([np.sign(velocity), np.ones(SAMPLES), velocity, gravity, np.gradient(velocity)], axis=1)
    torque = columns @ np.array([3.0, 1.5, 0.4, 0.1, 0.2])
    sums = Sums(
        (columns.T @ columns)[None, None], (columns.T @ torque)[None, None], np.full((1, 1), 1e-4),
        np.full((1, 1), 300), np.ones((1, 1), dtype=bool),
    )  # fmt: skip
    static, robot = gravity_share(sums, np.array([1e-4]))
    assert static.share[0, 0] == pytest.approx(0.1, abs=1e-4)
    assert static.constant[0, 0] == pytest.approx(1.5, abs=1e-3)
    assert robot[0] == pytest.approx(0.1, abs=1e-4)


def test_where_gravity_cannot_be_read_neither_counts():
    sums = Sums(np.zeros((1, 1, 5, 5)), np.zeros((1, 1, 5)), np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 1), bool))
    static, robot = gravity_share(sums, np.ones(1))
    assert not static.share.any()
    assert not static.constant.any()
    assert not robot.any()


def load_in(rows: np.ndarray, share: float, constant: float) -> GravityTorque:
    nothing = np.zeros((1, 1))
    sums = change_columns(
        (rows.T @ rows)[None, None], np.zeros((1, 1, 5)), nothing, nothing, nothing > -1, np.ones((1, 2))
    )
    return of_load(GravityTorque(np.array([[share]]), np.array([[constant]])), sums)


@given(st.floats(-60, 60), st.floats(0, 20), st.floats(-0.5, 0.5), st.floats(-10, 10))
def test_a_constant_is_no_load_and_a_share_one_as_far_as_gravity_varies(middle, swing, share, constant):
    time = np.linspace(0, 7, SAMPLES)
    rows = moved(middle + swing * np.cos(time), np.sin(time))
    load = load_in(rows, share, constant)
    assert load.share[0, 0] == share
    mean, deviation = rows[:, 3].mean(), rows[:, 3].std()
    told = share * mean + load.constant[0, 0]
    assert abs(told) <= abs(share * mean) + 1e-9
    if deviation > 0:
        assert told == pytest.approx(share * mean / (1 + (VARIES * mean / deviation) ** 2), abs=1e-6)


@given(st.floats(0.3, 0.7))
def test_wear_that_moves_share_and_constant_against_each_other_is_no_load(growth):
    time = np.linspace(0, 7, SAMPLES)
    rows = moved(np.full(SAMPLES, -40.0), np.sin(time))
    load = load_in(rows, growth, 40.0 * growth)
    told = features_of(rows, load.share[0, 0], load.constant[0, 0])
    assert told == pytest.approx(features_of(rows, 0.0, 0.0), abs=1e-5)
