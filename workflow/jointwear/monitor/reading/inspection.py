"""Compare a log block by block with the first log, and find the part where it goes wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import cache, partial
from itertools import pairwise

import numpy as np

from jointwear.measurement.clock import Ordered, part_of
from jointwear.measurement.flags import Flag
from jointwear.measurement.refused import Refused
from jointwear.monitor.reading.derivation import Motion
from jointwear.monitor.reading.later_check import LaterCheck
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.survey import Survey

#: Parts that a block with something wrong is looked at in, and the fewest samples of a part.
PARTS, SMALLEST_PART = 8, 300
#: What a user has to know who would mend one log by a key, at the end of such a suggestion.
ALL_LOGS = "; keys of a robot hold for all of its logs: where the others are right, mend this log alone"


class Inspector:
    """Flags what contradicts the model in one log; `refused` tells in words why samples were refused."""

    def __init__(self, model: TorqueModel, survey: Survey, path: str) -> None:
        self._check = LaterCheck(
            model.dynamics, np.array(survey.dead_band), survey.left, path, np.array(survey.torque_reference)
        )
        self.refused: list[str] = []
        self._told: set[str] = set()

    def __call__(self, around: Ordered, motion: Motion, kept: slice) -> np.ndarray:
        """Return flags (m, n) of a block, of which only `kept` is looked at: in parts where something is wrong."""
        self._check.begin()
        marks = self._look(around, motion, [kept.start, kept.stop])
        if not marks.any() or self._check.everywhere or kept.stop - kept.start < PARTS * SMALLEST_PART:
            return marks
        edges = np.linspace(kept.start, kept.stop, PARTS + 1).astype(int).tolist()
        closer = self._look(around, motion, edges, cache(partial(self._relieved, around, motion, kept)))
        odd = closer & ~int(Flag.TORQUE_FROZEN) != 0
        if (marks & int(Flag.REFUSED)).any():
            # What shows in the whole alone is nowhere in particular: each part of it is just below what is no chance.
            closer[odd if odd.any() else marks & int(Flag.REFUSED) != 0] |= int(Flag.REFUSED)
        elif (closer[kept] & int(Flag.UNEXPLAINED) != 0).all():
            self._check.accept()
        return closer

    def _relieved(self, around: Ordered, motion: Motion, kept: slice) -> np.ndarray | None:
        """Return the torque (m, n) without the load that the `kept` samples show together, None where they show none.

        A part of a few seconds may hold one move with a load, of which the model then explains next to nothing.
        """
        seen = part_of(around, kept)
        lighter = self._check.relieve(seen.chunk, seen.stretch, _cut(motion, kept))
        if lighter is None:
            return None
        torque = around.chunk.torque.copy()
        torque[kept] = lighter
        return torque

    def _look(
        self,
        around: Ordered,
        motion: Motion,
        edges: list[int],
        relieved: Callable[[], np.ndarray | None] = lambda: None,
    ) -> np.ndarray:
        marks = np.zeros(around.chunk.position.shape, dtype=np.int64)
        for start, stop in pairwise(edges):
            part = slice(start, stop)
            seen = part_of(around, part)
            lighter = partial(_part_of_torque, relieved, part)
            try:
                marks[part] |= self._check(seen.chunk, seen.stretch, _cut(motion, part), len(edges) == 2, lighter)
            except Refused as refusal:
                marks[part] |= int(Flag.REFUSED)
                self.tell(refusal)
        return marks

    def tell(self, refusal: Refused) -> None:
        """Keep in words why samples were refused."""
        # Parts of a log with one fault differ in the numbers of their sentences alone.
        if refusal.suggestion not in self._told:
            self._told.add(refusal.suggestion)
            self.refused.append(f"{refusal}; {refusal.suggestion}{ALL_LOGS if refusal.by_keys else ''}")


def _cut(motion: Motion, part: slice) -> Motion:
    """Return a part of a motion."""
    moved = {f.name: getattr(motion, f.name) for f in fields(motion)}
    return Motion(**{k: None if v is None else v[part] for k, v in moved.items()})


def _part_of_torque(torque: Callable[[], np.ndarray | None], part: slice) -> np.ndarray | None:
    """Return a part of a torque, None where there is none."""
    whole = torque()
    return None if whole is None else whole[part]
