"""A mass at the last link that the model does not know."""

import numpy as np

from jointwear.effects.effect import Effect, Parameter

_NAMES = ("mass", "moment_x", "moment_y", "moment_z", "xx", "xy", "yy", "xz", "yz", "zz")


def _columns(state, axis, source, p):
    if state.tip_regressor is None:
        from jointwear.files.errors import InputError

        raise InputError(
            "a payload among the 'effects' needs the tip regressor; write it as 'payload' of the robot file"
        )
    return state.tip_regressor()


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
    torque=lambda state, axis, source, p: _columns(state, axis, source, p) @ np.array([p[name] for name in _NAMES]),
    columns=_columns,
    parameters_of=lambda p, c: {**p, **dict(zip(_NAMES, map(float, c), strict=True))},
    grid=lambda state, axis: [{}] if state.tip_regressor is not None else [],
    whole_arm=True,
)
