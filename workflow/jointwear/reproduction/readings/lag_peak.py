"""Is the lag taken at the maximum of R or of |R|?"""

STAGE = "location"
PAPER = "The time delay at which the two signals give the maximum cross-correlation"
DEFAULT = "maximum"


def maximum(correlation):
    """At the maximum of R."""
    return correlation


def absolute_maximum(correlation):
    """At the maximum of |R|."""
    return abs(correlation)
