"""Ways in which the forms of effects may bend: tables over the argument, harmonics, variants of a parameter."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from jointwear.effects.effect import AxisFunction, Bend, Parameters
from jointwear.effects.holes import Law
from jointwear.effects.order import change_by_delay, second_derivative
from jointwear.effects.state import State
from jointwear.effects.tables import hats, knots_of

Shape = Callable[[State, int, Parameters], tuple[np.ndarray, np.ndarray]]
BendColumns = Callable[[State, int, int | None, Parameters, Any], np.ndarray]

#: Harmonics of a wave over the motor angle, and the knots of their table in a robot file.
HARMONICS, KNOTS_OF_A_TURN = (2, 3), 97
#: Delays of torque [s] beside that of an effect of timing.
DELAYS = (0.006, 0.018, -0.006)


def table_bend(shape: Shape, count: int = 8, per_wave: int = 0, law: Law | None = None) -> Bend:
    """Return the bend of an effect carrier x f(argument): f is corrected by a table of `count` knots.

    Parameters
    ----------
    per_wave : for a wave over the argument, knots in one wave (the parameter `order` counts waves in 2 pi), enough
        for its second harmonic and a slow change of its amplitude.
    law : the form at any argument, of an effect whose torque goes on straight beyond what was seen, as far again: so
        does its correction in a robot file, and in holes between it is weak.
    """

    def knots(state, axis, source, p, used):
        _, argument = shape(state, axis, p)
        bases = count
        if per_wave:
            span = float(np.ptp(argument[used]))
            bases = int(np.clip(round(span * p["order"] * per_wave / (2 * np.pi)), 6, 40))
        return knots_of(argument[used], bases)

    def columns(state, axis, source, p, table):
        carrier, argument = shape(state, axis, p)
        return carrier[:, None] * hats(argument, table)

    return Bend(columns, knots, written_as_table if law is None else written_straight_on, law)


def written_straight_on(parameters: Parameters, knots: np.ndarray, coefficients: np.ndarray) -> list[dict[str, Any]]:
    """Return the same with a table whose outer pieces go on as far as the table is wide, at either end."""
    wide, slope = knots[-1] - knots[0], np.diff(coefficients) / np.diff(knots)
    values = [coefficients[0] - slope[0] * wide, *coefficients, coefficients[-1] + slope[-1] * wide]
    return written_as_table(parameters, np.array([knots[0] - wide, *knots, knots[-1] + wide]), np.array(values))


def written_as_table(parameters: Parameters, knots: np.ndarray, coefficients: np.ndarray) -> list[dict[str, Any]]:
    """Return one entry whose `correction` holds the bends."""
    return [{**parameters, "correction": {"knots": knots, "values": coefficients}}]


def harmonics_bend(columns: AxisFunction, beside: BendColumns) -> Bend:
    """Return the bend of a wave over the motor angle: its harmonics; a robot file holds them as a table of one turn.

    Parameters
    ----------
    beside : further columns, of a recording and not of the robot: no file holds them.
    """

    def bent(state, axis, source, p, knots):
        waves = [columns(state, axis, source, {**p, "order": k * p["order"]}) for k in HARMONICS]
        return np.concatenate([*waves, beside(state, axis, source, p, knots)], axis=1)

    def written(parameters, knots, coefficients):
        angle = np.linspace(0, 2 * np.pi, KNOTS_OF_A_TURN)
        values = sum(
            coefficients[2 * i] * np.sin(k * angle) + coefficients[2 * i + 1] * np.cos(k * angle)
            for i, k in enumerate(HARMONICS)
        )
        return [{**parameters, "correction": {"knots": angle, "values": values}}]

    return Bend(bent, None, written)


def timing_bend() -> Bend:
    """Return the bend of an effect of timing: torque that is late by some delays, and its second derivatives.

    A robot file holds no such bends: what is written is the textbook form.
    """

    def columns(state, axis, source, p, knots):
        late = [change_by_delay(state, axis, d) for d in DELAYS]
        return np.stack([*late, *(second_derivative(state, x[:, axis]) for x in (state.torque, state.load))], axis=1)

    return Bend(columns)
