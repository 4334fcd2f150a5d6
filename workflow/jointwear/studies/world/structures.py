"""Hidden springs, loads, elastic gears and tilted bases, by MuJoCo's own means; ``draw(scales, rng, axis)``."""

from __future__ import annotations

import numpy as np

from jointwear.studies.challenge.scene import log_uniform
from jointwear.studies.world.hidden import Hidden, Scales
from jointwear.studies.world.packages import mujoco

#: Range [Hz] of the swing of a link on its elastic gear: above what the controllers ask, below what no log shows.
_SWING = (7.0, 25.0)


def spring(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A joint spring with its preload, straight or stiffening, or a coil between two bodies over the second axis."""
    reach = max((scales.high[axis] - scales.low[axis]) / 2, 0.2)
    forms = ["straight", "stiffening"] + (["coil"] if axis == 1 else [])
    form = str(rng.choice(forms))
    if form == "coil":
        # The counterbalance of a heavy arm: it carries a part of the gravity torque of the axis.
        size = rng.uniform(0.3, 0.8)
        arm, depth = 0.25 * _length(scales), 0.8 * _length(scales)
        stiffness = size * max(scales.load[axis], scales.drives.coulomb[axis]) / (arm * depth * 0.6)

        def build(drafted):
            near, far = _coil_ends(drafted, axis, arm, depth)
            tie = drafted.spec.add_tendon(name="coil", springlength=[0.4 * depth] * 2)
            tie.stiffness = [stiffness, 0.0, 0.0]
            tie.wrap_site(near)
            tie.wrap_site(far)

        return Hidden("joint_spring", axis, form, size, "load", build=build)
    size = log_uniform(rng, 0.08, 0.5)
    stiffness = size * scales.drives.coulomb[axis] / reach * 1.5
    centre, bend = rng.uniform(scales.low[axis], scales.high[axis]), rng.uniform(0.5, 2.0)

    def build(drafted):
        joint = drafted.joint(axis)
        cubic = stiffness * bend / reach**2 if form == "stiffening" else 0.0
        joint.stiffness = [stiffness, 0.0, cubic]
        joint.springref = centre

    parameters = {"stiffness": stiffness} if form == "straight" else {}
    return Hidden("joint_spring", axis, form, stiffness, "N m/rad", parameters, build=build)


def _length(scales: Scales) -> float:
    return float(np.linalg.norm(scales.chain.offset[2])) or 0.3


def _coil_ends(drafted, axis: int, arm: float, depth: float) -> tuple[str, str]:
    """Add the two ends of a coil across the axis: on the link off its turning line, on the body before it deep down."""
    line = drafted.chain.axis[axis]
    along = drafted.chain.offset[axis + 1] - line * (line @ drafted.chain.offset[axis + 1])
    along = along / (np.linalg.norm(along) or 1.0)
    drafted.link(axis).add_site(name="coil_link", pos=arm * along)
    rotation, offset = drafted.chain.rotation[axis], drafted.chain.offset[axis]
    drafted.link(axis - 1).add_site(name="coil_base", pos=offset + rotation @ (-depth * along))
    return "coil_link", "coil_base"


def payload(scales: Scales, rng: np.random.Generator, axis: int | None = None) -> Hidden:
    """A box welded to the last link; 2 to 80 % of the rated load."""
    mass = log_uniform(rng, 0.03, 0.8) * scales.kind.rated
    side = 0.06 * mass ** (1 / 3)
    line = scales.chain.axis[-1]
    place = line * rng.uniform(0.03, 0.12) * max(1.0, side / 0.06) + rng.uniform(-0.04, 0.04, 3)
    sides = side * rng.uniform(0.6, 1.4, 3)
    inertia = mass / 12 * (np.sum(sides**2) - sides**2)

    def build(drafted):
        last = drafted.link(drafted.chain.joints - 1)
        # Without a place of its own the centre of mass would be twice as far away as the body.
        last.add_body(name="box", pos=place, mass=mass, inertia=inertia, explicitinertial=True, ipos=np.zeros(3))

    parameters = {"mass": mass} | {f"moment_{a}": float(mass * place[k]) for k, a in enumerate("xyz")}
    return Hidden("payload", None, "welded_box", mass, "kg", parameters, build=build)


def tilt(scales: Scales, rng: np.random.Generator, axis: int | None = None) -> Hidden:
    """A base that stands askew by 0.5 to 5 degrees: gravity comes from elsewhere."""
    angle, heading = np.deg2rad(log_uniform(rng, 0.5, 5.0)), rng.uniform(0, 2 * np.pi)
    down = 9.81 * np.array([np.sin(angle) * np.cos(heading), np.sin(angle) * np.sin(heading), -np.cos(angle)])

    def build(drafted):
        drafted.spec.option.gravity = down

    # Turns of gravity about x and about y that bring it there.
    parameters = {"about_x": float(np.arcsin(down[1] / 9.81)), "about_y": float(-np.arcsin(down[0] / 9.81))}
    return Hidden("mounting_tilt", None, "gravity", float(np.rad2deg(angle)), "degree", parameters, build=build)


def elastic_gear(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A second joint behind the motor's, held by a spring: motor inertia and friction before it, the link behind."""
    inertia = scales.drives.armature[axis]
    stiffness = scales.inertia[axis] * (2 * np.pi * log_uniform(rng, *_SWING)) ** 2

    def build(drafted):
        drafted.flexible.add(axis)
        motor = drafted.joint(axis)
        gear = drafted.link(axis).add_joint(name=f"gear_{axis + 1}", axis=motor.axis, pos=motor.pos)
        gear.type = mujoco().mjtJoint.mjJNT_HINGE
        gear.limited = mujoco().mjtLimited.mjLIMITED_FALSE
        gear.stiffness = [stiffness, 0.0, 0.0]
        gear.damping = [0.06 * np.sqrt(stiffness * inertia), 0.0, 0.0]

    return Hidden("joint_flexibility", axis, "two_joints", stiffness, "N m/rad", {"stiffness": stiffness}, build=build)


DRAW = {
    "joint_spring": spring,
    "payload": payload,
    "mounting_tilt": tilt,
    "joint_flexibility": elastic_gear,
}
