"""The robot file of a plant, as its user would have written it: URDF, friction, motor inertia and gears."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from jointwear.files.text_files import replace_text
from jointwear.robots.robot import Robot, load_robot
from jointwear.studies.world.chains import Chain, urdf_text
from jointwear.studies.world.plant import DriveParameters


def write_robot(folder: Path, name: str, chain: Chain, drives: DriveParameters, gear: np.ndarray) -> Robot:
    """Write `name`.urdf and `name`.yaml into `folder` and return the robot that they describe.

    Parameters
    ----------
    gear : (n,) gear ratios; 1 where the user knows the joint side only.
    """
    folder.mkdir(parents=True, exist_ok=True)
    replace_text(folder / f"{name}.urdf", urdf_text(chain, name))
    joints = []
    for k, joint in enumerate(chain.names):
        g = float(gear[k])
        joints.append(
            {
                "name": joint,
                "limits": [float(chain.lower[k]), float(chain.upper[k])],
                "gear_ratio": g,
                "motor_inertia": float(drives.armature[k] / g**2),
                "viscous": float(drives.viscous[k] / g**2),
                "coulomb": {
                    "positive": float(drives.coulomb[k] / abs(g)),
                    "negative": float(-drives.coulomb[k] / abs(g)),
                },
                "torque_limit": None,
            }
        )
    content = {"name": name, "gravity": [0.0, 0.0, -9.81], "urdf": f"{name}.urdf", "joints": joints}
    # Inertial parameters that are known imperfectly need not be those of a rigid body.
    content["inertia_check"] = "none"
    # JSON is YAML.
    replace_text(folder / f"{name}.yaml", json.dumps(content, indent=1) + "\n")
    return load_robot(folder / f"{name}.yaml")
