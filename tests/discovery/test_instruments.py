"""Noise of derived accelerations: predicted, kept from looking like timing, and real timing still found."""

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from jointwear import effects
from jointwear.discovery import Recording, assumed, discover
from jointwear.discovery.beyond_band import beyond_band
from jointwear.discovery.candidates import Candidate, raw_columns, term_of
from jointwear.discovery.fused_load import end_of_columns, fused_load
from jointwear.discovery.instruments import LATE, Cutoffs, band_limited, cutoff_of, limit, swing_cutoff, torque_noise
from jointwear.discovery.linear import Term
from jointwear.discovery.noise import Whitener, estimate
from jointwear.discovery.outcome import Named
from jointwear.discovery.problem import build_problem
from jointwear.discovery.saturated import estimate_noise
from jointwear.discovery.settings import Settings
from jointwear.discovery.shared_drives import sticking
from jointwear.discovery.tolerance import with_tolerances
from jointwear.discovery.whitening import bridged, whiten
from jointwear.effects import make_state
from jointwear.effects.order import second_derivative
from jointwear.measurement.derived_noise import DerivedNoise, quantisation_density
from jointwear.measurement.filtering import RINGING, derivatives, low_pass, zero_phase_gain
from jointwear.measurement.motion import measure
from jointwear.measurement.recording import split
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot

RATE = 200.0


@pytest.fixture(scope="module")
def robot():
    return load_robot("config/robots/puma560.yaml")


def coarse(robot, seed=0, step=2 * np.pi / 2**16, late=0.0, **told):
    """Four records of 5 s at 200 Hz with a coarse encoder; the torque is exact but for 0.2 %, maybe late."""
    rng = np.random.default_rng(seed)
    time = np.arange(0, 5.0, 1 / RATE)
    parts = []
    for k in range(4):
        phase, speed = rng.uniform(0, 6, (2, 6)), 2 * np.pi * np.array([0.25, 0.6])[:, None] * rng.uniform(0.8, 1.2, 6)
        size = np.array([0.5, 0.15])[:, None]

        def motion(t, size=size, speed=speed, phase=phase):
            x = speed * t[:, None, None] + phase
            q = np.sum(size * np.sin(x), axis=1)
            return q, np.sum(size * speed * np.cos(x), axis=1), -np.sum(size * speed**2 * np.sin(x), axis=1)

        torque = Dynamics(robot).inverse_dynamics(*motion(time - late))
        noise = 0.002 * torque.std(axis=0) * rng.standard_normal(torque.shape)
        parts.append((time + 6 * k, np.full(len(time), k), motion(time)[0], torque + noise))
    time, label, q, torque = (np.concatenate(x) for x in zip(*parts, strict=True))
    return Recording(time, label, step * np.round(q / step), torque, name="coarse", **told)


@pytest.fixture(scope="module")
def white(robot):
    recording = split(coarse(robot))
    problem = build_problem(recording, robot, Settings(), measure(recording))
    return whiten(problem, estimate_noise(problem))


@pytest.fixture(scope="module")
def rough(robot):
    """Positions so coarse that every axis needs instruments."""
    recording = split(coarse(robot, step=2 * np.pi / 2**13))
    problem = build_problem(recording, robot, Settings(), measure(recording))
    return whiten(problem, estimate_noise(problem))


def test_rounding_has_its_density():
    rng = np.random.default_rng(2)
    values = rng.uniform(0, 1, 200_000)
    error = values - 0.01 * np.round(values / 0.01)
    assert np.var(error) == pytest.approx(quantisation_density(0.01, 500.0) * 250.0, rel=0.02)


def test_gain_is_that_of_the_filter():
    time = np.arange(4000) / RATE
    for cutoff in (0.1 * RATE, 0.3 * RATE):
        for share in (0.25, 0.9, 1.1, 1.3):
            passed = low_pass(np.sin(2 * np.pi * share * cutoff * time), cutoff, RATE)[1000:3000]
            gain = zero_phase_gain(share * cutoff, cutoff, RATE)
            assert np.sqrt(2 * np.mean(passed**2)) == pytest.approx(gain, abs=0.01)


