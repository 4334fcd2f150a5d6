"""What may be missing from, or wrong in, the experiment that the paper describes.

A component names one such thing: an effect of the library, a wrong parameter of the model, or a wrong
experiment. A candidate is a set of components, alone or in pairs; the empty set says that nothing is missing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointwear.studies.recovery.plan import NOT_TOLD_APART, NOTHING

AXES = 6


@dataclass(frozen=True)
class Parameter:
    """One number of a component: bounds of the search, value if nothing is wrong, 1-based axis or None."""

    name: str
    nominal: float
    lower: float
    upper: float
    unit: str
    axis: int | None = None


@dataclass
class Coefficients:
    """How the parts of the torque are weighted, for S trajectories at once.

    `inertial`, `gravity`, `speed` (S,); `payload` (S, 10): mass times the monomials of its centre of mass
    (1, x, y, z, xx, yy, zz, xy, xz, yz) [kg m^0..2]; `gain`, `coulomb`, `viscous`, `armature` (S, n).
    """

    inertial: np.ndarray
    gravity: np.ndarray
    speed: np.ndarray
    payload: np.ndarray
    gain: np.ndarray
    coulomb: np.ndarray
    viscous: np.ndarray
    armature: np.ndarray

    @classmethod
    def nominal(cls, count: int) -> Coefficients:
        """Coefficients of the unloaded arm as the toolbox has it."""
        one, axes = np.ones(count), np.ones((count, AXES))
        return cls(one, one, one, np.zeros((count, 10)), axes, axes, axes, axes)


@dataclass(frozen=True)
class Component:
    """`kind`: "effect" (missing from the model), "retuned" (a wrong parameter) or "experiment" (a wrong task).

    `apply` changes coefficients given the parameters (S, p).
    """

    name: str
    kind: str
    parameters: tuple[Parameter, ...]
    apply: Callable[[Coefficients, np.ndarray], None]

    @property
    def same_in_slow_motion(self) -> tuple[str, ...]:
        """Names of the components that slow motion cannot tell from this one."""
        return NOT_TOLD_APART[self.name]


def payload_monomials(mass: np.ndarray, com: np.ndarray) -> np.ndarray:
    """Return mass times (1, x, y, z, xx, yy, zz, xy, xz, yz), shape (..., 10), of a centre of mass (..., 3)."""
    x, y, z = np.moveaxis(np.asarray(com, dtype=float), -1, 0)
    terms = [np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, x * z, y * z]
    return np.asarray(mass)[..., None] * np.stack(terms, axis=-1)


def _payload(c: Coefficients, p: np.ndarray) -> None:
    c.payload = c.payload + payload_monomials(p[:, 0], p[:, 1:4])


def _times(*fields: str) -> Callable[[Coefficients, np.ndarray], None]:
    def apply(c: Coefficients, p: np.ndarray) -> None:
        for name in fields:
            value = getattr(c, name)
            setattr(c, name, value * (p if value.ndim == 2 else p[:, 0]))

    return apply


def _each_axis(name: str, lower: float, upper: float) -> tuple[Parameter, ...]:
    return tuple(Parameter(name, 1.0, lower, upper, "1", axis) for axis in range(1, AXES + 1))


COMPONENTS: dict[str, Component] = {
    c.name: c
    for c in (
        Component(
            "payload",
            "effect",
            (
                Parameter("mass", 0.0, 0.0, 10.0, "kg"),
                Parameter("com_x", 0.0, -0.3, 0.3, "m"),
                Parameter("com_y", 0.0, -0.3, 0.3, "m"),
                # A load is held before the flange, not behind it.
                Parameter("com_z", 0.0, 0.0, 0.3, "m"),
            ),
            _payload,
        ),
        Component("torque_constant_error", "effect", _each_axis("gain", 0.3, 3.0), _times("gain")),
        Component(
            "gravity_scale",
            "retuned",
            (Parameter("gravity_scale", 1.0, 0.3, 3.0, "1"),),
            _times("gravity"),
        ),
        Component(
            "mass_scale",
            "retuned",
            (Parameter("mass_scale", 1.0, 0.3, 3.0, "1"),),
            _times("gravity", "inertial"),
        ),
        Component("coulomb_scale", "retuned", _each_axis("coulomb_scale", 0.2, 5.0), _times("coulomb")),
        Component("viscous_scale", "retuned", _each_axis("viscous_scale", 0.0, 20.0), _times("viscous")),
        Component("motor_inertia_scale", "retuned", _each_axis("motor_inertia_scale", 0.0, 20.0), _times("armature")),
        Component("faster_segments", "experiment", (Parameter("speed", 1.0, 0.5, 40.0, "1"),), _times("speed")),
    )
}


@dataclass(frozen=True)
class Explanation:
    """A set of components that act together."""

    components: tuple[Component, ...]

    @property
    def name(self) -> str:
        """Names joined by "+", or "nothing"."""
        return "+".join(c.name for c in self.components) or NOTHING

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters of all components, in order."""
        return tuple(p for c in self.components for p in c.parameters)

    def coefficients(self, values: np.ndarray) -> Coefficients:
        """Return the coefficients for parameter values (S, p)."""
        result, first = Coefficients.nominal(len(values)), 0
        for component in self.components:
            last = first + len(component.parameters)
            component.apply(result, values[:, first:last])
            first = last
        return result


def candidate(name: str) -> Explanation:
    """Return the candidate of a name such as "payload", "payload+gravity_scale" or "nothing".

    Raises
    ------
    KeyError : if there is no such component.
    """
    return Explanation(() if name == NOTHING else tuple(COMPONENTS[part] for part in name.split("+")))
