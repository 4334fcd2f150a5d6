"""Structure that links explain which are further off than was said is told as that; what acts from outside is not."""

from dataclasses import replace

import numpy as np
import pytest
from scratch_project import ROOT

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.problem.whitening import INERTIAL
from jointwear.discovery.search.leftovers import unexplained
from jointwear.discovery.search.links_known_less import links_in_words
from jointwear.files.documents import read_yaml

DATASETS = read_yaml(ROOT / "workflow/schemas/config.schema.yaml")["properties"]["discover"]["properties"]["datasets"]
ELBOW = 2


def _outcome(white, added):
    """Return what is left unexplained of targets to which whitened torque is added, axis by axis."""
    white = replace(white, targets=[y + more for y, more in zip(white.targets, added, strict=True)])
    outcome = Outcome(white.problem, white, white.fit(), None)
    outcome.unexplained = unexplained(outcome)[0]
    return outcome


def _links_off(white, sigmas):
    """Return what is left of links that are off by so many standard deviations where they are said to be well known."""
    white = replace(white, base=[replace(t, std=0.2 * t.std) if t.label == INERTIAL else t for t in white.base])
    links = next(t for t in white.base if t.label == INERTIAL)
    off = sigmas * links.std
    return _outcome(white, [links.blocks[a] @ off if a in links.blocks else 0.0 for a in range(len(white.targets))])


@pytest.fixture(scope="module")
def pushed(white):
    """Something pushes the elbow for a tenth of the time."""
    rows = len(white.targets[ELBOW])
    push = np.zeros(rows)
    push[rows // 2 : rows // 2 + rows // 10] = 3.0
    return _outcome(white, [push if a == ELBOW else 0.0 for a in range(len(white.targets))])


def test_links_further_off_than_said_are_told(white):
    far_off = _links_off(white, 8.5)
    assert {u.argument for u in far_off.unexplained} == {"position"}
    (words,) = links_in_words(far_off)
    assert words.endswith("state inertial_prior: 0.15")
    # What the schema does not allow is not asked for.
    most = DATASETS["additionalProperties"]["properties"]["inertial_prior"]["maximum"]
    for prior, told in ((most / 3.0, 1), (1.01 * most / 3.0, 0)):
        settings = replace(white.problem.settings, inertial_prior=prior)
        far_off.problem = replace(white.problem, settings=settings)
        assert len(links_in_words(far_off)) == told


def test_a_push_is_not_told_as_links(pushed):
    assert pushed.unexplained
    assert links_in_words(pushed) == []


def test_nothing_is_told_where_nothing_is_left(white):
    assert links_in_words(_outcome(white, [0.0] * len(white.targets))) == []