def test_noise_of_accelerations_is_predicted(robot):
    recording = coarse(robot)
    exact = measure(coarse(robot, step=1e-12))
    # A missing sample: a filter takes the place of splines, whose own error would be larger on so smooth a motion.
    recording.position[700, 5] = np.nan
    measured = measure(recording)
    assert not measured.fitted
    frequency = np.linspace(0, RATE / 2, 1025)[1:]
    predicted = np.sqrt(measured.noise.acceleration(frequency).sum(axis=1) * frequency[0])
    used = measured.usable & exact.usable
    for axis in range(4):
        error = (measured.acceleration - exact.acceleration)[used[:, axis], axis]
        assert np.sqrt(np.mean(error**2)) == pytest.approx(predicted[axis], rel=0.25)


def test_what_the_noise_model_leaves_is_white(white):
    for axis in white.problem.judged:
        assert np.var(white.fit().residual[axis]) == pytest.approx(1.0, abs=0.15)


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


def test_a_given_step_counts_where_the_positions_were_smoothed(robot):
    recording = split(coarse(robot, step=1e-9))
    told = replace(recording, encoder_step=1e-4)
    assert np.all(measure(told).noise.density > 100 * measure(recording).noise.density)


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


def test_a_late_torque_is_found_through_a_coarse_encoder(robot):
    found = discover(coarse(robot, seed=6, late=0.02), robot)
    named = {(e["effect"], e["axis"]) for e in found.effects}
    assert ("actuation_delay", 2) in named
    delay = next(e for e in found.effects if e["axis"] == 2)["parameters"]["delay"]["value"]
    assert delay == pytest.approx(0.02, rel=0.25)


