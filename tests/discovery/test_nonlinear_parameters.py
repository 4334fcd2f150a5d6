"""Nonlinear parameters that stand in for each other: where the evidence is largest, and what is known of each."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import discover
from jointwear.discovery.estimates import curvature
from jointwear.discovery.estimates.curvature import LARGEST_SPREAD, Spreads, moved_together, spreads_of
from jointwear.discovery.problem.candidates import Candidate

CURVE = Candidate("stribeck_friction", 0, None, {"speed": 0.1, "exponent": 1.0})
POWER = Candidate("nonlinear_viscous_friction", 0, None, {"exponent": 1.0})


def ridge(monkeypatch, covariance, at=(0.1, 1.0), edge=np.inf):
    """Let the evidence be that of two parameters of a Stribeck curve with a covariance of their logarithms."""
    precision = np.linalg.inv(covariance)

    def evidence_at(white, fit, candidate, any_size=False):
        if candidate.nonlinear["exponent"] >= edge:
            return -np.inf
        off = np.log([candidate.nonlinear[name] / best for name, best in zip(("speed", "exponent"), at, strict=True)])
        return -0.5 * off @ precision @ off

    monkeypatch.setattr(curvature, "evidence_at", evidence_at)
    monkeypatch.setattr(curvature, "limits", lambda white, candidate: {"speed": (1e-3, 5.0), "exponent": (0.3, 4.0)})


@pytest.mark.parametrize("edge", [0.0, 1.0])
def test_a_torque_that_would_have_to_turn_round_says_nothing_of_its_parameter(monkeypatch, edge):
    """Evidence ends there: its curvature is none, or without bound."""

    def evidence_at(white, fit, candidate, any_size):
        assert any_size
        exponent = candidate.nonlinear["exponent"]
        return -np.inf if exponent >= edge else -0.5 * (np.log(exponent) / 0.2) ** 2

    monkeypatch.setattr(curvature, "evidence_at", evidence_at)
    assert spreads_of(None, None, POWER).std == {"exponent": LARGEST_SPREAD}


def test_the_curvature_of_the_evidence_is_the_spread_of_a_parameter(monkeypatch):
    def evidence_at(white, fit, candidate, any_size):
        return -0.5 * (np.log(candidate.nonlinear["exponent"]) / 0.2) ** 2

    monkeypatch.setattr(curvature, "evidence_at", evidence_at)
    assert spreads_of(None, None, POWER).std["exponent"] == pytest.approx(0.2)


def test_what_is_known_of_a_parameter_is_not_what_is_known_while_the_others_are_held(monkeypatch):
    """While the exponent is held the speed seems known to 28 % of its standard deviation."""
    covariance = np.array([[0.04, 0.96 * 0.2 * 0.1], [0.96 * 0.2 * 0.1, 0.01]])
    ridge(monkeypatch, covariance)
    found = spreads_of(None, None, CURVE)
    assert found.std == pytest.approx({"speed": 0.2, "exponent": 0.1})
    np.testing.assert_allclose(found.root @ found.root.T, covariance, rtol=1e-6)


def test_one_parameter_of_which_nothing_is_known_leaves_the_other(monkeypatch):
    ridge(monkeypatch, np.diag([0.04, 0.01]), edge=1.0001)
    assert spreads_of(None, None, CURVE).std == pytest.approx({"speed": 0.2, "exponent": LARGEST_SPREAD})


def test_spreads_grow_to_others_and_keep_how_parameters_stand_in_for_each_other():
    one, other = Spreads(("a", "b"), np.array([[0.1, 0.0], [0.1, 0.1]])), Spreads(("a", "b"), 0.2 * np.eye(2))
    more = one.at_least(other)
    assert more.std == pytest.approx({"a": 0.2, "b": 0.2})
    covariance = more.root @ more.root.T
    assert covariance[0, 1] == pytest.approx(0.04 * np.sqrt(0.5))


def test_a_step_ends_on_a_bound():
    spreads = Spreads(("speed", "exponent"), np.array([[0.1, 0.0], [0.0, 2.0]]))
    moved = spreads.moved(CURVE, np.array([1.0, -1.0]))
    assert moved.nonlinear == pytest.approx({"speed": 0.1 * np.exp(0.1), "exponent": 0.3})


@pytest.mark.parametrize("at", [(0.105, 1.05), (0.14, 1.3), (0.1, 1.0)])
def test_parameters_move_along_a_ridge_together(monkeypatch, at):
    ridge(monkeypatch, np.array([[0.0016, 0.99 * 0.0016], [0.99 * 0.0016, 0.0016]]), at)
    moved = moved_together(None, None, CURVE)
    assert moved.nonlinear == pytest.approx({"speed": at[0], "exponent": at[1]}, rel=1e-3)


def test_a_single_parameter_is_left_where_its_own_search_ended():
    assert moved_together(None, None, POWER) is POWER


SIZE = {"excess": 9.0, "speed": 0.13, "exponent": 1.4}


def stribeck(q, v, *_):
    """Friction of joint 2 that rises towards low speed."""
    full = np.zeros_like(q)
    curve = np.exp(-((np.abs(v[:, 1]) / SIZE["speed"]) ** SIZE["exponent"]))
    full[:, 1] = SIZE["excess"] * curve * np.sign(v[:, 1])
    return full


@pytest.mark.long
def test_a_curve_of_three_parameters_lies_within_what_is_told_of_each(robot):
    """At the end of a search of one after the other, and with what is known of one while the others are held, the speed
    of the first was 3.1 standard deviations off."""
    off = []
    for seed in (41, 42, 43):
        recording = replace(make_case(robot, seed, stribeck), temperature=None)
        (found,) = discover(recording, robot).effects
        assert (found["effect"], found["axis"]) == ("stribeck_friction", 2)
        told = found["parameters"]
        off += [(told[name]["value"] - size) / told[name]["std"] for name, size in SIZE.items()]
    assert np.abs(off).max() < 2.0
