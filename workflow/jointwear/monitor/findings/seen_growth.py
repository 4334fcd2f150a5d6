"""How small a growth can be seen: findings on axes that are judged coarsely, late, or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.watched_axis import UNSEEN
from jointwear.monitor.watching.watching import Watch

#: Kind of a finding on an axis whose limit cannot be seen, of one on axes whose windows scatter, and of one on axes
#: whose viscous friction differs from shift to shift.
COARSE, LOOSE, MISSED = "coarse", "loose", "coarse_viscous"
#: Scatter of the windows of a shift, standard deviation of the log level beside their own noise, that is told. A shift
#: of eight such windows is known to 1.4 %, three times worse than shifts of a steady robot differ (0.2 to 0.5 %). Of
#: 24 simulated robots that carried parts which their file lacked ten exceed it; of 15 of them whose file was given the
#: mean load, three.
LOOSEST = 0.04


def coarse_findings(
    statistics: WindowStatistics, baseline: np.ndarray, least: np.ndarray, limit: float
) -> list[dict[str, Any]]:
    """Return one finding for each axis whose growth up to the limit would not be seen, with the `least` that would be.

    Parameters
    ----------
    baseline : (w,) bool. least : (n,) smallest growth of Coulomb friction that two shifts show, NaN unknown. limit : of
        that growth.
    """
    return [
        {
            "time": float(statistics.end[np.flatnonzero(baseline)[-1]]),
            "axes": [int(j) + 1],
            "kind": COARSE,
            "least": float(least[j]),
            "words": (
                f"Of axis {j + 1} {coarse_words(least[j])}, and its limit is {100 * limit:.0f} %: its friction differs "
                "too much from shift to shift, or is too small against the noise. That there is no alarm says nothing "
                "of smaller changes."
            ),
        }
        for j in np.flatnonzero(least > limit)
    ]


def loose_findings(statistics: WindowStatistics, baseline: np.ndarray, level: Watch) -> list[dict[str, Any]]:
    """Return one finding on all axes whose windows scatter by more than :data:`LOOSEST`, or none.

    Parameters
    ----------
    baseline : (w,) bool. level : what was watched of friction.
    """
    scatter = np.array([0.0 if axis is None else np.sqrt(axis.dispersion.extra) for axis in level.axes])
    loose = np.flatnonzero(scatter > LOOSEST)
    if not len(loose) or not baseline.any():
        return []
    axes, most = [int(j) + 1 for j in loose], 100 * scatter.max()
    words = (
        f"The windows of {name_axes(axes)} scatter by {'up to ' if len(axes) > 1 else ''}{most:.0f} %, so that growth "
        "alarms late: does the robot file lack a load, or does the robot carry parts some of the time? State the "
        "payload in the robot file, name the part under 'program', or run learn_normal."
    )
    time = float(statistics.end[np.flatnonzero(baseline)[-1]])
    return [{"time": time, "axes": axes, "kind": LOOSE, "words": words}]


def missed_findings(statistics: WindowStatistics, baseline: np.ndarray, viscous: Watch) -> list[dict[str, Any]]:
    """Return one finding on all axes whose viscous friction is not judged in some program, as shifts of the baseline
    itself miss the prediction there by more than :data:`~.watched_axis.UNSEEN`, or none.

    Parameters
    ----------
    baseline : (w,) bool. viscous : what was watched of viscous friction.
    """
    missed = np.array([0.0 if axis is None else axis.missed for axis in viscous.axes])
    coarse = np.flatnonzero(missed > UNSEEN)
    if not len(coarse) or not baseline.any():
        return []
    axes, several = [int(j) + 1 for j in coarse], len(coarse) > 1
    words = (
        f"Viscous friction of {name_axes(axes)} can only be judged coarsely: in the normal period alone it differed "
        f"from shift to shift by {'up to ' if several else ''}{100 * missed.max():.0f} % of the friction of the axis, "
        "in one program at least. It is not judged in such programs; that there is no alarm of it says nothing there."
    )
    return [{"time": float(statistics.end[np.flatnonzero(baseline)[-1]]), "axes": axes, "kind": MISSED, "words": words}]


def coarse_words(least: float) -> str:
    """Return in words the smallest growth of Coulomb friction that can be seen."""
    return f"only changes above {100 * least:.0f} % can be seen"


def dead_band_findings(
    statistics: WindowStatistics,
    baseline: np.ndarray,
    unseen: np.ndarray,
    noisy: Sequence[bool],
    dead_band: Sequence[float],
) -> list[dict[str, Any]]:
    """Return one finding for each axis that cannot be judged, or only coarsely, beside a dead band that is all noise.

    Parameters
    ----------
    baseline : (w,) bool, at whose end it is told. unseen : (n,) bool, the axis is never judged, or changes up to its
        limit are not seen.
    noisy, dead_band [rad/s] : of the survey, (n,).
    """
    last = int(np.flatnonzero(baseline)[-1]) if baseline.any() else 0
    return [
        {
            "time": float(statistics.end[last]),
            "axes": [j + 1],
            "kind": "dead_band",
            "words": (
                f"Axis {j + 1} counts as at rest below {dead_band[j]:.2g} rad/s. That comes from the noise of its "
                "position in the first log, more than its speed asks for, and leaves less of its motion to judge. If "
                "that log is worse than the others, state 'dead_band' in the entry of the robot."
            ),
        }
        for j in range(len(unseen))
        if unseen[j] and j < len(noisy) and noisy[j]
    ]
