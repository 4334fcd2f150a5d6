"""The inertial parameters of the nominal model: regressor of the torques, and how well they are known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pinocchio as pin

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import Link, Robot, body_content


def inertial_regressor(dynamics: Dynamics, position, velocity, acceleration) -> np.ndarray:
    """Return the derivative of the torques by the inertial parameters in the joint frames, shape (m, n, 10 n).

    Ten parameters a link: m, m c (3), then inertia xx xy yy xz yz zz about the origin of the joint frame.
    """
    model, data = dynamics.model, dynamics.data
    count, n = position.shape
    result = np.empty((count, n, 10 * n))
    for i in range(count):
        result[i] = pin.computeJointTorqueRegressor(model, data, position[i], velocity[i], acceleration[i])
    return result


def gravity_regressor(robot: Robot, position: np.ndarray) -> np.ndarray:
    """Return the derivative (m, n, 3) of the torques by gravity in the base frame, in which they are linear."""
    pulls = [Dynamics(replace(robot, gravity=unit)).gravity_torque(position) for unit in np.eye(3)]
    return np.stack(pulls, axis=-1)


def wind_up_regressor(
    dynamics: Dynamics,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    pulls: Callable[[], np.ndarray] | None = None,
) -> Callable[[int], tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Return axis -> derivatives (m, n) of the torques by the acceleration of one link, by its velocity and its angle.

    The inertia of the motor, which a twist of its gear leaves behind, is left out. Worked out once, when first asked.
    By its angle a link changes the inertia that the other joints move too: an elbow of 900 N m/rad that gives way by
    0.4 degrees changes that of an upright joint by a percent, all that such a joint has. On its own joint only gravity
    is derived: it stands beside the stiffness, which accelerations with noise would shift, and with it the swing.

    Parameters
    ----------
    position, velocity, acceleration : (m, n) [rad], [rad/s], [rad/s2]. pulls : :func:`gravity_regressor` of the same
        robot and positions, where it is at hand.
    """
    robot = dynamics.robot

    @cache
    def masses() -> np.ndarray:
        return np.array(dynamics.mass_matrix(position)) - np.diag(robot.armature)

    @cache
    def turned() -> np.ndarray:
        """Derivatives (m, n) of the gravity torque of each joint by its own angle.

        A joint that turns turns gravity the other way for all links behind it.
        """
        gravity = np.cross(np.asarray(robot.gravity, dtype=float), FlangeLoad(robot).axes(position))
        return np.einsum("mjk,mjk->mj", pulls() if pulls else gravity_regressor(robot, position), gravity)

    @cache
    def slopes() -> tuple[np.ndarray, np.ndarray]:
        return dynamics.torque_slopes(position, velocity, acceleration)

    @cache
    def of_axis(axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        by_angle, by_velocity = (slope[..., axis] for slope in slopes())
        by_angle = by_angle.copy()
        by_angle[..., axis] = turned()[..., axis]
        return masses()[..., axis], by_velocity, by_angle

    return of_axis


def link_frames(robot: Robot) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return rotation (3, 3) and origin (3,) of each link frame in its joint frame.

    Standard DH puts the link frame at the end of the row; a URDF has link and joint frame in one.
    """
    if robot.dh is None:
        return [(np.eye(3), np.zeros(3))] * robot.joints
    frames = []
    for row in robot.dh:
        rotation = np.array(
            [[1, 0, 0], [0, np.cos(row.alpha), -np.sin(row.alpha)], [0, np.sin(row.alpha), np.cos(row.alpha)]]
        )
        frames.append((rotation, np.array([row.a, 0.0, row.d])))
    return frames


def _skew(c):
    return np.array([[0, -c[2], c[1]], [c[2], 0, -c[0]], [-c[1], c[0], 0]])


#: Order of the six entries of an inertia among the ten parameters: xx xy yy xz yz zz.
SIX = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))


def parameters_of_body(mass: float, com: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """Return the ten parameters of a body from its mass, centre of mass (3,) and inertia (3, 3) about that."""
    about_origin = inertia + mass * _skew(com).T @ _skew(com)
    return np.array([mass, *(mass * com), *(about_origin[i] for i in SIX)])


def matrix_of_six(six: np.ndarray) -> np.ndarray:
    """Return the inertia matrix (3, 3) from its six entries among the ten parameters."""
    m = np.zeros((3, 3))
    for value, (i, j) in zip(six, SIX, strict=True):
        m[i, j] = m[j, i] = value
    return m


def bodies(robot: Robot) -> list[tuple[float, np.ndarray, np.ndarray]]:
    """Return mass, centre of mass and inertia about it of every link in its *link* frame, payload left out."""
    if robot.links is not None:
        return [(link.mass, link.com, link.inertia) for link in robot.links]
    model = Dynamics(replace(robot, payload=None)).model
    return [(b.mass, np.array(b.lever), np.array(b.inertia)) for b in list(model.inertias)[1:]]


def to_joint_frame(robot: Robot, link: int) -> np.ndarray:
    """Return the (10, 10) matrix that turns the parameters of `link` from the link to the joint frame."""
    rotation, origin = link_frames(robot)[link]
    matrix = np.empty((10, 10))
    for k in range(10):
        unit = np.zeros(10)
        unit[k] = 1.0
        matrix[:, k] = _moved(unit, rotation, origin)
    return matrix


def _moved(pi: np.ndarray, rotation: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Parameters about the origin of a frame at (rotation, origin), seen from the outer frame; linear in pi."""
    mass, moment, inertia = pi[0], rotation @ pi[1:4], rotation @ matrix_of_six(pi[4:]) @ rotation.T
    # Steiner, linear in mass and first moment: I' = I + S(p)'S(mc) + S(mc)'S(p) + m S(p)'S(p).
    p, h = _skew(origin), _skew(moment)
    inertia = inertia + p.T @ h + h.T @ p + mass * p.T @ p
    return np.array([mass, *(moment + mass * origin), *(inertia[i] for i in SIX)])


def prior_factor(robot: Robot, relative: float) -> np.ndarray:
    """Return a factor L, shape (10 n, r), of the covariance L L' of the inertial parameters in the joint frames.

    Every mass, coordinate of a centre of mass and moment of inertia is known to `relative`; in the first order a
    centre of mass may also move in any direction by a quarter of that, of its distance or of the radius of gyration of
    its link, whichever is longer, and products of inertia by a tenth of the moments beside them, because zeros in a
    data sheet are rarely exact: a link that is given as centred on its joint is not known to the micrometre.
    """
    columns = []
    for link, (mass, com, inertia) in enumerate(bodies(robot)):
        frame = to_joint_frame(robot, link)
        base = np.concatenate([[mass], com, [inertia[i] for i in SIX]])
        moments = np.abs(np.diag(inertia))
        spread = np.empty(10)
        spread[0] = relative * mass
        spread[1:4] = relative * (np.abs(com) + 0.25 * reach_of_link(mass, com, inertia))
        spread[4:] = [
            relative * (abs(inertia[i, j]) + (0.0 if i == j else 0.1 * np.sqrt(moments[i] * moments[j])))
            for i, j in SIX
        ]
        for k in range(10):
            if spread[k] <= 0:
                continue
            step = np.zeros(10)
            step[k] = spread[k]
            up, down = (parameters_of_body(b[0], b[1:4], matrix_of_six(b[4:])) for b in (base + step, base - step))
            column = np.zeros(10 * robot.joints)
            column[10 * link : 10 * link + 10] = frame @ (up - down) / 2
            columns.append(column)
    return np.array(columns).T if columns else np.zeros((10 * robot.joints, 0))


def reach_of_link(mass: float, com: np.ndarray, inertia: np.ndarray) -> float:
    """Return the distance [m] of a link's centre of mass (3,) from its frame, or its radius of gyration if longer."""
    gyration = np.sqrt(0.5 * np.abs(np.diag(inertia)).sum() / mass) if mass > 0 else 0.0
    return max(float(np.linalg.norm(com)), float(gyration))


def mass_direction(robot: Robot, link: int) -> np.ndarray:
    """Return how the parameters (10 n,) change when mass and inertia of `link` grow by 100 %."""
    mass, com, inertia = bodies(robot)[link]
    direction = np.zeros(10 * robot.joints)
    direction[10 * link : 10 * link + 10] = to_joint_frame(robot, link) @ parameters_of_body(mass, com, inertia)
    return direction


#: Relative size below which an entry of an inertia matrix is round-off.
ROUND_OFF = 1e-10


def _of_a_body(inertia: np.ndarray) -> np.ndarray:
    """Return the nearest inertia matrix (3, 3) without negative moments, free of round-off.

    No body has negative moments and no model by DH table takes them; a URDF takes any set of parameters, physical or
    not, that gives the torques of the fit, and is left alone.
    """
    size = float(np.abs(inertia).max())
    clean = np.where(np.abs(inertia) < ROUND_OFF * size, 0.0, inertia)
    moments, axes = np.linalg.eigh(clean)
    if moments[0] >= 0:
        return clean
    # A shade more than nothing, so that rounding does not make it negative again.
    return (axes * np.maximum(moments, ROUND_OFF * size)) @ axes.T


#: Share of its nominal mass that a link keeps at least: the centre of mass of one with next to none would lie far
#: outside of the arm, where no robot file may have it.
LEAST_MASS = 0.02


def links_from_parameters(robot: Robot, delta: np.ndarray) -> list[dict]:
    """Return mass, com and inertia of every link, in the layout of a robot file, after adding `delta` (10 n,)."""
    result = []
    for link, (mass, com, inertia) in enumerate(bodies(robot)):
        change = np.linalg.solve(to_joint_frame(robot, link), delta[10 * link : 10 * link + 10])
        pi = parameters_of_body(mass, com, inertia) + change
        new_mass = float(max(pi[0], LEAST_MASS * mass, 0.0))
        new_com = pi[1:4] / new_mass if new_mass > 1e-9 else np.zeros(3)
        about = matrix_of_six(pi[4:]) - new_mass * _skew(new_com).T @ _skew(new_com)
        if robot.links is not None:
            about = _of_a_body(about)
        result.append(body_content(Link(new_mass, new_com, about)))
    return result
