"""A robot as data: kinematics, links, joints, payload and effects, read from one YAML file.

The layout of the file is documented in config/README.md and checked by workflow/schemas/robot.schema.yaml.
Turning a robot into torques is the work of :mod:`jointwear.robots.dynamics`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.registered import path_in
from jointwear.robots.robot_file import read_robot_file


@dataclass(frozen=True)
class Link:
    """One rigid body. `com` [m] in the link frame, `inertia` (3, 3) [kg m2] about the centre of mass."""

    mass: float
    com: np.ndarray
    inertia: np.ndarray


@dataclass(frozen=True)
class DHRow:
    """One row of a standard Denavit-Hartenberg table: d [m], a [m], alpha [rad], offset [rad]."""

    d: float
    a: float
    alpha: float
    offset: float = 0.0


@dataclass(frozen=True)
class EffectEntry:
    """An effect of the library that acts on this robot; `axis` and `source_axis` are 1-based or None."""

    effect: str
    axis: int | None
    source_axis: int | None
    parameters: dict[str, Any]


@dataclass(frozen=True)
class Robot:
    """A robot with n joints. Arrays have shape (n,); friction and inertia of the drives are on the joint side.

    Attributes
    ----------
    coulomb_positive, coulomb_negative : Coulomb friction [N m] for positive and negative velocity, signed
        like the torque that overcomes it (positive >= 0, negative <= 0).
    viscous : viscous friction [N m s/rad].
    armature : inertia of motor and gear seen at the joint [kg m2].
    torque_limit : largest torque [N m], NaN where unknown.
    """

    name: str
    gravity: np.ndarray
    joint_names: tuple[str, ...]
    lower: np.ndarray
    upper: np.ndarray
    gear_ratio: np.ndarray
    armature: np.ndarray
    viscous: np.ndarray
    coulomb_positive: np.ndarray
    coulomb_negative: np.ndarray
    torque_limit: np.ndarray
    dh: tuple[DHRow, ...] | None = None
    links: tuple[Link, ...] | None = None
    urdf: Path | None = None
    payload: Link | None = None
    effects: tuple[EffectEntry, ...] = ()
    provenance: dict[str, str] = field(default_factory=dict)

    def coulomb(self, velocity: np.ndarray) -> np.ndarray:
        """Return the Coulomb friction [N m] of every joint at velocities (..., n), 0 at rest."""
        return np.where(velocity > 0, self.coulomb_positive, 0.0) + np.where(velocity < 0, self.coulomb_negative, 0.0)

    def friction(self, velocity: np.ndarray) -> np.ndarray:
        """Return the viscous and Coulomb friction [N m] of every joint at velocities (..., n) [rad/s]."""
        return self.viscous * velocity + self.coulomb(velocity)

    @property
    def joints(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    def without_drives(self) -> Robot:
        """Return the robot without friction and motor inertia: what a torque sensor behind its gears knows."""
        none = np.zeros(self.joints)
        return replace(self, armature=none, viscous=none, coulomb_positive=none, coulomb_negative=none)

    def without_motor_inertia(self) -> Robot:
        """Return the robot without the inertia of its motors; friction stays, which may be that of its bearings."""
        return replace(self, armature=np.zeros(self.joints))


def inertia_matrix(six: list[float] | None) -> np.ndarray:
    """Turn (xx, yy, zz, xy, yz, xz) [kg m2] into a symmetric (3, 3) matrix; None gives zeros."""
    xx, yy, zz, xy, yz, xz = six if six is not None else (0.0,) * 6
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=float)


def inertia_entries(matrix: np.ndarray) -> list[float]:
    """Return (xx, yy, zz, xy, yz, xz) of a symmetric (3, 3) matrix, as :func:`inertia_matrix` takes them."""
    return [float(matrix[i]) for i in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))]


def body_of(content: dict[str, Any]) -> Link:
    """Return the body that `content` describes, laid out as in a robot file."""
    return Link(float(content["mass"]), np.array(content["com"], dtype=float), inertia_matrix(content.get("inertia")))


def body_content(link: Link | None) -> dict[str, Any]:
    """Return a body in the layout of a robot file, one without a mass for None."""
    if link is None:
        return {"mass": 0.0, "com": [0.0, 0.0, 0.0]}
    return {
        "mass": float(link.mass),
        "com": [float(x) for x in link.com],
        "inertia": inertia_entries(link.inertia),
    }


def _payload(content: dict[str, Any] | None) -> Link | None:
    return body_of(content) if content and content["mass"] > 0 else None


def with_payload(robot: Robot, content: dict[str, Any] | None) -> Robot:
    """Return the robot with the payload of `content`, laid out as in a robot file; None for none."""
    return replace(robot, payload=_payload(content))


def robot_from_data(data: dict[str, Any], urdf: Path | None = None) -> Robot:
    """Build a :class:`Robot` from the checked content of a robot file.

    Parameters
    ----------
    data : the content as :func:`jointwear.robots.robot_file.read_robot_file` returns it.
    urdf : path of the URDF file where the robot is given by one.
    """
    joints = data["joints"]
    gear = np.array([j["gear_ratio"] for j in joints], dtype=float)

    def column(get) -> np.ndarray:
        return np.array([np.nan if get(j) is None else get(j) for j in joints], dtype=float)

    return Robot(
        name=data["name"],
        gravity=np.array(data["gravity"], dtype=float),
        joint_names=tuple(j["name"] for j in joints),
        lower=column(lambda j: j["limits"][0]),
        upper=column(lambda j: j["limits"][1]),
        gear_ratio=gear,
        armature=gear**2 * column(lambda j: j["motor_inertia"]),
        viscous=gear**2 * column(lambda j: j["viscous"]),
        coulomb_positive=np.abs(gear) * column(lambda j: j["coulomb"]["positive"]),
        coulomb_negative=np.abs(gear) * column(lambda j: j["coulomb"]["negative"]),
        torque_limit=column(lambda j: j["torque_limit"]),
        dh=tuple(DHRow(r["d"], r["a"], r["alpha"], r.get("offset", 0.0)) for r in data["dh"]) if "dh" in data else None,
        links=tuple(body_of(e) for e in data["links"]) if "links" in data else None,
        urdf=urdf,
        payload=_payload(data.get("payload")),
        effects=tuple(
            EffectEntry(e["effect"], e.get("axis"), e.get("source_axis"), dict(e.get("parameters", {})))
            for e in data.get("effects", [])
        ),
        provenance=dict(data.get("provenance", {})),
    )


def load_robot(path: str | Path) -> Robot:
    """Read and check a robot file.

    Raises
    ------
    InputError : if the file is missing, is not YAML, or breaks the layout; the message names the key.
    """
    path = Path(path)
    data = read_robot_file(path)
    urdf = path_in(data["urdf"], path.parent) if "urdf" in data else None
    return robot_from_data(data, urdf)
