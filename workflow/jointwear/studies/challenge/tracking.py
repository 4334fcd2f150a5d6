"""A closed loop in place of a perfect motion: forward dynamics under a controller, with the error it leaves."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from jointwear.studies.challenge.arm import Arm
from jointwear.studies.challenge.motion import Path, SampledPath
from jointwear.studies.challenge.surroundings import Temperatures
from jointwear.studies.challenge.world import PlantState

#: Speed [rad/s] over which friction turns its sign in the loop; without it the integration would chatter.
_SIGN_WIDTH = 4e-3
#: Position error [rad] of a loop that has lost its path.
LOST = 1.0
#: Step of the integration [s].
STEP = 1e-3
#: How often a loop that loses its path is tuned down.
_TRIES = 4


def track(
    arm: Arm,
    nominal: Arm,
    paths: Sequence[Path],
    starts: np.ndarray,
    heat: Temperatures,
    duration: float,
    bandwidth: float,
    law: Callable[[PlantState], np.ndarray] | None = None,
    integral: bool = False,
) -> list[SampledPath]:
    """Let a controller drive the arm along the paths, all recordings side by side.

    Parameters
    ----------
    arm : the arm that moves. nominal : the arm that the controller's feed-forward believes in.
    paths : r wanted motions. duration : of each [s].
    bandwidth : natural frequency of the PD loop [Hz]; it is critically damped with the mean mass of each joint.
    law : a hidden torque (r, n) [N m] that the arm feels, of the state (r rows; load and acceleration are zero).
    integral : the controller also adds up the position error, four times as slowly.

    Returns
    -------
    list : what really moved, one a path, with the torque of the controller.
    """
    count = round(duration / STEP) + 1
    clock = STEP * np.arange(count)
    wanted = np.array([p.at(clock) for p in paths])  # (r, 3, m, n)
    rows, n = len(paths), arm.robot.joints
    feed = np.array([nominal.torque(*w) for w in wanted])
    warm = np.array([heat.at(np.full(count, r), clock) for r in range(rows)])
    masses = np.concatenate([nominal.mass_matrix(w[0, ::200]) for w in wanted])
    typical = np.diagonal(masses, axis1=1, axis2=2).mean(axis=0)
    rate = 2 * np.pi * bandwidth
    stiff, damp = typical * rate**2, 2 * typical * rate
    positive, negative, viscous = arm.robot.coulomb_positive, arm.robot.coulomb_negative, arm.robot.viscous
    kept = np.empty((4, rows, count, n))
    q, v = wanted[:, 0, 0].copy(), wanted[:, 1, 0].copy()
    rest, numbers, empty = np.zeros((rows, n)), np.arange(rows), np.zeros((rows, n))
    last, summed = np.zeros((rows, n)), np.zeros((rows, n))
    for k in range(count):
        torque = feed[:, k] + stiff * (wanted[:, 0, k] - q) + damp * (wanted[:, 1, k] - v)
        if integral:
            summed += STEP * rate / 4 * stiff * (wanted[:, 0, k] - q)
            torque = torque + summed
        # Everything is taken in the middle of the step, so that torque and motion belong to the same instant.
        middle, speed = q + STEP / 2 * v, v + STEP / 2 * last
        turn = np.tanh(speed / _SIGN_WIDTH)
        level = np.where(speed > 0, positive, -negative)
        friction, slope = viscous * speed + level * turn, viscous + level * (1 - turn**2) / _SIGN_WIDTH
        if law is not None:
            state = PlantState(starts + clock[k], numbers, middle, speed, empty, warm[:, k], empty, empty)
            friction = friction + law(state) * np.abs(turn)
        # Linearly implicit in the friction: its slope near standstill is too steep for an explicit step.
        mass = arm.mass_matrix(middle) + STEP / 2 * slope[:, :, None] * np.eye(n)
        force = torque - arm.load(middle, speed, rest) - friction + STEP / 2 * slope * last
        a = np.linalg.solve(mass, force[..., None])[..., 0]
        kept[0, :, k], kept[1, :, k] = middle + STEP**2 / 8 * a, v + STEP / 2 * a
        kept[2, :, k], kept[3, :, k] = a, torque
        q, v, last = q + STEP * v + STEP**2 / 2 * a, v + STEP * a, a
    return [SampledPath(STEP, *kept[:, r]) for r in range(rows)]


class ArmLost(ArithmeticError):
    """No controller keeps an arm on its paths."""


def tuned_down(
    drive: Callable[[float], list[SampledPath]], paths: Sequence[Path], bandwidth: float, arm: str
) -> list[SampledPath]:
    """Return what `drive` makes of a bandwidth [Hz], or of half of it and so on where the arm loses its paths.

    Joints of light wrists pull at each other: whoever sets up such a robot tunes its loop down.

    Raises
    ------
    ArmLost : if no bandwidth down to an eighth keeps the arm on its paths.
    """
    for halving in range(_TRIES):
        with np.errstate(over="ignore", invalid="ignore"):
            moved = drive(bandwidth / 2**halving)
        if all(_on_path(m, p) for m, p in zip(moved, paths, strict=True)):
            return moved
    raise ArmLost(f"the controller loses '{arm}' even at {bandwidth / 2 ** (_TRIES - 1):.3g} Hz")


def _on_path(moved: SampledPath, wanted: Path) -> bool:
    clock = moved.step * np.arange(len(moved.position))
    return follows(moved.position, wanted.at(clock)[0])


def follows(position: np.ndarray, wanted: np.ndarray) -> bool:
    """Return whether positions (m, n) [rad] stay within :data:`LOST` of those that a controller asked for."""
    return bool(np.all(np.abs(position - wanted) < LOST))
