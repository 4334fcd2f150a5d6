"""A mass at the last link that the model does not know."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from jointwear.effects.effect import Effect, Parameter
from jointwear.files.errors import InputError
from jointwear.robots.inertia import SIX, bodies, matrix_of_six, parameters_of_body
from jointwear.robots.robot import Link, body_content, body_of

_NAMES = ("mass", "moment_x", "moment_y", "moment_z", "xx", "xy", "yy", "xz", "yz", "zz")
#: What a payload is likely to be: this share of the mass of the arm, at this lever [m].
_SHARE, _LEVER = 0.05, 0.15
#: What a robot file takes: distance of a centre of mass [m] and moment of inertia [kg m2], as in its schema.
FARTHEST, LARGEST = 100.0, 1e7


def _columns(state, axis, source, p):
    if state.tip_regressor is None:
        raise InputError(
            "a payload among the 'effects' needs the tip regressor; write it as 'payload' of the robot file"
        )
    return state.tip_regressor()


def _prior(robot):
    mass = _SHARE * sum(b[0] for b in bodies(robot))
    return np.array([mass, *[mass * _LEVER] * 3, *[mass * _LEVER**2] * 6])


def _least(robot):
    """Return the lowest coefficients: no more is missing than the last link and what the robot file hangs on it."""
    carried = robot.payload.mass if robot.payload is not None else 0.0
    return np.array([-(bodies(robot)[-1][0] + carried), *[-np.inf] * 9])


#: Entries of the Cholesky factor of a pseudo-inertia, and its least eigenvalue over the largest to start from.
_LOWER, _THIN = np.tril_indices(4), 1e-6


def _pseudo_inertia(ten):
    inertia = matrix_of_six(ten[4:])
    spread = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    return np.block([[spread, ten[1:4, None]], [ten[None, 1:4], np.array([[ten[0]]])]])


def _ten(pseudo):
    inertia = np.trace(pseudo[:3, :3]) * np.eye(3) - pseudo[:3, :3]
    return np.array([pseudo[3, 3], *pseudo[:3, 3], *(inertia[i] for i in SIX)])


def _nearest(robot, coefficients, precision):
    """Return the nearest coefficients with which the last link and all it carries are a body of mass without holes.

    A pseudo-inertia without negative eigenvalues is one, and its factor has no bounds (Wensing, Kim and Slotine 2018;
    Rucker and Wensing 2022).
    """
    own = parameters_of_body(*bodies(robot)[-1])
    if robot.payload is not None:
        own = own + parameters_of_body(robot.payload.mass, robot.payload.com, robot.payload.inertia)
    values, axes = np.linalg.eigh(_pseudo_inertia(coefficients + own))
    if values[0] >= 0 or values[-1] <= 0:
        return coefficients
    root = np.linalg.cholesky(precision).T
    start = np.linalg.cholesky((axes * np.maximum(values, _THIN * values[-1])) @ axes.T)[_LOWER]

    def body(entries):
        factor = np.zeros((4, 4))
        factor[_LOWER] = entries
        return _ten(factor @ factor.T) - own

    scale = np.maximum(np.abs(start), 1e-3 * np.abs(start).max())
    found = least_squares(lambda x: root @ (body(x) - coefficients), start, x_scale=scale, max_nfev=200)
    return body(found.x)


def _parameter_vector(parameters):
    return np.array([parameters.get(name, 0.0) for name in _NAMES])


def _about_centre(total, farthest=np.inf):
    """Return centre of mass (3,) and inertia (3, 3) about it of ten parameters with a mass."""
    mass = float(total[0])
    com = np.clip(total[1:4] / mass, -farthest, farthest)
    about = matrix_of_six(total[4:]) - mass * (com @ com * np.eye(3) - np.outer(com, com))
    return com, (about + about.T) / 2


def _sound(parameters):
    total = _parameter_vector(parameters)
    return bool(total[0] > 0) and bool(np.linalg.eigvalsh(_about_centre(total)[1])[0] >= 0)


def _written(content, parameters):
    """Return the body of a robot file that is the sum of `content` and a payload; the nearest that is a body."""
    own = body_of(content or body_content(None))
    total = parameters_of_body(own.mass, own.com, own.inertia) + _parameter_vector(parameters)
    mass = float(total[0])
    if mass <= 1e-9:
        return body_content(None)
    com, about = _about_centre(total, FARTHEST)
    moments, axes = np.linalg.eigh(about)
    # A shade more than nothing, so that rounding makes no moment negative.
    least = 1e-10 * min(max(float(moments[-1]), 0.0), LARGEST)
    about = (axes * np.clip(moments, least, LARGEST)) @ axes.T
    return body_content(Link(mass, com, about))


EFFECT = Effect(
    identifier="payload",
    name="Payload",
    equation="regressor of the last link x (m, m c, inertia)",
    parameters=(
        Parameter("mass", "kg", -1e4, 1e4, "m"),
        *(Parameter(f"moment_{a}", "kg m", -1e4, 1e4, f"first moment m c_{a} in the last link frame") for a in "xyz"),
        *(Parameter(a, "kg m2", -1e4, 1e4, f"inertia {a} about the origin of the last link frame") for a in _NAMES[4:]),
    ),
    confused_with=("torque_constant_error", "joint_spring"),
    excitation="poses that turn the last link about every axis against gravity",
    source="standard; e.g. Khalil and Dombre 2002",
    argument="pose",
    argument_unit="rad",
    torque=lambda state, axis, source, p: _columns(state, axis, source, p) @ _parameter_vector(p),
    columns=_columns,
    parameters_of=lambda p, c: {**p, **dict(zip(_NAMES, map(float, c), strict=True))},
    grid=lambda state, axis: [{}],
    needs=("tip",),
    whole_arm=True,
    prior=_prior,
    least=_least,
    nearest=_nearest,
    # Mass and first moments; the inertia of what a hand holds is hardly ever seen.
    leading=4,
    sound=_sound,
    writes=lambda content, p: {**content, "payload": _written(content.get("payload"), p)},
)
