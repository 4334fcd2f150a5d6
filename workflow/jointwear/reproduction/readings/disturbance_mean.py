"""Of which average torque does the disturbance take one percent?"""

STAGE = "simulation"
PAPER = "a zero-mean Gaussian process with unit standard deviation scaled to one percent of the average torque"
DEFAULT = "absolute_cycle"


def absolute_cycle(samples, cycle):
    """The mean of |torque| over the whole cycle."""
    return abs(cycle).mean(axis=-2)


def signed_cycle(samples, cycle):
    """The size of the signed mean over the whole cycle."""
    return abs(cycle.mean(axis=-2))


def absolute_hour(samples, cycle):
    """The mean of |torque| over the sixty samples of the hour."""
    return abs(samples).mean(axis=-2)


def signed_hour(samples, cycle):
    """The size of the signed mean over the sixty samples of the hour."""
    return abs(samples.mean(axis=-2))
