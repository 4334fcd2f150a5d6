"""Other readings of the axes under which a later piece of a log is explained as its first log was: two exchanged, a
sign turned, the torque of the motor. Of those that leave as little the likeliest is told, and those nearly as likely.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain

import numpy as np

from jointwear.measurement.checks.axes_check import CLEARLY, WRONG, explained, explained_otherwise, favours
from jointwear.measurement.checks.axis_readings import Likelihood, Reading, all_turned
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.robots.dynamics import Dynamics

#: Growth of the log of what the model leaves, summed over axes, that is no longer chance; and what may be left of it
#: once a wrong reading is mended.
WORSE, MENDED = 2.0, 1.0
#: Growth of each axis up to which two pieces count as alike.
SAME_GROWTH = 0.7


@dataclass(frozen=True)
class OtherReadings:
    """Looks for other readings of one piece of a log.

    Attributes
    ----------
    grown : of shares (n,) as of :func:`.explained`, gives the log of each over what it was in the first log, (n,), NaN
        where unknown.
    plain : growth (n,) of the piece as it is read.
    """

    dynamics: Dynamics
    grown: Callable[[np.ndarray], np.ndarray]
    plain: np.ndarray

    def find(self, parts: np.ndarray, usable: np.ndarray) -> list[Reading]:
        """Return the readings that mend a piece, the likeliest first; none where it is likelier as it is.

        Exchanged positions of two joints of a wrist may leave one of them less by as much as the other more, so that
        they leave no more than exchanged torques do, which leave of each what is usual.

        Parameters
        ----------
        parts, usable : samples as of :func:`.explained`, (m, 4, n) and (m, n).
        """
        turned = [(reading, self._explained(reading, parts, usable)) for reading in all_turned(self.dynamics.robot)]
        mending = self._mending(parts, usable, turned) or self._better_turned(turned)
        if not mending:
            return []
        robot, likelihood = self.dynamics.robot, Likelihood(self.dynamics, FEWEST_OF_JOINT)
        # A few seconds with a load that the robot file does not have may look like another zero of a joint.
        as_read, least = likelihood(parts, usable), min(growth for growth, _ in mending)
        nats = [
            (likelihood(*reading.read(parts, usable, robot)) - as_read, k, reading)
            for k, (growth, reading) in enumerate(mending)
            if growth <= least + SAME_GROWTH
        ]
        nats = sorted((x for x in nats if x[0] > favours(x[2], robot)), reverse=True)
        return [reading for lead, _, reading in nats if lead > nats[0][0] - favours(nats[0][2], robot)]

    def left(self, reading: Reading, parts: np.ndarray, usable: np.ndarray) -> float:
        """Return the growth, summed over axes, of samples that are read so."""
        return self._growth(self._explained(reading, parts, usable))

    def _explained(self, reading: Reading, parts: np.ndarray, usable: np.ndarray) -> np.ndarray:
        return explained(self.dynamics, *reading.read(parts, usable, self.dynamics.robot))

    def _growth(self, left: np.ndarray) -> float:
        grown = self.grown(left)
        # An axis that another reading leaves without motion is not explained by it.
        return float(np.nansum(np.where(np.isfinite(grown), grown, self.plain)))

    def _gain(self, growth: float) -> float:
        return float(np.nansum(self.plain)) - growth

    def _mends(self, growth: float) -> bool:
        return growth < MENDED and self._gain(growth) > WORSE

    def _mending(
        self, parts: np.ndarray, usable: np.ndarray, turned: list[tuple[Reading, np.ndarray]]
    ) -> list[tuple[float, Reading]]:
        """Return growth and reading of those under which samples are explained as in the first log.

        Parameters
        ----------
        turned : readings that turn all joints around, with the shares (n,) that they leave.
        """
        # A reading that does not mend a part of the samples mends no more of all.
        others = explained_otherwise(self.dynamics, parts, usable, lambda _, left: not self._mends(self._growth(left)))
        found = [(self._growth(left), reading) for reading, left in chain(others, turned)]
        return [(growth, reading) for growth, reading in found if self._mends(growth)]

    def _better_turned(self, turned: list[tuple[Reading, np.ndarray]]) -> list[tuple[float, Reading]]:
        """Return growth and reading of those that turn all joints around, `turned`, and explain each far better.

        They need not explain them as in the first log, which may have had another product: no load makes the torques
        of all joints count the other way round.
        """
        found = []
        for reading, left in turned:
            drop = (self.plain - self.grown(left))[np.isfinite(self.plain)]
            if np.all(drop > CLEARLY) and np.sum(drop) > WORSE and np.nanmax(left) < WRONG:
                found.append((self._growth(left), reading))
        return found


def refusal_of(name: str, found: list[Reading]) -> Refused:
    """Return the refusal of a log that has to be read otherwise; `found` as of :meth:`OtherReadings.find`."""
    reasons, remedies = "; or ".join(r.reason for r in found), "; or ".join(r.remedy for r in found)
    return Refused(f"{name}: {reasons} against the first log", remedies, any(r.by_keys for r in found))
