"""The link behind an elastic gear: how far the gear is wound up while the motor moves as recorded."""

from __future__ import annotations

import numpy as np
from scipy.linalg.blas import dtbsv

from jointwear.effects.state import State, record_slices

#: Least inertia [kg m2] of a link; a robot file may be wrong.
LEAST = 1e-9
#: Samples at the start of a record whose load is taken from the next one: derivatives are not known there, and a link
#: that is struck rings for long.
STRUCK = 8


def wind_up(
    state: State, load: np.ndarray, inertia: np.ndarray, stiffness: float, drag: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the wind-up [rad] of a gear and its second derivative [rad/s2], (m,), 0 without an order.

    J w'' + D w' + K w = load, with the load straight and the inertia constant between samples, which is solved exactly
    from sample to sample; a record starts settled.

    Parameters
    ----------
    load : (m,) torque that the gear would transmit if it were rigid [N m]. inertia : (m,) J of the link [kg m2].
    stiffness, drag : K [N m/rad] and D [N m s/rad].
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
    place, speed = _swung(state.time, pull, mass, stiffness, drag, np.array([part.start for part in parts], dtype=int))
    acceleration = (pull - stiffness * place - drag * speed) / mass
    for part in parts:
        if part.stop - part.start < 2:
            place[part] = acceleration[part] = 0.0
    return place, acceleration


def _swung(time, load, mass, stiffness, drag, starts) -> tuple[np.ndarray, np.ndarray]:
    """Return place and speed (m,) of an oscillator along records that begin at `starts`.

    All records are one system: what takes one sample to the next is none where a record begins.
    """
    step = np.diff(time)
    before = starts[1:] - 1
    step[before] = 1.0
    slope = np.append(np.diff(load) / step, 0.0)
    slope[before] = 0.0
    between = 0.5 * (mass[1:] + mass[:-1])
    square, decay = stiffness / between, drag / (2.0 * between)
    turn = np.sqrt(np.maximum(square - decay**2, 1e-9 * square))
    fade = np.exp(-decay * step)
    cosine, sine = fade * np.cos(turn * step), fade * np.sin(turn * step) / turn
    # About the motion that follows a straight load without swinging.
    straight = slope[:-1]
    start, rate = load[:-1] / stiffness - straight * drag / stiffness**2, straight / stiffness
    # Speeds in units of the swing, so that all entries are of one size.
    unit = float(np.sqrt(np.mean(square)))
    own, cross = cosine + decay * sine, sine
    back, held = -square * sine, cosine - decay * sine
    count = len(time)
    known = np.zeros(2 * count)
    known[2::2] = start + rate * step - own * start - cross * rate
    known[3::2] = (rate - back * start - held * rate) / unit
    known[2 * starts], known[2 * starts + 1] = load[starts] / stiffness, slope[starts] / stiffness / unit
    for share in (own, cross, back, held):
        share[before] = 0.0
    # Every sample follows from the one before: a triangle of four diagonals.
    band = np.zeros((4, 2 * count), order="F")
    band[0] = 1.0
    band[2, 0:-2:2], band[1, 1:-2:2] = -own, -cross * unit
    band[3, 0:-2:2], band[2, 1:-2:2] = -back / unit, -held
    solved = dtbsv(3, band, known, lower=1, diag=1)
    return solved[::2], solved[1::2] * unit
