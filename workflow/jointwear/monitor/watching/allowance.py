"""How the allowance of false alarms is shared between the charts of an axis (docs/decisions/when_to_alarm.md)."""

from __future__ import annotations

#: Shares of viscous friction alone, where the level that is judged leaves it out, and of backlash.
VISCOUS_SHARE, BACKLASH_SHARE = 0.05, 0.05
#: Share of the level: all that the others leave, at any stated rate.
LEVEL_SHARE = 1.0 - VISCOUS_SHARE - BACKLASH_SHARE
