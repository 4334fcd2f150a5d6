"""What columns of timing share with the residual is kept out of them, and real timing still found."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from discovery_cases import COARSE_RATE as RATE
from discovery_cases import coarse, make_case

from jointwear import effects
from jointwear.discovery import discover
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Term
from jointwear.discovery.noise.noise import Whitener
from jointwear.discovery.preflight import check_data
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.problem.instruments import (
    LATE,
    Cutoffs,
    axis_cutoffs,
    band_limited,
    clock_of,
    cutoff_of,
    limit,
    swing_cutoff,
    torque_noise,
)
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import base_columns, whiten
from jointwear.discovery.search.tolerance import with_tolerances
from jointwear.discovery.settings import Settings
from jointwear.effects import make_state
from jointwear.measurement.behind_gears import felt_robot
from jointwear.measurement.derived.derived_noise import DerivedNoise
from jointwear.measurement.derived.filtering import low_pass
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import split


@pytest.fixture(scope="module")
def white(robot):
    recording = split(coarse(robot))
    problem = build_problem(recording, robot, Settings(), measure(recording))
    return whiten(problem, estimate_noise(problem))


def test_cutoff_falls_with_the_noise_and_vanishes_without():
    model = Whitener(np.arange(5000), np.zeros(0), 1.0)
    frequency = np.linspace(0, RATE / 2, 513)[1:]
    found = []
    for density in (1e-22, 1e-13, 1e-11, 1e-10):
        noise = DerivedNoise(np.array([[density]]), (2,), np.array([np.inf]), True, RATE)
        found.append(cutoff_of(model, torque_noise(noise, np.eye(1), frequency)[0], frequency, RATE))
    assert found[0] == np.inf
    assert all(a > b for a, b in pairwise(found))
    noise = torque_noise(noise, np.eye(1), frequency)[0]
    # Columns that hold much motion are hurt less.
    assert cutoff_of(model, noise, frequency, RATE, 0, 1e4) > cutoff_of(model, noise, frequency, RATE, 0)


def test_columns_of_torque_end_by_what_they_hold_themselves(rough):
    """The last joint moves its motor, and hardly any load: the motor's noise is not in columns of the load."""
    problem, axis = rough.problem, 5
    motor, load = problem.robot.armature[axis], np.sqrt(problem.load_squares[axis, axis])
    assert np.sqrt(problem.mass_squares[axis, axis]) == pytest.approx(motor + load, rel=0.01)
    assert load < 0.01 * motor
    # A column that ends within the motion is another motion, which a torque constant explains.
    moved = problem.train_state.acceleration[:, [axis]]
    ended = limit(moved, np.asarray(problem.train_state.record), rough.cutoffs[axis].torque, RATE)
    assert np.std(ended - moved) < 0.01 * np.std(moved)


def test_columns_of_torque_end_where_most_of_the_torque_is_noise(rough):
    for ends in (5.0, 0.1, np.inf):
        problem = replace(rough.problem)
        problem.__dict__["motion_ends"] = np.full(problem.robot.joints, ends)
        for axis in problem.judged:
            known = rough.cutoffs[axis]
            found = axis_cutoffs(problem, axis, rough.whiteners[axis])
            assert found.torque == max(known.structure, min(known.torque, ends))
            assert (found.structure, found.timing) == (known.structure, known.timing)


def test_a_limited_state_keeps_steps_of_friction(white):
    state, axis = white.problem.train_state, 1
    limited = band_limited(state, axis, 5.0, RATE)
    level = state.drive.coulomb(axis, state.velocity[:, axis])
    record = np.asarray(state.record)
    smooth = limit((state.torque[:, axis] - level)[:, None], record, 5.0, RATE)[:, 0]
    np.testing.assert_allclose(limited.torque[:, axis], smooth + level)
    np.testing.assert_array_equal(limited.torque[:, 0], state.torque[:, 0])
    assert band_limited(state, axis, np.inf, RATE) is state


def test_ends_of_records_that_are_not_judged_are_not_carried_to_samples_that_are(white):
    state, axis, ends = white.problem.train_state, 1, white.problem.measured.vague_ends
    record = np.asarray(state.record)
    edges = np.flatnonzero(np.diff(record)) + 1
    wild = state.acceleration.copy()
    for first, last in pairwise([0, *edges, len(record)]):
        assert last - first > 8 * ends > 0
        wild[first : first + ends], wild[last - ends : last] = 100.0, -100.0
    calm = band_limited(state, axis, 3.0, RATE, ends).acceleration
    np.testing.assert_array_equal(
        band_limited(replace(state, acceleration=wild), axis, 3.0, RATE, ends).acceleration, calm
    )
    assert np.abs(band_limited(replace(state, acceleration=wild), axis, 3.0, RATE).acceleration - calm).max() > 10.0


