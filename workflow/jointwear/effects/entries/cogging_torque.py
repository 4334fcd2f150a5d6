"""Torque ripple of the motor that does not depend on its load."""

import numpy as np

from jointwear.effects.bends import harmonics_bend
from jointwear.effects.effect import Effect, Parameter


def _angle(state, axis, p):
    return p["order"] * state.drive.gear_ratio[axis] * state.position[..., axis]


def _waves(state, axis, p):
    return p["order"] * abs(float(state.drive.gear_ratio[axis]))


def _height(state, axis, p):
    """Return the torque at an amplitude of one, as far as the band of the recording lets it pass."""
    # A fast wave shakes the joint: it is in its acceleration as much as in the torque, and both were filtered.
    return np.ones(state.position.shape[:-1]) * state.passed(axis, _waves(state, axis, p)) ** 2


def _columns(state, axis, source, p):
    angle = _angle(state, axis, p)
    return np.stack([np.sin(angle), np.cos(angle)], axis=-1) * _height(state, axis, p)[..., None]


EFFECT = Effect(
    identifier="cogging_torque",
    name="Cogging torque",
    equation="A sin(k G q + phi)",
    parameters=(
        Parameter("amplitude", "N m", 0.0, 1e4, "A"),
        Parameter("order", "1", 0.05, 400.0, "k, waves in one turn of the motor", 1.0, searched=False),
        Parameter("phase", "rad", -6.3, 6.3, "phi"),
    ),
    confused_with=("torque_constant_ripple",),
    excitation="slow motion over several turns of the motor at different loads",
    source="Piccoli and Yim 2016",
    argument="motor angle",
    argument_unit="rad",
    torque=lambda state, axis, source, p: (
        p["amplitude"] * _height(state, axis, p) * np.sin(_angle(state, axis, p) + p["phase"])
    ),
    columns=_columns,
    parameters_of=lambda p, c: {
        **p,
        "amplitude": float(np.hypot(c[0], c[1])),
        "phase": float(np.arctan2(c[1], c[0])),
    },
    grid=lambda state, axis: [{"order": float(k)} for k in range(1, 25)],
    needs=("gear", "motor torque"),
    bend=harmonics_bend(_columns),
    waves=_waves,
    shape=lambda state, axis, p: (_height(state, axis, p), np.mod(_angle(state, axis, p), 2 * np.pi)),
)
