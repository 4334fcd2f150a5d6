"""Samples are in folds of records, cut where records are few, and in blocks of time."""

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.problem.folds import blocks_of, folds_of


def test_a_block_of_time_ends_with_its_record():
    """Records shorter than a block are one each; a longer one is cut."""
    record = np.repeat([0, 1, 2], [4, 4, 12])
    time = np.concatenate([np.arange(4), 100 + np.arange(4), 200 + np.arange(12)]) * assumed.BLOCK / 5
    assert blocks_of(time, record).tolist() == [0] * 4 + [1] * 4 + [2] * 5 + [3] * 5 + [4] * 2
    assert not len(blocks_of(time[:0], record[:0]))


def test_few_records_are_cut_until_there_are_four_folds():
    """Folds are numbered in the order of the records, whatever their labels are."""
    assert folds_of(np.repeat([7, 3], 4), fewest=3).tolist() == [0, 0, 1, 1, 2, 2, 3, 3]
    enough = np.repeat([7, 3, 5], 2)
    assert folds_of(enough, fewest=3).tolist() == [0, 0, 1, 1, 2, 2]
    assert folds_of(enough, fewest=4).tolist() == folds_of(enough, fewest=3, pieces=2).tolist() == list(range(6))
