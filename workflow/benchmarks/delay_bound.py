"""How soon growth could be told at best: a bound on the delay of any detector, on months of the simulated shop floor.

A detector is given what no user can give it: the law of the growth (its shape and its rate) to the letter, and how
residuals of shifts scatter. It does not know whether and when growth began. It takes the largest log-likelihood ratio
over a grid of onsets (for a known law this is the cumulative sum of Page, 1954), and alarms at the rate that one axis
has of the robot's. Residuals of shifts are drawn as independent: what the normal state does not know lasts longer in
truth, so that the bound is below what can be reached. One scatter stands for all axes of a kind of robot: an axis that
scatters less could be told sooner.

    PYTHONPATH=workflow python workflow/benchmarks/delay_bound.py --cells 400

Prints JSON: median delays [h] by the calendar and of operation, and the share within 48 h by the calendar, of Coulomb
growth by 20 % within two weeks.
"""

from __future__ import annotations

import argparse
import json

import numpy as np
from scipy.special import ndtri, stdtrit

from jointwear.monitor.normal.shifts import shift_labels
from jointwear.monitor.watching.allowance import LEVEL_SHARE
from jointwear.studies.shop_floor.cell import Cell, draw_cell
from jointwear.studies.shop_floor.month import BASELINE_DAYS, DAY

#: False alarms per 1,000 h of a robot; growth by 20 % within so many hours counts as fast; the aim [h].
RATE, FAST, AIM = 1.0, 336.0, 48.0
#: Hours between the onsets that are tried, and how far back they reach.
GRID, BACK = 4, 336
#: Null months and worn months that are drawn for each robot.
NULLS, RUNS = 400, 100
#: Degrees of freedom of the heavy law (:data:`jointwear.monitor.watching.null_runs.FREEDOM`).
FREEDOM = 3.5
#: Scale of that law at which its quartiles are those of the normal one.
HEAVY = float(ndtri(0.75) / stdtrit(FREEDOM, 0.75))
#: Robust standard deviations of the means of shifts, of robots with one disturbance or none and with ten
#: (docs/decisions/when_to_alarm.md, "Steady robots"): of their windows' noise alone, and of the residuals as they are.
SCATTER = {
    "normal state known": (0.0007, 0.0040, "normal"),
    "scatter as it is, normal law": (0.0009, 0.0126, "normal"),
    "scatter as it is, heavy law": (0.0009, 0.0126, "student"),
}


def _log_ratio(residual: np.ndarray, growth: np.ndarray, sigma: float, law: str) -> np.ndarray:
    """Return the log of the density of residuals (r, 1) with growth (o,) over that without."""
    if law == "normal":
        return (residual * growth - 0.5 * growth**2) / sigma**2
    power = (FREEDOM + 1) / 2
    size = FREEDOM * (HEAVY * sigma) ** 2
    return power * (np.log1p(residual**2 / size) - np.log1p((residual - growth) ** 2 / size))


def _statistic(
    hours: np.ndarray, shift: np.ndarray, growth: np.ndarray, error: np.ndarray, cell: Cell, sigma: float, law: str
) -> np.ndarray:
    """Return the largest log-likelihood ratio (runs, h) at every logged hour.

    Parameters
    ----------
    hours : (h,) logged. shift : (h,) labels from 0. growth : (h,) that there is. error : (runs, shifts).
    """
    onsets = np.arange(BASELINE_DAYS * DAY, hours[-1] + 1, GRID)
    wear = cell.wear
    since = np.maximum(hours[:, None] - onsets, 0.0) + wear.onset
    supposed = np.log1p(wear.growth(since))
    total = now = np.zeros((len(error), len(onsets)))
    result = np.empty((len(error), len(hours)))
    first = 0
    for k, hour in enumerate(hours):
        if k and shift[k] != shift[k - 1]:
            total = total + now
            first = k
        residual = growth[first : k + 1].mean() + error[:, shift[k], None]
        now = _log_ratio(residual, supposed[first : k + 1].mean(axis=0), sigma, law)
        tried = (onsets <= hour) & (onsets > hour - BACK)
        result[:, k] = (total[:, tried] + now[:, tried]).max(axis=1)
    return result


def delays(cell: Cell, sigma: float, law: str, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return the delays (RUNS,) [h] by the calendar and of operation; infinite where nothing is told in the month."""
    logged = cell.logged[~cell.still]
    begin, end = logged * 3600.0, (logged + 1) * 3600.0
    labels = shift_labels(begin, end, logged < BASELINE_DAYS * DAY)
    rows = logged >= BASELINE_DAYS * DAY
    hours, shift = (logged[rows] + 1).astype(float), labels[rows] - labels[rows][0]

    def drawn(runs: int) -> np.ndarray:
        shape = (runs, shift[-1] + 1)
        if law == "normal":
            return sigma * random.standard_normal(shape)
        return HEAVY * sigma * random.standard_t(FREEDOM, shape)

    chance = -np.expm1(-RATE / 1000 * LEVEL_SHARE / len(cell.arm.home) * len(hours))
    null = _statistic(hours, shift, np.zeros(len(hours)), drawn(NULLS), cell, sigma, law)
    threshold = np.quantile(null.max(axis=1), 1 - chance)
    growth = np.log1p(cell.wear.growth(hours))
    told = _statistic(hours, shift, growth, drawn(RUNS), cell, sigma, law) > threshold
    told &= hours > cell.wear.onset
    first = np.argmax(told, axis=1)
    found = told.any(axis=1)
    operating = np.cumsum(hours > cell.wear.onset)
    return np.where(found, hours[first] - cell.wear.onset, np.inf), np.where(found, operating[first], np.inf)


def main(count: int) -> None:
    """Draw robots of the choosing seeds and print the bounds."""
    cells = [draw_cell("choose", index) for index in range(count)]
    worn = [c for c in cells if c.wear and c.wear.kind == "coulomb" and c.wear.duration <= FAST]
    result = {"robots": len(worn), "with all disturbances": sum(c.scenario == "all" for c in worn)}
    for name, (few, all_of_them, law) in SCATTER.items():
        random = np.random.default_rng([20150824, count])
        found = [delays(c, all_of_them if c.scenario == "all" else few, law, random) for c in worn]
        calendar, operating = (np.array([f[k] for f in found]) for k in range(2))
        many = np.array([c.scenario == "all" for c in worn])
        result[name] = {
            kind: {
                "calendar": round(float(np.median(calendar[chosen])), 1),
                "operation": round(float(np.median(operating[chosen])), 1),
                "within_aim": round(float(np.mean(calendar[chosen] <= AIM)), 2),
            }
            for kind, chosen in (("every robot", many | ~many), ("ten", many), ("one or none", ~many))
        }
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--cells", type=int, default=400)
    main(arguments.parse_args().cells)
