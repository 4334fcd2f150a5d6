"""How many principal components are kept?"""

STAGE = "detection"
PAPER = "the principal components account for more than seventy five percent of the variation; ranges between 3-4"
DEFAULT = "variance_share"


def variance_share(share, wanted):
    """The smallest number whose share of the variance exceeds detection.variance_share."""
    return int((share <= wanted).sum()) + 1


def three(share, wanted):
    """Always three."""
    return 3


def four(share, wanted):
    """Always four."""
    return 4
