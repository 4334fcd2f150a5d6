"""A joint is unexplained for what it lacks itself, not for what another has bent of the links that they share."""

import numpy as np
import pytest
from discovery_cases import lacking_on

from jointwear.discovery.estimates.outcome import Outcome, Unexplained
from jointwear.discovery.search.leftovers import unexplained
from jointwear.discovery.search.of_its_own import of_its_own

BAD, OTHER = 1, 2


def _left(white):
    outcome = Outcome(white.problem, white, white.fit(), None)
    outcome.unexplained = unexplained(outcome)[0]
    return outcome


def _strange(white, axis, size):
    """Return a torque (N_train,) [N m] in time with the acceleration that no inertia makes."""
    pace = white.problem.train_state.acceleration[:, 0] + white.problem.train_state.acceleration[:, axis]
    return size * np.sign(pace) * np.abs(pace) ** 0.3


@pytest.mark.parametrize("size", [1.0, 5.0, 20.0])
def test_joints_that_lack_nothing_are_not_listed_beside_one_whose_misfit_bends_the_links(white, size):
    """Up to four sound joints stood beside the one to look at, at p-values of 1e-300."""
    outcome = _left(lacking_on(white, BAD, _strange(white, BAD, size)))
    assert {u.axis for u in outcome.unexplained} > {BAD}
    assert {u.axis for u in of_its_own(outcome, outcome.unexplained)} == {BAD}


@pytest.mark.parametrize("size", [5.0, 20.0])
def test_two_joints_that_lack_something_are_both_listed(white, size):
    one = lacking_on(white, BAD, _strange(white, BAD, size))
    outcome = _left(lacking_on(one, OTHER, _strange(white, OTHER, 0.2 * size)))
    assert {u.axis for u in of_its_own(outcome, outcome.unexplained)} == {BAD, OTHER}


def test_one_joint_alone_is_not_asked_again(white):
    outcome = _left(white)
    alone = [Unexplained(BAD, "time", "s", 0.0, 1.0, 1e-9, 20.0)]
    assert of_its_own(outcome, alone) is alone
