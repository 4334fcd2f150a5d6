"""The link behind an elastic gear: how far the gear is wound up while the motor moves as recorded."""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dtbtrs

from jointwear.effects.state import State, record_slices

#: Least inertia [kg m2] of a link; a robot file may be wrong.
LEAST = 1e-9
#: Samples at the start of a record whose load is taken from the next one: derivatives are not known there, and a link
#: that is struck rings for long.
STRUCK = 8
#: Least part of its stiffness that gravity leaves a gear: with less the link would topple.
SOFTEST = 0.1
#: Times of its damping after which a free swing, then a thousandth, says nothing more of the start of its record.
FADED = 7.0


def wind_up(
    state: State,
    load: np.ndarray,
    inertia: np.ndarray,
    stiffness: float,
    drag: float,
    by_angle: np.ndarray | float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the wind-up [rad] of a gear and (J w')' / J [rad/s2], both (m,), 0 without an order.

    (J w')' + D w' + (K + g') w = load, the equation of motion of the link made linear about a rigid gear: the inertia
    J changes with the pose of what is behind, and gravity pulls a link back or on that is wound up. Load is straight
    and inertia constant between samples, between which that is solved exactly; a record starts settled.

    Parameters
    ----------
    load : (m,) torque that the gear would transmit if it were rigid [N m]. inertia : (m,) J of the link [kg m2].
    stiffness, drag : K [N m/rad] and D [N m s/rad]. by_angle : (m,) g', derivative of gravity by the angle of the link
    [N m/rad].
    """
    place, acceleration = np.zeros(len(load)), np.zeros(len(load))
    if state.record is None or stiffness <= 0:
        return place, acceleration
    parts = record_slices(state)
    if all(part.stop - part.start < 2 for part in parts):
        return place, acceleration
    mass, pull = np.maximum(inertia, LEAST), np.array(load, dtype=float)
    for part in parts:
        pull[part][:STRUCK] = pull[min(part.start + STRUCK, part.stop - 1)]
    back = np.maximum(stiffness + np.broadcast_to(by_angle, mass.shape), SOFTEST * stiffness)
    starts = np.array([part.start for part in parts], dtype=int)
    places, speeds = _swung(state.time, pull, mass, back, drag, starts)
    loads = np.stack([pull, np.zeros_like(pull), np.zeros_like(pull)], axis=-1)
    accelerations = (loads - back[:, None] * places - drag * speeds) / mass[:, None]
    # What a gear carries less what it would carry if it were rigid.
    felt = mass[:, None] * accelerations + (back - stiffness)[:, None] * places
    since = state.time - np.repeat(state.time[starts], np.diff(np.append(starts, len(mass))))
    felt[since * drag > FADED * 2.0 * mass] = 0.0
    free = _free_share(felt, starts)
    place = places[:, 0] - np.sum(free * places[:, 1:], axis=-1)
    acceleration = accelerations[:, 0] - np.sum(free * accelerations[:, 1:], axis=-1)
    for part in parts:
        if part.stop - part.start < 2:
            place[part] = acceleration[part] = 0.0
    return place, acceleration


def _free_share(felt: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return how much (m, 2) of two free swings of its record, the last columns of `felt` (m, 3), is in the first."""
    products = np.add.reduceat(felt[:, :, None] * felt[:, None, :], starts, axis=0)
    free, driven = products[:, 1:, 1:], products[:, 1:, 0]
    # Records of a sample or two do not hold both.
    shares = np.einsum("rij,rj->ri", np.linalg.pinv(free, rcond=1e-6, hermitian=True), driven)
    return np.repeat(shares, np.diff(np.append(starts, len(felt))), axis=0)


def _swung(time, load, mass, stiffness, drag, starts) -> tuple[np.ndarray, np.ndarray]:
    """Return places and speeds (m, 3) of an oscillator along records that begin at `starts`.

    The first column is driven by `load`, the others swing freely from a place and from a speed.

    All records are one system: what takes one sample to the next is none where a record begins.
    """
    step = np.diff(time)
    before = starts[1:] - 1
    step[before] = 1.0
    slope = np.append(np.diff(load) / step, 0.0)
    slope[before] = 0.0
    between, stiff = 0.5 * (mass[1:] + mass[:-1]), 0.5 * (stiffness[1:] + stiffness[:-1])
    square, decay = stiff / between, drag / (2.0 * between)
    turn = np.sqrt(np.maximum(square - decay**2, 1e-9 * square))
    fade = np.exp(-decay * step)
    cosine, sine = fade * np.cos(turn * step), fade * np.sin(turn * step) / turn
    # About the motion that follows a straight load without swinging.
    straight = slope[:-1]
    start, rate = load[:-1] / stiff - straight * drag / stiff**2, straight / stiff
    own, cross = cosine + decay * sine, sine
    back, held = -square * sine, cosine - decay * sine
    # It is the momentum that goes on where the inertia changes, in units of the swing so that entries are of one size.
    unit = float(np.sqrt(np.mean(square)) * np.mean(between))
    heavy = between / unit
    count = len(time)
    known = np.zeros((2 * count, 3), order="F")
    known[2::2, 0] = start + rate * step - own * start - cross * rate
    known[3::2, 0] = (rate - back * start - held * rate) * heavy
    known[2 * starts, 0] = load[starts] / stiffness[starts]
    known[2 * starts + 1, 0] = slope[starts] / stiffness[starts] * mass[starts] / unit
    known[2 * starts, 1] = known[2 * starts + 1, 2] = 1.0
    for share in (own, cross, back, held):
        share[before] = 0.0
    # Every sample follows from the one before: a triangle of four diagonals.
    band = np.zeros((4, 2 * count), order="F")
    band[0] = 1.0
    band[2, 0:-2:2], band[1, 1:-2:2] = -own, -cross / heavy
    band[3, 0:-2:2], band[2, 1:-2:2] = -back * heavy, -held
    solved, _ = dtbtrs(band, known, uplo="L", diag="U")
    return solved[::2], solved[1::2] * (unit / mass)[:, None]
