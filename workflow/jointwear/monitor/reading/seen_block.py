"""What the torques of one block of a log show beside wear: loads at the flange, how late they are, other zeros."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from jointwear.measurement.clock import Ordered
from jointwear.measurement.derived.even_steps import reaches
from jointwear.monitor.reading.accumulate import WindowSettings, moving
from jointwear.monitor.reading.carried import FoundLoad, LoadsOnMotion, carrying, found_loads
from jointwear.monitor.reading.derivation import Motion
from jointwear.monitor.reading.load_groups import together
from jointwear.monitor.reading.model import ModelTorque, TorqueModel
from jointwear.monitor.reading.survey import SLOWEST_RATE, Survey
from jointwear.monitor.reading.torque_lag import GLANCE, Lag, change_of, lag_of, pieces_of, plainly_none
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.reading.zeros import angles_of
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad


def model_torque(
    model: TorqueModel, around: Ordered, motion: Motion, usable: np.ndarray, dead_band: np.ndarray
) -> ModelTorque:
    """Return the torque of the model along a block, zeros if no sample (m, n) is usable; `dead_band` (n,) [rad/s]."""
    if not usable.any():
        zeros = np.zeros_like(around.chunk.position)
        return ModelTorque(zeros, zeros, zeros)
    # Only samples of axes that move are held against their gravity torque.
    moved = (np.abs(motion.velocity) > dead_band).any(axis=1)
    place = motion.position, motion.velocity, motion.acceleration
    return model(*place, around.chunk.time, motion.temperature, around.stretch, moved)


@dataclass(frozen=True)
class SeenBlock:
    """A block and what its torques (m, n) show, given a model along its motion and the samples that may be used.

    `least` : smallest mass [kg] of a load. `step` : usual time [s] between its samples, infinite where none follow each
    other: a log need not be sampled as the first one is.
    """

    around: Ordered
    motion: Motion
    loads: FlangeLoad
    least: float
    settings: WindowSettings
    survey: Survey
    step: float

    def shown_loads(self, model: ModelTorque, torque: np.ndarray, usable: np.ndarray) -> list[FoundLoad]:
        """Return the loads that each window shows, clear or not, given the torque of the model without them.

        Parameters
        ----------
        torque : (m, n) measured [N m]. usable : (m, n) bool.
        """
        residual = torque - model.total
        used, speed = self._moved(usable & np.isfinite(residual)), self.motion.velocity
        return found_loads(model, residual, speed, used, self._groups, self.step, self._along, self.least)

    def carrying(self, model: ModelTorque, loads: Sequence[FoundLoad]) -> tuple[ModelTorque, np.ndarray]:
        """Return the torque of the model with some of these loads, and the samples clear of a switch."""
        return carrying(model, loads, self.step, self._along)

    def lag(self, model: ModelTorque, torque: np.ndarray, usable: np.ndarray, every: int = 1) -> Lag:
        """Return how late a torque (m, n) [N m] is against the motion, by one of `every` windows; `model` with the
        loads, `usable` (m, n) bool."""
        motion, pieces = (self.motion.velocity, self.motion.acceleration), self._pieces[::every]
        return lag_of(torque, model, motion, self._moved(usable), pieces, self.around.chunk.time, self._along)

    def later(self, model: ModelTorque, torque: np.ndarray, usable: np.ndarray) -> float:
        """Return by how much later [s] a torque is than in the first log, 0 where that does not matter or samples too
        far apart do not tell; arguments as of :meth:`lag`."""
        first = self.survey.lag
        if first is None or not self._close:
            return 0.0
        if len(self._pieces) > GLANCE and plainly_none(self.lag(model, torque, usable, GLANCE), first):
            return 0.0
        return change_of(self.lag(model, torque, usable), first)

    def add_zeros(
        self,
        statistics: WindowStatistics,
        model: ModelTorque,
        torque: np.ndarray,
        usable: np.ndarray,
        dynamics: Dynamics,
        kept: slice,
    ) -> None:
        """Add to the windows what the `kept` samples tell of the zeros of the joints; not where these lie far apart.

        Parameters
        ----------
        model, torque, usable : as of :meth:`lag`. dynamics : of the model.
        """
        if not self._close or not usable.any():
            return
        motion = self.motion.position, self.motion.velocity, self.motion.acceleration
        used, time = self._moved(usable), self.around.chunk.time
        own = [slice(max(s.start, kept.start), min(s.stop, kept.stop)) for s in self._pieces]
        own = [s for s in own if s.stop > s.start]
        row = np.searchsorted(statistics.start, time[[s.start for s in own]], side="right") - 1
        crossed, shown = angles_of(torque, model, motion, used, own, self.step, dynamics, self._along)
        np.add.at(statistics.turned, row, crossed)
        np.add.at(statistics.turned_shown, row, shown)

    def _moved(self, usable: np.ndarray) -> np.ndarray:
        return usable & self._moving

    @property
    def _close(self) -> bool:
        return reaches(1 / self.step, SLOWEST_RATE)

    @cached_property
    def _moving(self) -> np.ndarray:
        settings = self.settings
        return moving(self.motion.velocity, self.around.stretch, settings.dead_band, settings.guard)

    @cached_property
    def _pieces(self) -> list[slice]:
        return pieces_of(self.around.chunk.time, self.around.stretch, self.settings.length)

    @cached_property
    def _groups(self) -> list[list[slice]]:
        window = np.floor(self.around.chunk.time / self.settings.length)
        return together(self._pieces, window, self.around.stretch, self.step)

    @cached_property
    def _along(self) -> LoadsOnMotion:
        return LoadsOnMotion(self.loads, self.motion.position, self.motion.velocity, self.motion.acceleration)
