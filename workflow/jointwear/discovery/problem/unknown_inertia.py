"""Motors whose inertia the robot file does not know: it is found before anything is held against their torque.

A URDF says nothing of motors, and a robot file that gives 0 kg m2 leaves it to retuning. Behind a gear of 100 the motor
is as heavy as the links, and the torque of a model without it lacks as much: a torque that is early or late, a lag and
a shaking are made of that torque, and noise of derived accelerations is known by the inertia that it moves. So the
search asks a robot with the motors that the data show, as if its file gave them, and the verdict tells them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.linear import least_squares, posterior_mean
from jointwear.discovery.problem.problem import FRICTION, FoundMotors, Problem
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.settings import Settings
from jointwear.measurement.derived.motion import Measured, measure
from jointwear.measurement.recording import Recording
from jointwear.robots.robot import Robot


def build_with_motors(
    recording: Recording, robot: Robot, settings: Settings, measured: Measured | None = None
) -> Problem:
    """Return the comparison of a split recording with a robot of whose motors none is without inertia.

    It is :func:`.problem.build_problem` where the file gives every motor an inertia, and behind the
    gear, where none is felt.
    """
    measured = measured or measure(recording)
    problem = build_problem(recording, robot, settings, measured)
    inertia, std = np.zeros((2, robot.joints))
    if problem.state.torque_kind != "link_sensor":
        for axis in problem.judged:
            if robot.armature[axis] == 0.0:
                inertia[axis], std[axis] = _motor_inertia(problem, axis)
    if not inertia.any():
        return problem
    with_motors = replace(robot, armature=robot.armature + inertia)
    return replace(build_problem(recording, with_motors, settings, measured), motors=FoundMotors(inertia, std))


def _motor_inertia(problem: Problem, axis: int) -> tuple[float, float]:
    """Return the motor inertia [kg m2] on the joint side under which the torque of one axis is most likely, or 0, and
    its standard deviation.

    Asked before the noise is known, of the base regression of this axis alone: the columns need it to some per cent,
    and what is written is fitted later, with all axes together. What the regression leaves is no white noise; its
    standard deviation is taken from blocks of time (Liang and Zeger 1986), and holds what the priors leave open.
    """
    used = problem.usable[:, axis]
    links = problem.inertial[problem.train, axis][:, problem.felt[axis]]
    groups = [problem.friction_columns(problem.train_state, axis), links, problem.smear[problem.train, axis]]
    columns, lacking = np.concatenate(groups, axis=1)[used], problem.discrepancy[problem.train, axis][used]
    gram, b = columns.T @ columns, columns.T @ lacking
    noise = max(float(np.mean((lacking - columns @ least_squares(b, gram, gram)) ** 2)), 1e-300)
    std = np.concatenate([problem.friction_prior(axis), np.ones(columns.shape[1] - len(FRICTION))])
    found = posterior_mean(b / noise, gram / noise, std)
    scores = np.zeros((int(problem.block_of_sample.max()) + 1, columns.shape[1]))
    np.add.at(scores, problem.block_of_sample[used], columns * ((lacking - columns @ found) / noise)[:, None])
    # In units of the priors, of which one each is added to what the data say.
    spread = np.linalg.inv(std[:, None] * gram / noise * std + np.eye(len(std)))
    variance = spread @ (std[:, None] * (scores.T @ scores) * std + np.eye(len(std))) @ spread
    k = FRICTION.index("motor_inertia")
    return max(float(found[k]), 0.0), float(std[k] * np.sqrt(variance[k, k]))
