"""Errors on records left out: the margin of a record to come, and what is worse by chance."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.discovery import Settings
from jointwear.discovery.model.left_out import Asked, margin, mean_squares, surely_worse
from jointwear.discovery.problem.whitening import INERTIAL


@given(st.lists(st.floats(0.01, 0.9), min_size=2, max_size=6), st.floats(0.1, 10.0))
def test_the_margin_of_a_record_to_come_has_no_unit(ratios, factor):
    squares = np.column_stack([np.square(ratios), np.ones(len(ratios))])
    assert margin(factor * squares, Settings()) == pytest.approx(margin(squares, Settings()), rel=1e-3, abs=1e-9)
    assert margin(squares[:1], Settings()) == np.inf
    # The same mean told by twice as many records, and an error that is larger in all of them alike.
    assert margin(np.vstack([squares, squares]), Settings()) >= margin(squares, Settings()) - 1e-9
    assert margin(squares * [4.0, 1.0], Settings()) < margin(squares, Settings())


@pytest.mark.parametrize(
    ("ratios", "kept"), [((0.5, 0.5, 0.5, 0.2), True), ((0.9, 0.95, 0.85, 0.9), True), ((0.2, 0.95, 0.95, 0.95), False)]
)
def test_a_record_that_gains_more_than_the_others_is_no_risk(ratios, kept):
    squares = np.column_stack([np.square(ratios), np.ones(len(ratios))])
    assert (margin(squares, Settings()) >= 0.0) == kept


def test_a_record_that_is_worse_by_chance_costs_nothing():
    """The error of a slow record is nearly all noise; what a right correction adds to it comes out either way."""
    rng, block = np.random.default_rng(2), np.repeat(np.arange(30), 50)
    noise = np.repeat(rng.standard_normal(30 * 5), 10)
    for size, sure in ((0.25, False), (1.5, True)):
        left = noise + size * np.sign(np.sin(np.arange(len(block)) / 40))
        if not sure:
            left *= 1.04 * np.sqrt(np.mean(noise**2) / np.mean(left**2))
        assert np.mean(left**2) > Settings().not_worse ** 2 * np.mean(noise**2)
        assert surely_worse(*mean_squares(block, left, noise), Settings()) == sure


@given(st.lists(st.integers(0, 5), min_size=1, max_size=50), st.floats(0.1, 10.0))
def test_mean_squares_of_blocks_make_up_the_whole(labels, factor):
    labels = np.sort(np.array(labels))
    error = np.linspace(-1.0, 2.0, len(labels))
    (one, other), count = mean_squares(labels, error, factor * error)
    assert np.sum(one * count) == pytest.approx(np.sum(error**2))
    assert other == pytest.approx(factor**2 * one)


@pytest.mark.parametrize("deaf", [False, True])
def test_a_part_of_a_model_is_asked_as_if_it_were_all(white, deaf):
    """Of an axis that says nothing of the links too: then the sums over all axes are others."""
    part = [t for t in white.base if t.label != "friction 1"]
    if deaf:
        part = [
            replace(t, blocks={a: x for a, x in t.blocks.items() if a != 1}) if t.label == INERTIAL else t for t in part
        ]
    found, wanted = Asked(white, white.base)(part), Asked(white, part)(part)
    for one in ("ratio", "surely", "gained", "steady"):
        np.testing.assert_allclose(getattr(found, one), getattr(wanted, one), rtol=1e-9)
