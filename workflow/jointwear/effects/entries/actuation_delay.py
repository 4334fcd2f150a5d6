"""Torque that is recorded later than it acts, or earlier: a dead time, a filter, or the log of a command."""

import numpy as np

from jointwear.effects.bends import timing_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.order import change_by_delay, change_by_lag

_LONGEST = 0.06
#: Delays and time constants [s] to start from, to either side.
_DEAD, _LAGS = (0.004, 0.012, 0.02), (0.005, 0.015, 0.03)


def _columns(state, axis, source, p):
    if state.record is None:
        return np.zeros((*np.shape(state.time), 1))
    delay, lag = p["delay"], bool(p.get("lag"))
    change, starts = (change_by_lag, _LAGS) if lag else (change_by_delay, _DEAD)
    key = "late", axis, delay, lag
    return state.once(key, lambda: change(state, axis, delay)[..., None], keep=abs(delay) in starts)


def _grid(state, axis):
    return [
        {"delay": sign * d, "lag": lag} for lag, delays in enumerate((_DEAD, _LAGS)) for sign in (1, -1) for d in delays
    ]


EFFECT = Effect(
    identifier="actuation_delay",
    name="Actuation delay",
    equation="tau(t - d) - tau(t), or the same with a first-order lag of time constant d; d < 0 for a logged command",
    parameters=(
        Parameter("delay", "s", -_LONGEST, _LONGEST, "d, by how much the recorded torque is late"),
        Parameter("lag", "1", 0, 1, "0: a dead time, 1: a first-order lag", 0, fixed=True),
    ),
    confused_with=("presliding_hysteresis", "joint_flexibility"),
    excitation="fast changes of torque, with and without reversals",
    source="engineering judgement",
    argument="rate of torque",
    argument_unit="N m/s",
    torque=lambda state, axis, source, p: _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    # To first order the effect is -d times the rate of torque, so the coefficient scales the delay.
    parameters_of=lambda p, c: {**p, "delay": float(p["delay"] * c[0])},
    grid=_grid,
    needs=("order",),
    alternatives=lambda p: [{**p, "lag": 1 - p.get("lag", 0)}],
    scaled="delay",
    timing=True,
    shifts=lambda p: not p.get("lag"),
    late=True,
    bend=timing_bend(),
    sequential=True,
)
