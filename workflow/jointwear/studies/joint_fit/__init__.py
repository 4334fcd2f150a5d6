"""One experiment for the whole paper: poses, payload, wear shape and reading fitted to all that it prints.

`levels`, `noise_bank`, `divergence` and `detection` are a fast engine for one task; `distance` holds it against the
paper; `pose_search` looks for poses; `experiments` puts tasks of one arm together; `confirmation` runs them again with
the engine of `multiverse` and random numbers that took no part; `controls` does the same to papers of known origin.
"""
