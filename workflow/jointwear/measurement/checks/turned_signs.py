"""Joints turned around together, position and torque of each: the signs under which the model makes a recording
likeliest, those that are needed for it, and those that are left in doubt.

A joint turned around resembles others: a shoulder and an elbow together mirror an arm as another mounting does, and a
base or a slender wrist alone changes next to nothing. So all signs are looked at together, not one after the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from itertools import combinations

import numpy as np

from jointwear.files.wording import numbered, significant
from jointwear.measurement.checks.axis_readings import Likelihood, Reading
from jointwear.measurement.refused import FEWEST_OF_JOINT
from jointwear.measurement.stated import Stated
from jointwear.robots.dynamics import Dynamics

#: Log likelihood [nats] of some joints, 0-based, turned around.
Nats = Callable[[frozenset[int]], float]
#: Log likelihood [nats] by which other signs are told though a recording is not refused. Right logs reached 26, see
#: :data:`.axes_check.FAVOURS`; two gentle joints of a clean simulated arm reached 37 and 59 for their own wrong signs.
TOLD = 20.0
#: How words of signs in doubt begin.
IN_DOUBT = "turned around"


def nats_of_signs(dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray) -> Nats:
    """Return the log likelihood [nats] of samples with some joints turned around, kept once it is known.

    Parameters
    ----------
    parts : (m, 4, n) position, velocity, acceleration, torque. usable : (m, n) bool.
    """
    likelihood = Likelihood(dynamics, FEWEST_OF_JOINT)

    @cache
    def nats(axes: frozenset[int]) -> float:
        return likelihood(*turned_around(axes).read(parts, usable, dynamics.robot))

    return nats


def turned_around(axes: frozenset[int]) -> Reading:
    """Return the reading that turns 0-based axes around, all together."""
    return Reading("flip", tuple(sorted(axes)))


def likeliest_signs(nats: Nats, joints: int) -> frozenset[int]:
    """Return the joints that have to be turned around for the likeliest signs; one or two are turned at a time."""
    steps = [frozenset(s) for size in (1, 2) for s in combinations(range(joints), size)]
    best: frozenset[int] = frozenset()
    while True:
        other = max((best ^ step for step in steps), key=nats)
        if not nats(other) > nats(best):
            return best
        best = other


def needed_signs(nats: Nats, found: frozenset[int], doubt: float) -> frozenset[int]:
    """Return those of the found joints that have to be turned around: each that is not makes less likely by more than
    `doubt` [nats]."""
    while found:
        fewer = max((found - {axis} for axis in found), key=nats)
        if nats(found) - nats(fewer) > doubt:
            return found
        found = fewer
    return found


def in_doubt(
    explained: Callable[[np.ndarray], np.ndarray], nats: Nats, parts: np.ndarray, stated: Stated
) -> Iterator[str]:
    """Yield in words the signs that would fit better, by less than a recording is refused for.

    What tells them is so little that a robot file which lacks something may do it too.

    Parameters
    ----------
    explained : share of the squared torque (n,) that the model leaves of samples (m, 4, n).
    """
    joints = parts.shape[2]
    best = likeliest_signs(nats, joints)
    if nats(best) - nats(frozenset()) <= TOLD:
        return
    reading = turned_around(best)
    signs = np.where(np.isin(np.arange(joints), list(best)), -1.0, 1.0)
    left, other = explained(parts), explained(parts * signs)
    gain = np.nan_to_num(left / np.maximum(other, 1e-12))
    most = int(np.argmax(gain))
    words = numbered("joint", [axis + 1 for axis in reading.axes])
    less, more = (significant(100 * float(share[most]), 2) for share in (other, left))
    yield (
        f"{IN_DOUBT}, {words} would fit the model a little better: it would leave {less} % of the squared torque of "
        f"joint {most + 1} and not {more} %, which what the robot "
        f"file lacks may do too; where nobody has checked that sign, compare: {reading.remedy_beside(stated)}"
    )
