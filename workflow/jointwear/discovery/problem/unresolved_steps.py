"""Steps of acceleration that the sampling does not resolve: at their instants the torque of the model is not known.

A trapezoid of speed has steps of acceleration at its corners, a joint that breaks away shakes all others. Between two
samples of a derived acceleration such a step lies anywhere, and so does the torque of all joints there. What follows
the steps follows acceleration and torque, and would be structure over them.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import maximum_filter1d

from jointwear.discovery.problem.reversals import resolved_motion
from jointwear.discovery.problem.whitening import White


def at_unresolved_steps(white: White, axis: int) -> np.ndarray:
    """Return the used training samples (m,) of an axis, as a mask, at which its torque holds an unresolved step.

    There a filter near the one behind the derivatives changes the torque by more than noise does, at the sample or
    within half a period of its cut-off: where a sample lies in the middle of a step, no filter changes it.
    Where the motion is resolved, or splines were fitted, there is none, nor where most samples are such: those are no
    instants.
    """
    problem, whitener = white.problem, white.whiteners[axis]
    measured, rounding = problem.measured, problem.rounding(axis)
    if resolved_motion(measured) or not np.any(rounding):
        return np.zeros(len(whitener.rows), dtype=bool)
    step = np.zeros(len(rounding), dtype=bool)
    step[whitener.rows] = np.max(np.abs(whitener(rounding)), axis=1) > problem.settings.noise_sigmas
    reach = math.ceil(0.5 / measured.cutoff[axis] * measured.rate)
    beside = maximum_filter1d(step, 2 * reach + 1, mode="constant")[whitener.rows]
    return beside & (2 * np.count_nonzero(beside) < len(beside))
