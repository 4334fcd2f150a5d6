"""Are the series scaled before the principal component analysis?"""

STAGE = "detection"
PAPER = "The text does not say."
DEFAULT = "standardised"


def _deviation(series):
    """The standard deviation, exactly zero where rounding alone moves a series (some 1e-15 of its size)."""
    import numpy as np

    spread = series.std(axis=0, ddof=1)
    spread[spread <= 1e-12 * np.maximum(abs(series).max(axis=0), 1.0)] = 0.0
    return spread


def standardised(series):
    """Means removed, divided by the standard deviation in training."""
    spread = _deviation(series)
    spread[spread == 0] = 1.0
    return spread


def centred(series):
    """Means removed, not scaled."""
    return 0 * series.std(axis=0, ddof=1) + 1.0


def constant_left_out(series):
    """Means removed, divided by the standard deviation; a series constant in training has no say, as in PLS_Toolbox."""
    import numpy as np

    spread = _deviation(series)
    spread[spread == 0] = np.inf
    return spread
