"""Load at the flange as the gravity torques show it, window by window: a condition of operation, no wear.

The regression of a window finds by which share g its gravity torque differs from the model's. A load moves that of
several axes at once; their mean by weight of evidence is one value of the robot, and together with the model's torque
it tells the load on each axis.
"""

from __future__ import annotations

import numpy as np

from jointwear.monitor.estimate import COLUMNS, Sums, column_estimate

#: Standard deviation a priori of the share; an axis whose share is known no better than this does not count.
USUAL, COARSEST = 0.2, 0.15


def gravity_share(sums: Sums, pooled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the share by which gravity torque differs from the model, of each axis (w, n), shrunk, and of the robot
    (w,), in the baseline's units; zeros where nothing shows it. `pooled` (n,) noise variance [N2 m2]."""
    n = sums.gram.shape[-3]
    free = np.ones((n, len(COLUMNS)), dtype=bool)
    value, variance = column_estimate(sums, np.zeros((n, len(COLUMNS))), free, pooled, COLUMNS.index("gravity"))
    known = np.isfinite(value) & (variance < COARSEST**2) & (variance > 0)
    safe = np.where(known, variance, 1.0)
    shrunk = np.where(known, value, 0.0) * USUAL**2 / (USUAL**2 + safe)
    weight = np.where(known, 1.0 / safe, 0.0)
    total = weight.sum(axis=1)
    robot = np.divide(
        (weight * np.where(known, value, 0.0)).sum(axis=1), total, out=np.zeros(len(total)), where=total > 0
    )
    return np.where(known, shrunk, 0.0), robot
