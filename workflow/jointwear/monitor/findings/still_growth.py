"""Growth of an axis with an open alarm that stands still below its limit: no date is one of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from jointwear.monitor.findings.findings import moment_words
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.limits import LimitDate, in_sentence

#: Kind of the finding.
STANDSTILL = "standstill"


def standstill_findings(statistics: WindowStatistics, limits: Sequence[LimitDate | None]) -> list[dict[str, Any]]:
    """Return a finding on each axis with an open alarm whose growth stands still.

    Parameters
    ----------
    limits : of each axis, None where no date is due.
    """
    result = []
    for j, limit in enumerate(limits):
        if limit is None or math.isnan(limit.still):
            continue
        since = limit.still
        words = (
            f"Growth of the {in_sentence(limit.quantity)} of axis {j + 1} has stood still since about "
            f"{moment_words(statistics, since)}: it may never reach its limit. What made it grow began and stopped, "
            "or is a drift that this axis has anyway; should it go on, its limit is given a date again."
        )
        result.append({"time": since, "axes": [j + 1], "kind": STANDSTILL, "words": words})
    return result
