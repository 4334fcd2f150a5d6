"""Two arms of different type: the robot files that a user would have, and the drives as they really are.

The light one has the size of a collaborative arm with strain-wave gears, the heavy one that of a foundry arm with
cycloidal gears. Parameters are typical of the kind, not those of a product.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.robots.robot import Robot, robot_from_data

_QUARTER = float(np.pi / 2)


@dataclass(frozen=True)
class ArmType:
    """What all arms of a type share; lists have one value per axis.

    `home` [rad] around which programs move, `reach` [rad] of their moves, `speed` [rad/s] of a fast move;
    `coulomb` [N m], `viscous` [N m s/rad], `armature` [kg m2] nominal, on the joint side; `bandwidth` [Hz] of the
    position loop; `payloads` [kg] that occur; `encoder_step` [rad]; `torque_step` [N m]; `logs_velocity`.
    """

    name: str
    dh: tuple[tuple[float, float, float], ...]
    masses: tuple[float, ...]
    centres: tuple[tuple[float, float, float], ...]
    inertias: tuple[tuple[float, float, float], ...]
    home: tuple[float, ...]
    reach: tuple[float, ...]
    speed: tuple[float, ...]
    coulomb: tuple[float, ...]
    viscous: tuple[float, ...]
    armature: tuple[float, ...]
    bandwidth: tuple[float, ...]
    payloads: tuple[float, ...]
    encoder_step: float
    torque_step: tuple[float, ...]
    logs_velocity: bool


LIGHT = ArmType(
    name="light_arm",
    dh=(
        (0.18, 0.0, _QUARTER), (0.0, -0.61, 0.0), (0.0, -0.57, 0.0),
        (0.17, 0.0, _QUARTER), (0.12, 0.0, -_QUARTER), (0.12, 0.0, 0.0),
    ),
    masses=(7.4, 13.0, 4.0, 2.0, 2.0, 0.6),
    centres=(
        (0.02, 0.0, 0.03), (0.23, 0.0, 0.16), (0.19, 0.0, 0.05),
        (0.0, 0.007, 0.02), (0.0, 0.007, 0.02), (0.0, 0.0, -0.03),
    ),
    inertias=(
        (0.034, 0.035, 0.022), (0.03, 0.42, 0.41), (0.005, 0.11, 0.11),
        (0.003, 0.002, 0.003), (0.003, 0.002, 0.003), (0.0004, 0.0004, 0.0003),
    ),
    home=(0.0, -1.2, 1.4, -1.8, -1.5, 0.0),
    reach=(1.4, 0.6, 0.8, 0.9, 0.9, 1.6),
    speed=(1.6, 1.2, 1.7, 2.4, 2.4, 3.0),
    coulomb=(11.0, 13.0, 9.0, 2.6, 2.3, 2.0),
    viscous=(12.0, 14.0, 8.0, 1.6, 1.5, 1.2),
    armature=(3.2, 3.2, 1.3, 0.4, 0.4, 0.4),
    bandwidth=(5.0, 5.0, 6.0, 8.0, 8.0, 8.0),
    payloads=(0.0, 2.5, 5.0, 8.0),
    encoder_step=2.4e-5,
    torque_step=(0.05, 0.05, 0.05, 0.012, 0.012, 0.012),
    logs_velocity=True,
)  # fmt: skip
HEAVY = ArmType(
    name="heavy_arm",
    dh=(
        (0.45, 0.16, -_QUARTER), (0.0, 0.70, 0.0), (0.0, 0.13, -_QUARTER),
        (0.80, 0.0, _QUARTER), (0.0, 0.0, -_QUARTER), (0.11, 0.0, 0.0),
    ),
    masses=(70.0, 48.0, 36.0, 14.0, 6.0, 1.2),
    centres=(
        (-0.05, 0.1, 0.0), (-0.38, 0.0, -0.12), (-0.04, 0.02, 0.04),
        (0.0, -0.25, 0.0), (0.0, 0.0, 0.02), (0.0, 0.0, -0.02),
    ),
    inertias=(
        (2.2, 1.9, 1.6), (0.7, 3.4, 3.2), (0.6, 0.7, 0.4), (0.3, 0.05, 0.3), (0.02, 0.02, 0.012), (0.001, 0.001, 0.001),
    ),
    home=(0.0, -1.1, 0.3, 0.0, 0.8, 0.0),
    reach=(1.2, 0.5, 0.5, 1.4, 0.8, 2.0),
    speed=(1.5, 1.3, 1.6, 3.0, 3.0, 3.6),
    coulomb=(62.0, 75.0, 48.0, 10.0, 9.0, 6.5),
    viscous=(70.0, 80.0, 48.0, 6.0, 5.5, 3.2),
    armature=(24.0, 26.0, 12.0, 1.6, 1.4, 0.8),
    bandwidth=(4.0, 4.0, 5.0, 7.0, 7.0, 7.0),
    payloads=(0.0, 6.0, 12.0, 18.0),
    encoder_step=1.2e-5,
    torque_step=(0.4, 0.4, 0.3, 0.08, 0.08, 0.05),
    logs_velocity=False,
)  # fmt: skip
ARM_TYPES = {arm.name: arm for arm in (LIGHT, HEAVY)}
#: Relative standard deviations by which a real arm differs from its robot file.
BODY_ERROR, DRIVE_ERROR, FRICTION_ERROR = 0.04, 0.05, 0.12


def robot_data(arm: ArmType, random: np.random.Generator | None = None, mass: float = 0.0) -> dict[str, Any]:
    """Return the content of a robot file: the nominal arm, or, with random numbers, an arm as built.

    Parameters
    ----------
    mass : at the flange [kg].
    """

    def off(size: float) -> float:
        return 1.0 if random is None else float(1 + size * random.standard_normal())

    limit = 3.2
    joints = [
        {
            "name": f"axis_{j + 1}",
            "limits": [arm.home[j] - limit, arm.home[j] + limit],
            "gear_ratio": 1.0,
            "motor_inertia": arm.armature[j] * off(DRIVE_ERROR),
            "viscous": arm.viscous[j],
            "coulomb": {"positive": arm.coulomb[j], "negative": -arm.coulomb[j]},
            "torque_limit": None,
        }
        for j in range(len(arm.dh))
    ]
    links = [
        {
            "mass": mass_ * off(BODY_ERROR),
            "com": [c * off(BODY_ERROR) for c in centre],
            "inertia": [x * scale for x in (*inertia, 0.0, 0.0, 0.0)],
        }
        for mass_, centre, inertia, scale in zip(
            arm.masses, arm.centres, arm.inertias, [off(BODY_ERROR) for _ in arm.dh], strict=True
        )
    ]
    return {
        "name": arm.name,
        "gravity": [0.0, 0.0, -9.81],
        "dh": [{"d": d, "a": a, "alpha": alpha} for d, a, alpha in arm.dh],
        "links": links,
        "joints": joints,
        "payload": {"mass": mass, "com": [0.0, 0.02, 0.08]},
        "effects": [],
        "provenance": {"source": "made up for the shop floor", "note": "numbers typical of its kind"},
    }


def robot_of(data: dict[str, Any]) -> Robot:
    """Return the robot of a robot file's content."""
    return robot_from_data(data)
