"""Candidate terms for the peers: the equations of the effects on a coarse grid of their nonlinear parameters.

Written for the peers alone, so that neither discovery's library nor the generator's formulas are lent to them. The same
preparation serves all: derivatives by a zero-phase filter, rest left out, the model's own free parameters (inertial
ones under the prior) taken out of the residual and of every term.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import butter, sosfiltfilt

from jointwear.robots.robot import Link, Robot
from jointwear.studies.challenge.arm import Arm, inertial_columns

#: Cut-off [Hz] of the filter where the data set gives no derivatives.
_CUT_OFF = 8.0
_REST = 0.03
#: Time [s] at either end of a recording where the filter is not to be trusted.
_EDGE = 0.3


@dataclass(frozen=True)
class AxisProblem:
    """Least squares of one axis: residual `target` (m,), terms (m, p) with unit RMS, and the effect of each term."""

    target: np.ndarray
    terms: np.ndarray
    effects: tuple[str, ...]


def derivatives(
    position: np.ndarray, trajectory: np.ndarray, interval: float, velocity: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return smooth position, velocity and acceleration (m, n), recording by recording."""
    filtered = butter(4, _CUT_OFF, fs=1 / interval, output="sos")
    q, v, a = (np.empty_like(position) for _ in range(3))
    for label in np.unique(trajectory):
        rows = trajectory == label
        q[rows] = sosfiltfilt(filtered, position[rows], axis=0)
        speed = np.gradient(q[rows], interval, axis=0) if velocity is None else velocity[rows]
        v[rows] = speed if velocity is None else sosfiltfilt(filtered, speed, axis=0)
        a[rows] = np.gradient(v[rows], interval, axis=0)
    return q, v, a


def _terms_of_axis(
    axis: int, robot: Robot, q: np.ndarray, v: np.ndarray, a: np.ndarray, heat: np.ndarray, time: np.ndarray,
    trajectory: np.ndarray, load: np.ndarray, torque: np.ndarray, payload: np.ndarray,
) -> list[tuple[str, np.ndarray]]:  # fmt: skip
    s, speed, n = np.sign(v[:, axis]), np.abs(v[:, axis]), robot.joints
    dt, x = heat[:, axis] - heat[:, axis].mean(), q[:, axis]
    tau, clock = torque[:, axis], (time - time[0]) / (time[-1] - time[0])
    motor = robot.gear_ratio[axis] * x
    terms: list[tuple[str, np.ndarray]] = []
    terms += [("stribeck_friction", np.exp(-((speed / w) ** p)) * s) for w in (0.05, 0.1, 0.2) for p in (1, 2)]
    terms += [("nonlinear_viscous_friction", speed**p * s) for p in (0.3, 0.5, 2.0)]
    terms += [("load_dependent_friction", np.abs(load[:, axis]) * s)]
    terms += [("temperature_dependent_viscous_friction", np.exp(-dt / w) * v[:, axis]) for w in (20.0, 60.0)]
    terms += [("temperature_dependent_coulomb_friction", dt * s)]
    terms += [("position_dependent_friction", f(k * x) * s) for k in (1, 2, 3) for f in (np.sin, np.cos)]
    terms += [("presliding_hysteresis", _dahl(x, trajectory, w) - s) for w in (0.015, 0.04, 0.1)]
    terms += [("cogging_torque", f(k * motor)) for k in (1, 2, 3, 4) for f in (np.sin, np.cos)]
    terms += [("torque_constant_ripple", tau * f(k * motor)) for k in (1, 2, 3, 4) for f in (np.sin, np.cos)]
    terms += [("torque_constant_error", tau), ("torque_constant_temperature", dt * tau)]
    terms += [("torque_offset_drift", f) for f in (clock, clock**2)]
    terms += [("joint_spring", f) for f in (x - x.mean(), (x - x.mean()) ** 3)]
    terms += [("payload", column) for column in payload[:, :, axis]]
    rate = np.empty((2, len(tau)))
    for label in np.unique(trajectory):
        rows = trajectory == label
        rate[0, rows] = np.gradient(tau[rows], time[rows])
        rate[1, rows] = np.gradient(np.gradient(load[rows, axis], time[rows]), time[rows])
    terms += [("actuation_delay", rate[0]), ("joint_flexibility", rate[1])]
    for other in (axis - 1, axis + 1):
        if axis >= n - 3 and 0 <= other < n:
            both = v[:, axis] + v[:, other]
            terms += [("drive_coupling", f) for f in (np.sign(v[:, other]), v[:, other], np.sign(both), a[:, other])]
    terms += [("wear_drift", f * s) for f in (clock, clock**2)]
    return terms


