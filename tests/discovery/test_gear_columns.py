"""Columns of an elastic gear before the encoder."""

from dataclasses import replace

import numpy as np

from jointwear.discovery.candidates import Candidate, raw_torques


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
    wild = raw_torques(replace(white, problem=problem, _states={}), gear)[1]
    assert ends > 0
    assert np.abs(wild - calm).max() < 1e-9
