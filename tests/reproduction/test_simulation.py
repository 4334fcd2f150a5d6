"""The simulated measurement: what is random, what is exact, and every reading."""

import numpy as np
import pytest

from jointwear.files.storage import read_variables
from jointwear.reproduction import readings
from jointwear.reproduction.grid import Cell
from jointwear.reproduction.simulation import Noise, RepeatedTask
from jointwear.reproduction.wear import Wear
from jointwear.reproduction.worn_run import coulomb_levels, simulate_worn_run
from jointwear.robots.trajectory import load_task
from jointwear.statistics.randomness import generator

ROBOT = "config/robots/puma560_paper.yaml"


def reading(default_reading):
    return {k: default_reading[k] for k in readings.of_stage("simulation")}


def repeated(puma, root, noise, hours=24, axis=None, percent=20.0):
    hour = np.arange(1, hours + 1)
    levels = coulomb_levels(puma, hour, axis, Wear(percent, 1.5, hours) if axis else None)
    return RepeatedTask(puma, load_task(root / "config/tasks/T2.yaml"), levels, noise)


def test_without_noise_the_measurement_is_inverse_dynamics(puma, root, default_reading):
    quiet = Noise(0.0, 0.0, 0.5, reading(default_reading))
    run = repeated(puma, root, quiet, axis=3)
    measured = run.measure(generator(1, "x", replicate=0))
    np.testing.assert_allclose(measured, run.torque, atol=1e-9)


def test_wear_touches_its_axis_alone_and_ends_at_the_exact_growth(puma, root, default_reading):
    quiet = Noise(0.0, 0.0, 0.5, reading(default_reading))
    worn, healthy = repeated(puma, root, quiet, axis=3), repeated(puma, root, quiet)
    difference = worn.torque - healthy.torque
    assert not np.delete(difference, 2, axis=2).any()
    velocity = worn.motion.velocity[:, 2]
    expected = np.where(velocity > 0, puma.robot.coulomb_positive[2], puma.robot.coulomb_negative[2]) * 0.2
    np.testing.assert_allclose(difference[-1, :, 2], np.where(velocity == 0, 0, expected), atol=1e-12)


def test_the_coupled_disturbance_comes_back_as_torque(puma, root, default_reading):
    disturbed = Noise(0.01, 0.0, 0.5, reading(default_reading))
    run = repeated(puma, root, disturbed, hours=200)
    torque = run.measure(generator(1, "x", replicate=0))
    error = (torque - run.torque).std(axis=(0, 1))
    cycle = load_task(root / "config/tasks/T2.yaml").grid(0.5)
    mean = np.abs(puma.inverse_dynamics(cycle.position, cycle.velocity, cycle.acceleration)).mean(axis=0)
    np.testing.assert_allclose(error, 0.01 * mean, rtol=0.05)


@pytest.mark.parametrize(
    ("name", "value"),
    [(n, v) for n in readings.of_stage("simulation") for v in readings.ambiguities()[n].alternatives],
)
def test_every_alternative_simulates(puma, root, default_reading, name, value):
    noise = Noise(0.01, 1e-4, 0.5, {**reading(default_reading), name: value})
    torque = repeated(puma, root, noise, hours=3, axis=1).measure(generator(1, "x", replicate=0))
    assert torque.shape == (3, 60, 6)
    assert np.isfinite(torque).all()


def test_an_axis_at_rest_shows_noise_only_with_the_commanded_direction(puma, root, default_reading):
    task = load_task(root / "config/tasks/T1.yaml")
    hour = np.arange(1, 5)
    largest = {}
    for name in readings.ambiguities()["coulomb_direction"].alternatives:
        noise = Noise(0.01, 1e-4, 0.5, {**reading(default_reading), "coulomb_direction": name})
        run = RepeatedTask(puma, task, coulomb_levels(puma, hour), noise)
        largest[name] = np.abs(run.measure(generator(1, "x", replicate=0))[..., 5]).max()
    assert largest["commanded_velocity"] < 5e-4
    assert largest["measured_velocity"] > 0.3


