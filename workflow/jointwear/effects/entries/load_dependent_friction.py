"""Coulomb friction that grows with the torque that the gear transmits."""

import numpy as np

from jointwear.effects.effect import Effect, Parameter


def _columns(state, axis, source, p):
    return (np.abs(state.load[..., axis]) ** p["exponent"] * state.direction[..., axis])[..., None]


EFFECT = Effect(
    identifier="load_dependent_friction",
    name="Load-dependent friction",
    equation="mu |tau_load|^p sign(v)",
    parameters=(
        Parameter("coefficient", "(N m)^(1-p)", 0.0, 1e3, "mu, share of the load torque that becomes friction"),
        Parameter("exponent", "1", 0.3, 3.0, "p", 1.0),
    ),
    confused_with=("torque_constant_error",),
    excitation="the same motion in poses with different gravity load",
    source="Hamon, Gautier and Garrec 2010; Bittencourt and Gunnarsson 2012",
    argument="load",
    argument_unit="N m",
    torque=lambda state, axis, source, p: p["coefficient"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "coefficient": float(c[0])},
    grid=lambda state, axis: [{"exponent": a} for a in (0.5, 1.0, 1.5, 2.0)],
    shape=lambda state, axis, p: (state.direction[..., axis], np.abs(state.load[..., axis])),
)
