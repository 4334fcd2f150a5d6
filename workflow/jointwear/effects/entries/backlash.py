"""Lost motion in the gear: listed so that a verdict can say that it cannot be seen."""

from jointwear.effects.effect import Effect, Parameter

EFFECT = Effect(
    identifier="backlash",
    name="Backlash",
    equation="lost motion between motor and link",
    parameters=(Parameter("gap", "rad", 0.0, 0.1, "lost motion"),),
    confused_with=(),
    excitation="a second encoder on the link side",
    source="engineering judgement",
    argument="travel since reversal",
    argument_unit="rad",
    torque=None,
    columns=None,
    parameters_of=None,
    grid=lambda state, axis: [],
    identifiable=False,
    reason="without a link encoder its torque is a ringing whose form no library can hold: it depends on the inertia "
    "behind the gap and on the controller",
)
