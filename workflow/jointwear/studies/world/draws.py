"""Draw what is hidden in a case: errors of the robot file, and effects or disturbances on axes that can show them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.studies.world import channels, frictions, outside, structures
from jointwear.studies.world.chains import Chain, with_body, with_errors
from jointwear.studies.world.hidden import Hidden, Scales
from jointwear.studies.world.plan import EFFECTS, Case
from jointwear.studies.world.plant import DriveParameters
from jointwear.studies.world.setting import Setting

DRAW = {**frictions.DRAW, **structures.DRAW, **channels.DRAW, **outside.DRAW}

#: Whole-arm effects have no axis.
WHOLE_ARM = {"payload", "mounting_tilt"}
#: Effects that need a load on their axis.
_LOADED = {
    "load_dependent_friction",
    "torque_constant_error",
    "joint_flexibility",
    "torque_constant_temperature",
    "torque_constant_ripple",
}


def subjects_of(case: Case, rng: np.random.Generator) -> list[str | None]:
    """Return what a case hides; two different effects by chance in a case of two."""
    if case.kind == "two":
        return [str(x) for x in rng.choice(EFFECTS, 2, replace=False)]
    return [case.subject]


def real_arm(
    case: Case, setting: Setting, chain: Chain, drives: DriveParameters, rng: np.random.Generator
) -> tuple[Chain, DriveParameters, dict[str, Any] | None]:
    """Return the arm that moves: the one of the robot file with errors, and in "retuned" cases one gross error."""
    real = with_errors(chain, rng, setting.inertial_error)
    off = [np.clip(1 + setting.drive_error * rng.normal(size=chain.joints), 0.5, 1.5) for _ in range(3)]
    parameters = {
        "coulomb_friction": drives.coulomb * off[0],
        "viscous_friction": drives.viscous * off[1],
        "motor_inertia": drives.armature * off[2],
    }
    if case.kind != "retuned":
        return real, DriveParameters(*parameters.values()), None
    axis, name = int(rng.integers(chain.joints)), str(case.subject)
    share = float(rng.uniform(0.15, 0.40) * rng.choice([-1, 1]))
    if name == "link_inertia":
        real = with_body(real, axis, real.mass[axis] * (1 + share), real.com[axis], real.inertia[axis] * (1 + share))
    else:
        parameters[name] = parameters[name].copy()
        parameters[name][axis] *= 1 + share
    return real, DriveParameters(*parameters.values()), {"parameter": name, "axis": axis + 1, "share": share}


def draw_hidden_things(subjects: Sequence[str | None], scales: Scales, rng: np.random.Generator) -> list[Hidden]:
    """Draw the things to hide, each on an axis where it can act."""
    hidden: list[Hidden] = []
    for name in subjects:
        n = scales.chain.joints
        axes = list(range(n))
        if name in _LOADED:
            axes = [k for k in axes if scales.load[k] > 0.4 * scales.drives.coulomb[k]] or [1]
        taken = [h.axis for h in hidden]
        # Two effects share an axis in two cases of five.
        free = [k for k in axes if k not in taken]
        axis = int(rng.choice(axes if rng.random() < 0.4 or not free else free))
        hidden.append(DRAW[str(name)](scales, rng, None if name in WHOLE_ARM else axis))
    return hidden
