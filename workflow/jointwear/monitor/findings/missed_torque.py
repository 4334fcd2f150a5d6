"""Axes whose growth in percent is unsure, as the model misses much of their torque."""

from __future__ import annotations

from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.backlash import left_of_torque

#: Kind of the finding.
BASE = "unsure_percent"


def unsure_percent_findings(
    statistics: WindowStatistics, baseline: np.ndarray, coulomb: np.ndarray, changed: np.ndarray
) -> list[dict[str, Any]]:
    """Return one finding on all axes that have changed and whose torque the model misses too much of, or none.

    What the model misses of a torque that follows the path looks like friction, too: on an arm with 1.2 kg that its
    file lacked, viscous growth of 70 % was told as 51 %, with the load in the file as 69 %.

    Parameters
    ----------
    baseline : (w,) bool. coulomb : (n, 2) levels [N m]. changed : (n,) bool.
    """
    left, level = left_of_torque(statistics, baseline), coulomb.mean(axis=1)
    gathered = ((statistics.count > 0) & (statistics.far_count > 0))[baseline].any(axis=0)
    axes = (np.flatnonzero(gathered & left.missed_by_model(level) & changed) + 1).tolist()
    if not axes:
        return []
    shares = 100 * np.sqrt(left.noise) / np.maximum(level, 1e-12)
    size = max(shares[j - 1] for j in axes)
    words = (
        f"Growth of {name_axes(axes)} in percent is unsure, beyond its stated error: in the normal period already the "
        f"model missed torque of {'up to ' if len(axes) > 1 else ''}{size:.0f} % of the Coulomb friction there (root "
        "mean square), which may look like friction, too, so that what the percent are of is off. Does the robot carry "
        "a load that its file lacks? State it as 'payload' of the robot file."
    )
    return [{"time": float(statistics.start[np.flatnonzero(baseline)[0]]), "axes": axes, "kind": BASE, "words": words}]
