"""Friction and motor inertia that records left out support only in part are written in part, and that is told."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings, discover
from jointwear.discovery.estimates.outcome import Unexplained
from jointwear.discovery.linear import Term
from jointwear.discovery.model.drive_shares import drive_shares, supported, surely_impossible, told_shares
from jointwear.discovery.model.estimation import finalise
from jointwear.discovery.model.fallback import DRIVE
from jointwear.discovery.model.left_out import Asked
from jointwear.discovery.model.told_fallbacks import told_fallbacks
from jointwear.discovery.model.written_robot import written_robot
from jointwear.discovery.presentation.page import put_back_in_words
from jointwear.discovery.verdict import Gap


@pytest.fixture(scope="module")
def found(robot):
    """Viscous friction of joint 2 that is twice what the robot file says."""

    def twice(q, v, *_):
        full = np.zeros_like(q)
        full[:, 1] = robot.viscous[1] * v[:, 1]
        return full

    return discover(make_case(robot, 22, twice), robot, Settings())


def worth(shares, left=1.0, given=1.0):
    """Records with which the drive predicts best at `shares` (r,), each with one unit of its torque squared."""
    shares = np.asarray(shares, float)
    return np.column_stack([shares, np.ones(len(shares)), np.full((len(shares), 2), [left, given])])


@pytest.mark.parametrize(
    ("shares", "low", "high"),
    [
        ((1.0, 1.0, 1.0), 1.0, 1.0),
        ((0.6, 0.6, 0.6, 0.6), 0.6, 0.6),
        ((1.55, 0.61, 0.89), 0.0, 0.4),  # as of a hose that pulls otherwise in each record
        ((0.97, 1.0, 0.98), 0.9, 0.98),
        ((1.4, -0.8, 0.3), 0.0, 0.0),
        ((0.3,), 1.0, 1.0),  # one record says nothing of another
    ],
)
def test_a_drive_is_written_as_far_as_all_records_surely_support_it(shares, low, high):
    assert low - 1e-9 <= supported(worth(shares, given=9.0), Settings()) <= high + 1e-9


def test_more_records_that_scatter_alike_support_more():
    some, many = worth([1.2, 0.8, 1.0], given=9.0), worth([1.2, 0.8, 1.0] * 3, given=9.0)
    assert supported(some, Settings()) < supported(many, Settings()) < 1.0
    assert supported(7.0 * some, Settings()) == pytest.approx(supported(some, Settings()))


@pytest.mark.parametrize(("left", "share"), [(1.0, 0.0), (1.2, 0.167), (2.2, 0.5)])
def test_a_drive_on_which_written_links_lean_is_not_given_up_below_the_margin(left, share):
    """The others alone leave 1.2 times the given squares: with a sixth of the drive it is the margin. 2.2 is beyond."""
    squares = worth([1.0, -0.2, 0.7], left=left)
    assert supported(squares, Settings()) == pytest.approx(share, abs=1e-3)
    if left == 1.2:
        right, square, others, given = squares.sum(axis=0)
        error = others - 2.0 * share * right + share**2 * square
        assert np.sqrt(error / given) == pytest.approx(Settings().not_worse, abs=1e-3)


def test_what_drives_are_worth_is_what_the_model_leaves_of_records_left_out(found):
    white, terms = found.final.outcome.white, list(found.final.fit.terms)
    ask = Asked(white, terms, each=False)
    ratio = ask(terms).ratio
    for axis, squares in ask.drives(terms).items():
        right, square, left, given = squares.sum(axis=0)
        assert np.sqrt((left - 2.0 * right + square) / given) == pytest.approx(ratio[axis], rel=1e-9)


def test_only_axes_with_structure_or_that_do_not_gain_nearly_always_are_asked(found):
    """Friction of joint 2 is wrong and gains in every block: it is written as fitted."""
    white, kept = found.final.outcome.white, list(found.final.fit.terms)
    axis = 1
    assert any(t.drive[:1] == (axis,) for t in kept)
    assert axis not in drive_shares(white, kept, [])
    rows = white.whiteners[axis].rows
    sign, record = np.sign(white.problem.train_state.velocity[rows, axis]), white.folds(axis)
    sigma = white.whiteners[axis].marginal
    odd = replace(white.problem, discrepancy=white.problem.discrepancy.copy())
    lacks = 20.0 * sign * np.where(record == record.max(), 0.8, 1.0)
    odd.discrepancy[np.flatnonzero(white.problem.train)[rows], axis] = sigma * lacks
    targets = [lacks if a == axis else np.zeros_like(y) for a, y in enumerate(white.targets)]
    trial = replace(white, problem=odd, targets=targets)
    term = Term("friction", {axis: sign[:, None]}, np.array([1e3]), {axis: sigma * sign[:, None]}, (axis, 0))
    assert drive_shares(trial, [term], []) == {}
    ((share, ratio),) = drive_shares(trial, [term], [axis]).values()
    assert 0.0 < share < 1.0
    assert ratio < 1.0
    # Beside a name of its own axis the parameters of a drive are asked as the name was.
    effect = Term("effect", {axis: np.ones((len(rows), 1))}, np.ones(1), {axis: np.ones((len(rows), 1))}, effect=True)
    assert drive_shares(trial, [term, effect], [axis]) == {}


@pytest.mark.parametrize("share", [0.4, 0.0])
def test_both_files_hold_the_share_and_the_page_tells_it(found, robot, monkeypatch, share):
    axis = 1
    whole = finalise(found.final.outcome)
    assert whole.delta_friction[axis].any()
    monkeypatch.setattr("jointwear.discovery.model.drive_shares.supported", lambda *_: share)
    left = Unexplained(axis, "position", "rad", 0.0, 1.0, 1e-12, 50.0)
    outcome = replace(found.final.outcome, unexplained=[left])
    monkeypatch.setattr("jointwear.discovery.model.estimation.put_back", lambda _, terms, *more: (list(terms), ()))
    final = finalise(outcome)
    monkeypatch.setattr("jointwear.discovery.model.drive_shares.supported", lambda *_: 1.0)
    fitted = finalise(outcome)
    assert fitted.delta_friction[axis].any()
    for part, all_of_it in (
        (final.delta_friction, fitted.delta_friction),
        (final.retuned_friction, fitted.retuned_friction),
    ):
        assert part[axis] == pytest.approx(share * all_of_it[axis])
    viscous = written_robot(final).data["joints"][axis]["viscous"] * robot.gear_ratio[axis] ** 2
    assert viscous == pytest.approx(robot.viscous[axis] + share * fitted.delta_friction[axis, 2])
    words = f"friction and motor inertia at {share:g} of what was fitted" if share else DRIVE
    mine = [f for f in final.fallbacks if f.axis == axis + 1]
    assert [(f.model, f.step, f.in_part) for f in mine] == [
        (model, words, share > 0.0) for model in ("augmented", "retuned")
    ]
    gap = Gap((1.0,) * 6, (0.8,) * 6, (0.8,) * 6, (0.1,) * 6)
    told = told_fallbacks(replace(final, fallbacks=tuple(mine)), gap)
    assert all(("in part as fitted" in f.kept) == (share > 0.0) for f in told)


def test_a_drive_that_gains_and_loses_by_turns_is_told_with_that_reason():
    (step,) = told_shares({0: (0.35, 0.9)}, "augmented")
    entry = {
        "model": "augmented",
        "axis": 1,
        "steps": [{"step": step.step, "ratio": 0.9}],
        "kept": "",
        "held_out": None,
    }
    (words,) = put_back_in_words({"fallbacks": [entry], "unexplained": []})
    assert "it gains in some stretches of time and loses in others" in words
    assert "Put back: friction and motor inertia at 0.35 of what was fitted." in words


def test_a_fit_below_zero_beside_structure_without_a_name_is_not_written():
    """A record of 3 s had joint 2 without friction in one direction and without a motor, and lost 11 % elsewhere."""
    nominal = np.array([[6.0, 6.0, 2.0, 2.0]] * 3)
    std = np.full((3, 4), 0.5)
    change = np.zeros((3, 4))
    change[0, 0], change[1, 3], change[2, 3] = -9.0, -2.5, -9.0
    # Of the second axis zero is within what is not known; of the third nothing stays unexplained.
    assert surely_impossible(nominal, change, std, [0, 1], Settings()) == [0]
    # What the robot file has not, or no data tell of, is no reason.
    assert surely_impossible(np.zeros((3, 4)), change, std, [0, 1, 2], Settings()) == []
    assert surely_impossible(nominal, change, np.zeros((3, 4)), [0, 1, 2], Settings()) == []
