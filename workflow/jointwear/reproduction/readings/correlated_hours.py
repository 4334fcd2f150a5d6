"""Which hours are correlated?"""

STAGE = "location"
PAPER = "The text does not say."
DEFAULT = "whole_run"


def whole_run(hours, onset):
    """All hours of the run."""
    import numpy as np

    return np.ones((len(onset), len(hours)), dtype=bool)


def until_onset(hours, onset):
    """The hours up to the detected onset; all where nothing is detected."""
    import numpy as np

    return (hours <= onset[:, None]) | np.isnan(onset)[:, None]