def _dahl(position: np.ndarray, trajectory: np.ndarray, reach: float) -> np.ndarray:
    """Dahl's state at the samples, started sliding in every recording."""
    state = np.empty(len(position))
    z, last = 0.0, None
    steps = np.diff(position, prepend=position[0])
    for k, (label, dq) in enumerate(zip(trajectory.tolist(), steps.tolist(), strict=True)):
        if label != last:
            z, last = float(np.sign(position[min(k + 1, len(position) - 1)] - position[k])), label
        elif dq:
            goal = 1.0 if dq > 0 else -1.0
            z = goal + (z - goal) * np.exp(-abs(dq) / reach)
        state[k] = z
    return state


def _inside(trajectory: np.ndarray, guard: int) -> np.ndarray:
    """Return a mask (m,) without the first and last `guard` samples of every recording."""
    inside = np.ones(len(trajectory), dtype=bool)
    for label in np.unique(trajectory):
        rows = np.flatnonzero(trajectory == label)
        inside[rows[:guard]] = inside[rows[-guard:]] = False
    return inside


def build_problems(data: dict, robot: Robot, train: tuple[int, ...], prior: float) -> list[AxisProblem]:
    """Return one least-squares problem an axis from the training recordings.

    Parameters
    ----------
    data : arrays of the data set by native name, all recordings. prior : of the inertial parameters.
    """
    rows = np.isin(data["trajectory"], train)
    time, trajectory, torque = data["time"][rows], data["trajectory"][rows], data["torque"][rows]
    interval = float(np.median(np.diff(time)))
    given = data.get("velocity")
    q, v, a = derivatives(data["position"][rows], trajectory, interval, None if given is None else given[rows])
    if data.get("acceleration") is not None:
        a = data["acceleration"][rows]
    arm = Arm(robot)
    nominal, load = arm.torque(q, v, a), arm.load(q, v, a)
    inertial, payload = inertial_columns(robot, q, v, a), _payload_columns(robot, q, v, a)
    problems = []
    for axis in range(robot.joints):
        moving = (np.abs(v[:, axis]) > _REST) & _inside(trajectory, round(_EDGE / interval))
        own = [v[:, axis] > 0, v[:, axis] < 0, v[:, axis], a[:, axis]]
        base = np.column_stack([*own, *inertial[:, :, axis]]).astype(float)[moving]
        found = _terms_of_axis(
            axis, robot, q, v, a, data["temperature"][rows], time, trajectory, load, nominal, payload
        )
        terms = np.column_stack([t for _, t in found])[moving]
        residual = (torque - nominal)[moving, axis]
        noise = max(float(np.std(np.diff(residual))) / np.sqrt(2), 1e-9)
        restraint = np.zeros(base.shape[1])
        restraint[4:] = (noise / prior) ** 2
        weight = np.linalg.solve(base.T @ base + np.diag(restraint + 1e-9), base.T)
        target, terms = residual - base @ (weight @ residual), terms - base @ (weight @ terms)
        size = np.sqrt(np.mean(terms**2, axis=0))
        keep = size > 1e-9
        problems.append(
            AxisProblem(
                target, terms[:, keep] / size[keep], tuple(e for (e, _), k in zip(found, keep, strict=True) if k)
            )
        )
    return problems


def _payload_columns(robot: Robot, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Return the torque of 1 kg in the last frame and of its first moments, (4, m, n)."""
    base = Arm(robot).load(q, v, a)

    def torque(com: list[float]) -> np.ndarray:
        return Arm(replace(robot, payload=Link(1.0, np.array(com), np.zeros((3, 3))))).load(q, v, a) - base

    # A shifted point mass also adds its square; half the difference of two opposite shifts has the moment alone.
    shifts = 0.01 * np.eye(3)
    moments = [(torque(list(d)) - torque(list(-d))) / 0.02 for d in shifts]
    return np.array([torque([0.0, 0.0, 0.0]), *moments])
