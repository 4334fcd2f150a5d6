"""How wrong the nominal parameters are, and what that leaves of certainty."""

from types import SimpleNamespace

import numpy as np

from jointwear.discovery.estimates.base import INERTIAL_ERRORS, doubted_links
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.whitening import INERTIAL

#: What moves with a link is hardly to be told from it: columns of a body at the flange and of the last link.
NOISE = np.random.default_rng(np.random.SeedSequence(5)).standard_normal((200, 3))
BODY = Term("payload", {0: NOISE[:, [0]]}, np.array([10.0]))
LINK = {0: NOISE[:, [0]] + 0.05 * NOISE[:, [1]]}


def fitted(correction: float, chosen: float) -> tuple[SimpleNamespace, Fit]:
    links = Term(INERTIAL, LINK, np.ones(1))
    targets = [BODY.blocks[0][:, 0] + correction * LINK[0][:, 0] + 0.3 * NOISE[:, 2]]
    fit = Fit(targets, [BODY, Term(INERTIAL, LINK, np.array([chosen]))])
    return SimpleNamespace(base=[links]), fit


def test_a_body_is_no_surer_than_the_link_that_carries_it():
    white, fit = fitted(0.0, INERTIAL_ERRORS[0])
    known, doubted = fit.covariance[0, 0], doubted_links(white, fit)[0, 0]
    loose = fitted(0.0, INERTIAL_ERRORS[-1])[1].covariance[0, 0]
    assert 2.0 * known < doubted < loose


def test_data_that_tell_of_the_links_leave_no_doubt():
    white, fit = fitted(40.0, INERTIAL_ERRORS[-1])
    np.testing.assert_allclose(doubted_links(white, fit), fit.covariance, rtol=0.05)


def test_without_links_nothing_is_doubted():
    fit = Fit([NOISE[:, 0]], [BODY])
    assert doubted_links(SimpleNamespace(base=[]), fit) is fit.covariance
