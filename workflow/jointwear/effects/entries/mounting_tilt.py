"""A base that does not stand level: gravity comes from another direction than the model has it."""

from __future__ import annotations

import numpy as np

from jointwear.effects.effect import Effect, Parameter
from jointwear.files.errors import InputError

#: Largest tilt [rad] that counts as bad mounting; beyond it the robot is mounted in another way.
_LARGEST = 0.35
#: What bad mounting is likely to be [rad].
_LIKELY = np.radians(2.0)
_SENSE = "right-handed turn of gravity as the base has it (the base leans the other way)"


def _level(gravity):
    """Return the two directions (2, 3) across gravity that are closest to x and y of the base (y, z if it is x)."""
    down = gravity / np.linalg.norm(gravity)
    first = np.eye(3)[1 if abs(down[0]) > 0.9 else 0]
    first = first - (first @ down) * down
    first = first / np.linalg.norm(first)
    return np.stack([first, np.cross(-down, first)])


def _turned(gravity, angles):
    """Return gravity turned about the directions of :func:`_level` by a rotation vector (2,) [rad]."""
    angle = float(np.hypot(*angles))
    if angle == 0:
        return np.array(gravity, dtype=float)
    about = np.asarray(angles) @ _level(gravity) / angle
    return np.cos(angle) * gravity + np.sin(angle) * np.cross(about, gravity)


def _columns(state, axis, source, p):
    if state.gravity_regressor is None:
        raise InputError(
            "a mounting tilt among the 'effects' needs the torque of gravity; write it as 'gravity' of the robot file"
        )
    gravity = state.drive.gravity
    if not np.any(gravity):
        raise InputError("a mounting tilt among the 'effects' turns gravity, and 'gravity' of the robot file is 0")
    return state.gravity_regressor() @ np.cross(_level(gravity), gravity).T


def _parameters_of(p, c):
    # The columns stand for the sine of the angle; gravity keeps its size.
    size = float(np.hypot(*c))
    angle = np.arcsin(min(size, 1.0)) / size if size > 0 else 1.0
    return {**p, "about_x": float(angle * c[0]), "about_y": float(angle * c[1])}


def _torque(state, axis, source, p):
    gravity = state.drive.gravity
    if state.gravity_regressor is None or not np.any(gravity):
        return _columns(state, axis, source, p)
    return state.gravity_regressor() @ (_turned(gravity, (p["about_x"], p["about_y"])) - gravity)


def _writes(content, p):
    gravity = np.array(content.get("gravity", [0.0, 0.0, -9.81]), dtype=float)
    return {**content, "gravity": [float(x) for x in _turned(gravity, (p["about_x"], p["about_y"]))]}


EFFECT = Effect(
    identifier="mounting_tilt",
    name="Mounting tilt",
    equation="G(q; R g) - G(q; g) with R a turn of gravity by two angles",
    parameters=(
        Parameter("about_x", "rad", -_LARGEST, _LARGEST, f"{_SENSE}, about the level direction next to base x"),
        Parameter("about_y", "rad", -_LARGEST, _LARGEST, "the same next to base y"),
    ),
    confused_with=("payload", "joint_spring"),
    excitation="poses that turn the arm about its first axis, and the first axis through its whole travel",
    source="installation practice",
    argument="pose",
    argument_unit="rad",
    torque=_torque,
    columns=_columns,
    parameters_of=_parameters_of,
    grid=lambda state, axis: [{}],
    needs=("gravity",),
    whole_arm=True,
    prior=lambda robot: np.array([_LIKELY, _LIKELY]),
    writes=_writes,
)
