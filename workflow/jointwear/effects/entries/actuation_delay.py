"""Torque that is measured or acts later than commanded."""

from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.order import delayed


def _columns(state, axis, source, p):
    torque = state.torque[..., axis]
    return (delayed(state, torque, p["delay"]) - torque)[..., None]


EFFECT = Effect(
    identifier="actuation_delay",
    name="Actuation delay",
    equation="tau(t - d) - tau(t)",
    parameters=(Parameter("delay", "s", 0.0, 0.06, "d"),),
    confused_with=("presliding_hysteresis", "joint_flexibility"),
    excitation="fast changes of torque, with and without reversals",
    source="engineering judgement",
    argument="rate of torque",
    argument_unit="N m/s",
    torque=lambda state, axis, source, p: _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    # To first order the effect is -d times the rate of torque, so the coefficient scales the delay.
    parameters_of=lambda p, c: {"delay": float(p["delay"] * c[0])},
    grid=lambda state, axis: [] if state.record is None else [{"delay": d} for d in (0.004, 0.012, 0.02)],
    sequential=True,
)
