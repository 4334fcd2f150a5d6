"""Roles of measured quantities, their units, and how those are spelled."""

from __future__ import annotations

import difflib
import math
from typing import TYPE_CHECKING

from jointwear.files.errors import LONGEST_VALUE, InputError, shown
from jointwear.measurement.unit_terms import other_size, size_of_terms

if TYPE_CHECKING:
    import numpy as np  # read at every call of Snakemake: nothing heavy is imported

#: Kelvins of a degree Fahrenheit.
FAHRENHEIT = 5 / 9
ROLES = ("time", "trajectory", "position", "velocity", "acceleration", "torque", "temperature")
#: Factor (and offset) that turns a unit into the project's, by role.
UNITS: dict[str, dict[str, tuple[float, float]]] = {
    "time": {
        name: (seconds, 0.0)
        for name, seconds in {
            "s": 1.0,
            "ms": 1e-3,
            "us": 1e-6,
            "ns": 1e-9,
            "min": 60.0,
            "h": 3600.0,
            "d": 86400.0,
        }.items()
    },
    "trajectory": {"1": (1.0, 0.0)},
    "position": {"rad": (1.0, 0.0), "deg": (math.pi / 180, 0.0), "rev": (2 * math.pi, 0.0)},
    "velocity": {
        "rad/s": (1.0, 0.0),
        "deg/s": (math.pi / 180, 0.0),
        "rev/s": (2 * math.pi, 0.0),
        "rpm": (math.pi / 30, 0.0),
    },
    "acceleration": {"rad/s2": (1.0, 0.0), "deg/s2": (math.pi / 180, 0.0)},
    "torque": {
        name: (factor, 0.0)
        for name, factor in {
            "N m": 1.0,
            "mN m": 1e-3,
            "kN m": 1e3,
            "kgf m": 9.80665,
            "kgf cm": 0.0980665,
            "lbf ft": 1.3558179483314004,
            "lbf in": 0.1129848290276167,
            "N cm": 1e-2,
        }.items()
    },
    "temperature": {"degC": (1.0, 0.0), "K": (1.0, -273.15), "degF": (FAHRENHEIT, -32.0 * FAHRENHEIT)},
}
#: Units of positions in words.
POSITION_WORDS = {"rad": "radians", "deg": "degrees", "rev": "revolutions"}
SPELLINGS = {
    "degree/s": "deg/s", "degrees/s": "deg/s", "°/s": "deg/s", "deg/sec": "deg/s", "rad/sec": "rad/s",
    "radian/s": "rad/s", "radians/s": "rad/s", "dps": "deg/s", "degree/s2": "deg/s2", "degrees/s2": "deg/s2",
    "deg/s^2": "deg/s2", "°/s2": "deg/s2", "°/s^2": "deg/s2", "newton meter": "N m", "milliseconds": "ms",
    "millisecond": "ms", "msec": "ms", "microseconds": "us", "nanoseconds": "ns", "µs": "us",
    "ampere": "A", "Ampere": "A", "amperes": "A", "amp": "A", "amps": "A", "Amps": "A", "Prozent": "%",
    "Grad": "deg", "Grad/s": "deg/s",
    "degree": "deg", "degrees": "deg", "°": "deg", "radian": "rad", "radians": "rad", "Nm": "N m", "N.m": "N m",
    "N*m": "N m", "rad s-1": "rad/s", "deg s-1": "deg/s", "rad/s^2": "rad/s2", "rad s-2": "rad/s2", "celsius": "degC",
    "C": "degC", "°C": "degC", "F": "degF", "°F": "degF", "fahrenheit": "degF",
    "kelvin": "K", "second": "s", "seconds": "s", "sec": "s", "": "s",
    "minute": "min", "minutes": "min", "hour": "h", "hours": "h", "hr": "h", "day": "d", "days": "d",
    "N·m": "N m", "mNm": "mN m", "mN·m": "mN m", "mN*m": "mN m", "mN.m": "mN m", "Nmm": "mN m", "N mm": "mN m",
    "N·mm": "mN m", "N*mm": "mN m", "N.mm": "mN m", "Ncm": "N cm", "N·cm": "N cm", "N*cm": "N cm", "N.cm": "N cm",
    "kNm": "kN m", "kN·m": "kN m", "kgfm": "kgf m", "kgf·m": "kgf m",
    "kgfcm": "kgf cm", "kgf·cm": "kgf cm", "kgf-cm": "kgf cm", "lbft": "lbf ft", "lbf·ft": "lbf ft", "lb ft": "lbf ft",
    "ft lbf": "lbf ft", "ft-lbf": "lbf ft", "lbf-ft": "lbf ft", "lbin": "lbf in", "lbf·in": "lbf in", "lb in": "lbf in",
    "in lbf": "lbf in", "in-lbf": "lbf in", "lbf-in": "lbf in",
    "turn": "rev", "turns": "rev", "revolution": "rev", "revolutions": "rev", "revs": "rev",
    "RPM": "rpm", "r/min": "rpm", "rev/min": "rpm", "1/min": "rpm", "U/min": "rpm", "min-1": "rpm", "min^-1": "rpm",
    "rps": "rev/s", "turn/s": "rev/s", "turns/s": "rev/s", "U/s": "rev/s",
    "microsecond": "us", "usec": "us", "nanosecond": "ns", "nsec": "ns",
}  # fmt: skip


