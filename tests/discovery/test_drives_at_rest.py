"""Where a shared drive that has a name is slow enough to stick no structure is told of its joints."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.search.drives_at_rest import at_rest
from jointwear.discovery.search.leftovers import unexplained

AXIS, OTHER = 4, 5
DRIVE = Candidate("drive_coupling", AXIS, OTHER, {"own": 1.0, "other": 1.0})


def _outcome(white, level, wrong=0.0):
    """Return an outcome with a named drive of Coulomb friction `level` [N m], off by `wrong` where it sticks."""
    columns = raw_columns(white, DRIVE)
    blocks, raw = {AXIS: white.columns(AXIS, columns)}, {AXIS: white.raw(AXIS, columns)}
    term = Term("drive_coupling", blocks, np.full(3, 1e3), raw)
    speed = white.problem.train_state.velocity[:, [AXIS, OTHER]].sum(axis=1)
    torque = level * columns[:, 0] + wrong * (np.abs(speed) < assumed.STICKS)
    targets = [y + white.columns(a, torque[:, None])[:, 0] if a == AXIS else y for a, y in enumerate(white.targets)]
    asked = replace(white, targets=targets)
    return Outcome(asked.problem, asked, asked.fit([term]), None, named=[Named(DRIVE, term, None, 99.0)]), speed


@pytest.mark.parametrize("level", [0.0, 60.0])
def test_a_named_drive_is_unknown_where_it_may_stick(white, level):
    sigma = white.whiteners[AXIS].sigma
    outcome, speed = _outcome(white, level * sigma)
    mask, slow = at_rest(outcome, AXIS), (np.abs(speed) < assumed.STICKS)[white.whiteners[AXIS].rows]
    assert slow.any()
    assert mask[slow].all() if level else not mask.any()
    assert np.mean(mask) < 0.5
    assert not at_rest(outcome, OTHER).any()
    assert not at_rest(replace(outcome, named=[]), AXIS).any()


def test_what_it_does_there_is_no_structure(white, monkeypatch):
    sigma = white.whiteners[AXIS].sigma
    outcome, _ = _outcome(white, 60.0 * sigma, wrong=12.0 * sigma)

    def most():
        return max(u.nats for u in unexplained(outcome, robust=True)[1] if u.axis == AXIS)

    without = most()
    monkeypatch.setattr("jointwear.discovery.search.leftovers.at_rest", lambda *_: False)
    assert without < 0.2 * most()
