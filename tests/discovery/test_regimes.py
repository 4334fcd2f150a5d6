"""Residual torque by regime: what the map of the page shows, and on which joint an effect of the whole arm is shown."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.discovery.presentation.drawing import axis_of, draw_effect, draw_regimes
from jointwear.discovery.problem.regimes import (
    BINS,
    ModelSamples,
    axis_of_most,
    binned_mean,
    pose_of_most,
    read_model_samples,
    residual_by_regime,
)
from jointwear.files.storage import Variable, write_dataset


def motion(missing, samples=1600, noise=0.01):
    """Three joints, the last at rest; `missing` (position, velocity) gives the torque (N, 3) that the model lacks."""
    time = np.arange(samples) / 50
    phase = np.outer(time, [1.3, 2.1, 0.0]) + 0.4
    position, velocity = np.sin(phase), np.array([1.3, 2.1, 0.0]) * np.cos(phase)
    error = noise * np.random.default_rng(5).standard_normal((samples, 3))
    usable = np.ones((samples, 3), dtype=bool)
    usable[:, 2] = False
    return ModelSamples(
        time=time,
        position=position,
        velocity=velocity,
        acceleration=-position,
        temperature=np.full((samples, 3), np.nan),
        load=position.copy(),
        usable=usable,
        retuned=missing(position, velocity) + error,
        augmented=error,
    )


def payload(position, velocity):
    """Small on joint 1, large on joint 2, and a function of the position of joint 1."""
    return np.stack([0.1 * position[:, 0], 3 * position[:, 0] ** 2, np.zeros(len(position))], axis=1)


def stored(found, path):
    pair = ("instant", "joint")
    torque = 0 * found.retuned
    variables = {"joint": Variable(("joint",), np.arange(1, 4), "number of the joint", "1")}
    for name in ("position", "velocity", "acceleration", "temperature", "load"):
        variables[name] = Variable(pair, getattr(found, name), name, "1")
    variables["time"] = Variable(("instant",), found.time, "time", "s")
    variables["usable"] = Variable(pair, found.usable.astype(np.int8), "usable", "1")
    variables["torque"] = Variable(pair, torque, "torque", "N m")
    variables["retuned"] = Variable(pair, torque - found.retuned, "torque", "N m")
    variables["augmented"] = Variable(pair, torque - found.augmented, "torque", "N m")
    write_dataset(path, variables, {"title": "models of a test"})
    return path


def test_friction_over_position_is_found_in_newton_metres():
    def missing(position, velocity):
        one = 2 * np.sign(velocity[:, 0]) * (position[:, 0] > 0)
        return np.stack([one, 0 * one, 0 * one], axis=1)

    found = residual_by_regime(motion(missing))
    most = found.largest()
    assert (most["joint"], most["argument"]) == (1, "position x direction")
    assert most["rms"] == pytest.approx(np.sqrt(2), rel=0.1)
    assert most["share"] > 0.9
    assert np.isnan(found.residual[2])
    assert np.isnan(found.rms[2]).all()
    assert not any("temperature" in name for name in found.arguments)


@given(st.integers(0, 50))
def test_a_binned_mean_never_explains_more_than_there_is(seed):
    random = np.random.default_rng(seed)
    residual, argument, carrier = random.standard_normal((3, 40 * BINS))
    mean = binned_mean(residual, argument, carrier)
    assert np.mean(mean**2) == pytest.approx(np.mean(mean * residual))
    assert np.mean(mean**2) <= np.mean(residual**2)


def test_noise_alone_has_small_shares():
    found = residual_by_regime(motion(lambda position, velocity: 0 * position))
    assert np.nanmax(found.share) < 0.05


def test_a_payload_is_shown_where_it_matters_most(tmp_path):
    found = motion(payload)
    assert axis_of_most(found) == 1
    assert pose_of_most(found, 1) == 0
    path = stored(found, tmp_path / "models.nc")
    np.testing.assert_allclose(read_model_samples(path).retuned, found.retuned)
    effect = {"effect": "payload", "axis": None, "source_axis": None, "regime": {"argument": "pose"}}
    assert axis_of(effect, path) == 1
    assert axis_of({**effect, "axis": 3}, path) == 2
    draw_effect(effect, 0, path, tmp_path / "effect.svg")
    assert "Mean residual of joint 2 over position of joint 1 [rad]" in (tmp_path / "effect.svg").read_text()


def test_the_map_says_torque_and_share(tmp_path):
    draw_regimes(residual_by_regime(motion(payload)), tmp_path / "regimes.svg")
    text = (tmp_path / "regimes.svg").read_text()
    assert "most on joint 2 over position of another joint" in text
    assert "at rest" in text
    assert "RMS in N m and share" in text