SETTINGS = {
    "seed": 5,
    "replicates": 3,
    "sampling": {"interval": 10.0, "samples": 60},
    "noise": {"disturbance_share": 0.01, "encoder": 1e-4, "time_step": 0.5},
    "shape": 1.5,
    "wear_hours": 12,
}


@pytest.fixture
def settings(default_reading):
    return {**SETTINGS, "reading": reading(default_reading)}


def simulate(root, path, settings, axis=2, percent=10.0):
    cell = Cell("T1", percent, axis)
    simulate_worn_run(root / ROBOT, root / "config/tasks/T1.yaml", path, cell=cell, settings=settings)
    return read_variables(path, "torque")[0]


def test_same_seed_same_bytes(root, tmp_path, settings):
    simulate(root, tmp_path / "a.nc", settings)
    simulate(root, tmp_path / "b.nc", settings)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_another_seed_other_numbers(root, tmp_path, settings):
    a = simulate(root, tmp_path / "a.nc", settings)
    b = simulate(root, tmp_path / "b.nc", {**settings, "seed": 6})
    assert not np.allclose(a, b)


def test_a_replicate_does_not_depend_on_how_many_there_are(root, tmp_path, settings):
    few = simulate(root, tmp_path / "a.nc", {**settings, "replicates": 2})
    many = simulate(root, tmp_path / "b.nc", {**settings, "replicates": 5})
    assert np.array_equal(few, many[:2])


def test_streams_of_different_runs_differ():
    keys = [("wear", "T1", 1, 10000), ("wear", "T1", 2, 10000), ("wear", "T11", 1, 10000), ("normal", "T1")]
    draws = {tuple(generator(1, *key, replicate=r).random(4)) for key in keys for r in (0, 1)}
    assert len(draws) == 8


def test_files_open_with_xarray(root, tmp_path, settings):
    import xarray

    simulate(root, tmp_path / "a.nc", settings)
    with xarray.open_dataset(tmp_path / "a.nc") as data:
        assert data.torque.dims == ("replicate", "hour", "sample", "axis")
        assert data.torque.units == "N m"
        assert data.attrs["seed"] == 5
        assert len(data.attrs["config_digest"]) == 64
        for variable in data.variables.values():
            assert variable.attrs["long_name"]


def test_torque_limits_are_reported(root, tmp_path, settings):
    simulate(root, tmp_path / "a.nc", settings)
    torque, share = read_variables(tmp_path / "a.nc", "torque", "limit_share")
    limits = np.array([97.6, 186.4, 89.4, 24.2, 20.1, 21.3])
    np.testing.assert_allclose(share, np.abs(torque).max(axis=(0, 1, 2)) / limits, rtol=1e-6)


def test_an_axis_that_the_robot_lacks_is_refused(root, tmp_path, settings):
    with pytest.raises(ValueError, match="axis 7 cannot wear"):
        simulate_worn_run(
            root / ROBOT,
            root / "config/tasks/T1.yaml",
            tmp_path / "x.nc",
            cell=Cell("T1", 10.0, 7),
            settings={**settings, "shape": 1.0, "wear_hours": 12},
        )
    assert not list(tmp_path.iterdir())


def test_effects_of_the_robot_file_act_in_the_simulation(puma, root, default_reading):
    from dataclasses import replace

    from jointwear.robots.dynamics import Dynamics
    from jointwear.robots.robot import EffectEntry

    entry = EffectEntry("torque_constant_error", 2, None, {"share": 0.1})
    stretched = Dynamics(replace(puma.robot, effects=(entry,)))
    quiet = Noise(0.0, 0.0, 0.5, reading(default_reading))
    plain, changed = repeated(puma, root, quiet, hours=3), repeated(stretched, root, quiet, hours=3)
    factor = np.ones(6)
    factor[1] = 1.1
    np.testing.assert_allclose(changed.torque, plain.torque * factor, rtol=1e-9)
    measured = changed.measure(generator(1, "x", replicate=0))
    np.testing.assert_allclose(measured, changed.torque, atol=1e-9)
