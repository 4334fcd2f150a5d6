"""A serial arm as plain arrays: joint placements, axes and one body a joint; read from a URDF and written as one.

The written URDF holds no meshes, no gripper and no fixed links, so that MuJoCo, Pinocchio and a user read the same arm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pinocchio as pin

from jointwear.robots.urdf_file import text_of


@dataclass(frozen=True)
class Chain:
    """An arm of n revolute joints.

    Attributes
    ----------
    rotation (n, 3, 3), offset (n, 3) [m] : of each joint frame in the frame before it at position 0.
    axis : (n, 3) unit vectors in the joint frames.
    mass (n,) [kg], com (n, 3) [m], inertia (n, 3, 3) [kg m2] about the centre of mass : bodies in the joint frames.
    lower, upper : (n,) [rad].
    """

    rotation: np.ndarray
    offset: np.ndarray
    axis: np.ndarray
    mass: np.ndarray
    com: np.ndarray
    inertia: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    @property
    def joints(self) -> int:
        """Number of joints."""
        return len(self.mass)

    @property
    def names(self) -> list[str]:
        """Names of the joints in the URDF that is written."""
        return [f"joint_{k + 1}" for k in range(self.joints)]


def read_chain(path: Path, names: tuple[str, ...]) -> Chain:
    """Read the joints `names` of a URDF; all other joints are held at 0 and their bodies welded on."""
    full = pin.buildModelFromXML(text_of(path))
    others = [j for j in range(1, full.njoints) if full.names[j] not in names]
    model = pin.buildReducedModel(full, others, pin.neutral(full))
    data = model.createData()
    q = pin.neutral(model)
    pin.computeJointJacobians(model, data, q)
    joints = range(1, model.njoints)
    axes = []
    for j in joints:
        column = pin.getJointJacobian(model, data, j, pin.ReferenceFrame.LOCAL)[3:, model.idx_vs[j]]
        axes.append(column / np.linalg.norm(column))
    lower, upper = [], []
    for j in joints:
        bounded = model.nqs[j] == 1
        low, high = model.lowerPositionLimit[model.idx_qs[j]], model.upperPositionLimit[model.idx_qs[j]]
        usable = bounded and high - low > 0.1
        lower.append(max(low, -2 * np.pi) if usable else -2 * np.pi)
        upper.append(min(high, 2 * np.pi) if usable else 2 * np.pi)
    bodies = [model.inertias[j] for j in joints]
    return Chain(
        rotation=np.array([model.jointPlacements[j].rotation for j in joints]),
        offset=np.array([model.jointPlacements[j].translation for j in joints]),
        axis=np.array(axes),
        mass=np.array([b.mass for b in bodies]),
        com=np.array([b.lever for b in bodies]),
        inertia=np.array([of_a_solid(b.inertia) for b in bodies]),
        lower=np.array(lower),
        upper=np.array(upper),
    )


def of_a_solid(inertia: np.ndarray) -> np.ndarray:
    """Return the inertia (3, 3) with its largest principal moment cut to what the other two allow in a solid."""
    moments, axes = np.linalg.eigh(inertia)
    moments = np.maximum(moments, 1e-6)
    moments[2] = min(moments[2], 0.999 * (moments[0] + moments[1]))
    return (axes * moments) @ axes.T


def with_body(chain: Chain, joint: int, mass: float, com: np.ndarray, inertia: np.ndarray) -> Chain:
    """Return the chain with another body behind one joint (0-based)."""
    masses, coms, inertias = chain.mass.copy(), chain.com.copy(), chain.inertia.copy()
    masses[joint], coms[joint], inertias[joint] = mass, com, inertia
    return replace(chain, mass=masses, com=coms, inertia=inertias)


def with_errors(chain: Chain, rng: np.random.Generator, share: float) -> Chain:
    """Return the chain with mass, centre of mass and inertia of every body off by normal errors of this share."""
    if not share:
        return chain
    n = chain.joints
    mass = chain.mass * np.clip(1 + share * rng.normal(size=n), 0.5, 1.5)
    com = chain.com * (1 + share * rng.normal(size=(n, 3)))
    scale = np.clip(1 + share * rng.normal(size=(n, 1, 1)), 0.5, 1.5)
    return replace(chain, mass=mass, com=com, inertia=chain.inertia * scale)


def _words(values: np.ndarray) -> str:
    return " ".join(repr(float(v)) for v in values)


def urdf_text(chain: Chain, name: str) -> str:
    """Return the arm as URDF: links without shape, revolute joints `joint_1` onwards."""
    lines = ['<?xml version="1.0"?>', f'<robot name="{name}">', '  <link name="base"/>']
    parent = "base"
    for k, joint in enumerate(chain.names):
        link = f"link_{k + 1}"
        places = {"xx": (0, 0), "xy": (0, 1), "xz": (0, 2), "yy": (1, 1), "yz": (1, 2), "zz": (2, 2)}
        moments = " ".join(f'i{word}="{float(chain.inertia[k][place])!r}"' for word, place in places.items())
        angles = _words(pin.rpy.matrixToRpy(chain.rotation[k]))
        lines += [
            f'  <link name="{link}">',
            "    <inertial>",
            f'      <origin xyz="{_words(chain.com[k])}" rpy="0 0 0"/>',
            f'      <mass value="{float(chain.mass[k])!r}"/>',
            f"      <inertia {moments}/>",
            "    </inertial>",
            "  </link>",
            f'  <joint name="{joint}" type="revolute">',
            f'    <origin xyz="{_words(chain.offset[k])}" rpy="{angles}"/>',
            f'    <parent link="{parent}"/>',
            f'    <child link="{link}"/>',
            f'    <axis xyz="{_words(chain.axis[k])}"/>',
            f'    <limit lower="{float(chain.lower[k])!r}" upper="{float(chain.upper[k])!r}" effort="0" velocity="0"/>',
            "  </joint>",
        ]
        parent = link
    return "\n".join([*lines, "</robot>"]) + "\n"
