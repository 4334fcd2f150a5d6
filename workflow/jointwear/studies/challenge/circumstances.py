"""How a case is driven and logged: rate, encoders, torque channel, controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Share of cases whose motion is that of a closed loop with tracking error, half of them with each controller.
CLOSED_LOOP = 0.2
CONTROLLERS = ("pd", "pid")

#: Rates of logs [Hz], how often each, and how long a recording is [s].
RATES = {
    30: (0.04, 15.0),
    50: (0.10, 15.0),
    100: (0.32, 15.0),
    125: (0.20, 15.0),
    200: (0.14, 10.0),
    250: (0.10, 10.0),
    500: (0.06, 6.0),
    1000: (0.04, 4.0),
}

#: Encoders behind the gears: bits of a joint turn (0 is exact) and how often each. Motor encoders have 12 to 16 bits
#: of a motor turn, which a gear of 60 to 200 makes 18 to 24 bits of a joint turn.
LINK_BITS = {13: 0.03, 15: 0.07, 17: 0.20, 18: 0.10, 19: 0.25, 20: 0.10, 22: 0.10, 24: 0.05, 0: 0.10}

#: What a torque sensor behind the gears can see: neither friction nor the motor's own inertia.
LINK_SENSED = {"payload", "mounting_tilt", "torque_constant_error", "torque_constant_temperature", "link_inertia"}
#: What belongs to a current that is turned into torque.
OF_CURRENT = {
    "torque_constant_error",
    "torque_constant_ripple",
    "torque_constant_temperature",
    "torque_offset_drift",
}
#: Noise of a logged command over that of a current: it is computed, not measured.
COMMAND_NOISE = 0.05


@dataclass(frozen=True)
class Circumstances:
    """Of one case: `interval` and `duration` of a recording [s]; `step` (n,) [rad] of the encoders, 0 where exact;
    `torque` "motor", "command" or "link_sensor"; `controller` of a closed loop or None; `quiet` scales its noise."""

    interval: float
    duration: float
    link_side: bool
    step: np.ndarray
    torque: str
    controller: str | None
    quiet: float


def draw_circumstances(
    rng: np.random.Generator, kind: str, subject: str | None, gear: np.ndarray, smooth: bool
) -> Circumstances:
    """Draw how a case is logged; `smooth` cases follow their path exactly, without a controller."""
    rate = int(rng.choice(list(RATES), p=[share for share, _ in RATES.values()]))
    link_side = bool(rng.random() < 0.4)
    if link_side:
        bits = int(rng.choice(list(LINK_BITS), p=list(LINK_BITS.values())))
        step = np.full(len(gear), 2 * np.pi / 2.0**bits if bits else 0.0)
    else:
        step = 2 * np.pi / (2.0 ** rng.integers(12, 17) * np.abs(gear))
    torque = str(rng.choice(["motor", "motor", "motor", "command", "link_sensor"]))
    unloaded = kind == "nothing" or (kind in ("single", "retuned") and subject in LINK_SENSED)
    if (torque == "link_sensor" and not unloaded) or (torque == "command" and (subject in OF_CURRENT or kind == "two")):
        torque = "motor"
    closed = rng.random() < CLOSED_LOOP and not smooth
    controller = str(rng.choice(CONTROLLERS))
    return Circumstances(
        interval=1 / rate,
        duration=RATES[rate][1],
        link_side=link_side,
        step=step,
        torque=torque,
        controller=controller if closed else None,
        quiet=COMMAND_NOISE if torque == "command" else 1.0,
    )
