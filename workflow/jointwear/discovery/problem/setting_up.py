"""From a recording and a robot file to the problem that the search is given."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from jointwear.discovery.problem.building_up import built_up_anywhere, with_whole_friction
from jointwear.discovery.problem.problem import SMEAR, Problem
from jointwear.discovery.problem.reversals import leave_out_reversals, leave_out_ringing
from jointwear.discovery.problem.shared_drives import sticking
from jointwear.discovery.settings import Settings
from jointwear.effects import State, effect_torque, make_state
from jointwear.measurement.derived.filtering import limit
from jointwear.measurement.derived.motion import Measured, measure
from jointwear.measurement.recording import Recording
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import (
    gravity_regressor,
    inertial_regressor,
    prior_factor,
    to_joint_frame,
    wind_up_regressor,
)
from jointwear.robots.robot import Robot

#: Fewest usable samples of an axis that a verdict is based on.
FEWEST_SAMPLES = 60


def build_problem(recording: Recording, robot: Robot, settings: Settings, measured: Measured | None = None) -> Problem:
    """Set up the comparison of a split recording with `robot`; `measured` are its samples if already at hand."""
    measured = measured or measure(recording)
    moving = measured.usable
    measured = leave_out_ringing(leave_out_reversals(measured), robot)
    dynamics = Dynamics(robot)
    q, v, a = measured.position, measured.velocity, measured.acceleration
    regressor = inertial_regressor(dynamics, q, v, a)
    # The tip is the frame in which a robot file gives the payload.
    tip = to_joint_frame(robot, robot.joints - 1)
    pulls = cache(lambda: gravity_regressor(robot, q))
    last = regressor[:, :, -10:] @ tip
    state = make_state(
        robot,
        q,
        v,
        a,
        np.array(dynamics.rigid_body_torque(q, v, a)) if len(q) else q,
        time=measured.time,
        temperature=measured.temperature,
        record=measured.trajectory,
        tip_regressor=lambda: last,
        gravity_regressor=pulls,
        wind_up_regressor=wind_up_regressor(dynamics, q, v, a, pulls),
    )
    state = replace(
        state,
        torque_kind=recording.torque_kind,
        encoder_side=recording.encoder_side,
        passes=measured.passes,
        derives=measured.derives,
    )
    nominal = state.torque + effect_torque(robot, state)
    train = np.isin(measured.trajectory, recording.train)
    factor = prior_factor(robot, settings.inertial_prior)
    inertial = regressor @ factor
    moving_train, missing = measured.usable & train[:, None], measured.torque - nominal
    stuck = sticking(moving_train, v, a, missing, inertial, settings.noise_sigmas)
    measured = replace(measured, usable=measured.usable & ~stuck)
    judged = measured.usable & train[:, None]
    built_up = built_up_anywhere(
        judged,
        measured.trajectory,
        q,
        v,
        a,
        missing,
        inertial,
        robot.coulomb(v),
        settings.accept,
        settings.form_error,
        pulls,
    )
    measured = with_whole_friction(measured, built_up, settings.usual)
    counts = np.sum(measured.usable[train], axis=0)
    return Problem(
        robot=robot,
        dynamics=dynamics,
        settings=settings,
        measured=measured,
        state=state,
        train=train,
        test=np.isin(measured.trajectory, recording.test),
        discrepancy=measured.torque - nominal,
        regressor=regressor,
        factor=factor,
        inertial=inertial,
        smear=_smear(measured, state),
        moving=moving,
        judged=tuple(int(j) for j in np.flatnonzero(counts >= FEWEST_SAMPLES)),
        positions=tuple(recording.position.T),
        encoder_step=recording.encoder_step,
        built_up=tuple(built_up),
    )


def _smear(measured: Measured, state: State) -> np.ndarray:
    """Return what low-pass filters near the one behind the derivatives do to the rigid-body torque, (N, n, 3).

    A zero-phase filter rounds the corners of the acceleration. To first order the rounding looks like that of a
    slightly lower cut-off, so the base regression can take it off before it is mistaken for a delay.
    """
    rigid = state.load + state.drive.armature * state.acceleration
    result = np.zeros((*rigid.shape, len(SMEAR)))
    if measured.fitted:
        # Knots were added to splines until they left no more than noise.
        return result
    for axis, cutoff in enumerate(measured.cutoff):
        if np.isfinite(cutoff):
            column = rigid[:, [axis]]
            for k, share in enumerate(SMEAR):
                rounded = limit(column, measured.trajectory, share * cutoff, measured.rate)
                result[:, [axis], k] = rounded - column
    return result
