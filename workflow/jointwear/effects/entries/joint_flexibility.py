"""A gear that twists under load, so that the motor accelerates differently from the link."""

from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.order import second_derivative


def _columns(state, axis, source, p):
    return second_derivative(state, state.load[..., axis])[..., None]


EFFECT = Effect(
    identifier="joint_flexibility",
    name="Joint flexibility",
    equation="(Jm G^2 / K) d2(tau_load)/dt2",
    parameters=(
        Parameter(
            "inertia_over_stiffness", "s2", 0.0, 1.0, "Jm G^2/K, the square of the period of the drive over 2 pi"
        ),
    ),
    confused_with=("actuation_delay",),
    excitation="motion with much jerk, and different loads",
    source="Gautier, Janot and Vandanjon 2013; Spong 1987",
    argument="second derivative of the load",
    argument_unit="N m/s2",
    torque=lambda state, axis, source, p: p["inertia_over_stiffness"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "inertia_over_stiffness": float(c[0])},
    grid=lambda state, axis: [] if state.record is None else [{}],
    sequential=True,
)
