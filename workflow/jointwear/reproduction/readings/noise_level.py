"""Is 0.0001 rad the standard deviation or the variance of the measurement noise?"""

STAGE = "simulation"
PAPER = "nu_k is 0.0001 rad, based on the average accuracy of the encoder"
DEFAULT = "standard_deviation"


def standard_deviation(level):
    """The standard deviation, as the unit rad says."""
    return level


def variance(level):
    """The variance [rad2]: the standard deviation is its root, 0.01 rad."""
    return level**0.5
