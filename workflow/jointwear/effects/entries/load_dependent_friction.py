"""Coulomb friction that grows with the torque that the gear transmits."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter


def _friction(state, axis, exponent):
    return np.abs(state.load[..., axis]) ** exponent * state.direction[..., axis]


def _columns(state, axis, source, p):
    friction = _friction(state, axis, p["exponent"])
    if not p.get("directional"):
        return friction[..., None]
    # Where load and motion have one sign the motor works against the load, else the load drives the joint.
    driven = state.load[..., axis] * state.velocity[..., axis] < 0
    return np.stack([np.where(driven, 0.0, friction), np.where(driven, friction, 0.0)], axis=-1)


def _torque(state, axis, source, p):
    sizes = [p["coefficient"], p["driven"]] if p.get("directional") else [p["coefficient"]]
    return _columns(state, axis, source, p) @ np.array(sizes)


def _parameters_of(p, c):
    return {**p, **dict(zip(("coefficient", "driven"), map(float, c), strict=False))}


def _shape(state, axis, p):
    return state.direction[..., axis], np.abs(state.load[..., axis])


EFFECT = Effect(
    identifier="load_dependent_friction",
    name="Load-dependent friction",
    equation="mu |tau_load|^p sign(v), with another mu where the load drives the joint",
    parameters=(
        Parameter("coefficient", "(N m)^(1-p)", 0.0, 1e3, "mu, share of the load torque that becomes friction"),
        Parameter("exponent", "1", 0.3, 3.0, "p", 1.0),
        Parameter("driven", "(N m)^(1-p)", 0.0, 1e3, "mu_d, the same where the load drives the joint; if directional"),
        Parameter("directional", "1", 0, 1, "1: mu_d holds where the load drives the joint", 0, fixed=True),
    ),
    confused_with=("torque_constant_error",),
    excitation="the same motion in poses with different gravity load",
    source="Hamon, Gautier and Garrec 2010; Bittencourt and Gunnarsson 2012; directional: Duclusaud et al. 2025 (BAM)",
    argument="load",
    argument_unit="N m",
    needs=("friction",),
    torque=_torque,
    columns=_columns,
    parameters_of=_parameters_of,
    grid=lambda state, axis: [*({"exponent": a} for a in (0.5, 1.0, 1.5, 2.0)), {"exponent": 1.0, "directional": 1}],
    shape=_shape,
    bend=table_bend(_shape),
    regime=lambda state, axis, source, p: state.load[..., axis],
)
