"""A chain as a standard Denavit-Hartenberg table: the same arm for the tiers whose generator knows no URDF."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from jointwear.studies.world.arms import Drives
from jointwear.studies.world.chains import Chain

#: Axes whose directions differ by less than this sine are parallel.
_PARALLEL = 1e-6


def frames_of(chain: Chain) -> tuple[list[np.ndarray], list[tuple[float, float, float, float]]]:
    """Return the frames 0..n (4, 4) of a standard table at position 0 in the base frame, and its rows (theta, d, a,
    alpha) [rad, m, m, rad]; frame i - 1 has its z along joint i."""
    lines = [(pose[:3, :3] @ axis, pose[:3, 3]) for pose, axis in zip(_poses(chain), chain.axis, strict=True)]
    z, origin = lines[0]
    x = _across(z)
    frames, rows = [_frame(x, z, origin)], []
    for next_z, point in lines[1:]:
        x, new_origin = _normal(z, origin, x, next_z, point)
        frames.append(_frame(x, next_z, new_origin))
        z, origin = next_z, new_origin
    frames.append(frames[-1])
    for before, after in pairwise(frames):
        link = np.linalg.inv(before) @ after
        theta, alpha = np.arctan2(link[1, 0], link[0, 0]), np.arctan2(link[2, 1], link[2, 2])
        rows.append((theta, link[2, 3], link[0, 3] * np.cos(theta) + link[1, 3] * np.sin(theta), alpha))
    return frames, rows


def _poses(chain: Chain) -> list[np.ndarray]:
    """Return the pose (4, 4) of every joint frame in the base frame at position 0."""
    poses, pose = [], np.eye(4)
    for rotation, offset in zip(chain.rotation, chain.offset, strict=True):
        step = np.eye(4)
        step[:3, :3], step[:3, 3] = rotation, offset
        pose = pose @ step
        poses.append(pose)
    return poses


def _across(z: np.ndarray) -> np.ndarray:
    """Return a unit vector across z: the base's x where it is not along z."""
    x = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = x - z * (z @ x)
    return x / np.linalg.norm(x)


def _frame(x: np.ndarray, z: np.ndarray, origin: np.ndarray) -> np.ndarray:
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = x, np.cross(z, x), z, origin
    return frame


def _normal(
    z: np.ndarray, origin: np.ndarray, x: np.ndarray, next_z: np.ndarray, point: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return direction and foot of the common normal from one joint axis to the next."""
    across = np.cross(z, next_z)
    if np.linalg.norm(across) < _PARALLEL:
        apart = point - origin
        apart = apart - z * (z @ apart)
        distance = np.linalg.norm(apart)
        return (apart / distance if distance > 1e-9 else x), origin + apart
    across = across / np.linalg.norm(across)
    # origin + s z + t across = point + u next_z
    _, t, u = np.linalg.solve(np.column_stack([z, across, -next_z]), point - origin)
    foot = point + u * next_z
    return (across if t >= 0 else -across), foot


def robot_document(
    name: str, chain: Chain, drives: Drives, reach: np.ndarray, provenance: dict[str, str]
) -> dict[str, Any]:
    """Return the content of a robot file by DH table.

    Parameters
    ----------
    reach : (n, 2) position limits [rad].
    """
    frames, rows = frames_of(chain)
    gravity = frames[0][:3, :3].T @ np.array([0.0, 0.0, -9.81])
    links, joints = [], []
    for k, pose in enumerate(_poses(chain)):
        inside = np.linalg.inv(frames[k + 1]) @ pose
        com = inside[:3, :3] @ chain.com[k] + inside[:3, 3]
        i = inside[:3, :3] @ chain.inertia[k] @ inside[:3, :3].T
        six = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[1, 2], i[0, 2]]
        links.append({"mass": _short(chain.mass[k]), "com": _all(com), "inertia": _all(six)})
        g = drives.gear[k]
        level = _short(drives.coulomb[k] / abs(g))
        joints.append(
            {
                "name": f"joint_{k + 1}",
                "limits": _all(reach[k]),
                "gear_ratio": float(g),
                "motor_inertia": _short(drives.armature[k] / g**2),
                "viscous": _short(drives.viscous[k] / g**2),
                "coulomb": {"positive": level, "negative": -level},
            }
        )
    table = [
        {"d": _short(d), "a": _short(a), "alpha": float(alpha), "offset": float(theta)} for theta, d, a, alpha in rows
    ]
    return {
        "name": name,
        "gravity": _all(gravity),
        "dh": table,
        "links": links,
        "joints": joints,
        "provenance": provenance,
    }


def _short(value: float) -> float:
    """Round to six digits; round-off becomes 0."""
    return float(f"{0.0 if abs(value) < 1e-9 else value:.6g}")


def _all(values: Any) -> list[float]:
    return [_short(float(v)) for v in values]
