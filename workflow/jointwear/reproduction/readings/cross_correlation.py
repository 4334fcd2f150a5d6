"""Are the means removed before the cross-correlation?"""

STAGE = "location"
PAPER = "Equation (5) removes the means; MATLAB's xcorr, the obvious tool, does not."
DEFAULT = "raw"


def raw(series, inside):
    """No, as MATLAB's xcorr computes it."""
    return series * inside


def means_removed(series, inside):
    """Yes, as equation (5) says."""
    mean = (series * inside).sum(axis=1, keepdims=True) / inside.sum(axis=1, keepdims=True)
    return (series - mean) * inside
