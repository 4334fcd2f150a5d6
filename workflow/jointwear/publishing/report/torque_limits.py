"""How close every run comes to the torque limits of the robot file (the paper's "operational limits")."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.storage import read_variables

PAPER_SHARE = 0.5  # section V: "not exceeding more than 50% of the maximum allowed design torque for any axis"


def limit_use(simulations: list[str]) -> list[dict[str, Any]]:
    """Return for every run the largest share of a torque limit over all replicates, hours and axes.

    `share` and `axis` are None where the robot file gives no limit; `shares` lists all axes.
    """
    rows = []
    for path in sorted(simulations):
        (shares,) = read_variables(path, "limit_share")
        known = np.isfinite(shares)
        axis = int(np.nanargmax(shares)) + 1 if known.any() else None
        share = float(shares[axis - 1]) if axis else None
        rows.append(
            {
                "task": Path(path).parent.name,
                "run": Path(path).stem,
                "axis": axis,
                "share": share,
                "shares": [float(s) if np.isfinite(s) else None for s in shares],
                "over_half": share is not None and share > PAPER_SHARE,
                "over_limit": share is not None and share > 1.0,
            }
        )
    return rows
