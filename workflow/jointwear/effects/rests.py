"""Stops of a joint, or of a drive that several joints turn: what holds it there is friction of any level."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from jointwear.statistics.runs import runs

#: What turns slower than this [rad/s] for some samples may stand still.
SLOW = 0.015
#: Fewest samples of a stop, and the most of :data:`SLOW` that half of them may reach: what turns without a stop passes
#: through evenly, so that half of its samples are faster than one half.
FEWEST_OF_STOP, STILL = 3, 1 / 3


@dataclass(frozen=True)
class Rest:
    """A stop between two moving samples of one record, after time `start` and before `end` [s].

    Friction goes from the level of the motion before it (`before`, sign) to that of the motion after it as the drive
    winds up: evenly, for what is known of it. `samples` are those in the stop, `record` those of its record.
    """

    record: slice
    samples: slice
    start: float
    end: float
    before: float
    after: float

    def found_in(self, time: np.ndarray) -> slice:
        """Return which of the instants (m,) of all samples, which rise within the record, lie in the stop."""
        own = time[self.record]
        first, after = np.searchsorted(own, self.start, "right"), np.searchsorted(own, self.end, "left")
        return slice(self.record.start + int(first), self.record.start + int(after))

    def sense(self, time: np.ndarray) -> np.ndarray:
        """Return the share of Coulomb friction, -1 to 1, at instants (m,) within the stop."""
        return self.before + (self.after - self.before) * (time - self.start) / (self.end - self.start)

    def held(self, time: np.ndarray) -> np.ndarray:
        """Return the sign (m,) of the motion before the stop in its first half, of that after it in its second."""
        return np.where(time < 0.5 * (self.start + self.end), self.before, self.after)


def rests(velocity: np.ndarray, time: np.ndarray, records: list[slice]) -> list[Rest]:
    """Return the stops of a velocity (m,) [rad/s] at `time` (m,) [s] within each record.

    A record that begins or ends at rest says nothing of one side of the stop: it has none there.
    """
    found = []
    for record, stop in _stops(velocity, records):
        i, k = stop.start, stop.stop
        if record.start < i and k < record.stop:
            before, later = np.sign(velocity[i - 1]), np.sign(velocity[k])
            found.append(Rest(record, stop, time[i - 1], time[k], float(before), float(later)))
    return found


def sense_of(velocity: np.ndarray, records: list[slice]) -> np.ndarray:
    """Return the sense (m,), -1 to 1, of a velocity [rad/s], 0 where it is not known.

    What passes slowly through zero has a sense all the way. What stands still has none, nor has what turns round again
    within fewer samples than a stop has.
    """
    sense = np.sign(velocity)
    result, slow = sense.copy(), np.abs(velocity) < SLOW
    for record in records:
        for way in runs(sense[record], record.start, longest=FEWEST_OF_STOP - 1):
            if slow[way].all():
                result[way] = 0.0
    for _, stop in _stops(velocity, records):
        result[stop] = 0.0
    return result


def _stops(velocity: np.ndarray, records: list[slice]) -> Iterator[tuple[slice, slice]]:
    """Yield the record and the samples of every stop, those with which a record begins or ends among them."""
    slow = np.abs(velocity) < SLOW
    for record in records:
        for part in runs(slow[record], record.start, shortest=FEWEST_OF_STOP):
            if not slow[part.start]:
                continue
            speeds = np.sort(np.abs(velocity[part]))
            if speeds[len(speeds) // 2] < STILL * SLOW:
                yield record, part
