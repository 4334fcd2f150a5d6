"""A torque constant (or drive gain) that is off by a fixed share."""

from jointwear.effects.effect import Effect, Parameter

EFFECT = Effect(
    identifier="torque_constant_error",
    name="Torque-constant error",
    equation="eps tau",
    parameters=(Parameter("share", "1", -0.9, 0.9, "eps, share by which the measured torque is too large"),),
    confused_with=("load_dependent_friction", "payload"),
    excitation="a known payload, or poses whose gravity load is known",
    source="Gautier and Briot 2014, drive gains",
    argument="torque",
    argument_unit="N m",
    torque=lambda state, axis, source, p: p["share"] * state.torque[..., axis],
    columns=lambda state, axis, source, p: state.torque[..., axis, None],
    parameters_of=lambda p, c: {**p, "share": float(c[0])},
    grid=lambda state, axis: [{}],
    of_drive=True,
    regime=lambda state, axis, source, p: state.torque[..., axis],
    of_torque=True,
)
