"""Recover what the paper left out: poses, payload and wear shape that reproduce its tables of torque.

`tables` reads the published values, `sampled_motion` and `sampled_torque` predict them from a trajectory and
a candidate of `candidates`, `least_squares` and `fit` search, `comparison` and `transfer` judge,
`bound` shows what no slow motion of the unloaded arm can reach.
"""
