"""One seed, one stream of random numbers for every replicate of every run."""

from __future__ import annotations

import numpy as np


def generator(seed: int, *key: str | int, replicate: int) -> np.random.Generator:
    """Return the random numbers of one replicate of one run.

    Parameters
    ----------
    seed : the seed of the whole workflow.
    key : words and whole numbers that name the run, for example ("wear", "T1", 1, 10).
    replicate : 0-based number of the replicate.

    Notes
    -----
    The key becomes a spawn key of numpy's SeedSequence, so that a run's numbers depend on its name alone: not
    on which other runs exist, on their order, or on how many replicates are asked for.
    """
    words: list[int] = []
    for part in key:
        if isinstance(part, str):
            words += [len(part), *part.encode()]
        else:
            words.append(int(part))
    sequence = np.random.SeedSequence(seed, spawn_key=(*words, replicate))
    return np.random.Generator(np.random.SFC64(sequence))
