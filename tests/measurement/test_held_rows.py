"""Rows that a logger holds are no record of a motion; coarse, slow and interrupted ones are."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from discovery_cases import make_case
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.measurement.checks.held_rows import check_rows_are_new, check_torques_are_new, without_lines
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.refused import Refused

RATE = 50.0


@dataclass
class Samples:
    time: np.ndarray
    position: np.ndarray
    torque: np.ndarray
    velocity: np.ndarray | None = None


def recorded(step=1e-4, resolution=1e-3, speed=1.0, held=1, rate=RATE):
    time = np.arange(0.0, 20.0, 1 / rate)
    phase = speed * time[:, None] * np.array([1.0, 1.3, 0.7])
    position = np.round(0.8 * np.sin(phase) / step) * step
    torque = np.round((3.0 * np.sign(np.cos(phase)) + np.sin(phase)) / resolution) * resolution
    rows = (np.arange(len(time)) // held) * held
    return Samples(time, position[rows], torque[rows])


def check(samples):
    check_rows_are_new(samples, np.zeros(len(samples.time), int), "a log")


@pytest.mark.parametrize("held", [2, 3, 5, 10])
def test_a_log_on_a_faster_grid_than_its_values_is_refused(held):
    with pytest.raises(Refused, match=f"for about {held / RATE:.2g} s") as told:
        check(recorded(held=held))
    assert "write each value once" in told.value.suggestion


@given(
    step=st.sampled_from([1e-6, 1e-4, 2e-3, 1e-2]),
    resolution=st.sampled_from([1e-6, 0.05, 1.0, 10.0]),
    speed=st.floats(0.02, 2.0),
    rate=st.sampled_from([20.0, 50.0, 250.0]),
)
@settings(max_examples=60, deadline=None)
def test_coarse_positions_and_torques_of_slow_motion_are_no_held_rows(step, resolution, speed, rate):
    check(recorded(step, resolution, speed, rate=rate))


def test_rests_and_a_few_held_rows_are_a_record_of_the_motion():
    samples = recorded()
    samples.position[200:500], samples.torque[200:500] = samples.position[200], samples.torque[200]
    for k in range(520, 900, 40):
        samples.position[k : k + 4], samples.torque[k : k + 4] = samples.position[k], samples.torque[k]
    check(samples)


@pytest.mark.parametrize("what", ["position of joint 2", "torques of all joints"])
def test_a_part_of_the_columns_of_a_slower_source_is_refused_by_name(what):
    samples, held = noisy(1, 125.0), np.arange(2500) // 10 * 10
    if what == "torques of all joints":
        samples.torque[:] = samples.torque[held]
    else:
        samples.position[:, 1] = samples.position[held, 1]
    with pytest.raises(Refused, match=f"rows repeat the {what}, .* for about 0.08 s"):
        check(samples)
    # A position from a slower source beside a velocity of its own derives nothing.
    samples.velocity = np.zeros_like(samples.position)
    if what != "torques of all joints":
        check(samples)


def test_a_torque_that_one_joint_keeps_is_no_slower_source():
    samples = noisy(1)
    samples.torque[:, 1] = samples.torque[np.arange(1000) // 10 * 10, 1]
    check(samples)


def with_dead_band(values, band):
    """A torque that is logged once it is so far from what was logged last."""
    kept = values.copy()
    for k in range(1, len(values)):
        kept[k] = values[k] if abs(values[k] - kept[k - 1]) >= band else kept[k - 1]
    return kept


@pytest.fixture(scope="module")
def sound(puma):
    recording = make_case(puma.robot, 4)
    return recording, measure(recording)


def check_torques(sound, torque):
    recording, measured = sound
    check_torques_are_new(
        replace(recording, torque=torque), replace(measured, torque=torque), recording.trajectory, "a log", records=True
    )


@pytest.mark.parametrize(("how", "held"), [("rows", 5), ("dead band", None), ("rows", 2)])
def test_a_torque_of_one_joint_from_a_slower_source_is_refused_by_name(sound, how, held):
    torque = sound[0].torque.copy()
    column = torque[:, 2]
    torque[:, 2] = (
        with_dead_band(column, 0.1 * np.std(column)) if held is None else column[np.arange(len(column)) // held * held]
    )
    words = "the torque of joint 3 before 100 % of its changes in motion"
    with pytest.raises(Refused, match=words) as told:
        check_torques(sound, torque)
    assert "log the torque of joint 3 as often as those of the others" in told.value.suggestion
    if held is not None:
        assert f"held for about {held / 100:.2g} s" in str(told.value)
    one = np.where((sound[0].trajectory == 1)[:, None], torque, sound[0].torque)
    with pytest.raises(Refused, match="the torque of joint 3 of trajectory 1 before 100 %"):
        check_torques(sound, one)


@pytest.mark.parametrize("share", [0.02, 0.2, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("alone", [True, False])
def test_torques_with_coarse_digits_are_not_held(sound, share, alone):
    torque = sound[0].torque.copy()
    joints = [2] if alone else slice(None)
    step = share * np.std(torque, axis=0)[joints]
    torque[:, joints] = np.round(torque[:, joints] / step) * step
    check_torques(sound, torque)


def test_torques_of_two_digits_at_a_limit_and_with_rests_are_not_held(sound):
    torque = sound[0].torque
    size = 10.0 ** (np.floor(np.log10(np.abs(torque))) - 1)
    check_torques(sound, np.round(torque / size) * size)
    clipped, limit = torque.copy(), np.quantile(np.abs(torque[:, 2]), 0.3)
    clipped[:, 2] = np.clip(clipped[:, 2], -limit, limit)
    check_torques(sound, clipped)
    still = torque.copy()
    still[:1500, 2] = still[0, 2]
    check_torques(sound, still)


def noisy(held, rate=RATE):
    """A torque with noise, of which every so many rows are kept and the others drawn as lines between them."""
    samples = recorded(step=1e-6, resolution=1e-6, rate=rate)
    samples.torque += 0.02 * np.random.default_rng(held).standard_normal(samples.torque.shape)
    kept = samples.time[::held]
    for values in (samples.position, samples.torque):
        for j in range(values.shape[1]):
            values[:, j] = np.interp(samples.time, kept, values[::held, j])
    return samples


@pytest.mark.parametrize("held", [2, 3, 5, 10])
def test_lines_between_the_values_of_a_slower_source_are_refused(held):
    with pytest.raises(Refused, match=f"lie on a straight line.* for about {held / RATE:.2g} s"):
        check(noisy(held))


@pytest.mark.parametrize("rate", [50.0, 250.0, 1000.0])
def test_what_was_measured_lies_on_no_line_and_a_few_holes_are_no_slower_source(rate):
    samples = noisy(1, rate)
    check(samples)
    # A smooth torque without any noise, as a simulation writes it.
    phase = samples.time[:, None] * np.array([1.0, 1.3, 0.7])
    check(Samples(samples.time, 0.8 * np.sin(phase), 3.0 * np.cos(phase)))
    rows = np.arange(len(samples.time))
    kept = np.flatnonzero(rows % 150 > 15)
    for values in (samples.position, samples.torque):
        for j in range(values.shape[1]):
            values[:, j] = np.interp(rows, kept, values[kept, j])
    check(samples)
    # What lies on the lines is left out, and nothing else: of a hole all rows between its ends.
    found = np.isnan(without_lines(samples, np.zeros(len(rows), int)).position).all(axis=1)
    first, last = kept[0], kept[-1]
    inside = (rows > first) & (rows < last) & ~np.isin(rows, kept)
    assert (found[first : last + 1] == inside[first : last + 1]).all()
