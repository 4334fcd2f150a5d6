"""What may be hidden in a plant: one description for everything, and the instant that the running hooks see."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jointwear.studies.world.arms import Drives
from jointwear.studies.world.chains import Chain
from jointwear.studies.world.plant import Draft, DriveParameters, Plant


@dataclass
class Instant:
    """One step of a running plant. Hooks add to `friction`, `damping` and `force` (n,), which start at the drives'.

    `load` (n,) is the torque behind the gears [N m] of the step before, `temperature` (n,) [degC], `time` [s] since
    the first recording, `clock` [s] since the start of this one.
    """

    plant: Plant
    time: float
    clock: float
    recording: int
    position: np.ndarray
    velocity: np.ndarray
    temperature: np.ndarray
    load: np.ndarray
    friction: np.ndarray
    damping: np.ndarray
    force: np.ndarray


@dataclass
class Channel:
    """The torque channel of one recording at simulation steps: arrays (m, n), `step` [s] apart."""

    step: float
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    temperature: np.ndarray
    torque: np.ndarray


@dataclass(frozen=True)
class Scales:
    """From what sizes are drawn: the arm and its drives; lowest and highest position [rad], largest speed [rad/s],
    root mean square of the load [N m] and inertia [kg m2] of each axis (n,); `starts` and `span` of the recordings,
    `duration` of each [s]; `rate` of the log [Hz]."""

    chain: Chain
    drives: DriveParameters
    kind: Drives
    gear: np.ndarray
    low: np.ndarray
    high: np.ndarray
    speed: np.ndarray
    load: np.ndarray
    inertia: np.ndarray
    span: float
    starts: np.ndarray
    duration: float
    rate: float


@dataclass(frozen=True)
class Hidden:
    """Something that is in the plant or in its torque channel and not in the robot file.

    Attributes
    ----------
    name : identifier of the effect or disturbance. axis, source : 0-based; axis None is the whole arm.
    also : further axes on which it shows. form : MuJoCo's means. size, unit : how much.
    parameters : true values that a verdict should estimate, under the names of the library.
    build : changes the plant before it is built. step : acts at every control step.
    channel : returns what the recorder makes of the torque, (m, n). lag : time constant [s] and dead time [s] of the
        drive of the axis: the torque that acts comes after the one that is commanded.
    """

    name: str
    axis: int | None
    form: str
    size: float
    unit: str
    parameters: dict[str, float] = field(default_factory=dict)
    build: Callable[[Draft], None] | None = None
    step: Callable[[Instant], None] | None = None
    channel: Callable[[Channel], np.ndarray] | None = None
    lag: tuple[float, float] | None = None
    source: int | None = None
    also: tuple[int, ...] = ()
    facts: dict[str, Any] = field(default_factory=dict)
