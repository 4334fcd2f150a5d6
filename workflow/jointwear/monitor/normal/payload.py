"""Load at the flange as the gravity torques show it, window by window: a condition of operation, no wear.

The regression of a window finds by which share its gravity torque differs from the model's, and by which constant. A
load moves the share of several axes at once; their mean by weight of evidence is one value of the robot. The constant
of an axis is half of what its Coulomb friction grew by forwards more than backwards, or an offset of its sensor, so
that no part of it counts as load: the share of the axis alone does, and only as far as its gravity torque varies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.estimate import COLUMNS, Sums, column_estimate

#: Standard deviation a priori of the share; an axis whose share is known no better than this does not count.
USUAL, COARSEST = 0.2, 0.15
#: Standard deviation of the gravity torque within a window, over its mean, at which half of what the share says of the
#: mean is taken for a load.
VARIES = 0.1


@dataclass(frozen=True)
class GravityTorque:
    """By what gravity torques differ from the model's: `share` (w, n) of them and `constant` (w, n) [N m], both shrunk,
    zeros where nothing shows them.

    Where the gravity torque hardly changes within a window, friction that is off the shape of its curve moves one
    against the other: of an axis that wore by 65 % the share rose by 0.23, which looked like a load that the baseline
    lacks, and the sum stayed within 0.2 %. What of the two is a load, :func:`of_load` says.
    """

    share: np.ndarray
    constant: np.ndarray


def gravity_share(sums: Sums, pooled: np.ndarray) -> tuple[GravityTorque, np.ndarray]:
    """Return the difference of the gravity torque from the model, axis by axis, and the share of the robot (w,) by
    which it differs, in the baseline's units; zeros where nothing shows it. `pooled` (n,) noise variance [N2 m2]."""
    n = sums.gram.shape[-3]
    free, held = np.ones((n, len(COLUMNS)), dtype=bool), np.zeros((n, len(COLUMNS)))
    value, variance = column_estimate(sums, held, free, pooled, COLUMNS.index("gravity"))
    constant, _ = column_estimate(sums, held, free, pooled, COLUMNS.index("offset"))
    known = np.isfinite(value) & (variance < COARSEST**2) & (variance > 0)
    safe = np.where(known, variance, 1.0)
    shrinking = np.where(known, USUAL**2 / (USUAL**2 + safe), 0.0)
    weight = np.where(known, 1.0 / safe, 0.0)
    total = weight.sum(axis=1)
    robot = np.divide(
        (weight * np.where(known, value, 0.0)).sum(axis=1), total, out=np.zeros(len(total)), where=total > 0
    )
    return GravityTorque(np.nan_to_num(value) * shrinking, np.nan_to_num(constant) * shrinking), robot


def of_load(static: GravityTorque, sums: Sums) -> GravityTorque:
    """Return the part of the differences `static` (w, n) that a load explains, with :data:`VARIES`.

    The share tells of a load by the torque that varies with gravity. What it says of the mean is taken back by a
    constant where hardly anything varies, since there it may be friction. The constant that was read is no load: where
    it was one, friction that grew forwards alone, or backwards alone, explained itself away.
    """
    one, gravity = COLUMNS.index("offset"), COLUMNS.index("gravity")
    count = np.maximum(sums.gram[..., one, one], 1.0)
    mean = sums.gram[..., one, gravity] / count
    variance = np.maximum(sums.gram[..., gravity, gravity] / count - mean**2, 0.0)
    still = (VARIES * mean) ** 2
    unknown = np.divide(still, variance + still, out=np.zeros_like(still), where=still > 0)
    return GravityTorque(static.share, -unknown * static.share * mean)
