"""What becomes of samples beyond the range of the histogram?"""

STAGE = "features"
PAPER = "binned into twelve equal-sized intervals (the text does not say of which range)"
DEFAULT = "dropped"


def outer_bins(index, bins):
    """They count in the first or last bin."""
    return index.clip(0, bins - 1), None


def dropped(index, bins):
    """They are left out; the histogram is normalised over the rest."""
    return index.clip(0, bins - 1), (index >= 0) & (index < bins)
