"""Parameters of a robot file in other units, or seldom meant: torques far too large, gravity, gear ratios."""

from __future__ import annotations

import numpy as np

from jointwear.files.wording import numbered, significant
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import bodies
from jointwear.robots.robot import Robot

#: Error of the nominal model over the torque that was measured, RMS: of most joints and of a single one, from which
#: parameters are in other units. A model without friction has 1 at most, one with a payload that is not there 3; link
#: inertia in kg mm2 or friction of the wrong side of a gear 10 to 30,000.
OF_MOST, OF_ONE = 8.0, 50.0
#: Gear ratio from which a joint is geared: where half of an arm is, a joint without may be one that was forgotten.
GEARED = 10.0
#: Gravity [m/s2] on Earth, least and most: at the equator and at a pole.
EARTH = 9.78, 9.84
#: What a robot file asks for, by the part of the torque that is too large.
_REMEDIES = {
    "the bodies": "give masses in kg, centres of mass in m and inertias in kg m2",
    "motor inertia": "give 'motor_inertia' at the motor in kg m2: that at the joint over the square of the gear ratio",
    "friction": "give 'coulomb' and 'viscous' at the motor: those at the joint over the gear ratio, and its square",
}
#: What it asks for where the torque is that of a sensor behind the gears, which does not feel the motors. Coulomb
#: friction that is more than all torque there was left out before (`behind_gears.py`); viscous friction comes here.
_BEHIND_GEARS = "leave out 'coulomb' and 'viscous' of motor and gear: 'torque_kind' says that it is measured behind"


def check_model_size(measured: Measured, robot: Robot, name: str, behind_gears: bool = False) -> None:
    """Check that the nominal model, with everything that its file holds, gives torques of the size of those measured.

    Parameters
    ----------
    behind_gears : whether the torque was measured there, where friction of motors and gears is not felt.

    Raises
    ------
    Refused : where it does not, with the part of the model that is largest.
    """
    samples = thinned(measured)
    motion = samples.position, samples.velocity, samples.acceleration
    rigid = Dynamics(robot).rigid_body_torque(*motion)
    rotor = robot.armature * samples.acceleration
    parts = {
        "the bodies": rigid - rotor,
        "motor inertia": rotor,
        "friction": robot.friction(samples.velocity),
    }
    ratio = np.full(robot.joints, np.nan)
    error = samples.torque - sum(parts.values())
    for j, used in enumerate(samples.usable.T):
        size = np.sqrt(np.mean(samples.torque[used, j] ** 2)) if used.sum() >= FEWEST_OF_JOINT else 0.0
        if size > 0:
            ratio[j] = np.sqrt(np.mean(error[used, j] ** 2)) / size
    known = ratio[np.isfinite(ratio)]
    if not len(known) or (np.median(known) <= OF_MOST and np.max(known) <= OF_ONE):
        return
    worst = int(np.nanargmax(ratio))
    used = samples.usable[:, worst]
    largest = max(parts, key=lambda part: float(np.mean(parts[part][used, worst] ** 2)))
    remedy = _BEHIND_GEARS if behind_gears and largest == "friction" else _REMEDIES[largest]
    raise Refused(
        f"{name}: the model of robot '{robot.name}' misses the torque of joint {worst + 1} by "
        f"{significant(ratio[worst])} times its size; the torque of {largest} is far too large for it",
        f"{remedy}; or state the unit of the torque",
        by_keys=True,
    )


def unusual_parameters(robot: Robot) -> list[str]:
    """Return in words what a robot file says that is seldom meant."""
    found, gravity = [], float(np.linalg.norm(robot.gravity))
    if not EARTH[0] <= gravity <= EARTH[1]:
        found.append(
            f"the robot file has a gravity of {gravity:.4g} m/s2, on Earth it is 9.81: what is missing looks like a "
            "force or a spring"
        )
    # A DH table states a mass of 0, of a link without an effect on any torque; a URDF leaves one out.
    light = [] if robot.links is not None else [j + 1 for j, body in enumerate(bodies(robot)) if not body[0] > 0]
    if light:
        found.append(
            f"the URDF has no mass for what {numbered('joint', light)} {'moves' if len(light) == 1 else 'move'} before "
            "the next joint: give the link its <inertial>, unless it stands for none"
        )
    ratio = np.abs(robot.gear_ratio)
    direct, geared = ratio == 1.0, ratio >= GEARED
    told = direct & (np.maximum(robot.armature, np.maximum(robot.coulomb_positive, robot.viscous)) > 0)
    if told.any() and geared.sum() >= direct.sum():
        least, most = ratio[geared].min(), ratio[geared].max()
        others = f"{least:.4g}" if least == most else f"{least:.4g} to {most:.4g}"
        found.append(
            f"the gear ratio of {numbered('joint', np.flatnonzero(told) + 1)} is 1, as it is where a robot file says "
            f"nothing of it, that of others is {others}: friction and motor inertia of the file count there as at the "
            "joint; give 'gear_ratio' unless that is so"
        )
    slow = np.flatnonzero(np.abs(robot.gear_ratio) < 1.0)
    if len(slow):
        found.append(
            f"the gear ratio of {numbered('joint', slow + 1)} is below 1: it is turns of the motor for one of the "
            "joint, and friction and motor inertia of the file are the motor's"
        )
    return found
