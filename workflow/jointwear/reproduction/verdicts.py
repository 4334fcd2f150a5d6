"""Does a reproduced value agree with the published one?

Tolerances: 5 % on torque, 0.05 on the coefficient of variation, 10 h on detection. A value *agrees* where the
median over replicates is within the tolerance and the published value lies in the range over replicates
(widened by the rounding of the print); it is *close* where only one of the two holds and the median is within
twice the tolerance; else it *differs*. A wide range alone never earns agreement.
"""

from __future__ import annotations

import math

TORQUE_TOLERANCE = 0.05
VARIATION_TOLERANCE = 0.05
HOUR_TOLERANCE = 10.0
REST_TORQUE = 5e-4  # N m; what prints as 0.000
PRINTED_ROUNDING = 5e-4  # three decimals in Tables V and VI
HOUR_ROUNDING = 0.5

AGREES, CLOSE, DIFFERS, NOT_COMPARABLE = "agrees", "close", "differs", "not comparable"


def _compare(published: float, median: float, low: float, high: float, tolerance: float, rounding: float) -> str:
    if not math.isfinite(median):
        return NOT_COMPARABLE
    off = abs(median - published)
    inside = low - rounding <= published <= high + rounding
    if off <= tolerance and inside:
        return AGREES
    return CLOSE if off <= 2 * tolerance and (inside or off <= tolerance) else DIFFERS


def torque_verdict(published: float | None, median: float, low: float, high: float) -> str:
    """Compare a maximum torque [N m]; an axis at rest (0.000) must stay below 5e-4 N m."""
    if published is None:
        return NOT_COMPARABLE
    if published == 0:
        return AGREES if abs(median) < REST_TORQUE else DIFFERS
    return _compare(published, median, low, high, TORQUE_TOLERANCE * abs(published), PRINTED_ROUNDING)


def variation_verdict(
    published: float | None, median: float, low: float, high: float, noise_range: tuple[float, float] | None = None
) -> str:
    """Compare a coefficient of variation.

    `noise_range` is given for an axis at rest, whose torque is pure noise: 2.5 and 97.5 % over replicates; the
    published value must lie inside.
    """
    if published is None:
        return NOT_COMPARABLE
    if noise_range is not None:
        return (
            AGREES if noise_range[0] - PRINTED_ROUNDING <= published <= noise_range[1] + PRINTED_ROUNDING else DIFFERS
        )
    return _compare(published, median, low, high, VARIATION_TOLERANCE, PRINTED_ROUNDING)


def detection_verdict(
    ran: bool, published: float | None, probability: float, median: float, low: float, high: float
) -> str:
    """Compare detection: `published` hour, or None where the paper did not detect; `ran` says that the paper ran it,
    and that ours lasts as long.

    Where the paper did not detect, we agree if we detect in less than half of the replicates and are close below
    three quarters. Where it did, hours are compared if we detect in at least half; in at least a quarter we are close
    where the median is within 10 h, else we differ. The hours are those of the replicates that detect.
    """
    if not ran:
        return NOT_COMPARABLE
    if published is None:
        return AGREES if probability < 0.5 else CLOSE if probability < 0.75 else DIFFERS
    if probability < 0.5:
        return CLOSE if probability >= 0.25 and abs(median - published) <= HOUR_TOLERANCE else DIFFERS
    return _compare(published, median, low, high, HOUR_TOLERANCE, HOUR_ROUNDING)
