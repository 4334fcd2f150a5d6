"""Dimensions of the multiverse: ambiguities of :mod:`jointwear.reproduction.readings`, two parameters of the text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from jointwear.reproduction import readings

Value = str | float | int
Reading = dict[str, Value]

WEAR_SHAPES = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0)
CONSECUTIVE_HOURS = (1, 3, 5, 8)

# What a simulated torque depends on; everything else is analysis of the same torque.
SIMULATION = (
    "coulomb_direction",
    "disturbance_mean",
    "disturbance_return",
    "noise_draws",
    "noise_level",
    "training_length",
)


@dataclass(frozen=True)
class Dimension:
    """One choice that the text leaves open: its values, the default first, and the stage that asks it."""

    name: str
    stage: str
    values: tuple[Value, ...]
    question: str

    @property
    def default(self) -> Value:
        """The value of the default reading."""
        return self.values[0]


def _default_first(values: tuple[Value, ...], default: Value) -> tuple[Value, ...]:
    return (default, *(v for v in values if v != default))


def dimensions(defaults: Mapping[str, Value]) -> list[Dimension]:
    """Return every dimension, in the order of the stages of the workflow.

    Parameters
    ----------
    defaults : the reading of the config with `wear_shape` and `consecutive_hours`; see :func:`default_reading`.
    """
    order = ("simulation", "training", "features", "detection", "location")
    ambiguous = [
        Dimension(a.name, a.stage, _default_first(tuple(a.alternatives), defaults[a.name]), a.question)
        for stage in order
        for a in readings.ambiguities().values()
        if a.stage == stage
    ]
    return [
        Dimension(
            "wear_shape",
            "simulation",
            _default_first(WEAR_SHAPES, float(defaults["wear_shape"])),
            "How large is c2 x 120 h, the shape constant of equation (7)?",
        ),
        *ambiguous,
        Dimension(
            "consecutive_hours",
            "detection",
            _default_first(CONSECUTIVE_HOURS, int(defaults["consecutive_hours"])),
            "How many hours in a row above the limit make an onset?",
        ),
    ]


def default_reading(reading: Mapping[str, str], wear_shape: float, consecutive_hours: int) -> Reading:
    """Return the reading of the config as one point of the multiverse."""
    return {**reading, "wear_shape": float(wear_shape), "consecutive_hours": int(consecutive_hours)}


def part(reading: Mapping[str, Value], names: tuple[str, ...]) -> tuple[Value, ...]:
    """Return the values of some dimensions: the key under which work is shared."""
    return tuple(reading[name] for name in names)


def stage_names(*stages: str) -> tuple[str, ...]:
    """Return the ambiguities of the given stages, in alphabetical order."""
    return tuple(sorted(name for stage in stages for name in readings.of_stage(stage)))
