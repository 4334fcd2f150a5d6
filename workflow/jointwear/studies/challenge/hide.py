"""Choose an axis on which an effect can act, and draw the effect."""

from __future__ import annotations

import numpy as np

from jointwear.studies.challenge import drive_forms, friction_forms, outside_forms, structure_forms
from jointwear.studies.challenge.scene import Scene
from jointwear.studies.challenge.tiers import WHOLE_ARM
from jointwear.studies.challenge.world import Hidden

DRAW = {**friction_forms.DRAW, **drive_forms.DRAW, **structure_forms.DRAW, **outside_forms.DRAW}

#: Effects that follow the load of the axis: without load there is nothing to hide.
_LOADED = {"load_dependent_friction", "joint_flexibility", "torque_constant_error"}
#: Effects that need a path with smooth derivatives between the samples.
SMOOTH_ONLY = {"joint_flexibility"}


def allowed_axes(name: str, scene: Scene) -> list[int]:
    """Return the 0-based axes on which an effect can act; empty for one of the whole arm."""
    axes = list(range(scene.joints))
    if name in WHOLE_ARM:
        return []
    if name in _LOADED:
        return [k for k in axes if scene.load[k] > 0.4 * scene.coulomb[k]]
    if name == "drive_coupling":
        return axes[-3:]
    return axes


def draw_hidden(name: str, scene: Scene, rng: np.random.Generator, axis: int | None = None) -> Hidden:
    """Draw one effect or disturbance; without `axis` (0-based) an axis is drawn among those that can carry it."""
    allowed = allowed_axes(name, scene)
    if axis is None and allowed:
        axis = int(rng.choice(allowed))
    return DRAW[name](scene, rng, axis)
