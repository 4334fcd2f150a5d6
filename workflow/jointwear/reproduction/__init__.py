"""Reproduction: the method of the paper, from simulated wear to its tables."""