#: Units of what is logged as torque and is none: with a factor of the config it becomes one.
CURRENTS, SHARES = {"A": 1.0, "mA": 1e-3}, ("%", "percent", "1/1000")


def sizes_of(role: str) -> dict[str, float]:
    """Return the size of each unit of a role in the project's."""
    return {unit: size for unit, (size, _) in UNITS[role].items()}


#: What the German word for a degree means: elsewhere, and in its own field, it is a hundredth of a right angle.
_DEGREE_OR_GON = ("grad", "grads", "grade")


def size_of(role: str, unit: str) -> float:
    """Return the size of a unit of a role in the project's, 1 where it is not known."""
    known = UNITS[role].get(unit)
    return known[0] if known else size_of_terms(role, unit) or 1.0


def spelled(role: str, unit: str) -> str:
    """Return a unit of a role as :data:`UNITS` spells it, where it is known under any name; others as they are."""
    plain = str(unit).strip()
    if role == "time":
        # The length counts here; a date that the time counts from is the reader's matter.
        plain = plain.split(" since ")[0].strip()
    plain = SPELLINGS.get(plain, plain)
    if plain in UNITS[role] or (size := size_of_terms(role, plain)) is None:
        return plain
    return next((name for name, (own, _) in UNITS[role].items() if math.isclose(own, size, rel_tol=1e-9)), plain)


def is_known(role: str, unit: str) -> bool:
    """Return whether a unit of a role, as it is :func:`spelled`, can be read."""
    return unit in UNITS[role] or size_of_terms(role, unit) is not None


def meant_unit(role: str, unit: str) -> str:
    """Return a hint what was meant by a unit that is not known, or an empty string; none is told that differs from what
    is written by a factor."""
    plain, known = str(unit).strip(), [*UNITS[role], *((*CURRENTS, *SHARES) if role == "torque" else ())]
    head, _, rest = plain.partition("/")
    if head.strip().lower() in _DEGREE_OR_GON and role in ("position", "velocity", "acceleration"):
        behind = f"/{rest}" if rest else ""
        return f"; write 'deg{behind}' for degrees, 'gon{behind}' for hundredths of a right angle"
    # What is near a unit of torque by its letters alone is no current.
    currents = () if plain.lower().endswith(("a", "amp", "amps", "ampere", "amperes")) else CURRENTS
    named = {word: meant for word, meant in SPELLINGS.items() if word and meant in known}
    close = difflib.get_close_matches(plain[:LONGEST_VALUE], [w for w in (*known, *named) if w not in currents], 1, 0.5)
    return f"; did you mean '{named.get(close[0], close[0])}'?" if close and not other_size(plain, close[0]) else ""


def converted(values: np.ndarray, role: str, unit: str | None, name: str) -> np.ndarray:
    """Return values of a role in the unit of the project, of the shape that they have.

    Parameters
    ----------
    unit : that they are in; None for that of the project. name : of the data set, for messages.

    Raises
    ------
    InputError : if the unit is not known.
    """
    if unit is None:
        return values
    plain = spelled(role, unit)
    if not is_known(role, plain):
        if role == "trajectory":
            return values  # labels, whatever they are said to be
        raise InputError(
            f"data set '{name}': unit {shown(str(unit))} of {role} is not known{meant_unit(role, plain)} (allowed: "
            f"{', '.join(UNITS[role])})"
        )
    factor, offset = UNITS[role].get(plain) or (size_of(role, plain), 0.0)
    return values if (factor, offset) == (1.0, 0.0) else values * factor + offset
