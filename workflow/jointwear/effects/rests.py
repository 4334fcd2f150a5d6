"""Stops of a joint, or of a drive that several joints turn: what holds it there is friction of any level."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: What turns slower than this [rad/s] for some samples may stand still.
SLOW = 0.015
#: Fewest samples of a stop, and the most of :data:`SLOW` that half of them may reach: what turns without a stop passes
#: through evenly, so that half of its samples are faster than one half.
FEWEST, STILL = 3, 1 / 3


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
    slow_all = np.abs(velocity) < SLOW
    for record in records:
        slow = slow_all[record]
        edges = np.flatnonzero(np.diff(slow.astype(np.int8), prepend=0, append=0))
        first, after = edges[::2], edges[1::2]
        good = (after - first >= FEWEST) & (first > 0) & (after < len(slow))
        for i, k in zip(first[good] + record.start, after[good] + record.start, strict=True):
            speeds = np.sort(np.abs(velocity[i:k]))
            if speeds[(k - i) // 2] < STILL * SLOW:
                before, later = np.sign(velocity[i - 1]), np.sign(velocity[k])
                found.append(Rest(record, slice(i, k), time[i - 1], time[k], float(before), float(later)))
    return found
