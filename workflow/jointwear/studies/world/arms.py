"""The arms of the tier: whose description is read, and the drives that the descriptions do not tell.

Friction, motor inertia and gears are engineering judgement for arms of that size, on the joint side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pinocchio as pin

from jointwear.files.registered import locate
from jointwear.studies.world.chains import Chain, of_a_solid, read_chain


@dataclass(frozen=True)
class Drives:
    """Drives of n joints: gear ratio, Coulomb [N m], viscous [N m s/rad] and motor inertia [kg m2], on the joint side.

    `speed` [rad/s] is the pace of the arm, `rated` [kg] its rated load.
    """

    gear: tuple[float, ...]
    coulomb: tuple[float, ...]
    viscous: tuple[float, ...]
    armature: tuple[float, ...]
    speed: float
    rated: float


@dataclass(frozen=True)
class ArmKind:
    """One arm: its description (None: made here) and the joints of it that move."""

    name: str
    path: str | None
    joints: tuple[str, ...]
    drives: Drives


_ROBOTS = "package:example-robot-data/robots/"
_UR = tuple(f"{j}_joint" for j in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"))


def _numbered(stem: str, count: int) -> tuple[str, ...]:
    return tuple(stem.format(k + 1) for k in range(count))


ARMS = {
    kind.name: kind
    for kind in (
        ArmKind(
            "ur5",
            "ur_description/urdf/ur5_robot.urdf",
            _UR,
            Drives((101,) * 6, (8, 8, 6, 2, 2, 2), (11, 11, 7, 2, 2, 1.5), (0.7, 0.7, 0.7, 0.2, 0.2, 0.2), 1.6, 5.0),
        ),
        ArmKind(
            "ur10",
            "ur_description/urdf/ur10_robot.urdf",
            _UR,
            Drives(
                (101, 101, 101, 101, 101, 101),
                (14, 14, 10, 3, 3, 3),
                (20, 22, 13, 3, 3, 2.5),
                (2.5, 2.5, 1.2, 0.3, 0.3, 0.3),
                1.4,
                10.0,
            ),
        ),
        ArmKind(
            "ur3",
            "ur_description/urdf/ur3_robot.urdf",
            _UR,
            Drives(
                (101,) * 6, (3, 3, 2, 0.8, 0.8, 0.7), (4, 4, 2.5, 0.8, 0.8, 0.6), (0.4, 0.4, 0.3, 0.1, 0.1, 0.1), 2.0, 3
            ),
        ),
        ArmKind(
            "panda",
            "panda_description/urdf/panda.urdf",
            _numbered("panda_joint{}", 7),
            Drives(
                (100,) * 7,
                (1.5, 1.5, 1.2, 1.2, 0.8, 0.8, 0.6),
                (1.2, 1.2, 0.9, 0.9, 0.5, 0.5, 0.4),
                (0.6, 0.6, 0.5, 0.5, 0.2, 0.2, 0.2),
                1.5,
                3.0,
            ),
        ),
        ArmKind(
            "kinova",
            "kinova_description/robots/kinova.urdf",
            _numbered("j2s6s200_joint_{}", 6),
            Drives(
                (136, 136, 136, 110, 110, 110),
                (2.5, 3, 2.5, 0.8, 0.8, 0.8),
                (2, 2, 2, 0.5, 0.5, 0.5),
                (0.4, 0.4, 0.4, 0.1, 0.1, 0.1),
                0.9,
                1.6,
            ),
        ),
        ArmKind(
            "z1",
            "z1_description/urdf/z1.urdf",
            _numbered("joint{}", 6),
            Drives(
                (31,) * 6,
                (1.0, 1.5, 1.2, 0.6, 0.4, 0.4),
                (0.8, 1.0, 0.8, 0.4, 0.25, 0.2),
                (0.12, 0.15, 0.12, 0.05, 0.03, 0.03),
                1.8,
                2.0,
            ),
        ),
        ArmKind(
            "xarm7",
            "xarm_description/urdf/xarm7.urdf",
            _numbered("joint{}", 7),
            Drives(
                (100,) * 7,
                (3, 3, 2, 2, 1.2, 1.2, 0.7),
                (3, 3, 2, 2, 1, 1, 0.5),
                (0.8, 0.8, 0.5, 0.5, 0.2, 0.2, 0.1),
                1.6,
                3.5,
            ),
        ),
        ArmKind(
            "tiago_arm",
            "tiago_description/robots/tiago_no_hand.urdf",
            _numbered("arm_{}_joint", 7),
            Drives(
                (100, 100, 100, 100, 75, 75, 75),
                (3, 3, 2, 2, 0.7, 0.7, 0.6),
                (2.5, 2.5, 1.5, 1.5, 0.4, 0.4, 0.4),
                (0.5, 0.5, 0.4, 0.4, 0.1, 0.1, 0.1),
                1.2,
                2.5,
            ),
        ),
        ArmKind(
            "heavy_210",
            None,
            (),
            Drives(
                (185, 200, 185, -100, 100, -60),
                (120, 140, 100, 28, 25, 15),
                (180, 200, 130, 30, 30, 15),
                (140, 160, 80, 12, 10, 4),
                1.0,
                150.0,
            ),
        ),
    )
}


@cache
def chain_of(name: str) -> Chain:
    """Return the arm `name` without error.

    Raises
    ------
    InputError : if the package that describes it is not installed.
    """
    kind = ARMS[name]
    return heavy_chain() if kind.path is None else read_chain(locate(_ROBOTS + kind.path), kind.joints)


def heavy_chain() -> Chain:
    """Return a six-axis arm of about 1.2 t for loads of 150 kg; in reality a counterbalance carries its second axis."""
    flat = pin.rpy.rpyToMatrix
    rotation = np.array(
        [
            np.eye(3),
            flat(-np.pi / 2, 0, 0),
            np.eye(3),
            flat(-np.pi / 2, 0, 0),
            flat(np.pi / 2, 0, 0),
            flat(-np.pi / 2, 0, 0),
        ]
    )
    offset = np.array([[0, 0, 0.55], [0.35, 0, 0], [0, -1.25, 0], [-0.05, 0.45, 0], [0, 0, 0.8], [0, 0.2, 0]])
    mass = np.array([420.0, 260.0, 230.0, 95.0, 45.0, 25.0])
    com = np.array(
        [
            [0.1, 0.02, -0.1],
            [0.02, -0.55, 0.08],
            [0.05, 0.1, 0.05],
            [0.0, 0.02, 0.35],
            [0.0, 0.04, 0.01],
            [0.01, 0, 0.08],
        ]
    )
    size = np.array(
        [[0.5, 0.5, 0.5], [0.3, 1.2, 0.3], [0.5, 0.6, 0.4], [0.25, 0.25, 0.8], [0.2, 0.3, 0.2], [0.25, 0.25, 0.15]]
    )
    inertia = np.array(
        [
            of_a_solid(m / 12 * np.diag([s[1] ** 2 + s[2] ** 2, s[0] ** 2 + s[2] ** 2, s[0] ** 2 + s[1] ** 2]))
            for m, s in zip(mass, size, strict=True)
        ]
    )
    reach = np.array([3.0, 1.0, 1.3, 3.0, 2.0, 3.0])
    return Chain(rotation, offset, np.tile([0.0, 0.0, 1.0], (6, 1)), mass, com, inertia, -reach, reach)