def test_discovery_knows_no_effect_by_name():
    # A robot file has a key `payload` of its own.
    names = "|".join(sorted(set(effects.library()) - {"payload"}))
    for path in sorted(Path("workflow/jointwear/discovery").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        assert not re.search(rf"\b(?:{names})\b", text), path
        assert not re.search(r"effect\w*\s*[!=]=\s*[\"']|label\.split\(", text), path


NEW = '''
"""A hump of the housing that the joint rides over."""
import numpy as np
from jointwear.effects.effect import Effect, Parameter

def _columns(state, axis, source, p):
    return (1 / np.cosh((state.position[..., axis] - p["place"]) / p["width"]) ** 2)[..., None]

EFFECT = Effect(
    identifier="housing_hump", name="Hump of the housing", equation="h / cosh^2((q - q0) / w)",
    parameters=(
        Parameter("height", "N m", -1e4, 1e4, "h"),
        Parameter("place", "rad", -9.0, 9.0, "q0", fixed=True),
        Parameter("width", "rad", 0.01, 1.0, "w", 0.1),
    ),
    confused_with=("joint_spring",), excitation="both directions", source="a test", argument="position",
    argument_unit="rad", columns=_columns,
    torque=lambda state, axis, source, p: p["height"] * _columns(state, axis, source, p)[..., 0],
    parameters_of=lambda p, c: {**p, "height": float(c[0])},
    grid=lambda state, axis: [{"place": float(x), "width": 0.1} for x in np.linspace(-0.5, 0.5, 11)],
)
'''


def test_an_effect_of_one_new_file_is_found_named_and_written(robot, tmp_path):
    recording = coarse(robot, seed=9, step=1e-6)
    hump = 3.0 / np.cosh((recording.position[:, 2] - 0.2) / 0.12) ** 2
    torque = recording.torque.copy()
    torque[:, 2] += hump
    (tmp_path / "housing_hump.py").write_text(NEW, encoding="utf-8")
    with effects.more_entries(tmp_path):
        found = discover(replace(recording, torque=torque), robot)
        assert [(e["effect"], e["axis"]) for e in found.effects] == [("housing_hump", 3)]
        (entry,) = found.augmented_robot["effects"]
        assert entry["parameters"]["height"] == pytest.approx(3.0, rel=0.1)
        with found.files["augmented"].robot() as written:
            effects.check_effects(written)


def test_records_of_one_length_are_filtered_as_each_alone():
    columns = np.random.default_rng(3).normal(size=(150, 3))
    for lengths in ((50, 50, 50), (60, 90)):
        record = np.repeat(np.arange(len(lengths)), lengths)
        alone = [low_pass(columns[record == k], 7.0, 50.0) for k in range(len(lengths))]
        assert np.array_equal(limit(columns, record, 7.0, 50.0), np.concatenate(alone))


def test_the_filter_is_that_of_scipy():
    values = np.random.default_rng(4).normal(size=(400, 2))
    sections = butter(4, 20.0, fs=100.0, output="sos")
    assert np.array_equal(low_pass(values, 20.0, 100.0), sosfiltfilt(sections, values, axis=0, padlen=RINGING))


def test_whitening_looks_back_from_its_rows():
    columns, rows = np.random.default_rng(5).normal(size=(40, 2)), np.array([3, 7, 8, 39])
    lags, sigma = np.array([0.5, -0.2, 0.1]), 0.4
    wanted = (columns[rows] - sum(w * columns[rows - k] for k, w in enumerate(lags, start=1))) / sigma
    assert Whitener(rows, lags, sigma)(columns) == pytest.approx(wanted)


def one_joint(share=0.0):
    """A link of 0.6 kg m2 behind a motor of 0.4 kg m2, positions with white noise that was derived up to 20 Hz.

    Returns the problem, load (N,) without noise, residual (N,) with an elastic gear of `share` [s2], and its noise
    model.
    """
    rng, rate, count = np.random.default_rng(6), 100.0, 4000
    link, motor, spread, torque_noise_ = 0.6, 0.4, 1e-4, 0.02
    time = np.arange(count) / rate
    noise = DerivedNoise(np.array([[spread**2 / (rate / 2)]]), (2,), np.array([20.0]), False, rate)
    shaken = low_pass(derivatives(time, low_pass(rng.normal(0, spread, count), 20.0, rate))[1], 20.0, rate)
    residual = rng.normal(0, torque_noise_, count) - (link + motor) * shaken
    load = 3.0 * np.sin(2 * np.pi * 0.5 * time) + (0.1 * np.sin(2 * np.pi * 9.0 * time) if share else 0.0)
    problem = SimpleNamespace(
        measured=SimpleNamespace(rate=rate, noise=noise),
        mass_squares=np.array([[(link + motor) ** 2]]),
        robot=SimpleNamespace(armature=np.array([motor])),
        train_state=SimpleNamespace(load=(load + link * shaken)[:, None], record=np.zeros(count)),
        settings=Settings(),
    )
    white = estimate(residual, np.ones(count, bool), np.zeros(count, int), 16)
    return problem, load, residual + share * second_derivative(_clock(time), load), white


def test_a_fused_load_shares_no_noise_with_the_residual():
    problem, load, residual, white = one_joint()
    fused = fused_load(problem, 0, white, residual)
    time = np.arange(len(load)) / problem.measured.rate
    given = problem.train_state.load[:, 0]
    errors = [second_derivative(_clock(time), x - load)[50:-50] for x in (given, fused)]
    shared = [np.corrcoef(x, residual[50:-50])[0, 1] for x in errors]
    assert shared[0] > 0.7
    assert abs(shared[1]) < 0.1
    assert np.std(errors[1]) < 0.6 * np.std(errors[0])


def test_a_fused_load_keeps_a_gear_that_it_knows():
    """What a gear adds to the residual is no noise of the load: not known, it takes most of a wave near its swing."""
    share = 3e-4
    problem, load, residual, white = one_joint(share)
    wave = load - low_pass(load, 3.0, problem.measured.rate)
    seen = [fused_load(problem, 0, white, residual, x) @ wave / (wave @ wave) for x in (0.0, share)]
    assert seen[0] < 0.6
    assert seen[1] == pytest.approx(1.0, abs=0.05)


def test_columns_of_a_soft_gear_end_before_the_fused_load_is_spoilt():
    problem, _, _, white = one_joint()
    ends = [end_of_columns(problem, 0, white, share, 7.0, 14.0) for share in (1e-6, 1e-4, 3e-4, 1e-2)]
    assert ends == sorted(ends, reverse=True)
    assert (ends[0], ends[-1]) == pytest.approx((14.0, 7.0))


def test_what_a_gear_does_above_its_band_does_not_change_its_size(robot):
    problem = build_problem(split(coarse(robot)), robot, Settings())
    white = whiten(problem, estimate_noise(problem))
    # Columns that end within the motion.
    white = replace(white, cutoffs=[replace(c, timing=1.0) for c in white.cutoffs])
    gear = Candidate("joint_flexibility", 1, None, {"inertia_over_stiffness": 1e-4, "inertia": 0.0, "side": 0})
    # A late torque has none: where its columns end what is above is noise.
    late = Candidate("actuation_delay", 1, None, {"delay": 0.01, "lag": 1})
    (beside,) = beyond_band(white, [gear, late])
    assert not np.any(beside.raw[1])
    state = white.state_of(effects.get_effect(gear.effect), 1, gear.nonlinear, assumed.OCTAVE)
    whole = white.columns(1, effects.get_effect(gear.effect).columns(state, 1, None, gear.nonlinear))[:, 0]
    lacking = replace(white, targets=[whole if axis == 1 else 0 * y for axis, y in enumerate(white.targets)])
    term = term_of(white, gear)
    sizes = [float(lacking.fit([term, *more]).theta[-1 - len(more)]) for more in ([], [beside])]
    assert sizes[0] > 1.1
    assert sizes[1] == pytest.approx(1.0, abs=0.05)


def _clock(time):
    return SimpleNamespace(record=np.zeros(len(time)), time=time)


def test_samples_of_a_shared_drive_that_sticks_are_left_out():
    rng = np.random.default_rng(3)
    time = np.arange(4000) / RATE
    velocity = np.stack([np.sin(w * time + k) for k, w in enumerate((2.0, 3.1, 4.3))], axis=1)
    acceleration = np.gradient(velocity, 1 / RATE, axis=0)
    usable, inertial = np.abs(velocity) > 0.02, rng.standard_normal((4000, 3, 2))
    speed = velocity[:, 1] + velocity[:, 2]
    slow = np.abs(speed) < assumed.STICKS
    # A shared drive on joints 2 and 3, of any friction where it sticks.
    level = np.where(slow, rng.uniform(-1, 1, 4000), np.sign(speed))
    missing = 0.02 * rng.standard_normal((4000, 3)) + 0.8 * level[:, None] * np.array([0, 1, 1])
    stuck = sticking(usable, velocity, acceleration, missing, inertial)
    assert not stuck[:, 0].any()
    np.testing.assert_array_equal(stuck[:, 1:], np.stack([slow, slow], axis=1))
    missing[:, 1] = 0.02 * rng.standard_normal(4000)
    assert not sticking(usable, velocity, acceleration, missing, inertial)[:, 1].any()


def test_bridges_are_straight_within_a_record_and_change_nothing_that_can_be_judged():
    rng = np.random.default_rng(3)
    columns, usable = rng.normal(size=(40, 2)), rng.random(40) > 0.4
    record = np.repeat([0, 1], 20)
    usable[[18, 19, 20, 21]] = False
    found = bridged(columns, usable, record)
    assert np.array_equal(found[usable], columns[usable])
    for piece in (slice(0, 20), slice(20, 40)):
        place = np.arange(20)[usable[piece]]
        for k in range(2):
            straight = np.interp(np.arange(20), place, columns[piece, k][usable[piece]])
            assert found[piece, k] == pytest.approx(straight, abs=1e-12)
    assert np.array_equal(bridged(columns[:, 0], usable, record), found[:, 0])
    assert np.array_equal(bridged(columns, np.zeros(40, bool), record), columns)


def test_what_cannot_be_judged_does_not_reach_its_neighbours(rough):
    axis = next(a for a in rough.problem.judged if np.isfinite(rough.cutoffs[a].judged))
    column = rough.problem.discrepancy[rough.problem.train, axis]
    spiked = np.where(rough.problem.usable[:, axis], column, 100.0)
    assert np.array_equal(rough.raw(axis, spiked), rough.raw(axis, column))


def test_a_delay_above_the_band_of_its_columns_is_no_structure(rough):
    """What the band limit of an instrument takes off is part of the tolerance of the effect."""
    axis = rough.problem.judged[0]
    cutoffs = [Cutoffs(timing=0.4, torque=8.0, judged=8.0, late=0.4)] * len(rough.cutoffs)
    asked = replace(rough, base=[], cutoffs=cutoffs, _states={})
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
