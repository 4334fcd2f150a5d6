"""Friction that the nominal model lacks, in formulas of the generator's own.

Every function draws one hidden effect for a 0-based axis: ``draw(scene, rng, axis) -> Hidden``. Sizes are shares of the
axis's Coulomb friction unless said otherwise.
"""

from __future__ import annotations

import numpy as np

from jointwear.studies.challenge.scene import Scene, log_uniform
from jointwear.studies.challenge.surroundings import REFERENCE_TEMPERATURE
from jointwear.studies.challenge.world import Hidden, hidden_law


def stribeck(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Extra friction at low speed: rational (Hess and Soom 1990), hyperbolic tangent, or hyperbolic secant."""
    size, width = log_uniform(rng, 0.05, 0.5), log_uniform(rng, 0.04, 0.25)
    form = str(rng.choice(["rational", "tanh", "sech"]))
    fall = {
        "rational": lambda x: 1 / (1 + x**2),
        "tanh": lambda x: 1 - np.tanh(x),
        "sech": lambda x: 1 / np.cosh(np.minimum(1.3 * x, 50)),
    }[form]
    height = size * scene.coulomb[axis]

    def law(state):
        v = state.velocity[:, axis]
        return height * fall(np.abs(v) / width) * np.sign(v)

    return hidden_law("stribeck_friction", axis, form, size, "Fc", {"height": height, "velocity": width}, law)


def nonlinear_viscous(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Lubricant that thins with shear (Eyring's asinh, a Carreau-like ratio) or a churning loss in v abs(v)."""
    size = log_uniform(rng, 0.05, 0.5)
    form = str(rng.choice(["eyring", "carreau", "churning"]))
    top = scene.speed[axis]
    bend = top * rng.uniform(0.08, 0.3)
    shape = {
        "eyring": lambda v: np.arcsinh(v / bend),
        "carreau": lambda v: v / (1 + np.abs(v) / bend) ** 0.75,
        "churning": lambda v: v * np.abs(v),
    }[form]
    height = size * scene.coulomb[axis]
    scale = height / shape(np.array(top))
    parameters = {"height": height, "at_velocity": float(top), "bend": float(bend)}
    return hidden_law(
        "nonlinear_viscous_friction",
        axis,
        form,
        size,
        "Fc at top speed",
        parameters,
        lambda state: scale * shape(state.velocity[:, axis]),
    )


def load_dependent(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Tooth friction: proportional to load, of Hertzian power 2/3, or unlike for driving and driven (Hamon 2010)."""
    size = log_uniform(rng, 0.02, 0.1)
    form = str(rng.choice(["proportional", "hertzian", "two_quadrants"]))
    reference = scene.load[axis]
    uneven = rng.uniform(0.1, 0.3)

    def law(state):
        load, direction = state.load[:, axis], np.sign(state.velocity[:, axis])
        if form == "hertzian":
            return size * reference * (np.abs(load) / reference) ** (2 / 3) * direction
        share = 1 + uneven * np.sign(load) * direction if form == "two_quadrants" else 1.0
        return size * np.abs(load) * share * direction

    return hidden_law(
        "load_dependent_friction", axis, form, size, "1", {"coefficient": size, "load": reference}, law, in_loop=False
    )


def viscosity(form: str, fall: float):
    """Return viscosity over that at the reference temperature, falling by `fall` over the next 20 K."""
    if form == "vogel":
        # ln eta = B / (T + 95 degC): Vogel's law with the constant that suits mineral oils.
        t0, pole = REFERENCE_TEMPERATURE, 95.0
        b = np.log(1 - fall) / (1 / (t0 + 20 + pole) - 1 / (t0 + pole))
        return lambda t: np.exp(b * (1 / (t + pole) - 1 / (t0 + pole)))
    kelvin = 273.15 + REFERENCE_TEMPERATURE
    energy = np.log(1 - fall) / (1 / (kelvin + 20) - 1 / kelvin)
    return lambda t: np.exp(energy * (1 / (t + 273.15) - 1 / kelvin))


def temperature_viscous(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Viscous friction with the viscosity of a lubricant, by Vogel's or Arrhenius's law; 20 to 60 % less per 20 K."""
    size, form = log_uniform(rng, 0.2, 0.6), str(rng.choice(["vogel", "arrhenius"]))
    ratio = viscosity(form, size)
    slope = scene.viscous[axis]

    def law(state):
        return slope * (ratio(state.temperature[:, axis]) - 1) * state.velocity[:, axis]

    return hidden_law(
        "temperature_dependent_viscous_friction", axis, form, size, "per 20 K", {"viscous": float(slope)}, law
    )


def temperature_coulomb(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Coulomb friction that falls by 5 to 30 % over 20 K, exponentially or as 1 / (1 + b dT)."""
    size, form = log_uniform(rng, 0.05, 0.3), str(rng.choice(["exponential", "hyperbolic"]))
    level = scene.coulomb[axis]

    def law(state):
        dt = state.temperature[:, axis] - REFERENCE_TEMPERATURE
        ratio = (1 - size) ** (dt / 20) if form == "exponential" else 1 / (1 + size / (1 - size) * dt / 20)
        return level * (ratio - 1) * np.sign(state.velocity[:, axis])

    return hidden_law(
        "temperature_dependent_coulomb_friction", axis, form, size, "per 20 K", {"coulomb": float(level)}, law
    )


def position_dependent(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction that waxes and wanes with the joint angle: a rounded hump (von Mises) or a softened triangle."""
    size, form = log_uniform(rng, 0.02, 0.3), str(rng.choice(["von_mises", "triangle"]))
    waves = int(rng.integers(1, 4))
    phase, sharp = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 0.9)
    height = size * scene.coulomb[axis]

    def law(state):
        x = waves * state.position[:, axis] + phase
        if form == "von_mises":
            wave = np.sinh(sharp * np.cos(x)) / np.sinh(sharp) + 0.25 * sharp * (np.cos(x) ** 2 - 0.5)
        else:
            wave = np.arcsin(0.95 * np.sin(x)) / np.arcsin(0.95)
        return height * wave * np.sign(state.velocity[:, axis])

    return hidden_law(
        "position_dependent_friction", axis, form, size, "Fc", {"height": height, "waves": waves, "phase": phase}, law
    )


def wear(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Coulomb friction that grows over the recordings: Weibull rise, power law, or a logistic onset."""
    size, form = log_uniform(rng, 0.02, 0.5), str(rng.choice(["weibull", "power", "logistic"]))
    span, bend = scene.span, rng.uniform(1.0, 3.0)
    middle = rng.uniform(0.35, 0.65)
    height = size * scene.coulomb[axis]

    def law(state):
        x = np.clip(state.time / span, 0, 1)
        if form == "weibull":
            growth = (1 - np.exp(-((1.5 * x) ** bend))) / (1 - np.exp(-(1.5**bend)))
        elif form == "power":
            growth = x**bend
        else:
            growth = 1 / (1 + np.exp(-(x - middle) / 0.12))
        return height * growth * np.sign(state.velocity[:, axis])

    return hidden_law("wear_drift", axis, form, size, "Fc", {"height": height, "exponent": bend}, law, in_loop=False)


DRAW = {
    "stribeck_friction": stribeck,
    "nonlinear_viscous_friction": nonlinear_viscous,
    "load_dependent_friction": load_dependent,
    "temperature_dependent_viscous_friction": temperature_viscous,
    "temperature_dependent_coulomb_friction": temperature_coulomb,
    "position_dependent_friction": position_dependent,
    "wear_drift": wear,
}
