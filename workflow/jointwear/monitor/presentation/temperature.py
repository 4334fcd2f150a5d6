"""How much of the change of a friction estimate over the windows goes with the temperature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FEWEST_WINDOWS = 4
#: Smallest spread of temperature [K] that counts as a variation.
SPREAD = 0.5


@dataclass(frozen=True)
class TemperatureShare:
    """A straight line of an estimate over temperature.

    `windows` used; `low`, `high` temperature [degC]; `slope` and `slope_std` [unit/K], the latter from the scatter
    about the line where that is larger than the estimates' own; `explained` share of the weighted variance, reduced
    for the freedom of the line (adjusted R2, not below 0); `with_time` correlation of temperature with time.
    """

    windows: int
    low: float
    high: float
    slope: float
    slope_std: float
    explained: float
    with_time: float


def temperature_share(
    estimate: np.ndarray, std: np.ndarray, temperature: np.ndarray, time: np.ndarray
) -> TemperatureShare | None:
    """Fit a line to estimates (w,) with standard deviations over temperatures [degC]; None where there is too little.

    Windows count by their inverse variance. `time` (w,) of the windows [s]: pauses between them count.
    """
    good = np.isfinite(estimate) & np.isfinite(std) & (std > 0) & np.isfinite(temperature)
    if good.sum() < FEWEST_WINDOWS or np.ptp(temperature[good]) < SPREAD:
        return None
    y, t = estimate[good], temperature[good]
    # No window may rule alone: a floor at a tenth of the median standard deviation.
    weight = 1.0 / np.maximum(std[good], 0.1 * np.median(std[good])) ** 2
    middle = np.average(t, weights=weight), np.average(y, weights=weight)
    dt, dy = t - middle[0], y - middle[1]
    power = float(np.sum(weight * dt**2))
    slope = float(np.sum(weight * dt * dy)) / power
    total, left = float(np.sum(weight * dy**2)), float(np.sum(weight * (dy - slope * dt) ** 2))
    count = len(y)
    scatter = max(left / (count - 2), 1.0)
    explained = 1.0 - (left / (count - 2)) / (total / (count - 1)) if total > 0 else 0.0
    return TemperatureShare(
        windows=count,
        low=float(t.min()),
        high=float(t.max()),
        slope=slope,
        slope_std=float(np.sqrt(scatter / power)),
        explained=max(explained, 0.0),
        with_time=float(np.corrcoef(time[good], t)[0, 1]),
    )
