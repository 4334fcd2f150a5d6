"""The circumstances of a case: arm, encoders, rates, torque channel, controller, errors of the robot file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.studies.world.arms import ARMS, ArmKind
from jointwear.studies.world.control import CONTROLLERS

#: The recording that is held out; never the first or last.
TEST = 2
#: Relative standard deviation of inertial parameters that a user tells discovery.
INERTIAL_PRIOR = 0.05
#: Things that a torque sensor behind the gear can see.
LINK_SENSED = {
    "payload",
    "mounting_tilt",
    "joint_spring",
    "torque_constant_error",
    "torque_constant_temperature",
    "torque_offset_drift",
    "link_inertia",
    "push",
    "gusts",
    "wall",
    "bump",
    "two_joint_hose",
    "tremor",
    None,
}
#: Things that belong to a current turned into torque.
CURRENT = {"torque_constant_error", "torque_constant_ripple", "torque_constant_temperature", "torque_offset_drift"}
#: Things over the motor angle.
GEARED = {"cogging_torque", "torque_constant_ripple"}
_RATES = (30, 50, 100, 125, 200, 250, 500, 1000)
_RATE_SHARES = (0.05, 0.1, 0.2, 0.2, 0.15, 0.15, 0.1, 0.05)
_LINK_BITS = (13, 15, 16, 17, 18, 19, 20, 22, 24, 0)
_LINK_SHARES = (0.03, 0.05, 0.07, 0.15, 0.1, 0.2, 0.15, 0.1, 0.05, 0.1)
#: Bits by which a controller reads less than the log holds, in the seven of ten whose controllers see steps at all.
_COARSER, _COARSER_SHARES = (0, 2, 4), (0.7, 0.2, 0.1)
#: Fewest bits that a controller reads.
_FEWEST_BITS = 13


@dataclass(frozen=True)
class Setting:
    """Circumstances of a case.

    Attributes
    ----------
    rate : of the log [Hz]. sub : simulation steps in one interval of the log.
    bits : of the encoders over a turn of the motor or of the joint; 0 is exact. link_side : encoders behind the gears.
    bits_read : of the positions that the controller reads; 0 reads them exactly.
    torque : "motor" (from current), "command" or "link_sensor".
    motors_in_file : the robot file has inertia and friction of the motors, whether or not the torque shows them.
    noise : standard deviation of the torque noise over that of the axis's torque. colour : its autoregression.
    inertial_error, drive_error : relative standard deviation of the errors of the robot file.
    gear_known : the robot file has gear ratios; otherwise 1. velocity, temperature : logged.
    velocity_lag : time constant [s] by which the logged velocity is smoothed; 0 is none.
    """

    arm: ArmKind
    rate: int
    sub: int
    recordings: int
    duration: float
    bits: int
    bits_read: int
    link_side: bool
    torque: str
    motors_in_file: bool
    noise: float
    colour: float
    controller: str
    bandwidth: float
    motion: str
    inertial_error: float
    drive_error: float
    gear_known: bool
    velocity: bool
    velocity_lag: float
    temperature: bool

    @property
    def step(self) -> float:
        """Time step of the simulation [s]."""
        return 1 / (self.rate * self.sub)

    def encoder_step(self, bits: int, gear: np.ndarray) -> np.ndarray:
        """Return the step (n,) [rad] at the joints of encoders with so many bits a turn; 0 bits are exact."""
        if not bits:
            return np.zeros_like(gear)
        turn = 2 * np.pi / 2.0**bits
        return np.full_like(gear, turn) if self.link_side else turn / np.abs(gear)


def draw_setting(rng: np.random.Generator, subjects: list[str | None]) -> Setting:
    """Draw circumstances in which all `subjects` make sense."""
    arm = ARMS[str(rng.choice(list(ARMS)))]
    rate = int(rng.choice(_RATES, p=_RATE_SHARES))
    kinds = ["motor", "motor", "command", "link_sensor"]
    torque = str(rng.choice(kinds))
    if torque == "link_sensor" and not all(s in LINK_SENSED for s in subjects):
        torque = "motor"
    if torque == "command" and any(s in CURRENT for s in subjects):
        torque = "motor"
    link_side = bool(rng.random() < 0.5)
    bits = int(rng.choice(_LINK_BITS, p=_LINK_SHARES)) if link_side else int(rng.integers(13, 18))
    coarser = int(rng.choice(_COARSER, p=_COARSER_SHARES))
    reads_steps = bits and rng.random() < 0.7
    exact = rng.random() < 0.4
    errors = (0.0, 0.0) if exact else (float(rng.choice([0.02, 0.05])), float(rng.choice([0.05, 0.10])))
    noise = {"motor": rng.uniform(0.004, 0.03), "command": 5e-4, "link_sensor": rng.uniform(0.004, 0.015)}[torque]
    warm = any(s is not None and "temperature" in s for s in subjects)
    return Setting(
        arm=arm,
        rate=rate,
        sub=max(1, -(-1000 // rate)),
        recordings=int(rng.integers(4, 6)),
        duration=float(rng.uniform(7.0, 8.0) if rate >= 500 else rng.uniform(9.0, 13.0)),
        bits=bits,
        bits_read=max(bits - coarser, _FEWEST_BITS) if reads_steps else 0,
        link_side=link_side,
        torque=torque,
        motors_in_file=bool(torque != "link_sensor" or rng.random() < 0.5),
        noise=float(noise),
        colour=float(rng.uniform(0.5, 0.9)) if torque == "motor" and rng.random() < 0.4 else 0.0,
        controller=str(rng.choice(CONTROLLERS)),
        bandwidth=float(rng.uniform(14, 28)),
        motion=str(rng.choice(["fourier", "fourier", "transfer"])),
        inertial_error=errors[0],
        drive_error=errors[1],
        gear_known=bool(any(s in GEARED for s in subjects) or rng.random() < 0.6),
        velocity=bool(rng.random() < 0.4),
        velocity_lag=float(rng.uniform(0.003, 0.015) if rng.random() < 0.4 else 0.0),
        temperature=bool(warm or rng.random() < 0.6),
    )
