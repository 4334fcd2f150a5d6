"""Structure over how far a joint has gone since it last turned round, as a drag chain or a seal leaves."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.search.leftovers import unexplained
from jointwear.discovery.structure import axis_bases
from jointwear.effects.bristle import travel_since_reversal

SINCE_REVERSAL = "travel since reversal x direction"


def test_travel_begins_anew_where_the_joint_turns_round_and_is_held_at_rest():
    position = np.array([0.0, 1.0, 2.0, 2.0, 1.5, 0.5, 0.5, 1.0])
    direction = np.array([0, 1, 1, 0, -1, -1, 0, 1])
    travel = travel_since_reversal(position, direction)
    assert np.isnan(travel[:4]).all()
    # The turn was seen at the sample before the first that moves back.
    assert travel[4:] == pytest.approx([0.5, 1.5, 1.5, 0.5])


def test_without_a_reversal_no_travel_is_known():
    assert np.isnan(travel_since_reversal(np.arange(5.0), np.ones(5))).all()
    assert np.isnan(travel_since_reversal(np.zeros(5), np.zeros(5))).all()


def test_a_joint_that_never_turns_round_has_no_such_basis(white):
    state, axis = white.problem.train_state, 1
    onwards = replace(state, velocity=np.abs(state.velocity) + 0.1)
    for one, has in ((state, True), (onwards, False)):
        found = axis_bases(one, axis, white.problem.usable[:, axis])
        assert any(basis.argument == SINCE_REVERSAL for basis in found) == has


def test_a_pull_that_begins_some_way_after_a_reversal_is_structure_over_that_travel(white):
    state, axis = white.problem.train_state, 1
    travel, way = np.zeros(len(state.time)), state.direction[:, axis]
    for label in np.unique(state.record):
        part = np.flatnonzero(state.record == label)
        travel[part] = np.nan_to_num(travel_since_reversal(state.position[part, axis], way[part]))
    pull = np.where(travel > 0.3, 2.0 * way, 0.0)
    extra = white.columns(axis, pull[:, None])[:, 0]
    asked = replace(white, targets=[y + extra if a == axis else y for a, y in enumerate(white.targets)])
    found, _ = unexplained(Outcome(asked.problem, asked, asked.fit(), None))
    assert (found[0].axis, found[0].argument) == (axis, SINCE_REVERSAL)
