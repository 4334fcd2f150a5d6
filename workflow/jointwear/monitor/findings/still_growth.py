"""Growth of an axis with an open alarm that stands still below its limit: no date is one of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.monitor.findings.findings import moment_words
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.limits import in_sentence

#: Kind of the finding.
STANDSTILL = "standstill"


def standstill_findings(
    statistics: WindowStatistics, still: np.ndarray, quantities: Sequence[str]
) -> list[dict[str, Any]]:
    """Return a finding on each axis with an open alarm whose growth stands still.

    Parameters
    ----------
    still : (n,) since when [s], NaN where it does not. quantities : of each axis, what had grown.
    """
    result = []
    for j in np.flatnonzero(np.isfinite(still)):
        since = float(still[j])
        words = (
            f"Growth of the {in_sentence(quantities[j])} of axis {j + 1} has stood still since about "
            f"{moment_words(statistics, since)}: it may never reach its limit. What made it grow has to be found all "
            "the same; should it go on, its limit is given a date again."
        )
        result.append({"time": since, "axes": [int(j) + 1], "kind": STANDSTILL, "words": words})
    return result
