"""The shape of one entry of the effect library: all that is special about an effect, so that nothing else knows it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.effects.needs import ALL as NEEDS
from jointwear.effects.state import State
from jointwear.robots.robot import Robot

#: Names that begin with one of a person keep its capital within a sentence.
_PEOPLE = ("Coulomb", "Stribeck")

Parameters = Mapping[str, Any]
#: (state, axis, source axis, parameters) -> array; axes are 0-based.
AxisFunction = Callable[[State, int, "int | None", Parameters], np.ndarray]


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect.

    A `fixed` one is a convention (such as a reference temperature), never estimated. One that is not `searched` stays
    on the values of the grid, because between them the effect means nothing (waves per turn of a motor are whole).
    """

    name: str
    unit: str
    lower: float
    upper: float
    description: str
    default: float = 0.0
    fixed: bool = False
    searched: bool = True


@dataclass(frozen=True)
class Derived:
    """A quantity that follows from the parameters of an effect; `value` returns None where it does not."""

    name: str
    unit: str
    description: str
    value: Callable[[Parameters], float | None]


@dataclass(frozen=True)
class Bend:
    """How the form of an effect may differ from that of its textbook.

    Attributes
    ----------
    columns : (state, axis, source, nonlinear, knots) -> flexible columns (m, k) over the effect's own argument.
    knots : (state, axis, source, nonlinear, used (m,)) -> knots (k,) of a table over that argument, empty where the
        samples `used` leave no room for one; None as the attribute where `columns` needs no knots.
    written : (parameters, knots, coefficients (k,)) -> the parameters of the entries of a robot file that hold the
        effect and its bends; None where a robot file can only hold the textbook form.
    law : (parameters, argument (k,)) -> the textbook form (k,) at any argument, where what is written of a bent one has
        to say something of holes in the arguments that were seen; None where nothing is asked.
    """

    columns: Callable[[State, int, int | None, Parameters, np.ndarray | None], np.ndarray]
    knots: Callable[[State, int, int | None, Parameters, np.ndarray], np.ndarray] | None = None
    written: Callable[[Parameters, np.ndarray | None, np.ndarray], list[dict[str, Any]]] | None = None
    law: Callable[[Parameters, np.ndarray], np.ndarray] | None = None


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
    needs : what the data must hold for the effect to be tried, names of :data:`jointwear.effects.needs.ALL`.
    shape : (carrier, argument) with torque = carrier x function(argument), each (...,), or None. It lets the
        function be corrected by a table over the argument.
    bend : how the form may differ from the textbook's, or None where it is exact.
    plain : nonlinear parameters of the simplest forms, simplest first, taken where the data do not decide.
    slower : nonlinear parameters from which forms of the same kind are searched that say less, as of waves over time
        slower ones, those that say least first; of those that are as good the first is taken.
    courses : nonlinear parameters of forms over time of which none is likelier than another before the data speak; of
        those that are as good the one is taken that is nearest to the average of all.
    alternatives : other nonlinear parameters of the same size that the search of a continuous one cannot reach.
    begins : the same with the other states in which records may begin, which is no part of the form, and with what a
        rest does to them.
    further : nonlinear parameters of forms that no point of the grid is like, for the fit behind the noise.
    alike : nonlinear parameters that look alike on a short travel; the one of the smallest coefficients is taken
        where the data do not decide.
    scaled : the one parameter in which the torque is nearly, not quite, linear: it is searched like a nonlinear one,
        with a coefficient of one, and the last fit's coefficient scales it.
    timing : made of rates of change of the torque, so that the noise of derived accelerations is part of the columns.
    shifts : parameters -> whether an effect is the torque itself at another time: it holds as much noise, of which
        hardly any lies along that of the residual.
    late : its `scaled` parameter is the time [s] by which the torque is late.
    of_load : of these, made of the load alone, which the measured torque tells as well as the motion.
    band : of these, the parameter that says up to which frequency [Hz] a robot file has the load, because noise of the
        motion is more above; empty: it has all of it.
    of_drive : a share of all that a drive gives: without a load on the axis, friction and motor inertia say the same.
    rubs : how many of its first coefficients are friction, without which it is another thing; 0: it need not rub.
    of_torque : its columns are in proportion to the torque of the robot file (`State.torque`), and as wrong as that.
    vanishes_at : the parameter that says at which argument the torque is zero ("reference" of a temperature).
    floats : where the torque is zero is not known from the data, because a constant is a correction of the friction.
    widths : prior standard deviations of the coefficients, as multiples of what is usual; empty: all usual.
    waves : (state, axis, nonlinear) -> waves in one radian of the joint, where a fast joint may outrun the sampling.
    as_wound : over the positions or loads of its joint it looks like the wind-up of a gear further in.
    as_seen : the form is a curve through the arguments that were seen and no law: beyond them it may be another.
    left : (state, axis, nonlinear) -> share (...,) of such a wave that the filters of a recording leave.
    regime : (state, axis, source, nonlinear) -> values (...,) of the argument; the argument of `shape` by default.
    needs_source : the effect comes from another axis. whole_arm : it acts on all axes at once.
    spreads : parameters -> whether the effect, one of an axis, acts on the others too.
    spread : torque (..., n) on every axis of an effect that spreads; `torque` and `columns` are those of its own axis.
        Its one coefficient is one: its size is in its parameters.
    prior : robot -> prior standard deviations (k,) of the coefficients of an effect on the whole arm.
    sound : parameters -> whether something with these parameters may exist at all, as a body; None: any may.
    agree : parameters that each lie within their bounds -> whether all together they are those of such an effect: what
        else has its torque has another name.
    least : robot -> the lowest values (k,) of the coefficients of an effect on the whole arm: a robot can lack no more
        than it has; None: no coefficient has one.
    nearest : (robot, coefficients (k,), their precision (k, k)) -> the coefficients nearest to them, by that precision,
        of something that may exist; None: any may.
    leading : how many of the first coefficients an effect on the whole arm is known by; 0: all.
    writes : (content of a robot file, parameters) -> content in which the effect is part of the robot itself, for an
        effect that is no entry of `effects`.
    sequential : depends on the order of samples; without an order it acts in its settled limit, with zero torque.
    derived : what follows from the parameters and is what a reader asks for.
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
    needs: tuple[str, ...] = ()
    shape: Callable[[State, int, Parameters], tuple[np.ndarray, np.ndarray]] | None = None
    bend: Bend | None = None
    plain: Callable[[State, int], Sequence[Parameters]] = lambda state, axis: []
    slower: Callable[[State, int, Parameters], Sequence[Parameters]] = lambda state, axis, p: []
    courses: Callable[[State, int], Sequence[Parameters]] = lambda state, axis: []
    alternatives: Callable[[Parameters], Sequence[Parameters]] = lambda p: []
    begins: Callable[[Parameters], Sequence[Parameters]] = lambda p: []
    further: Callable[[State, int], Sequence[Parameters]] = lambda state, axis: []
    alike: Callable[[Parameters], Sequence[Parameters]] = lambda p: []
    scaled: str = ""
    timing: bool = False
    shifts: Callable[[Parameters], bool] = lambda parameters: False
    late: bool = False
    of_load: bool = False
    band: str = ""
    of_drive: bool = False
    rubs: int = 0
    of_torque: bool = False
    vanishes_at: str = ""
    floats: bool = False
    as_wound: bool = False
    as_seen: bool = False
    widths: tuple[float, ...] = ()
    waves: Callable[[State, int, Parameters], float] | None = None
    left: Callable[[State, int, Parameters], np.ndarray | float] | None = None
    regime: AxisFunction | None = None
    needs_source: bool = False
    whole_arm: bool = False
    spreads: Callable[[Parameters], bool] = lambda parameters: False
    spread: AxisFunction | None = None
    prior: Callable[[Robot], np.ndarray] | None = None
    sound: Callable[[Parameters], bool] | None = None
    agree: Callable[[Parameters], bool] = lambda parameters: True
    least: Callable[[Robot], np.ndarray] | None = None
    nearest: Callable[[Robot, np.ndarray, np.ndarray], np.ndarray] | None = None
    leading: int = 0
    writes: Callable[[dict[str, Any], Parameters], dict[str, Any]] | None = None
    sequential: bool = False
    derived: tuple[Derived, ...] = ()
    identifiable: bool = True
    reason: str = ""

    @property
    def phrase(self) -> str:
        """The name as it stands within a sentence: "wear: growing Coulomb friction", but "Stribeck friction"."""
        return self.name if self.name.startswith(_PEOPLE) else self.name[0].lower() + self.name[1:]

    @property
    def follows_time(self) -> bool:
        """Whether the torque changes with time itself, so that it must hold for the time to come."""
        return "time" in self.needs

    @property
    def follows_temperature(self) -> bool:
        """Whether the torque changes with the temperature, and so from what was seen to warmer or colder joints."""
        return "temperature" in self.needs

    def complete(self, parameters: Parameters) -> dict[str, Any]:
        """Return `parameters` with defaults filled in."""
        return {**{p.name: p.default for p in self.parameters}, **parameters}

    def possible(self, parameters: Parameters) -> bool:
        """Return whether every parameter lies within its bounds, and all agree: no friction that drives."""
        return self.beyond(parameters) is None and self.agree(parameters)

    def beyond(self, parameters: Parameters) -> tuple[str, float, float] | None:
        """Return the first parameter beyond a bound, as a name with its unit, its value and the bound; None if none."""
        for p in self.parameters:
            value = parameters.get(p.name, p.default)
            if not p.lower <= value <= p.upper:
                most, bound = ("at most", p.upper) if value > p.upper else ("at least", p.lower)
                return f"its {p.name} [{p.unit}], {most}", float(value), float(bound)
        return None

    def bounded(self, parameters: Parameters) -> dict[str, Any]:
        """Return `parameters` moved to the nearest values that a robot file takes; tables are left alone."""
        bounds = {p.name: p for p in self.parameters}
        return {
            name: float(np.clip(value, bounds[name].lower, bounds[name].upper)) if name in bounds else value
            for name, value in parameters.items()
        }

    def unmet(self, state: State, axis: int) -> str:
        """Return in words why `state` does not allow the effect on `axis` to be tried; empty where it does."""
        if not self.identifiable:
            return self.reason
        for need in self.needs:
            why = NEEDS[need](state, axis)
            if why:
                return why
        return ""

    def searched(self, nonlinear: Parameters) -> list[Parameter]:
        """Return the nonlinear parameters that a search may move off the grid."""
        known = {p.name: p for p in self.parameters}
        if self.needs_source or self.whole_arm:
            return []
        return [known[name] for name in nonlinear if known[name].searched and not known[name].fixed]

    def argument_of(self, state: State, axis: int, source: int | None, nonlinear: Parameters) -> tuple[np.ndarray, str]:
        """Return values (...,) and unit of the argument of the torque; the position where it is no plain function."""
        if self.regime is not None:
            return self.regime(state, axis, source, nonlinear), self.argument_unit
        if self.shape is not None:
            return self.shape(state, axis, nonlinear)[1], self.argument_unit
        return state.position[..., axis], "rad"

    @property
    def argument_in_words(self) -> str:
        """What :meth:`argument_of` gives the values of."""
        plain = self.regime is not None or self.shape is not None or self.whole_arm
        return self.argument if plain else "position"


def correction_torque(effect: Effect, state: State, axis: int, parameters: Parameters) -> np.ndarray | float:
    """Return the torque (N,) [N m] of the table ``correction: {knots, values}`` of `parameters`, 0 without one.

    The table is piecewise linear in the argument of the effect, held constant beyond its ends, and multiplies
    the carrier of the effect: a form that the data give where the textbook form does not fit.
    """
    table = parameters.get("correction")
    if not table or effect.shape is None:
        return 0.0
    carrier, argument = effect.shape(state, axis, parameters)
    return carrier * np.interp(argument, table["knots"], table["values"])
