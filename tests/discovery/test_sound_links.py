"""Links that are fitted are links that may be written."""

import numpy as np
import pytest

from jointwear.discovery.model.sound_links import nearest_links
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import (
    bodies,
    inertial_regressor,
    links_from_parameters,
    mass_direction,
    matrix_of_six,
    parameters_of_body,
    prior_factor,
    to_joint_frame,
)


def written(robot, delta):
    """Return the change of the parameters (10 n,) that a robot file has when it is asked for `delta`."""
    result = np.zeros(10 * robot.joints)
    for link, (body, given) in enumerate(zip(links_from_parameters(robot, delta), bodies(robot), strict=True)):
        xx, yy, zz, xy, yz, xz = body["inertia"]
        pi = parameters_of_body(body["mass"], np.array(body["com"]), matrix_of_six(np.array([xx, xy, yy, xz, yz, zz])))
        frame = to_joint_frame(robot, link)
        result[10 * link : 10 * link + 10] = frame @ (pi - parameters_of_body(*given))
    return result


def test_links_that_no_file_takes_become_the_nearest_that_one_does(robot):
    """A negative mass cut off in the file alone gives another robot; moved in the metric of the fit it stays close."""
    rng = np.random.default_rng(3)
    regressor = inertial_regressor(Dynamics(robot), *rng.standard_normal((3, 40, 6))).reshape(240, -1)
    factor = prior_factor(robot, 0.05)
    columns = 20.0 * regressor @ factor
    precision = np.eye(factor.shape[1]) + columns.T @ columns
    # The second link as the fit of an arm would have it on which a spring has no name: of less than no mass.
    wanted = np.linalg.lstsq(factor, -1.6 * mass_direction(robot, 1), rcond=None)[0]
    cut = written(robot, factor @ wanted)
    found = nearest_links(robot, factor, wanted, precision)
    delta = factor @ found
    assert written(robot, delta) == pytest.approx(delta, abs=1e-6)

    def miss(change):
        return np.sqrt(np.mean((regressor @ (change - factor @ wanted)) ** 2))

    assert miss(delta) < 0.8 * miss(cut)
    # Nearest: no other links on the way from the given ones are.
    cost = [(z - wanted) @ precision @ (z - wanted) for z in (found, 0.99 * found, 0.9 * found)]
    assert cost[0] < cost[1] < cost[2]


def test_links_that_may_exist_are_left_as_they_were_fitted(robot):
    factor = prior_factor(robot, 0.05)
    fitted = 0.3 * np.random.default_rng(1).standard_normal(factor.shape[1])
    assert nearest_links(robot, factor, fitted, np.eye(len(fitted))) is fitted
