"""Temperature of every gear over the month: heated by what it dissipates, cooled by housing, neighbours and room.

Two nodes per axis, oil and housing. With p the friction power over that of the usual program at 25 degC,

    t_oil d(oil)/dt = housing - oil + q R p
    t_housing d(housing)/dt = room - housing + (1 - q) R p + g (next - housing)

R [K] the rise of the axis in steady production. Steps of ten minutes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.studies.shop_floor.gear import Gear

#: Steps per hour.
STEPS = 6


@dataclass(frozen=True)
class Body:
    """`rise` (n,) [K] in steady production, time constants `oil`, `housing` (n,) [h], `share` of the rise between oil
    and housing, `exchange` with the neighbours, `rubbing` (n,) share of the power that is viscous."""

    rise: np.ndarray
    oil: np.ndarray
    housing: np.ndarray
    share: float
    exchange: float
    rubbing: np.ndarray


def draw_body(n: int, random: np.random.Generator) -> Body:
    """Draw the thermal parameters of one arm."""
    return Body(
        rise=random.uniform(7, 20, n),
        oil=random.uniform(0.25, 0.6, n),
        housing=random.uniform(1.3, 3.5, n),
        share=float(random.uniform(0.2, 0.4)),
        exchange=float(random.uniform(0.05, 0.3)),
        rubbing=random.uniform(0.3, 0.6, n),
    )


def warm(body: Body, gear: Gear, power: np.ndarray, room: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return oil and housing temperatures (h, n) [degC] at the start of every hour.

    Parameters
    ----------
    power : (h, n) friction power of the hour's motion over that of steady production, 0 at rest.
    room : (h,) [degC].
    """
    hours, n = power.shape
    oil = np.full(n, room[0])
    housing = oil.copy()
    out = np.empty((2, hours, n))
    step = 1.0 / STEPS
    # A day before the month begins leaves the memory of a running plant.
    lead = np.concatenate([power[:24], power])
    air = np.concatenate([room[:24], room])
    for hour in range(hours + 24):
        if hour >= 24:
            out[0, hour - 24], out[1, hour - 24] = oil, housing
        for _ in range(STEPS):
            thin = gear.viscosity(oil)
            heat = body.rise * lead[hour] * (1 - body.rubbing + body.rubbing * thin)
            near = np.empty(n)
            near[1:-1] = 0.5 * (housing[2:] + housing[:-2])
            near[0], near[-1] = 0.5 * (air[hour] + housing[1]), 0.5 * (air[hour] + housing[-2])
            flow = air[hour] - housing + (1 - body.share) * heat + body.exchange * (near - housing)
            oil = oil + step / body.oil * (housing - oil + body.share * heat)
            housing = housing + step / body.housing * flow
    return out[0], out[1]
