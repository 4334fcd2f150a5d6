"""A delay that shrinks or turns round beside all that is named is no name."""

from types import SimpleNamespace

import pytest

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.model import kept_sizes as module
from jointwear.discovery.model.kept_sizes import GATE, with_kept_sizes
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.settings import Settings

FOUND = 0.01
PROBLEM = SimpleNamespace(settings=Settings())


def _named(effect, axis):
    return Named(Candidate(effect, axis, None, {"delay": FOUND}), None, None, 100.0)


def _asked(monkeypatch, sizes):
    """Return the outcome of a spring and delays of axes whose estimated `sizes` {axis: delay} are given."""
    named = [_named("actuation_delay", axis) for axis in sizes] + [_named("joint_spring", 0)]
    settled = []

    def finalise(outcome):
        sized = [
            SimpleNamespace(named=n, parameters={"delay": sizes.get(n.candidate.axis, 1.0)}) for n in outcome.named
        ]
        return SimpleNamespace(estimates=tuple(sized))

    monkeypatch.setattr(module, "finalise", finalise)
    monkeypatch.setattr(module, "settle", settled.append)
    found = with_kept_sizes(Outcome(PROBLEM, None, None, None, named=named))
    assert len(settled) == len(named) - len(found.named)
    return found


@pytest.mark.parametrize("size", [0.7 * FOUND, FOUND, 2.0 * FOUND])
def test_a_delay_that_keeps_its_size_stays(monkeypatch, size):
    found = _asked(monkeypatch, {2: size})
    assert [n.candidate.effect for n in found.named] == ["actuation_delay", "joint_spring"]
    assert not found.refusals


def test_delays_that_shrink_or_turn_round_are_given_up_the_worst_first(monkeypatch):
    found = _asked(monkeypatch, {1: 0.3 * FOUND, 2: 0.9 * FOUND, 3: -0.1 * FOUND})
    assert [n.candidate.key[:2] for n in found.named] == [("actuation_delay", 2), ("joint_spring", 0)]
    assert [(r.candidate.axis, r.gate) for r in found.refusals] == [(3, GATE), (1, GATE)]
    assert all(r.reached < r.needed for r in found.refusals)


def test_other_effects_are_not_asked(monkeypatch):
    monkeypatch.setattr(module, "finalise", lambda outcome: pytest.fail("nothing is late"))
    outcome = Outcome(PROBLEM, None, None, None, named=[_named("joint_spring", 0)])
    assert with_kept_sizes(outcome) is outcome
