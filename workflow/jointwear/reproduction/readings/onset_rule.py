"""When does an exceedance of the limit count as the onset of wear?"""

STAGE = "detection"
PAPER = "an onset of wear is identified if the Q value rises above a data-driven threshold"
DEFAULT = "consecutive_hours"


def consecutive_hours(above, count):
    """At the first of detection.consecutive_hours hours above the limit in a row."""
    import numpy as np

    if above.shape[-1] < count:
        return np.zeros(above.shape, dtype=bool)
    windows = np.lib.stride_tricks.sliding_window_view(above, count, axis=-1).all(axis=-1)
    padding = np.zeros((*above.shape[:-1], count - 1), dtype=bool)
    return np.concatenate([windows, padding], axis=-1)


def single_hour(above, count):
    """At the first hour above the limit."""
    return above


def until_the_end(above, count):
    """At the first hour from which on Q stays above the limit until the end."""
    import numpy as np

    return np.flip(np.minimum.accumulate(np.flip(above, axis=-1), axis=-1), axis=-1)
