"""A joint of which the robot file explains less than half, though no other way to read the recording fits better.

The direction of an axis, a link that is another's, a spring or a balancer: nothing of that kind is among the readings
of the axes, and each is more than parameters that are somewhat wrong. A good file may lack a spring, so that it refuses
nothing, and is told.
"""

from __future__ import annotations

import numpy as np

from jointwear.files.wording import listed, significant
from jointwear.measurement.checks.axes_check import WRONG, explained
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import Measured
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: What explains that a file leaves most of a joint, as the end of a sentence.
CAUSES = (
    "the file may be that of another arm, or be wrong there (the direction or the zero of an axis, a mass), or lack a "
    "spring, a balancer or a load"
)
#: Sum of the squares of the weights of a second difference: by so much it multiplies the variance of white noise.
OF_NOISE = 6.0


def left_over(measured: Measured, robot: Robot) -> np.ndarray:
    """Return for each joint the share (n,) of the squared torque that the model leaves, whatever the size of friction,
    beyond that of noise from sample to sample; NaN where too few samples tell."""
    thin = thinned(measured)
    left = explained(Dynamics(robot), thin.parts, thin.usable)
    return np.maximum(left - _of_noise(measured), 0.0)


def most_left(left: np.ndarray) -> list[int]:
    """Return the joints (0-based) of which more is left than a right file ever leaves, of shares (n,)."""
    with np.errstate(invalid="ignore"):
        return np.flatnonzero(left > WRONG).tolist()


def shares_in_words(left: np.ndarray, joints: list[int], noun: str) -> str:
    """Return in words how much is left of some joints: '85 % of the squared torque of axis 2'."""
    shares = listed([f"{significant(100 * left[j], 2)} % of {noun} {j + 1}" for j in joints])
    return shares.replace(" % of ", " % of the squared torque of ", 1)


def left_in_words(measured: Measured, robot: Robot) -> list[str]:
    """Return in words of which joints the robot file leaves most, nothing where of none."""
    left = left_over(measured, robot)
    joints = most_left(left)
    if not joints:
        return []
    shares = shares_in_words(left, joints, "joint")
    told = f"the robot file leaves {shares} unexplained, whatever the size of friction"
    return [f"{told}: {CAUSES}; check it before what is found there is believed"]


def _of_noise(measured: Measured) -> np.ndarray:
    """Return for each joint the share (n,) of the squared torque that white noise makes up."""
    torque, usable = measured.torque, measured.usable
    inside = np.diff(measured.trajectory) == 0
    row = usable[1:] & usable[:-1] & inside[:, None]
    triple = row[1:] & row[:-1]
    second = np.where(triple, np.diff(torque, 2, axis=0), 0.0)
    noise = np.sum(second**2, axis=0) / OF_NOISE / np.maximum(triple.sum(axis=0), 1)
    power = np.sum(np.where(usable, torque, 0.0) ** 2, axis=0) / np.maximum(usable.sum(axis=0), 1)
    return noise / np.maximum(power, 1e-12)
