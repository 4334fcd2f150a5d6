"""Columns of an elastic gear before the encoder."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.effect_estimates import out_of_step
from jointwear.discovery.estimates.refine import refine
from jointwear.discovery.estimates.scan import scan
from jointwear.discovery.problem.candidates import Candidate, build_dictionary, raw_torques, whitened


def test_ends_of_records_do_not_shake_a_gear(white):
    state, ends = white.problem.train_state, white.problem.measured.vague_ends
    gear = Candidate(
        "joint_flexibility", 1, None, {"inertia_over_stiffness": 1e-3, "inertia": 2.0, "side": 1, "damping": 0.05}
    )
    calm = raw_torques(white, gear)[1]
    load = state.load.copy()
    for label in np.unique(state.record):
        rows = np.flatnonzero(state.record == label)
        load[rows[-ends:]] += 100.0
    problem = replace(white.problem)
    problem.__dict__["train_state"] = replace(state, load=load)
    wild = raw_torques(replace(white, problem=problem), gear)[1]
    assert ends > 0
    assert np.abs(wild - calm).max() < 1e-9


@pytest.mark.parametrize("damping", [0.05, 0.3, 0.6])
def test_a_swing_is_found_however_soon_it_ends(white, damping):
    link = float(np.mean(white.problem.train_state.wind_up_regressor(1)[0][..., 1]))
    parameters = {"inertia_over_stiffness": 3.7e-4, "inertia": link, "side": 1, "damping": damping}
    there = whitened(white, raw_torques(white, Candidate("joint_flexibility", 1, None, parameters)))
    shaken = replace(white, targets=[there[axis][:, 0] for axis in range(len(white.targets))])
    fit = shaken.fit()
    best = scan(shaken, build_dictionary(shaken), fit)[0].candidate
    assert best.key == ("joint_flexibility", 1, None)
    found = refine(shaken, fit, best).nonlinear
    assert found["damping"] == pytest.approx(damping, rel=0.25)
    assert found["inertia_over_stiffness"] == pytest.approx(3.7e-4, rel=0.1)


def test_a_damping_is_no_better_known_than_how_far_the_swing_is_out_of_step():
    gear = {"inertia_over_stiffness": 4e-4, "inertia": 2.0, "side": 1, "damping": 0.02}
    candidate = Candidate("joint_flexibility", 1, None, gear)
    std = {"inertia_over_stiffness": 1.6e-5, "damping": 0.015}
    # Four per cent of the square of a period are two per cent of the frequency.
    assert out_of_step(candidate, gear, std)["damping"] == pytest.approx(0.025)
    behind = Candidate("joint_flexibility", 1, None, {**gear, "side": 0})
    assert out_of_step(behind, gear, std) == {}
