"""Torque ripple of the motor that does not depend on its load."""

import numpy as np

from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.motor_waves import HELD, ORDER, PHASE, motor_wave
from jointwear.effects.state import State


def _height(state, axis):
    return np.ones(state.position.shape[:-1])


EFFECT = Effect(
    identifier="cogging_torque",
    name="Cogging torque",
    equation="A sin(k G q + phi)",
    parameters=(Parameter("amplitude", "N m", 0.0, 1e4, "A"), ORDER, PHASE, HELD),
    confused_with=("torque_constant_ripple",),
    excitation="slow motion over several turns of the motor at different loads",
    source="Piccoli and Yim 2016",
    argument="motor angle",
    argument_unit="rad",
    needs=("gear", "motor torque"),
    **motor_wave(_height, left=State.shaken, may_be_held=True),
)
