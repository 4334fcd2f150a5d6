"""Friction of a lubricated gear at the temperature of its oil, and how it grows as the gear wears.

On one axis at speed v, with oil of relative viscosity h(T) and the torque L of the rigid bodies,

    friction = sign(v) { C k(T) (1 + a |L| / L0) [1 + s / (1 + h^m |v| / v_s)] + B h^m |v| / (1 + |v| / v_b) },

C level of boundary friction, s the rise at low speed where the film is thin (it shrinks with h |v|), B viscous friction
that thins with shear, k(T) = 1 - c (T - 25 degC). Viscosity follows Walther's law (ASTM D341), log log(nu + 0.7) linear
in log T. Its parameters are drawn for every axis of every arm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.studies.shop_floor.arms import FRICTION_ERROR, ArmType

#: Temperature [degC] at which friction has its nominal size.
REFERENCE = 25.0
#: Width [rad/s] over which friction changes sign.
TURN = 0.004
#: Lost motion [rad] of a new gear where gears have any, about half a minute of arc.
NEW_GAP = 1.5e-4
SHAPES = ("straight", "accelerating", "saturating", "late")


@dataclass(frozen=True)
class Gear:
    """Parameters of the law above, each (n,): `coulomb` [N m] forward and backward (n, 2), `viscous` [N m s/rad]."""

    coulomb: np.ndarray
    viscous: np.ndarray
    cooling: np.ndarray
    load: np.ndarray
    load_scale: np.ndarray
    rise: np.ndarray
    film_speed: np.ndarray
    thin_speed: np.ndarray
    power: np.ndarray
    oil: tuple[float, float]

    def viscosity(self, temperature: np.ndarray) -> np.ndarray:
        """Return h^m at temperatures (..., n) [degC], 1 at :data:`REFERENCE`."""
        return (_walther(temperature, self.oil) / _walther(np.float64(REFERENCE), self.oil)) ** self.power

    def level(self, temperature: np.ndarray) -> np.ndarray:
        """Return k(T), (..., n)."""
        return 1.0 - self.cooling * (temperature - REFERENCE)


def _walther(temperature: np.ndarray, oil: tuple[float, float]) -> np.ndarray:
    """Kinematic viscosity [mm2/s] from those at 40 and 100 degC."""
    double = [np.log10(np.log10(nu + 0.7)) for nu in oil]
    logs = np.log10([313.15, 373.15])
    slope = (double[1] - double[0]) / (logs[1] - logs[0])
    return 10.0 ** (10.0 ** (double[0] + slope * (np.log10(temperature + 273.15) - logs[0]))) - 0.7


def draw_gear(arm: ArmType, random: np.random.Generator) -> Gear:
    """Draw the gears of one arm."""
    n = len(arm.coulomb)
    nominal = np.array(arm.coulomb)
    side = 1 + 0.06 * random.standard_normal((n, 2))
    return Gear(
        coulomb=nominal[:, None] * np.exp(FRICTION_ERROR * random.standard_normal((n, 1))) * side,
        viscous=np.array(arm.viscous) * np.exp(FRICTION_ERROR * random.standard_normal(n)),
        cooling=random.uniform(0.0005, 0.006, n),
        load=random.uniform(0.03, 0.25, n),
        load_scale=10.0 * nominal,
        rise=random.uniform(0.03, 0.2, n),
        film_speed=random.uniform(0.08, 0.3, n) * np.array(arm.speed),
        thin_speed=random.uniform(1.5, 5.0, n) * np.array(arm.speed),
        power=random.uniform(0.35, 0.6, n),
        oil=(float(random.uniform(120, 330)), float(random.uniform(13, 26))),
    )


@dataclass(frozen=True)
class Wear:
    """Growth of one 0-based `axis` from `onset` [h], by `full` at `onset` + `duration` [h], in one of :data:`SHAPES`:
    of its `coulomb` or `viscous` friction, or of its lost motion [rad] (`backlash`)."""

    axis: int
    kind: str
    onset: float
    duration: float
    shape: str
    full: float = 0.2

    def growth(self, hour: np.ndarray) -> np.ndarray:
        """Return the relative growth at hours of any shape; what is straight goes on beyond its end."""
        x = np.maximum(np.asarray(hour, dtype=float) - self.onset, 0.0) / self.duration
        if self.shape == "straight":
            y = x
        elif self.shape == "accelerating":
            y = np.expm1(2.0 * np.minimum(x, 1.5)) / np.expm1(2.0)
        elif self.shape == "saturating":
            y = -np.expm1(-2.0 * x) / -np.expm1(-2.0)
        else:
            y = np.minimum(x, 1.5) ** 2
        return self.full * y


def draw_wear(axes: int, onset: tuple[float, float], random: np.random.Generator) -> Wear:
    """Draw wear that begins within `onset` [h] and reaches 20 % in one to three weeks."""
    return Wear(
        axis=int(random.integers(axes)),
        kind="coulomb" if random.random() < 0.75 else "viscous",
        onset=float(random.uniform(*onset)),
        duration=float(random.uniform(168, 504)),
        shape=str(random.choice(SHAPES)),
    )
