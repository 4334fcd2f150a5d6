"""Torque ripple of the motor that does not depend on its load."""

import numpy as np

from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.motor_waves import ORDER, PHASE, motor_wave


def _height(state, axis, share):
    # A fast wave shakes the joint: it is in its acceleration as much as in the torque, and both were filtered.
    return np.ones(state.position.shape[:-1]) * share**2


EFFECT = Effect(
    identifier="cogging_torque",
    name="Cogging torque",
    equation="A sin(k G q + phi)",
    parameters=(Parameter("amplitude", "N m", 0.0, 1e4, "A"), ORDER, PHASE),
    confused_with=("torque_constant_ripple",),
    excitation="slow motion over several turns of the motor at different loads",
    source="Piccoli and Yim 2016",
    argument="motor angle",
    argument_unit="rad",
    needs=("gear", "motor torque"),
    **motor_wave(_height),
)
