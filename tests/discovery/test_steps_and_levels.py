"""Another level in every record is no drift, and no friction over the position."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import lacking_on, trial_of

from jointwear.discovery.linear import gain
from jointwear.discovery.search.steps_and_levels import levels_lead, nats_beside_levels
from jointwear.effects import get_effect

AXIS = 1
DRIFT = get_effect("torque_offset_drift")


def test_levels_of_records_are_no_wave(white):
    state = white.problem.train_state
    record, half = np.asarray(state.record), 0.5 * white.problem.settings.accept
    waves = [p for p in DRIFT.grid(state, AXIS) if "period" in p]
    levels = lacking_on(white, AXIS, np.array([6.0, -5.0, 7.0])[record - record.min()])
    leads = [levels_lead(levels, levels.fit([]), trial_of(levels, "torque_offset_drift", AXIS, p)) for p in waves]
    assert min(leads) > half
    drifts = lacking_on(white, AXIS, 7.0 * np.sin(2 * np.pi * (state.time - waves[2]["start"]) / waves[2]["period"]))
    assert levels_lead(drifts, drifts.fit([]), trial_of(drifts, "torque_offset_drift", AXIS, waves[2])) < half


@pytest.mark.parametrize(("within", "told"), [(False, False), (True, True)])
def test_friction_over_a_position_of_its_own_in_each_record_is_a_level_of_it(white, within, told):
    """Friction that fell with the temperature was told as a wave over a travel of which the middle was never visited:
    its file was 3.5 times as bad as the noise there."""
    state, half = white.problem.train_state, 0.5 * white.problem.settings.accept
    record = np.asarray(state.record) - np.min(state.record)
    position = state.position.copy()
    # Each record keeps to a seventh of what the joint travels.
    position[:, AXIS] = np.array([-2.2, -1.9, 1.0])[record] + position[:, AXIS] / 7.0
    apart = replace(state, position=position)
    asked = replace(white, problem=replace(white.problem))
    vars(asked.problem)["train_state"] = apart
    levels = np.array([2.0, 2.0, -3.0])[record]
    wave = 6.0 * np.sin(9.0 * position[:, AXIS])
    torque = (wave if within else levels) * state.direction[:, AXIS]
    nonlinear = {"order": 9.0 if within else 1.5, "low": -2.5, "high": 1.5}
    trial = trial_of(asked, "position_dependent_friction", AXIS, nonlinear)
    lacking = lacking_on(asked, AXIS, torque)
    assert gain(*lacking.fit([]).gram(trial.term.blocks), trial.term.std) > half
    assert (nats_beside_levels(lacking, [], trial) > half) is told