def test_columns_of_drives_and_links_hold_nothing_of_ends_either(white):
    """An inertia that is fitted too small for them lets a torque constant take over what is missing."""
    problem, axis, ends = white.problem, 1, white.problem.measured.vague_ends
    record = np.asarray(problem.train_state.record)
    edges = np.flatnonzero(np.diff(record)) + 1
    cutoffs, beside = replace(white.cutoffs[axis], torque=3.0), np.zeros(len(record), dtype=bool)
    for first, last in pairwise([0, *edges, len(record)]):
        beside[first : first + ends] = beside[last - ends : last] = True
    acceleration, inertial = problem.state.acceleration.copy(), problem.inertial.copy()
    at_ends = np.flatnonzero(problem.train)[beside]
    acceleration[at_ends], inertial[at_ends] = 100.0, 100.0 * (inertial[at_ends] != 0)
    wild = replace(problem, state=replace(problem.state, acceleration=acceleration), inertial=inertial)
    for calm, other in zip(base_columns(problem, axis, cutoffs), base_columns(wild, axis, cutoffs), strict=True):
        assert calm.any()
        np.testing.assert_array_equal(other, calm)


def test_the_clock_is_known_to_a_share_of_the_period_that_was_logged(white):
    problem, axis = white.problem, 1
    measured = problem.measured
    faster = replace(problem, measured=replace(measured, noise=replace(measured.noise, rate=5.0 * measured.rate)))
    kept, reduced = (clock_of(p, axis, white.cutoffs[axis]) for p in (problem, faster))
    assert np.abs(kept).max() > 0.0
    np.testing.assert_allclose(reduced, kept / 5.0)


def test_a_dead_time_ends_higher_than_a_filter_and_a_bend(rough):
    delay = effects.get_effect("actuation_delay")
    for axis in rough.problem.judged:
        cutoffs = rough.cutoffs[axis]
        assert cutoffs.late >= cutoffs.timing
        dead, lag, bend = (
            rough.state_of(delay, axis, p) for p in ({"delay": 0.01, "lag": 0}, {"delay": 0.01, "lag": 1}, None)
        )
        assert (lag is bend) == (cutoffs.late == cutoffs.timing)
        assert (dead is bend) == (cutoffs.late == cutoffs.timing)
    assert any(c.late > c.timing for c in rough.cutoffs)
    # The noise is asked for up to the longest dead time that a search starts from.
    starts = delay.grid(rough.problem.train_state, rough.problem.judged[0])
    assert max(abs(p["delay"]) for p in starts if delay.shifts(p)) == LATE


@pytest.mark.parametrize("side", ["motor", "link"])
def test_behind_the_gear_its_twist_shows_in_the_positions_of_the_motor_alone(white, side):
    gear = effects.get_effect("joint_flexibility")
    state = replace(white.problem.train_state, torque_kind="link_sensor", encoder_side=side)
    assert bool(gear.unmet(state, 2)) == (side == "link")
    assert {p["side"] for p in gear.grid(state, 2)} == {1}
    assert not gear.unmet(replace(state, torque_kind="motor"), 2)


def test_a_coarse_encoder_is_no_timing(robot):
    found = discover(coarse(robot, seed=5), robot)
    assert not found.effects, found.effects
    assert found.verdict in ("none", "retuned")


@pytest.mark.long
def test_a_late_torque_is_found_through_a_coarse_encoder(robot):
    found = discover(coarse(robot, seed=6, late=0.02), robot)
    named = {(e["effect"], e["axis"]) for e in found.effects}
    assert ("actuation_delay", 2) in named
    delay = next(e for e in found.effects if e["axis"] == 2)["parameters"]["delay"]["value"]
    assert delay == pytest.approx(0.02, rel=0.25)


def test_a_delay_above_the_band_of_its_columns_is_no_structure(rough):
    """What the band limit of an instrument takes off is part of the tolerance of the effect."""
    axis = rough.problem.judged[0]
    cutoffs = [Cutoffs(timing=0.4, torque=8.0, judged=8.0, late=0.4)] * len(rough.cutoffs)
    asked = replace(rough, base=[], cutoffs=cutoffs)
    candidate = Candidate("actuation_delay", axis, None, {"delay": 0.02, "lag": 0})
    columns = raw_columns(asked, candidate)
    term = Term("delay", {axis: rough.columns(axis, columns)}, np.ones(1), {axis: asked.raw(axis, columns)})
    delay = effects.get_effect("actuation_delay")
    whole = rough.columns(axis, delay.columns(rough.problem.train_state, axis, None, candidate.nonlinear))[:, 0]
    asked = replace(asked, targets=[whole if a == axis else y for a, y in enumerate(rough.targets)])

    def left(terms):
        residual = asked.fit(terms).residual[axis]
        return float(residual @ residual) / float(whole @ whole)

    found = with_tolerances(asked, [Named(candidate, term, None, 100.0)])
    assert left([term]) > 20 * left(found)


