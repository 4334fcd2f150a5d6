"""Payloads and drives that no arm has beside its own links; without numpy, because the Snakefile checks robots at every
call.

Each is held to the arm itself, as a drive of a small arm would be nothing to a large one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.wording import significant

#: Multiple of the mass of the links up to which a payload is believed. Light arms carry half of their own mass, those
#: for 1,000 kg a fifth; ten times the most leaves room for files that lack some masses.
MOST_CARRIED = 5.0
#: Gear ratio, in size, below which it is the inverse of one: 1 is a direct drive, and a belt that makes a joint faster
#: than its motor is seldom beyond one to two.
LEAST_RATIO = 0.1
#: Multiple of the inertia of the whole arm, stretched out, up to which that of a motor behind its gear is believed.
#: Motors have up to about the inertia of the arm that they move; in g m2, or given at the joint, a thousand times more.
MOST_ROTOR = 100.0
#: Multiple of the torque that holds the whole arm with its payload, stretched out, up to which Coulomb friction behind
#: the gear is believed. That of measured arms is a tenth of it; given at the joint it is a gear ratio too large.
MOST_FRICTION = 3.0
#: Fewest joints of an arm; on a bench of one or two friction may be all there is.
FEWEST_JOINTS = 3
_GRAVITY = 9.81


def check_payload(path: Any, data: Mapping[str, Any], links: float) -> None:
    """Check that a payload is one that the links can carry.

    Parameters
    ----------
    data : of a robot file. links : mass of the links that move [kg], 0 where it is not known.

    Raises
    ------
    InputError : naming the key, the unit that it looks like and the largest payload.
    """
    mass, most = float(data.get("payload", {}).get("mass", 0.0)), MOST_CARRIED * links
    if links > 0 and mass > most:
        near = f"; this looks like g: {mass / 1000:g}" if mass / 1000 <= most else ""
        raise InputError(
            f"{path}: 'payload.mass' is {mass:g}, in kg, on links of {links:.4g} kg together{near} (allowed: up to "
            f"{MOST_CARRIED:g} times their mass, {most:.4g})"
        )


def check_ratio(path: Any, index: int, ratio: float) -> None:
    """Check that a gear ratio is no inverse of one.

    Raises
    ------
    InputError : naming the key and the inverse.
    """
    if 0 < abs(ratio) < LEAST_RATIO:
        raise InputError(
            f"{path}: 'joints[{index}].gear_ratio' is {ratio:.4g}, turns of the motor for one of the joint; this looks "
            f"like its inverse: {significant(1 / ratio, 4)} (allowed: {LEAST_RATIO:g} and more in size; 1 for a direct "
            "drive)"
        )


def check_drives(path: Any, data: Mapping[str, Any]) -> None:
    """Check motor inertia and friction behind the gears of an arm by DH table against its links.

    Parameters
    ----------
    data : of a robot file, checked, with complete joints.

    Raises
    ------
    InputError : naming the key, what it is behind the gear, and the largest value.
    """
    links = [*data["links"], *([data["payload"]] if "payload" in data else [])]
    mass = sum(float(body["mass"]) for body in links)
    reach = sum(abs(row["a"]) + abs(row["d"]) for row in data["dh"])
    reach += max(math.hypot(*body["com"]) for body in links)
    if len(data["joints"]) < FEWEST_JOINTS or not mass * reach > 0:
        return
    inertia, torque = mass * reach**2, mass * _GRAVITY * reach
    for i, joint in enumerate(data["joints"]):
        gear = abs(joint["gear_ratio"])
        rotor, most = joint["motor_inertia"], MOST_ROTOR * inertia / gear**2
        if rotor > most:
            # At the joint a motor has up to about the inertia of the arm; more is that of neither side.
            near = _at_motor(rotor / gear**2, inertia / gear**2)
            raise InputError(
                f"{path}: 'joints[{i}].motor_inertia' is {rotor:g}, in kg m2 at the motor; behind a gear of {gear:g} "
                f"that is {significant(rotor * gear**2)} kg m2, the whole arm has {significant(inertia)}{near} "
                f"(allowed: up to {significant(most)})"
            )
        most = MOST_FRICTION * torque / gear
        for way, friction in joint["coulomb"].items():
            if abs(friction) > most:
                near = _at_motor(friction / gear, most)
                raise InputError(
                    f"{path}: 'joints[{i}].coulomb.{way}' is {friction:g}, in N m at the motor; behind a gear of "
                    f"{gear:g} that is {significant(abs(friction) * gear)} N m, and {significant(torque)} N m hold the "
                    f"whole arm stretched out{near} (allowed: up to {significant(most)} in size)"
                )


def _at_motor(value: float, most: float) -> str:
    """Return a value as a proposal where it lies within what is allowed at the motor."""
    return f"; this looks like that of the joint, at the motor {significant(value)}" if abs(value) <= most else ""
