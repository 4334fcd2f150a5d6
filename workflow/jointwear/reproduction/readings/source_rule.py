"""Which axis is the source of the wear?"""

STAGE = "location"
PAPER = "we identify the source axis as one that has all positive lags"
DEFAULT = "column_not_negative"


def _choose(admitted, weight):
    """The admitted axis of largest weight, 1-based; 0 where no axis is admitted."""
    import numpy as np

    best = np.where(admitted, weight, -np.inf).argmax(axis=-1) + 1
    return np.where(admitted.any(axis=-1), best, 0)


def column_not_negative(lag):
    """The axis whose column in Table II holds no negative lag and at least one positive; of several the one
    with the largest sum."""
    total = lag.sum(axis=-2)
    return _choose((lag >= 0).all(axis=-2) & (total > 0), total)


def column_positive(lag):
    """The axis whose column holds positive lags to every other axis."""
    import numpy as np

    off_diagonal = ~np.eye(lag.shape[-1], dtype=bool)
    return _choose(((lag > 0) | ~off_diagonal).all(axis=-2), lag.sum(axis=-2))


def row_not_negative(lag):
    """The axis whose row holds no negative lag and at least one positive, as the text reads."""
    total = lag.sum(axis=-1)
    return _choose((lag >= 0).all(axis=-1) & (total > 0), total)


def largest_column_sum(lag):
    """The axis whose column has the largest sum of lags; it always names an axis."""
    import numpy as np

    total = lag.sum(axis=-2)
    return _choose(np.ones(total.shape, dtype=bool), total)
