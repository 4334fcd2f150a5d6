"""Hidden errors of motors and torque channels: torque constants, cogging, drift, delay; ``draw(scales, rng, axis)``."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter
from scipy.special import jv

from jointwear.studies.challenge.scene import either, log_uniform
from jointwear.studies.challenge.surroundings import REFERENCE_TEMPERATURE
from jointwear.studies.world.hidden import Channel, Hidden, Scales


def _on(axis: int, channel: Channel, values: np.ndarray) -> np.ndarray:
    torque = channel.torque.copy()
    torque[:, axis] = values
    return torque


def _teeth(rng: np.random.Generator, order: int):
    """Return a wave of motor angles that leans over, as a detent does, and the amplitude of its first harmonic."""
    phase, lean = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 0.7)
    # Jacobi-Anger: the sine of x + s sin x has the first harmonic J0(s) - J2(s).
    return lambda motor: np.sin(order * motor + phase + lean * np.sin(order * motor + phase)), jv(0, lean) - jv(2, lean)


def _order(scales: Scales, rng: np.random.Generator, axis: int) -> int:
    """Draw a line order that a log at this rate can follow for half of the motion at least."""
    fastest = 0.35 * scales.rate * 2 * np.pi / (abs(scales.gear[axis]) * 0.5 * scales.speed[axis])
    return int(rng.integers(1, max(2, min(5, int(fastest) + 1))))


def cogging(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A torque over the motor angle that acts on the rotor."""
    size, order = log_uniform(rng, 0.03, 0.15), _order(scales, rng, axis)
    (wave, first), height, gear = _teeth(rng, order), size * scales.drives.coulomb[axis], scales.gear[axis]

    def step(now):
        now.force[axis] -= height * wave(gear * now.position[axis])

    parameters = {"amplitude": float(height * first)}
    return Hidden("cogging_torque", axis, "detent", size, "Fc", parameters, step=step, facts={"gear_known": True})


def constant_ripple(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A torque constant that ripples over the motor angle."""
    size, order = log_uniform(rng, 0.01, 0.06), _order(scales, rng, axis)
    (wave, first), gear = _teeth(rng, order), scales.gear[axis]
    return Hidden(
        "torque_constant_ripple",
        axis,
        "current",
        size,
        "1",
        {"amplitude": float(size * first)},
        channel=lambda c: _on(axis, c, c.torque[:, axis] / (1 + size * wave(gear * c.position[:, axis]))),
        facts={"gear_known": True},
    )


def constant_error(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A current turned into torque with a wrong constant."""
    share = log_uniform(rng, 0.02, 0.15) * either(rng)
    return Hidden(
        "torque_constant_error",
        axis,
        "current",
        share,
        "1",
        {"share": share},
        channel=lambda c: _on(axis, c, c.torque[:, axis] * (1 + share)),
    )


def constant_temperature(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """Magnets that weaken as they warm: more current, so more computed torque; in one case of five the sensor falls."""
    size = log_uniform(rng, 0.02, 0.06) * (1 if rng.random() < 0.8 else -1)

    def channel(c):
        warm = c.temperature[:, axis] - REFERENCE_TEMPERATURE
        return _on(axis, c, c.torque[:, axis] / (1 - size * warm / 20))

    return Hidden("torque_constant_temperature", axis, "remanence", size, "1 per 20 K", channel=channel)


def drift(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """An amplifier whose zero wanders: warming up from the first minute on, or with the hours of the day."""
    size, form = log_uniform(rng, 0.05, 0.4) * either(rng), str(rng.choice(["warming_up", "daily"]))
    height, span = size * scales.drives.coulomb[axis], scales.span
    scale, phase = span * rng.uniform(0.15, 0.5), rng.uniform(0, 2 * np.pi)

    def channel(c):
        x = c.time
        offset = 1 - np.exp(-x / scale) if form == "warming_up" else 0.6 * np.sin(2 * np.pi * x / (2 * scale) + phase)
        return _on(axis, c, c.torque[:, axis] + height * offset)

    return Hidden("torque_offset_drift", axis, form, size, "Fc", channel=channel)


def delay(scales: Scales, rng: np.random.Generator, axis: int) -> Hidden:
    """A torque that is logged late, or a drive that follows its logged command late; dead time or low pass."""
    time, form = log_uniform(rng, 0.005, 0.025), str(rng.choice(["late_log", "late_drive", "log_filter", "slow_drive"]))
    signed = time if form in ("late_log", "log_filter") else -time
    parameters = {"delay": signed}

    def channel(c):
        tau = c.torque[:, axis]
        if form == "late_log":
            clock = c.step * np.arange(len(tau))
            return _on(axis, c, np.interp(clock - time, clock, tau))
        keep = np.exp(-c.step / time)
        return _on(axis, c, lfilter([1 - keep], [1, -keep], tau, zi=[keep * tau[0]])[0])

    if form in ("late_log", "log_filter"):
        return Hidden("actuation_delay", axis, form, signed, "s", parameters, channel=channel)
    lag = (0.0, time) if form == "late_drive" else (time, 0.0)
    return Hidden("actuation_delay", axis, form, signed, "s", parameters, lag=lag, facts={"command": True})


DRAW = {
    "cogging_torque": cogging,
    "torque_constant_ripple": constant_ripple,
    "torque_constant_error": constant_error,
    "torque_constant_temperature": constant_temperature,
    "torque_offset_drift": drift,
    "actuation_delay": delay,
}
