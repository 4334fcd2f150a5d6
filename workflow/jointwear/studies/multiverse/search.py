"""Search on from the readings that the design found: the sample is far too thin to hit good combinations by chance.

A few generations of crossing and changing the best readings, on a handful of pose sets at once so that a reading is
not fitted to one of them. Whatever the search finds is judged on pose sets that it never saw.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from jointwear.studies.multiverse.dimensions import SIMULATION, Dimension, Reading, stage_names

LOCATION = stage_names("location")
#: Probability with which a dimension of a new reading is left to chance.
CHANGE = 0.12
Evaluate = Callable[[list[Reading]], np.ndarray]


def recombined(
    parents: Sequence[Reading],
    found: Sequence[Dimension],
    count: int,
    random: np.random.Generator,
    known: set[tuple],
) -> list[Reading]:
    """Return up to `count` new readings made of the parents, best first among them.

    Simulation comes from one parent as a whole, and so does location, so that what fits together stays together
    and simulations are shared; every other dimension comes from either of two parents, or with the probability
    :data:`CHANGE` from chance. Readings in `known` are not made again; new ones are added to it.
    """
    weight = np.exp(-np.arange(len(parents)) / max(len(parents) / 3, 1))
    weight /= weight.sum()
    children: list[Reading] = []
    for _ in range(50 * count):
        if len(children) == count:
            break
        first, second, third = (parents[i] for i in random.choice(len(parents), size=3, p=weight))
        child: Reading = {}
        for d in found:
            if d.name in SIMULATION:
                child[d.name] = first[d.name]
            elif d.name in LOCATION:
                child[d.name] = third[d.name]
            elif random.random() < CHANGE:
                child[d.name] = d.values[random.integers(len(d.values))]
            else:
                child[d.name] = (first, second)[random.integers(2)][d.name]
        key = tuple(str(child[d.name]) for d in found)
        if key not in known:
            known.add(key)
            children.append(child)
    return children


def search(
    start: Sequence[Reading],
    found: Sequence[Dimension],
    evaluate: Evaluate,
    generations: int,
    children: int,
    survivors: int,
    random: np.random.Generator,
) -> tuple[list[Reading], np.ndarray]:
    """Return all readings that the search ran and their penalties, best first.

    Parameters
    ----------
    start : readings to begin with; they are run again, because their scores are of other pose sets.
    evaluate : returns the penalties (m,) of readings.
    generations, children : how often, and how many new readings each time.
    survivors : how many of the best so far become parents.
    """
    readings = list(start)
    known = {tuple(str(r[d.name]) for d in found) for r in readings}
    penalty = evaluate(readings)
    for _ in range(generations):
        order = np.argsort(penalty, kind="stable")[:survivors]
        new = recombined([readings[i] for i in order], found, children, random, known)
        if not new:
            break
        readings += new
        penalty = np.concatenate([penalty, evaluate(new)])
    order = np.argsort(penalty, kind="stable")
    return [readings[i] for i in order], penalty[order]


def starting_readings(
    readings: Sequence[Reading],
    shortfall: dict[str, np.ndarray],
    weights: dict[str, float],
    count: int,
) -> list[Reading]:
    """Return readings to start from: the best detections, each with the best location.

    Location does not touch detection, so that the best halves of two readings make one that is good in both.

    Parameters
    ----------
    shortfall : (m,) of every score in `weights`.
    """
    by_location = ("lag_signs", "location")
    detection = sum(weights[k] * v for k, v in shortfall.items() if k not in by_location)
    order = np.argsort(detection, kind="stable")
    # The lags are those of a detector's own runs: only good detectors tell which location is good.
    good = order[: max(len(order) // 4, 1)]
    location = sum(weights[k] * shortfall[k][good] for k in by_location)
    best = readings[good[int(np.argmin(location))]]
    made: list[Reading] = []
    keys: set[tuple] = set()
    for i in order:
        reading = {**readings[i], **{k: best[k] for k in LOCATION}}
        key = tuple(map(str, reading.values()))
        if key not in keys:
            keys.add(key)
            made.append(reading)
        if len(made) == count:
            break
    return made
