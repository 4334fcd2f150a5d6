"""The plant in MuJoCo: the arm from its URDF with drives, and the places where hidden things are put in."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jointwear.studies.world.chains import Chain, urdf_text
from jointwear.studies.world.packages import mujoco


@dataclass(frozen=True)
class DriveParameters:
    """Joint-side parameters (n,) of the drives: Coulomb [N m], viscous [N m s/rad], motor inertia [kg m2]."""

    coulomb: np.ndarray
    viscous: np.ndarray
    armature: np.ndarray


@dataclass
class Draft:
    """A plant in the making: MuJoCo's specification, and parameters that hidden effects may change before it is built.

    `motor` holds the joint that the motor turns, `flexible` the joints with an elastic gear behind it.
    """

    spec: Any
    chain: Chain
    drives: DriveParameters
    flexible: set[int] = field(default_factory=set)

    def joint(self, axis: int):
        """Return MuJoCo's joint of an axis (0-based): the one that its motor turns."""
        return self.spec.joint(f"joint_{axis + 1}")

    def link(self, axis: int):
        """Return MuJoCo's body behind an axis (0-based)."""
        return self.spec.body(f"link_{axis + 1}")


@dataclass
class Plant:
    """A compiled plant; `motor` and `elastic` (n,) are indices of the degrees of freedom, -1 where there is none."""

    model: Any
    data: Any
    motor: np.ndarray
    elastic: np.ndarray

    def link_position(self) -> np.ndarray:
        """Return the joint angles (n,) behind the gears [rad]."""
        q = self.data.qpos[self.motor]
        return q + np.where(self.elastic >= 0, self.data.qpos[self.elastic], 0.0)

    def link_velocity(self) -> np.ndarray:
        """Return the joint speeds (n,) behind the gears [rad/s]."""
        v = self.data.qvel[self.motor]
        return v + np.where(self.elastic >= 0, self.data.qvel[self.elastic], 0.0)


def draft(chain: Chain, drives: DriveParameters, step: float) -> Draft:
    """Start a plant with time step `step` [s]: rigid gears, friction and motor inertia of the drives, no limits."""
    spec = mujoco().MjSpec.from_string(urdf_text(chain, "arm"))
    spec.option.timestep = step
    # Explicit damping: the torque balance then holds at every step with the logged speed.
    spec.option.disableflags |= int(mujoco().mjtDisableBit.mjDSBL_EULERDAMP)
    for k in range(chain.joints):
        joint = spec.joint(f"joint_{k + 1}")
        joint.limited = mujoco().mjtLimited.mjLIMITED_FALSE
        joint.armature = drives.armature[k]
        joint.frictionloss = drives.coulomb[k]
        stiffen(joint, step)
        joint.damping = [drives.viscous[k], 0.0, 0.0]
    return Draft(spec, chain, drives)


def stiffen(element, step: float) -> None:
    """Let the friction loss of a joint or tendon reach its level within the least speed that the time step allows.

    MuJoCo's default lets friction build up over 0.1 rad/s and more, which no gear does.
    """
    element.solref_friction = [2 * step, 1.0]
    element.solimp_friction = [0.98, 0.999, 0.001, 0.5, 2.0]


def compile_plant(drafted: Draft) -> Plant:
    """Compile the plant."""
    model = drafted.spec.compile()
    n = drafted.chain.joints

    def dof(name: str) -> int:
        index = mujoco().mj_name2id(model, mujoco().mjtObj.mjOBJ_JOINT, name)
        return -1 if index < 0 else int(model.jnt_dofadr[index])

    return Plant(
        model,
        mujoco().MjData(model),
        np.array([dof(f"joint_{k + 1}") for k in range(n)]),
        np.array([dof(f"gear_{k + 1}") for k in range(n)]),
    )
