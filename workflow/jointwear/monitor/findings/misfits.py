"""A robot file that does not fit the first log of its robot, though nothing of it was refused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.measurement.checks.left_over import CAUSES, most_left, shares_in_words
from jointwear.monitor.events import Event
from jointwear.monitor.reading.survey import Survey
from jointwear.monitor.reading.windows import WindowStatistics

#: Kind of the findings.
MISFIT = "misfit"


def misfit_findings(statistics: WindowStatistics, survey: Survey, events: Sequence[Event]) -> list[dict[str, Any]]:
    """Return a finding on the joint that seems to count from another zero than the robot file says, or else on the
    axes of which the file explains less than half; none where it fits.

    Parameters
    ----------
    events : of the config; one of an axis answers what is told of it, as of a spring that no file has.
    """
    left = np.array([np.nan if x is None else x for x in survey.left_over])
    axes = most_left(left)
    if survey.zero_axis is not None:
        axes = [survey.zero_axis]
        words = (
            f"In the first log {survey.zero}. Until then friction and its growth are not to be trusted on any axis; "
            "if it is right as it is, any event of this axis answers this."
        )
    elif axes:
        words = (
            f"The robot file leaves {shares_in_words(left, axes, 'axis')} unexplained in the first log, whatever the "
            f"size of friction: {CAUSES}. Friction and its growth are not to be trusted there until the file is right; "
            f"if it is, any event of {name_axes([j + 1 for j in axes])} answers this."
        )
    else:
        return []
    answered = all(any(event.concerns(j) for event in events) for j in axes)
    told = {"time": float(statistics.start[0]), "axes": [j + 1 for j in axes], "kind": MISFIT, "words": words}
    return [{**told, **({"answered": True} if answered else {})}]
