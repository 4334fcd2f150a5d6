"""In which direction is the Kullback-Leibler divergence taken?"""

STAGE = "features"
PAPER = "KL distance of each axis from a reference distribution; between the initial distribution and ..."
DEFAULT = "reference_from_hour"


def _divergence(p, q):
    import numpy as np

    return np.maximum((p * (np.log(p) - np.log(q))).sum(axis=-1), 0.0)


def hour_from_reference(hour, reference):
    """D(hour || reference)."""
    return _divergence(hour, reference)


def reference_from_hour(hour, reference):
    """D(reference || hour)."""
    return _divergence(reference, hour)


def symmetric(hour, reference):
    """The mean of both directions."""
    return (_divergence(hour, reference) + _divergence(reference, hour)) / 2


def jensen_shannon(hour, reference):
    """Both directions against the mean of the two: the divergence of Jensen and Shannon, at most ln 2."""
    middle = (hour + reference) / 2
    return (_divergence(hour, middle) + _divergence(reference, middle)) / 2
