"""A name that only an earlier search had is told with what stands for it."""

from dataclasses import replace

import pytest

from jointwear.discovery.estimates.outcome import Named, Outcome, Refusal
from jointwear.discovery.findings import lost_candidates
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, raw_columns
from jointwear.discovery.search.given_up import telling_names_given_up

SPRING = Candidate("joint_spring", 2, None, {"centre": 0.0, "low": -9.0, "high": 9.0})


def outcome(white, *named):
    return Outcome(white.problem, white, white.fit(), None, named=list(named))


def name(white, candidate):
    columns = raw_columns(white, SPRING)
    return Named(candidate, Term("spring", {2: white.columns(2, columns)}, [20.0] * columns.shape[1], {}), None, 50.0)


def test_a_name_that_is_given_up_is_told_with_what_is_left_of_its_evidence(white):
    before, after = outcome(white, name(white, SPRING)), outcome(white)
    told = telling_names_given_up(before, after, "nats beside slow noise")
    (lost,) = lost_candidates(told)
    assert (lost.effect, lost.axis, lost.gate) == ("joint_spring", 3, "nats beside slow noise")
    # Nothing of it is in these data.
    assert lost.reached < lost.needed == white.problem.settings.accept
    assert not after.refusals


@pytest.mark.parametrize("kept", ["named", "suspects", "refusals"])
def test_what_the_later_search_tells_itself_is_not_told_twice(white, kept):
    one = name(white, SPRING)
    entry = {"named": one, "suspects": (one, "why"), "refusals": Refusal(SPRING, 5.0, "nats", 5.0, 9.0)}[kept]
    after = replace(outcome(white), **{kept: [entry]})
    assert telling_names_given_up(outcome(white, one), after, "gate") is after


def test_masses_of_links_are_no_effects(white):
    before = outcome(white, name(white, Candidate(LINK_MASS, 2, None, {})))
    after = outcome(white)
    assert telling_names_given_up(before, after, "gate") is after
