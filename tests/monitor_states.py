"""States of a monitored robot, altered for a test."""

from dataclasses import replace

import numpy as np

from jointwear.monitor.watching.records import CHANGED

#: A name in a log that would run as a script. The robot of the fixture `monitored`: hours, and the 0-based worn axis.
EVIL = "<script>alert(1)</script>"
HOURS, WORN = 60, 2


def changed(state, quantity, j=0, **more):
    """The state with one alarm of an axis, which counts as changed since."""
    alarm = {
        **state.alarms[-1], "axis": j + 1, "quantity": quantity, "detector": "model", "unit": "N m s/rad",
        "change": 2.0, "change_low": 1.0, "change_high": 3.0, "probability_axis": 0.99, "time": float(state.end[50]),
    } | more  # fmt: skip
    status = np.full_like(state.status, "healthy")
    status[50:, j] = CHANGED
    nothing = {"grown": ("",) * state.axes, "limits": (None,) * state.axes}
    return replace(state, alarms=[alarm], status=status, **nothing)


def with_estimates(state, **values):
    """The state with estimates that are the same everywhere."""
    shape = state.status.shape
    more = {name: (np.full(shape, value), np.ones(shape), "%") for name, value in values.items()}
    return replace(state, estimates={**state.estimates, **more}, now_error={})
