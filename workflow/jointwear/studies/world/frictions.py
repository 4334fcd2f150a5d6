"""Hidden friction: MuJoCo's friction loss, damping and springs changed as the arm runs; ``draw(scales, rng, axis)``."""

from __future__ import annotations

import numpy as np

from jointwear.studies.challenge.scene import either, log_uniform
from jointwear.studies.challenge.surroundings import REFERENCE_TEMPERATURE
from jointwear.studies.world.hidden import Hidden, Scales
from jointwear.studies.world.plant import stiffen


def stribeck(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction loss that rises at low speed, falling off with a power or a hyperbola of the speed."""
    size, speed = log_uniform(rng, 0.1, 0.6), log_uniform(rng, 0.05, 0.25)
    form, height = str(rng.choice(["rational", "hyperbolic"])), size * scales.drives.coulomb[axis]

    def step(now):
        x = abs(now.velocity[axis]) / speed
        now.friction[axis] += height / (1 + x * x) if form == "rational" else height / np.cosh(min(1.3 * x, 50.0))

    return Hidden("stribeck_friction", axis, form, size, "Fc", step=step)


def bent_viscous(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Damping that grows with the speed (MuJoCo's polynomial) or thins with it."""
    size, form = log_uniform(rng, 0.1, 0.6), str(rng.choice(["polynomial", "thinning"]))
    top, height = scales.speed[axis], size * scales.drives.coulomb[axis]
    if form == "polynomial":

        def build(drafted):
            damping = np.array(drafted.joint(axis).damping)
            # The second coefficient multiplies abs(v) v.
            damping[1] += height / top**2
            drafted.joint(axis).damping = damping

        return Hidden("nonlinear_viscous_friction", axis, form, size, "Fc", build=build)

    def step(now):
        x = abs(now.velocity[axis]) / top
        now.damping[axis] += height / top * 2 / (1 + 3 * x)

    return Hidden("nonlinear_viscous_friction", axis, form, size, "Fc", step=step)


def load_dependent(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction loss that grows with the load of the gear, alike both ways or more where the motor drives the load."""
    size = log_uniform(rng, 0.02, 0.1)
    form = str(rng.choice(["both_ways", "directional"]))
    driving, braking = (size, size) if form == "both_ways" else (size, size * rng.uniform(0.2, 0.5))

    def step(now):
        load = now.load[axis]
        # The motor drives the load where torque and speed have one sign.
        now.friction[axis] += (driving if load * now.velocity[axis] > 0 else braking) * abs(load)

    parameters = {"coefficient": size} if form == "both_ways" else {}
    return Hidden("load_dependent_friction", axis, form, size, "1", parameters, step=step)


def warm_viscous(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Damping that falls with the temperature of the oil, by Arrhenius or as a rational function."""
    size, form = log_uniform(rng, 0.2, 0.6), str(rng.choice(["arrhenius", "rational"]))
    base = scales.drives.viscous[axis]

    def step(now):
        warm = now.temperature[axis] - REFERENCE_TEMPERATURE
        if form == "arrhenius":
            # The fall is `size` over 20 K.
            kelvin = REFERENCE_TEMPERATURE + 273.15
            energy = -np.log(1 - size) / (1 / kelvin - 1 / (kelvin + 20))
            share = np.exp(energy * (1 / (kelvin + warm) - 1 / kelvin))
        else:
            share = 1 / max(1 + size / (1 - size) * warm / 20, 0.2)
        now.damping[axis] += base * (share - 1)

    return Hidden("temperature_dependent_viscous_friction", axis, form, size, "1 per 20 K", step=step)


def warm_coulomb(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction loss that falls with the temperature, straight or levelling off."""
    size, form = log_uniform(rng, 0.08, 0.3), str(rng.choice(["straight", "levelling"]))
    base = scales.drives.coulomb[axis]

    def step(now):
        x = (now.temperature[axis] - REFERENCE_TEMPERATURE) / 20
        fall = size * x if form == "straight" else size * 1.3 * np.tanh(x / 1.3)
        now.friction[axis] -= base * min(fall, 0.9)

    return Hidden("temperature_dependent_coulomb_friction", axis, form, size, "1 per 20 K", step=step)


def along_position(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction loss that waves with the joint angle: an eccentric gear (one or two waves a turn) or a worn range."""
    size, form = log_uniform(rng, 0.08, 0.35), str(rng.choice(["eccentric", "worn_range"]))
    height, order, phase = size * scales.drives.coulomb[axis], float(rng.integers(1, 6)), rng.uniform(0, 2 * np.pi)
    centre, width = rng.uniform(scales.low[axis], scales.high[axis]), 0.25 * (scales.high[axis] - scales.low[axis])

    def step(now):
        q = now.position[axis]
        if form == "eccentric":
            now.friction[axis] += height * np.sin(order * q + phase)
        else:
            now.friction[axis] += height * (2 / (1 + ((q - centre) / width) ** 2) - 1)

    return Hidden("position_dependent_friction", axis, form, size, "Fc", step=step)


def presliding(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction that builds up over some travel: a light wheel that slips on the base, tied to the joint by a spring."""
    reach, share = log_uniform(rng, 0.015, 0.1), rng.uniform(0.5, 0.9)
    height = share * scales.drives.coulomb[axis]
    stiffness = height / reach
    # A wheel light enough to follow and heavy enough for the time step: 30 Hz and up on its spring.
    inertia = stiffness / (2 * np.pi * 40) ** 2

    def build(drafted):
        drafted.joint(axis).frictionloss = drafted.joint(axis).frictionloss - height
        body = drafted.spec.worldbody.add_body(
            name="wheel", mass=1e-3, inertia=[1e-6] * 3, explicitinertial=True, gravcomp=1
        )
        stiffen(
            body.add_joint(name="wheel", armature=inertia, frictionloss=height, damping=[0.0, 0.0, 0.0]),
            drafted.spec.option.timestep,
        )
        tie = drafted.spec.add_tendon(name="tie", springlength=[0.0, 0.0])
        tie.stiffness = [stiffness, 0.0, 0.0]
        tie.damping = [1.2 * np.sqrt(stiffness * inertia), 0.0, 0.0]
        tie.wrap_joint(f"joint_{axis + 1}", 1.0)
        tie.wrap_joint("wheel", -1.0)

    def step(now):
        now.friction[axis] -= height

    return Hidden(
        "presliding_hysteresis",
        axis,
        "spring_and_wheel",
        reach,
        "rad",
        build=build,
        step=step,
        facts={"start_on_path": f"joint_{axis + 1}"},
    )


def wear(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction loss that grows from the first recording to the last."""
    size, power = log_uniform(rng, 0.08, 0.5), rng.uniform(0.8, 3.0)
    base = scales.drives.coulomb[axis]

    def step(now):
        now.friction[axis] += base * size * (now.time / scales.span) ** power

    return Hidden("wear_drift", axis, "power", size, "Fc", step=step)


def coupling(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """The last motor turns with the last two axes: a tendon over both carries its friction, damping and inertia."""
    n = scales.chain.joints
    i, j = n - 2, n - 1
    share, sign = rng.uniform(0.4, 1.0), either(rng)
    height, damping = share * scales.drives.coulomb[j], share * scales.drives.viscous[j]
    inertia = share * scales.drives.armature[j]

    def build(drafted):
        joint = drafted.joint(j)
        joint.armature = joint.armature - inertia
        tie = drafted.spec.add_tendon(name="shared", frictionloss=height, armature=inertia)
        stiffen(tie, drafted.spec.option.timestep)
        tie.damping = [damping, 0.0, 0.0]
        tie.wrap_joint(f"joint_{i + 1}", sign)
        tie.wrap_joint(f"joint_{j + 1}", 1.0)

    def step(now):
        now.friction[j] -= height
        now.damping[j] -= damping

    return Hidden("drive_coupling", i, "tendon", share, "1", build=build, step=step, source=j, also=(j,))


DRAW = {
    "stribeck_friction": stribeck,
    "nonlinear_viscous_friction": bent_viscous,
    "load_dependent_friction": load_dependent,
    "temperature_dependent_viscous_friction": warm_viscous,
    "temperature_dependent_coulomb_friction": warm_coulomb,
    "position_dependent_friction": along_position,
    "presliding_hysteresis": presliding,
    "wear_drift": wear,
    "drive_coupling": coupling,
}
