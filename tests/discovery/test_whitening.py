"""Samples that cannot be judged, ends of records, and noise that looks back."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.noise.noise import Whitener
from jointwear.discovery.problem.instruments import limit
from jointwear.discovery.problem.whitening import bridged
from jointwear.measurement.derived.filtering import low_pass


def test_what_the_noise_model_leaves_is_white(white):
    for axis in white.problem.judged:
        assert np.var(white.fit().residual[axis]) == pytest.approx(1.0, abs=0.15)


def test_whitening_looks_back_from_its_rows():
    columns, rows = np.random.default_rng(5).normal(size=(40, 2)), np.array([3, 7, 8, 39])
    lags, sigma = np.array([0.5, -0.2, 0.1]), 0.4
    wanted = (columns[rows] - sum(w * columns[rows - k] for k, w in enumerate(lags, start=1))) / sigma
    assert Whitener(rows, lags, sigma)(columns) == pytest.approx(wanted)


def test_bridges_are_straight_within_a_record_and_change_nothing_that_can_be_judged():
    rng = np.random.default_rng(3)
    columns, usable = rng.normal(size=(40, 2)), rng.random(40) > 0.4
    record = np.repeat([0, 1], 20)
    usable[[18, 19, 20, 21]] = False
    found = bridged(columns, usable, record)
    assert np.array_equal(found[usable], columns[usable])
    for piece in (slice(0, 20), slice(20, 40)):
        place = np.arange(20)[usable[piece]]
        for k in range(2):
            straight = np.interp(np.arange(20), place, columns[piece, k][usable[piece]])
            assert found[piece, k] == pytest.approx(straight, abs=1e-12)
    assert np.array_equal(bridged(columns[:, 0], usable, record), found[:, 0])
    assert np.array_equal(bridged(columns, np.zeros(40, bool), record), columns)


def test_what_cannot_be_judged_does_not_reach_its_neighbours(rough):
    axis = next(a for a in rough.problem.judged if np.isfinite(rough.cutoffs[a].judged))
    column = rough.problem.discrepancy[rough.problem.train, axis]
    spiked = np.where(rough.problem.usable[:, axis], column, 100.0)
    assert np.array_equal(rough.raw(axis, spiked), rough.raw(axis, column))


def test_records_of_one_length_are_filtered_as_each_alone():
    columns = np.random.default_rng(3).normal(size=(150, 3))
    for lengths in ((50, 50, 50), (60, 90)):
        record = np.repeat(np.arange(len(lengths)), lengths)
        alone = [low_pass(columns[record == k], 7.0, 50.0) for k in range(len(lengths))]
        assert np.array_equal(limit(columns, record, 7.0, 50.0), np.concatenate(alone))


def test_another_problem_begins_without_what_was_made_of_the_first(white):
    """What was kept of a problem stayed with its copies, whose noise may be another."""
    first = replace(white)
    first._states["made of its fields"] = 1.0
    assert replace(first, whiteners=[w and replace(w, sigma=2.0 * w.sigma) for w in first.whiteners])._states == {}
