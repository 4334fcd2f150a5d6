"""Is the torque binned with its sign?"""

STAGE = "features"
PAPER = "normalized with respect to maximum torque and binned into twelve equal-sized intervals"
DEFAULT = "absolute"


def absolute(normalised):
    """Its size, on [0, 1]."""
    return abs(normalised)


def signed(normalised):
    """With its sign, [-1, 1] mapped to [0, 1]."""
    return (normalised + 1) / 2
