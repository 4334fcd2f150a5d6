"""Samples in parts: folds that a fit is asked to predict, each a record or a piece of one, and blocks of time."""

from __future__ import annotations

import numpy as np

from jointwear.discovery import assumed


def folds_of(record: np.ndarray, fewest: int, pieces: int = 1) -> np.ndarray:
    """Return the record, cut into `pieces`, of each sample, into four in all or more if there are few records.

    Parameters
    ----------
    record : (N,) of each sample, in order. fewest : records from which none has to be cut for there to be enough folds.

    Returns
    -------
    (N,) number of the fold, from 0 in the order of the records.
    """
    labels, first = np.unique(record, return_index=True)
    labels = labels[np.argsort(first)]
    blocks = pieces if len(labels) >= fewest else max(pieces, int(np.ceil(4 / max(len(labels), 1))))
    fold = np.zeros(len(record), dtype=int)
    for i, label in enumerate(labels):
        index = np.flatnonzero(record == label)
        fold[index] = i * blocks + np.arange(len(index)) * blocks // len(index)
    return fold


def blocks_of(time: np.ndarray, record: np.ndarray) -> np.ndarray:
    """Return the block of time of each sample, :data:`.assumed.BLOCK` long within its record.

    Parameters
    ----------
    time : (N,) [s]. record : (N,) of each sample, in order.

    Returns
    -------
    (N,) number of the block, from 0 in order.
    """
    if not len(record):
        return np.zeros(0, dtype=int)
    start = np.concatenate([[0], np.flatnonzero(np.diff(record)) + 1])
    first = np.repeat(time[start], np.diff(np.append(start, len(record))))
    block = ((time - first) // assumed.BLOCK).astype(int)
    change = (np.diff(block) != 0) | (np.diff(record) != 0)
    return np.concatenate([[0], np.cumsum(change)])
