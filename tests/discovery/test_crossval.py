"""Signed ranks of what blocks of time gain, and the drop for each change where few blocks gain."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.discovery.search.crossval import lowered, positive


@given(st.lists(st.floats(-10, 10), min_size=1, max_size=40))
def test_signed_ranks_are_symmetric_and_free_of_scale(values):
    values = np.array(values) + 1e-3 * np.arange(1, len(values) + 1)
    values = values[values != 0]
    if not len(values) or len(np.unique(np.abs(values))) < len(values):
        return
    assert positive(values) == pytest.approx(1 - positive(-values))
    assert positive(3.0 * values) == pytest.approx(positive(values))


def test_signed_ranks_see_what_is_strong_in_few_blocks():
    rng = np.random.default_rng(3)
    blocks = rng.normal(0.05, 0.05, 40)
    blocks[:3] = 50.0
    assert positive(blocks) > 0.99
    assert positive(rng.normal(0.0, 1.0, 40)) < 0.99


def test_what_acts_in_few_blocks_is_asked_by_its_drop_for_each_change():
    """Five reversals that gain as much as they change, among fifty blocks in which nothing happens."""
    rng = np.random.default_rng(3)
    changes = rng.uniform(0.0, 1.0, 55)
    drops = 2.0 * rng.standard_normal(55) * np.sqrt(changes) - changes
    drops[:5], changes[:5] = (60.0, 300.0, 196.0, 260.0, 222.0), (240.0, 150.0, 145.0, 124.0, 123.0)
    assert positive(drops) < 0.99
    assert lowered(drops, changes) > 0.99
    assert lowered(3.0 * drops, 3.0 * changes) == pytest.approx(lowered(drops, changes))
    # One of them that loses is doubt enough, and a single block is no proof.
    drops[1] = -300.0
    assert lowered(drops, changes) < 0.99
    assert lowered(drops[:1], changes[:1]) < 0.99
    assert lowered(np.zeros(0), np.zeros(0)) == 0.5


def test_the_certainty_of_what_acts_in_two_blocks_is_that_of_two():
    """Their sum is three standard errors above zero: of many blocks that is sure, of two it is not."""
    changes = np.concatenate([[100.0, 100.0], np.full(60, 1e-3)])
    sense = np.where(np.arange(60) % 2, 1.0, -1.0)
    drops = np.concatenate([[90.0, 110.0], 0.1 * sense * (1.0 + 0.01 * np.arange(60))])
    rate = drops.sum() / changes.sum()
    scatter = np.sum((drops - rate * changes) ** 2 / changes) / (len(changes) - 1)
    assert rate * np.sqrt(changes.sum() / scatter) > 3.0
    assert positive(drops) < 0.9
    assert lowered(drops, changes) < 0.95
    assert lowered(np.tile(drops[:2], 31), np.full(62, 100.0)) > 0.99
