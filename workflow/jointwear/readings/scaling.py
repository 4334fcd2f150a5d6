"""Are the series scaled before the principal component analysis?"""

STAGE = "detection"
PAPER = "The text does not say."
DEFAULT = "standardised"


def standardised(series):
    """Means removed, divided by the standard deviation in training."""
    spread = series.std(axis=0, ddof=1)
    spread[spread == 0] = 1.0
    return spread


def centred(series):
    """Means removed, not scaled."""
    return 0 * series.std(axis=0, ddof=1) + 1.0