def test_a_wave_that_shakes_a_joint_is_filtered_with_its_acceleration(robot):
    rate, cutoff, waves = 200.0, 40.0, 300.0
    time = np.arange(4000) / rate
    speed = 0.2 + 0.05 * time
    position = np.zeros((4000, 6))
    position[:, 1] = np.cumsum(speed) / rate
    velocity = np.zeros_like(position)
    velocity[:, 1] = speed
    noise = DerivedNoise(np.zeros((1, 6)), (2,), np.full(6, cutoff), False, rate)
    state = make_state(robot, position, velocity, np.zeros_like(position), np.zeros_like(position))
    state = replace(state, derives=noise.passed)
    wave = np.sin(waves * position[:, 1])
    # What no controller follows is taken by the inertia, and the acceleration loses what its filter takes.
    left = low_pass(wave, cutoff, rate)
    weakened = wave * state.shaken(1, waves)
    inside = slice(200, 3800)
    assert np.sqrt(np.mean((left - weakened)[inside] ** 2)) < 0.03 * np.sqrt(np.mean(wave[inside] ** 2))
    assert state.passed(1, waves) == 1.0


def test_a_sensor_behind_the_gear_does_not_retune_a_motor_that_the_file_lacks(robot):
    zero = np.zeros(6)
    bare = replace(robot, armature=zero, viscous=zero, coulomb_positive=zero, coulomb_negative=zero)
    stds = {}
    for kind in ("motor", "link_sensor"):
        recording = split(replace(coarse(bare), torque_kind=kind))
        stds[kind] = build_problem(recording, bare, Settings(), measure(recording)).friction_prior(1)
    assert np.all(stds["link_sensor"] < 1e-3 * stds["motor"])
    # What the file has may be wrong, wherever the sensor is.
    recording = split(replace(coarse(robot), torque_kind="link_sensor"))
    kept = build_problem(recording, robot, Settings(), measure(recording)).friction_prior(1)
    assert np.all(kept > 1e-3 * stds["motor"])


@pytest.mark.long
def test_motor_inertia_of_the_file_is_no_part_of_what_a_link_sensor_feels(robot):
    recording = replace(make_case(robot.without_motor_inertia(), 26), torque_kind="link_sensor")
    found = discover(recording, robot)
    assert found.verdict == "none"
    assert any("no motor inertia is felt" in told for told in found.content.restrictions)
    assert check_data(recording, robot).restrictions == found.content.restrictions
    # Friction of the file stays: it may be that of bearings behind the sensor.
    np.testing.assert_array_equal(found.problem.robot.viscous, robot.viscous)
    assert not felt_robot(recording, robot)[0].armature.any()
    assert felt_robot(replace(recording, torque_kind="motor"), robot) == (robot, [])


@pytest.mark.parametrize("swing", [5.0, 12.0, 20.0])
def test_columns_of_a_swing_reach_beyond_it_as_far_as_noise_allows(swing):
    """Noise that nominal torque and residual share speaks against a swing below it and for it only above."""
    frequency = np.linspace(0.5, 100.0, 200)
    quiet = SimpleNamespace(rows=np.arange(5000), density=lambda f, rate: np.ones_like(f))

    def ends(size, energy=0.1):
        density = size * (frequency / 20.0) ** 4
        return swing_cutoff(quiet, density, frequency, 200.0, 1.0 / swing, 0.05, energy)

    assert ends(0.0) == np.inf
    found = [ends(size) for size in (1e-6, 1e-3, 1e-1, 10.0)]
    assert all(a >= b for a, b in pairwise(found))
    # However much noise there is, what lies below the swing cannot feign it; the filter rolls off over some of it.
    assert min(found) >= 0.75 * swing
    assert ends(1e-1, energy=10.0) >= ends(1e-1)


def test_friction_that_is_more_than_all_torque_behind_the_gear_is_that_of_the_motors(robot):
    recording = replace(make_case(robot.without_drives(), 26), torque_kind="link_sensor")
    felt, (told,) = felt_robot(recording, robot)
    # Friction of joints 4 to 6 is more than what the sensor shows of them.
    assert "neither friction nor inertia" in told
    assert not np.any([felt.coulomb_positive, felt.viscous, felt.armature])
    assert discover(recording, robot).verdict == "none"
    # A joint that rests shows no friction, whatever the file says.
    still = replace(recording, position=np.zeros_like(recording.position))
    assert felt_robot(still, robot)[0].coulomb_positive.any()
