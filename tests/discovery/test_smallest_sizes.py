"""What the check before discovery calls the smallest size is what a name asks for."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings
from jointwear.discovery.pipeline import discover
from jointwear.discovery.posing import pose_problem
from jointwear.discovery.preflight import check_data
from jointwear.discovery.problem.candidates import build_dictionary, term_of
from jointwear.discovery.problem.identifiability import identifiability
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.search.smallest_sizes import condensed, smallest_size
from jointwear.measurement.recording import split
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Link


def carrying(robot, mass: float):
    """Torques of a robot that carries a body of `mass` [kg] 0.15 m beyond the flange."""
    loaded = replace(robot, payload=Link(mass, np.array([0.0, 0.0, 0.15]), np.zeros((3, 3))))
    return lambda q, v, a, *_: Dynamics(loaded).inverse_dynamics(q, v, a) - Dynamics(robot).inverse_dynamics(q, v, a)


@pytest.fixture(scope="module")
def posed(robot):
    problem = pose_problem(split(make_case(robot, 31)), robot, Settings()).problem
    white = whiten(problem, estimate_noise(problem))
    return white, build_dictionary(white)


@pytest.mark.long
def test_a_payload_has_its_name_above_the_smallest_size_and_not_below(robot):
    (told,) = [s for s in check_data(make_case(robot, 31), robot).shown if s.effect == "payload"]
    assert told.unit == "kg"
    assert 0.0 < told.smallest_size < 5.0
    for times, named in ((2.0, ["payload"]), (0.2, [])):
        found = discover(make_case(robot, 31, carrying(robot, times * told.smallest_size)), robot)
        assert [e.effect for e in found.content.effects] == named


@pytest.mark.long
def test_a_body_asks_for_more_where_links_are_known_less(robot):
    case = make_case(robot, 31)
    checks = [check_data(case, robot, Settings(inertial_prior=prior)) for prior in (0.01, 0.05)]
    sizes = [next(s.smallest_size for s in check.shown if s.effect == "payload") for check in checks]
    assert sizes[0] < sizes[1]


def test_a_few_rows_say_the_same_as_all_samples(posed):
    white, dictionary = posed
    candidate = next(c for c, *_ in dictionary.entries[2] if c.effect == "joint_spring")
    term = term_of(white, candidate)
    few, short = condensed(white, term)
    assert max(len(y) for y in few.targets) < 100 < len(white.targets[0])
    _, gram = white.fit().gram(term.blocks)
    np.testing.assert_allclose(few.fit().gram(short.blocks)[1], gram, rtol=1e-6)


def test_an_axis_of_which_no_effect_is_asked_shows_none(posed):
    """As of one whose samples are too few between reversals."""
    white, dictionary = posed
    asked = replace(dictionary, entries={**dictionary.entries, 0: []})
    shown = {v.axis for v in identifiability(white, asked)}
    assert 0 not in shown
    assert shown >= set(white.problem.judged) - {0}


@pytest.mark.long
def test_the_torque_of_an_effect_has_to_matter_and_its_middle_form_to_be_seen(posed):
    white, dictionary = posed
    settings = white.problem.settings
    for v in identifiability(white, dictionary):
        if v.axis is None:
            continue
        assert v.middle <= v.energy
        size = smallest_size(white, v)
        assert size >= v.size * np.sqrt(settings.visible / max(v.left, 1e-12)) * (1 - 1e-12)
        whole = replace(white, problem=replace(white.problem, settings=replace(settings, smallest_share=1.0)))
        assert smallest_size(whole, v) >= size
