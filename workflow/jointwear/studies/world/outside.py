"""Disturbances that no effect of the library describes; ``draw(scales, rng, axis)``."""

from __future__ import annotations

import numpy as np

from jointwear.studies.challenge.scene import either, log_uniform
from jointwear.studies.world.hidden import Hidden, Scales


def _strength(scales: Scales, rng: np.random.Generator, axis: int) -> float:
    return log_uniform(rng, 0.3, 1.5) * scales.drives.coulomb[axis]


def push(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Somebody leans on the arm for seconds at a time: a torque on one axis that comes and goes with the clock."""
    height = _strength(scales, rng, axis)
    times = [np.sort(rng.uniform(0, scales.duration, 6)) for _ in scales.starts]
    signs = [rng.choice([-1.0, 1.0], 3) for _ in scales.starts]

    def step(now):
        pairs = times[now.recording].reshape(3, 2)
        for k, (begin, end) in enumerate(pairs):
            if begin < now.clock < end:
                rise = min(1.0, (now.clock - begin) / 0.1, (end - now.clock) / 0.1)
                now.force[axis] += signs[now.recording][k] * height * rise

    return Hidden("push", axis, "applied_torque", height, "N m", step=step)


def gusts(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Wind or shaking: a slow random torque, new in every recording."""
    height = _strength(scales, rng, axis)
    count = len(scales.starts)
    rates = rng.uniform(0.15, 1.6, (count, 6)) * 2 * np.pi
    phases = rng.uniform(0, 2 * np.pi, (count, 6))

    def step(now):
        k = now.recording
        now.force[axis] += height * 0.6 * np.sin(rates[k] * now.clock + phases[k]).sum() / np.sqrt(3)

    return Hidden("gusts", axis, "applied_torque", height, "N m", step=step)


def wall(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A soft obstacle near the end of the travel that pushes back over the last tenth."""
    height, side = 2 * _strength(scales, rng, axis), either(rng)
    span = scales.high[axis] - scales.low[axis]
    edge = scales.high[axis] - 0.15 * span if side > 0 else scales.low[axis] + 0.15 * span

    def step(now):
        depth = max(0.0, side * (now.position[axis] - edge)) / (0.1 * span)
        now.force[axis] -= side * height * min(depth, 2.0)

    return Hidden("wall", axis, "soft_contact", height, "N m", step=step)


def bump(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A damaged tooth: a narrow push against the motion at one or two places of the joint."""
    height = _strength(scales, rng, axis)
    span = scales.high[axis] - scales.low[axis]
    places = scales.low[axis] + span * rng.uniform(0.3, 0.7, 2)
    width = 0.035 * span

    def step(now):
        x = (now.position[axis] - places) / width
        now.force[axis] -= height * float(np.sum(-x * np.exp(0.5 - x * x / 2)))

    return Hidden("bump", axis, "tooth", height, "N m", step=step)


def step_in_time(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A torque that jumps in the middle of recordings and falls back: a brake that drags now and then."""
    height = _strength(scales, rng, axis)
    at = rng.uniform(0.2, 0.8, len(scales.starts)) * scales.duration

    def step(now):
        if now.clock > at[now.recording]:
            now.friction[axis] += height

    return Hidden("dragging_brake", axis, "friction_loss", height, "N m", step=step)


def two_joint_hose(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A hose over two joints that goes taut: a torque on both that depends on the sum of their angles."""
    other = axis - 1 if axis else 1
    height = 2 * _strength(scales, rng, axis)
    slack = rng.uniform(0.2, 0.8)

    def step(now):
        pull = now.position[axis] - scales.low[axis] + now.position[other] - scales.low[other]
        reach = scales.high[axis] - scales.low[axis] + scales.high[other] - scales.low[other]
        taut = max(0.0, pull / reach - slack * 0.7) * 2
        now.force[axis] -= height * taut
        now.force[other] -= height * taut

    return Hidden("two_joint_hose", axis, "hose", height, "N m", step=step, also=(other,))


def drifting_tremor(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A machine beside the robot that shakes it at a rate that rises in each recording."""
    height = 0.7 * _strength(scales, rng, axis)
    first, rise = rng.uniform(0.5, 1.5), rng.uniform(0.1, 0.4)
    phases = rng.uniform(0, 2 * np.pi, len(scales.starts))

    def step(now):
        t = now.clock
        now.force[axis] += height * np.sin(2 * np.pi * (first * t + rise * t * t / 2) + phases[now.recording])

    return Hidden("tremor", axis, "applied_torque", height, "N m", step=step)


def neighbour_drag(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction of one axis that depends on where its neighbour stands: a bearing that the weight behind it bends."""
    other = axis - 1 if axis else 1
    height = _strength(scales, rng, axis)
    phase = rng.uniform(0, 2 * np.pi)

    def step(now):
        now.friction[axis] += height * (0.6 + 0.6 * np.sin(2.3 * now.position[other] + phase))

    return Hidden("neighbour_drag", axis, "friction_loss", height, "N m", step=step)


DRAW = {
    "push": push,
    "gusts": gusts,
    "wall": wall,
    "bump": bump,
    "dragging_brake": step_in_time,
    "two_joint_hose": two_joint_hose,
    "tremor": drifting_tremor,
    "neighbour_drag": neighbour_drag,
}
