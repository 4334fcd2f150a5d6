"""A clock that runs too fast or too slow, told from the torques of a motion: a rate that was stated wrongly.

Where time is stretched by a factor, derived velocities fall by it and accelerations by its square, while positions and
their gravity stay. So inertial torques of all joints are off by one factor. What the drives add in proportion to
acceleration or speed tells nothing, because any motor inertia may be wrong by as much: it is left free.
"""

from __future__ import annotations

import numpy as np

from jointwear.files.wording import significant
from jointwear.measurement.checks.axes_check import FAVOURS, best_reading, explained, total_left
from jointwear.measurement.checks.axis_readings import INERTIAL_ERROR, Likelihood
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: Largest factor that is looked for, either way, and the step by which it is asked whether there is one.
LARGEST, STEP = 4.0, 1.1
#: How closely it is found, as a share of it.
CLOSELY = 1e-3
#: Distance from the end of the range that is looked through, as a share of the factor, from which it was not found.
AT_END = 10 * CLOSELY
#: Share of the accelerations of a joint that are ordinary, and samples beside the others that are left out with them.
ORDINARY, BESIDE = 0.9, 2
#: Powers of the factor in position, velocity, acceleration and torque.
POWERS = np.array([0.0, 1.0, 2.0, 0.0])


def check_time_scale(name: str, robot: Robot, parts: np.ndarray, usable: np.ndarray) -> None:
    """Check that time passed as fast as the recording says.

    Another clock has to be as much likelier as another zero, to fit better in size, to be likelier than every other
    reading of the axes, to show at ordinary accelerations too, and to change inertial torques by more than three
    standard deviations of a nominal model's inertial parameters.

    Parameters
    ----------
    name : of the data set or the log, for messages.
    parts : (m, 4, n) position, velocity, acceleration, torque. usable : (m, n) bool.

    Raises
    ------
    Refused : with the factor by which time runs too fast or too slow, or that it is too far for a clock.
    """
    bodies = Dynamics(robot.without_drives())
    stretch, nats, gained = _likeliest(bodies, parts, usable)
    if _within_errors(stretch) or gained < FAVOURS["zero"]:
        return
    factor = float(np.exp(stretch))
    # Loads that change within a log are likelier with far smaller bodies, and fit worse in size.
    given, other = Dynamics(robot), parts * (factor**POWERS)[:, None]
    before, after = (total_left(explained(given, p, usable), 1e-12) for p in (parts, other))
    if not before > after:
        return
    if best_reading(bodies, parts, usable)[0] > nats or not _everywhere(bodies, parts, usable):
        return
    if abs(stretch) > np.log(LARGEST) - AT_END:
        size = f"more than {LARGEST**2:.3g}" if stretch > 0 else f"less than {1 / LARGEST**2:.2g}"
        raise Refused(
            f"{name}: inertial torques of all joints are {size} times what the motion asks for: the time is more than "
            f"{LARGEST:g} times off, the rows are not those of one motion, or the bodies of the robot file have "
            "another size",
            "check the unit of the time; give rows of one recording, none lost or mixed with others, with positions "
            "that are measured in each row; check the lengths [m] and masses [kg] of the robot file",
        )
    looks, mend = stretch_in_words(factor)
    raise Refused(
        f"{name}: inertial torques of all joints are {factor**2:.3g} times what the motion asks for: time looks "
        f"{looks}, as where a rate is stated wrongly",
        f"{mend}, or write them at the rate at which the samples were taken",
    )


def stretch_in_words(factor: float, digits: int = 3) -> tuple[str, str]:
    """Return how time looks, and what puts it right.

    Parameters
    ----------
    factor : seconds that the stamps count in one second of the motion: 2 where logged time runs twice as fast.
    digits : of the factor that are told.
    """
    size = significant(factor, digits)
    looks = f"stretched by {size}" if factor > 1 else f"compressed to {size} of itself"
    return looks, f"divide the times by {size}"


def keeps_time(robot: Robot, parts: np.ndarray, usable: np.ndarray) -> bool:
    """Return whether time passed as fast as it says, within what a nominal model's inertial parameters are wrong by.

    Parameters
    ----------
    parts, usable : as of :func:`check_time_scale`, (m, 4, n) and (m, n).
    """
    return _within_errors(_likeliest(Dynamics(robot.without_drives()), parts, usable)[0])


def _everywhere(bodies: Dynamics, parts: np.ndarray, usable: np.ndarray) -> bool:
    """Return whether ordinary accelerations show another clock as well.

    A wrong clock holds in every sample. A belt or a coupling that slips moves the position of its joint where no torque
    does: the largest accelerations of the log are then none.
    """
    size = np.abs(parts[:, 2])
    large = (size > np.quantile(size, ORDINARY, axis=0)).any(axis=1)
    near = np.convolve(large, np.ones(2 * BESIDE + 1), mode="same") > 0.5
    rest = usable & ~near[:, None]
    return bool(rest.sum() < FEWEST_OF_JOINT) or not _within_errors(_likeliest(bodies, parts, rest)[0])


def _within_errors(log_factor: float) -> bool:
    return abs(2.0 * log_factor) < np.log1p(3.0 * INERTIAL_ERROR)


def _likeliest(bodies: Dynamics, parts: np.ndarray, usable: np.ndarray) -> tuple[float, float, float]:
    """Return the log of the factor by which time is likeliest stretched, its nats, and by how many it is likelier."""
    from scipy.optimize import minimize_scalar

    likelihood = Likelihood(bodies, FEWEST_OF_JOINT)

    def nats(log_factor: float) -> float:
        return likelihood(parts * np.exp(log_factor * POWERS)[:, None], usable)

    step, far, as_read = np.log(STEP), np.log(LARGEST), nats(0.0)
    slower, faster = nats(-step), nats(step)
    if max(slower, faster) <= as_read:
        return 0.0, as_read, 0.0
    bounds = (0.0, far) if faster > slower else (-far, 0.0)
    best = minimize_scalar(lambda x: -nats(x), bounds=bounds, method="bounded", options={"xatol": CLOSELY})
    return float(best.x), -float(best.fun), -float(best.fun) - as_read
