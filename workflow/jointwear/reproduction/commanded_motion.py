"""The commanded motion of a task as a file: joint motion and the path of the end effector (Figure 4)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, write_dataset
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import load_task

STEP = 0.1  # s, fine enough to draw


def write_trajectory(robot: str | Path, task: str | Path, output: str | Path) -> None:
    """Write position, velocity, acceleration and end-effector path over one cycle.

    Parameters
    ----------
    robot, task : robot file and task file.
    output : netCDF file.

    Raises
    ------
    InputError : if a file is wrong.
    """
    dynamics, the_task = Dynamics(load_robot(robot)), load_task(task)
    motion = the_task.grid(STEP)
    translation, _ = dynamics.forward_kinematics(motion.position)
    stops, _ = dynamics.forward_kinematics(the_task.waypoints)
    by_joint = ("instant", "axis")
    write_dataset(
        output,
        {
            "time": Variable(("instant",), motion.time, "time in the cycle", "s"),
            "axis": Variable(("axis",), np.arange(1, dynamics.robot.joints + 1), "axis of the robot", "1"),
            "position": Variable(by_joint, motion.position, "joint position", "rad"),
            "velocity": Variable(by_joint, motion.velocity, "joint velocity", "rad s-1"),
            "acceleration": Variable(by_joint, motion.acceleration, "joint acceleration", "rad s-2"),
            "end_effector": Variable(("instant", "coordinate"), translation, "end effector in the base frame", "m"),
            "waypoint": Variable(("stop", "coordinate"), stops, "end effector at the waypoints", "m"),
        },
        provenance.attributes(f"commanded motion of {the_task.name}", {"step": STEP}),
    )
