"""The shape of one entry of the effect library."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.effects.state import State

#: Names that begin with one of a person keep its capital within a sentence.
_PEOPLE = ("Coulomb", "Stribeck")

Parameters = Mapping[str, Any]
#: (state, axis, source axis, parameters) -> array; axes are 0-based.
AxisFunction = Callable[[State, int, "int | None", Parameters], np.ndarray]


@dataclass(frozen=True)
class Parameter:
    """A number of an effect. A `fixed` one is a convention (such as a reference temperature), never estimated."""

    name: str
    unit: str
    lower: float
    upper: float
    description: str
    default: float = 0.0
    fixed: bool = False


@dataclass(frozen=True)
class Effect:
    """A physical effect that a joint-torque simulation may miss.

    Attributes
    ----------
    identifier : name in robot files and verdicts.
    name, equation, source : for the report; plain words, formula, and where the formula is from.
    parameters : in the order in which the report lists them.
    confused_with : identifiers that look alike, and the motion that tells them apart (`excitation`).
    torque : torque on the axis, shape (...,); for an effect on the whole arm (..., n).
    columns : linear regressors at given nonlinear parameters, (..., k); whole arm (..., n, k).
    parameters_of : parameters from the nonlinear ones and the k coefficients of `columns`.
    grid : nonlinear parameters to try on a given state and axis; empty where the state cannot show the effect.
    shape : (carrier, argument) with torque = carrier x function(argument), each (...,), or None. It lets the
        function be corrected by a table over the argument.
    plain : nonlinear parameters of the simplest forms, simplest first, taken where the data do not decide.
    needs_source : the effect comes from another axis. whole_arm : it acts on all axes at once.
    sequential : depends on the order of samples; without an order it acts in its settled limit, with zero torque.
    identifiable : False where torque and position alone cannot show it at all (`reason` says why).
    """

    identifier: str
    name: str
    equation: str
    parameters: tuple[Parameter, ...]
    confused_with: tuple[str, ...]
    excitation: str
    source: str
    argument: str
    argument_unit: str
    torque: AxisFunction | None
    columns: AxisFunction | None
    parameters_of: Callable[[Parameters, np.ndarray], dict[str, float]] | None
    grid: Callable[[State, int], Sequence[Parameters]]
    shape: Callable[[State, int, Parameters], tuple[np.ndarray, np.ndarray]] | None = None
    plain: Callable[[State, int], Sequence[Parameters]] = lambda state, axis: []
    needs_source: bool = False
    whole_arm: bool = False
    sequential: bool = False
    identifiable: bool = True
    reason: str = ""

    @property
    def phrase(self) -> str:
        """The name as it stands within a sentence: "wear: growing Coulomb friction", but "Stribeck friction"."""
        return self.name if self.name.startswith(_PEOPLE) else self.name[0].lower() + self.name[1:]

    def complete(self, parameters: Parameters) -> dict[str, Any]:
        """Return `parameters` with defaults filled in."""
        return {**{p.name: p.default for p in self.parameters}, **parameters}


def correction_torque(effect: Effect, state: State, axis: int, parameters: Parameters) -> np.ndarray | float:
    """Return the torque of the table ``correction: {knots, values}`` of `parameters`, 0 without one.

    The table is piecewise linear in the argument of the effect, held constant beyond its ends, and multiplies
    the carrier of the effect: a form that the data give where the textbook form does not fit.
    """
    table = parameters.get("correction")
    if not table or effect.shape is None:
        return 0.0
    carrier, argument = effect.shape(state, axis, parameters)
    return carrier * np.interp(argument, table["knots"], table["values"])
