"""An offset of the torque that drifts with time, whatever the direction of motion."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter

#: Waves over the time of all recordings that are tried. A wave that is off by half a wave over that time is another
#: one, which no search of the period leaves again; of more waves than recordings a few levels say as much.
WAVES = (0.4, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0)


def _rise(state, p):
    return -np.expm1(-np.maximum(state.time - p["start"], 0.0) / p["time_constant"])


def _wave(state, p):
    return 2 * np.pi * (state.time - p["start"]) / p["period"]


def _columns(state, axis, source, p):
    if "period" in p:
        wave = _wave(state, p)
        return np.stack([np.sin(wave), np.cos(wave)], axis=-1)
    return _rise(state, p)[..., None]


def _torque(state, axis, source, p):
    total = np.zeros(np.shape(state.time))
    if p["level"]:
        total = total + p["level"] * _rise(state, p)
    if p["sine"] or p["cosine"]:
        total = total + p["sine"] * np.sin(_wave(state, p)) + p["cosine"] * np.cos(_wave(state, p))
    return total


def _parameters_of(p, c):
    if "period" in p:
        return {**p, "sine": float(c[0]), "cosine": float(c[1])}
    return {**p, "level": float(c[0])}


def _grid(state, axis):
    start, span = float(np.min(state.time)), float(np.ptp(state.time))
    if span <= 0:
        return []
    rises = [{"start": start, "time_constant": f * span} for f in (0.1, 0.25, 0.6, 2.0, 20.0)]
    return rises + [{"start": start, "period": span / waves} for waves in WAVES]


def _plain(state, axis):
    # A straight line.
    start, span = float(np.min(state.time)), float(np.ptp(state.time))
    return [{"start": start, "time_constant": 20.0 * span}] if span > 0 else []


def _slower(state, axis, p):
    # A few recordings show a fast wave at a few points, which a slow one goes through as well.
    return [g for g in _grid(state, axis) if "period" in g and g["period"] > p.get("period", np.inf)]


def _shape(state, axis, p):
    return np.ones(np.shape(state.time)), state.time


EFFECT = Effect(
    identifier="torque_offset_drift",
    name="Drifting torque offset",
    equation="c(t): a slow rise c (1 - exp(-t/tc)), or a slow wave",
    parameters=(
        Parameter("level", "N m", -1e4, 1e4, "c, where the rise ends"),
        Parameter("time_constant", "s", 1e-3, 1e9, "tc of the rise", 60.0),
        Parameter("sine", "N m", -1e4, 1e4, "sine part of the wave"),
        Parameter("cosine", "N m", -1e4, 1e4, "cosine part of the wave"),
        Parameter("period", "s", 1e-3, 1e9, "period of the wave", 60.0),
        Parameter("start", "s", -1e10, 1e10, "time at which the drift starts", 0.0, fixed=True),
    ),
    confused_with=("wear_drift",),
    excitation="both directions of motion spread over the whole time",
    source="Gautier 1997 on offsets; form by engineering judgement",
    argument="time",
    argument_unit="s",
    torque=_torque,
    columns=_columns,
    parameters_of=_parameters_of,
    grid=_grid,
    plain=_plain,
    slower=_slower,
    shape=_shape,
    bend=table_bend(_shape, 6),
    needs=("time",),
    floats=True,
)
