"""A gain of the torque of all axes: somebody changes a unit, a supply or the scale of a logger.

The friction of all axes then steps at once by about the same share. Weather and oil do that too, but leave the torque
that moves the bodies as it is. A gain multiplies that too, though some axes show little of it: what part of it looks
like another load at the flange is taken out with the load, on the wrist most of it.
"""

from __future__ import annotations

import numpy as np

from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.watching.scale import (
    FEWEST_TOGETHER,
    SAME_SCALE,
    TOGETHER,
    ScaleStep,
    cut_beside,
    first_pair,
    shift_steps,
)
from jointwear.monitor.watching.shared_error import FINDING
from jointwear.monitor.watching.watching import Watch

#: Share of the axes whose friction must step alike, and of those that show their bodies whose bodies must, too.
MOST, SOME = 2 / 3, 1 / 3


def gain_of_all(level: Watch, scale: Watch, shift: np.ndarray, baseline: np.ndarray) -> list[ScaleStep]:
    """Return the first gain of all axes, as a step of each; empty where there is none.

    Parameters
    ----------
    level : friction, watched without looking for services and for what axes have in common. scale : of the bodies.
    shift : (w,) labels. baseline : (w,) bool.

    Notes
    -----
    Two shifts in a row must show it. An axis that neither its friction nor its bodies show to have it keeps its scale.
    """
    n = len(level.axes)
    axes, named = ([j for j in range(n) if w.axes[j] is not None] for w in (level, scale))
    names = np.unique(shift)
    if len(axes) < FEWEST_TOGETHER or not named:
        return []
    usual, friction = shift_steps(level, axes, names, shift)
    _, bodies = shift_steps(scale, named, names, shift)
    known = np.isfinite(friction[..., 0])
    sizes = np.array([np.median(f[k]) if k.any() else 0.0 for f, k in zip(friction[..., 0], known, strict=True)])
    least = SAME_SCALE * np.abs(sizes)[:, None]
    with np.errstate(invalid="ignore"):
        alike = np.abs(friction[..., 0] - sizes[:, None]) < least
        own = np.sign(sizes)[:, None] * bodies[..., 0]
        clear = np.abs(bodies[..., 0]) > TOGETHER * bodies[..., 1]
        shown, against = clear & (own > least), clear & (own < -least)
    told = np.isfinite(bodies[..., 0]).sum(axis=1)
    good = np.isin(names, shift[after_baseline(baseline)]) & ~np.isin(names, shift[baseline])
    good &= (np.abs(sizes) > FINDING) & (known.sum(axis=1) >= FEWEST_TOGETHER)
    good &= alike.sum(axis=1) > MOST * known.sum(axis=1)
    good &= (shown.sum(axis=1) >= np.maximum(2, SOME * told)) & (against.sum(axis=1) <= SOME * told)
    a = first_pair(good, sizes)
    if a is None:
        return []
    value, variance = level.residual[:, axes] - usual[a, axes], level.noise[:, axes]
    begin = cut_beside(value, variance, float(sizes[a + 1]), shift, names[max(a - 1, 0) : a + 1], baseline)
    factor = float(np.exp(np.median(bodies[a + 1, shown[a + 1], 0])))
    off = known[a : a + 2] & ~alike[a : a + 2] & ~shown[a : a + 2]
    return [ScaleStep(j, begin, factor) for j in axes if not off[:, j].all()]
