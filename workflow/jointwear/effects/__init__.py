"""The one library of effects, shared by simulation and discovery.

An effect is one file of :mod:`jointwear.effects.entries` that defines ``EFFECT``; adding a file adds the effect.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.effects.effect import Bend, Effect, Parameter, correction_torque
from jointwear.effects.state import Drive, State, make_state
from jointwear.files.errors import InputError, nearest, shown
from jointwear.files.wording import count
from jointwear.robots.robot import Robot

#: Folders whose files are effects too, besides :mod:`jointwear.effects.entries`.
_MORE: list[Path] = []


@cache
def library() -> dict[str, Effect]:
    """Return every effect by identifier, in alphabetical order of the files.

    Raises
    ------
    InputError : naming the file that defines no effect, or one that cannot be.
    """
    from jointwear.effects import entries

    folders = [*map(Path, entries.__path__), *_MORE]
    files = sorted((p for f in folders for p in f.glob("*.py") if p.stem != "__init__"), key=lambda p: p.stem)
    found = {path.stem: _effect_of(path) for path in files}
    for path in files:
        _check_entry(path, found[path.stem], found)
    return found


def _effect_of(path: Path) -> Effect:
    try:
        if path.parent not in _MORE:
            module = importlib.import_module(f"jointwear.effects.entries.{path.stem}")
        else:
            spec = importlib.util.spec_from_file_location(f"jointwear_effect_{path.stem}", path)
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
    except (SyntaxError, ImportError, TypeError, NameError, AttributeError) as error:
        raise InputError(f"{path}: is no effect: {type(error).__name__}: {error}") from error
    effect = getattr(module, "EFFECT", None)
    if not isinstance(effect, Effect):
        raise InputError(f"{path}: defines no EFFECT; an effect is a file with EFFECT = Effect(...)")
    return effect


def _check_entry(path: Path, effect: Effect, known: Iterable[str]) -> None:
    """Check what an effect says of itself against its file and the identifiers that are known."""
    if effect.identifier != path.stem:
        raise InputError(f"{path}: 'identifier' is '{effect.identifier}', the file says '{path.stem}'")
    for name in effect.confused_with:
        if name not in known:
            raise InputError(f"{path}: 'confused_with' names '{name}', no effect of the library{nearest(name, known)}")
    for parameter in effect.parameters:
        if not parameter.lower < parameter.upper:
            bounds = f"{parameter.lower:g} to {parameter.upper:g}"
            raise InputError(f"{path}: parameter '{parameter.name}' goes from {bounds}; the lower bound comes first")


@contextmanager
def more_entries(folder: str | Path) -> Iterator[None]:
    """Let the files of a further folder be effects of the library too, within a `with` statement."""
    _MORE.append(Path(folder))
    library.cache_clear()
    try:
        yield
    finally:
        _MORE.remove(Path(folder))
        library.cache_clear()


def get_effect(identifier: str) -> Effect:
    """Return one effect.

    Raises
    ------
    InputError : if the library has no effect of that name.
    """
    effects = library()
    if identifier not in effects:
        raise InputError(f"unknown effect '{identifier}'{nearest(identifier, effects)} (allowed: {', '.join(effects)})")
    return effects[identifier]


def check_effects(robot: Robot) -> None:
    """Check the `effects` of a robot against the library.

    Raises
    ------
    InputError : names the entry and key that is wrong and what is allowed.
    """
    check_entries([asdict(entry) for entry in robot.effects], robot.joints, f"robot '{robot.name}'")


def check_entries(entries: Sequence[Mapping[str, Any]], joints: int, name: str) -> None:
    """Check `effects` as a robot file has them against the library.

    Parameters
    ----------
    entries : with `effect` and, where given, `axis`, `source_axis` and `parameters`. joints : of the robot.
    name : what a message calls the robot: its name or its file.

    Raises
    ------
    InputError : names the entry and key that is wrong and what is allowed.
    """
    for i, entry in enumerate(entries):
        where = f"{name}: 'effects[{i}]"
        identifier, axis, source = entry["effect"], entry.get("axis"), entry.get("source_axis")
        try:
            effect = get_effect(identifier)
        except InputError as error:
            raise InputError(f"{where}.effect': {error}") from None
        if not effect.identifiable:
            raise InputError(f"{where}.effect' is '{identifier}', which has no torque function: {effect.reason}")
        if not effect.whole_arm and axis is None:
            raise InputError(f"{where}.axis' is missing; '{identifier}' acts on one axis (allowed: 1 to {joints})")
        if effect.needs_source and source is None:
            raise InputError(f"{where}.source_axis' is missing; '{identifier}' comes from another axis")
        if effect.needs_source and source == axis:
            raise InputError(f"{where}.source_axis' is {axis}, as is 'axis'; it must be another one")
        known = {p.name: p for p in effect.parameters}
        for key, value in (entry.get("parameters") or {}).items():
            if key == "correction" and effect.shape is not None:
                _check_table(f"{where}.parameters.correction'", value)
                continue
            if key not in known:
                raise InputError(
                    f"{where}.parameters': unknown key '{key}'{nearest(key, known)} (allowed: {', '.join(known)})"
                )
            if not isinstance(value, (int, float)) or not known[key].lower <= value <= known[key].upper:
                low, high = known[key].lower, known[key].upper
                near = (
                    f"; the nearest valid value is {min(max(value, low), high)}"
                    if isinstance(value, (int, float))
                    else ""
                )
                raise InputError(f"{where}.parameters.{key}' is {value!r} (allowed: >= {low} and <= {high}){near}")
        free = [p.name for p in effect.parameters if not p.fixed]
        if free and not set(entry.get("parameters") or {}) & {*free, "correction"}:
            raise InputError(f"{where}.parameters' says no size of '{identifier}' (allowed: {', '.join(free)})")
        if entry in entries[:i]:
            raise InputError(f"{where}' is the same as 'effects[{entries.index(entry)}]'; it would act twice")


def _check_table(where: str, table: Any) -> None:
    """Check a table ``{knots, values}``: between knots that fall an interpolation says anything."""
    if not isinstance(table, dict) or set(table) != {"knots", "values"}:
        raise InputError(f"{where} is {shown(table)}, must be a table of 'knots' and 'values'")
    for key, numbers in table.items():
        listed = isinstance(numbers, (list, np.ndarray)) and len(numbers) > 0
        if not listed or not all(isinstance(x, (int, float)) for x in numbers):
            raise InputError(f"{where[:-1]}.{key}' is {shown(numbers)}, must be a list of numbers")
    knots, values = table["knots"], table["values"]
    if len(knots) != len(values):
        raise InputError(f"{where} has {count(len(knots), 'knot')} and {count(len(values), 'value')}; one for each")
    if any(after < before for before, after in pairwise(knots)):
        raise InputError(f"{where[:-1]}.knots' is {shown(knots)}; knots must rise")


def effect_torque(robot: Robot, state: State) -> np.ndarray:
    """Return the torque that the effects of `robot` add to the nominal model. Shape (..., n) [N m].

    A payload belongs to ``Robot.payload``, which the rigid-body dynamics already know; an entry `payload` in
    ``effects`` is allowed where the state carries a `tip_regressor`. The same holds for a tilt of the base, which
    ``Robot.gravity`` says, and the `gravity_regressor`.

    Raises
    ------
    InputError : if an entry is unknown, or acts on the whole arm and the state does not carry what it needs.
    """
    total = np.zeros(np.shape(state.position))
    for entry in robot.effects:
        effect = get_effect(entry.effect)
        if effect.torque is None:
            raise InputError(f"robot '{robot.name}': effect '{entry.effect}' has no torque function: {effect.reason}")
        parameters = effect.complete(entry.parameters)
        if effect.whole_arm:
            total += effect.torque(state, 0, None, parameters)
            continue
        axis = entry.axis - 1
        source = None if entry.source_axis is None else entry.source_axis - 1
        if effect.spreads(parameters) and state.wind_up_regressor is not None:
            total += effect.spread(state, axis, source, parameters)
            continue
        total[..., axis] += effect.torque(state, axis, source, parameters)
        total[..., axis] += correction_torque(effect, state, axis, parameters)
    return total


__all__ = [
    "Bend",
    "Drive",
    "Effect",
    "Parameter",
    "State",
    "check_effects",
    "check_entries",
    "effect_torque",
    "get_effect",
    "library",
    "make_state",
    "more_entries",
]
