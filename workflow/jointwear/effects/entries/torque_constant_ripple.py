"""Torque ripple of the motor that scales with its torque."""

from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.motor_waves import ORDER, PHASE, motor_wave
from jointwear.effects.state import State

EFFECT = Effect(
    identifier="torque_constant_ripple",
    name="Torque-constant ripple",
    equation="tau A sin(k G q + phi)",
    parameters=(Parameter("amplitude", "1", 0.0, 1.0, "A, share of the torque"), ORDER, PHASE),
    confused_with=("cogging_torque",),
    excitation="slow motion over several turns of the motor at different loads",
    source="Piccoli and Yim 2016",
    argument="motor angle",
    argument_unit="rad",
    needs=("gear", "motor torque"),
    **motor_wave(lambda state, axis: state.torque[..., axis], left=State.passed),
    of_torque=True,
)
