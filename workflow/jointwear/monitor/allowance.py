"""How the allowance of false alarms is shared between the charts of an axis (docs/decisions/when_to_alarm.md).

The level has a share that grows with the stated rate. Its thresholds come from a null whose normal state is right up
to chance (:mod:`.null_runs`). On a shop floor a part of the false alarms comes from robots whose normal state is wrong
for a while, and those pass a higher threshold nearly as often: over 800 simulated robot-months the measured rate grew
as the power 0.86 of the stated one, not in proportion. The share turns that law round.
"""

from __future__ import annotations

#: Share of the level at a stated rate of 1 false alarm per 1,000 h, and the power of the stated rate that it grows
#: with: months 3160 to 3959 of the shop-floor study had 0.36, 1.05 and 2.56 at 0.3, 1 and 3 with 0.75 throughout.
LEVEL_SHARE, LEVEL_POWER = 0.74, 0.16
#: Largest share of the level.
LARGEST_SHARE = 1.0
#: Shares of viscous friction alone, where the level that is judged leaves it out, and of backlash.
VISCOUS_SHARE, BACKLASH_SHARE = 0.05, 0.05


def level_share(false_alarms_per_1000_h: float) -> float:
    """Return the share of the allowance that the chart of the level has at a stated rate [per 1,000 h]."""
    return min(LEVEL_SHARE * false_alarms_per_1000_h**LEVEL_POWER, LARGEST_SHARE)
