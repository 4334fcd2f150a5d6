"""Which readings are run: the default, every single deviation, deviations in pairs, and a space-filling sample."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.text_files import replace_text
from jointwear.studies.multiverse.dimensions import SIMULATION, Dimension, Reading

KINDS = ("default", "single", "pair", "sample")


@dataclass(frozen=True)
class DesignPoint:
    """One reading of the design: its kind of :data:`KINDS` and its values."""

    kind: str
    reading: Reading


def latin_column(random: np.random.Generator, values: tuple, count: int) -> list:
    """Return `count` values in random order, each as often as any other to within one."""
    start = random.permutation(len(values))
    return [values[start[i % len(values)]] for i in random.permutation(count)]


def space_filling_sample(
    found: Sequence[Dimension], count: int, simulations: int, random: np.random.Generator
) -> list[Reading]:
    """Return a Latin hypercube sample of the readings.

    Every value of every dimension occurs equally often to within rounding. The dimensions that touch the
    simulation vary together in `simulations` groups, so that the costly part is run as often and no more.
    """
    columns = {}
    for dimension in found:
        if dimension.name in SIMULATION:
            groups = latin_column(random, dimension.values, simulations)
            columns[dimension.name] = [groups[i * simulations // count] for i in range(count)]
        else:
            columns[dimension.name] = latin_column(random, dimension.values, count)
    return [{d.name: columns[d.name][i] for d in found} for i in range(count)]


def build_design(found: Sequence[Dimension], count: int, pairs: int, simulations: int, seed: int) -> list[DesignPoint]:
    """Return `count` different readings.

    Parameters
    ----------
    found : the dimensions; their first values make the default reading.
    count : number of readings.
    pairs : how many of them deviate from the default in two dimensions.
    simulations : number of groups of the sample that differ in what is simulated.
    seed : of the workflow.

    Raises
    ------
    InputError : if `count` leaves no room for a sample.
    """
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(0x6D756C74,))))
    default: Reading = {d.name: d.default for d in found}
    singles = [{**default, d.name: v} for d in found for v in d.values[1:]]
    # Pairs of dimensions that are analysed alone: two deviations in the simulation would share no simulation.
    cheap = [d for d in found if d.name not in SIMULATION and d.stage != "location"]
    doubles = [
        {**default, a.name: u, b.name: v} for a, b in combinations(cheap, 2) for u in a.values[1:] for v in b.values[1:]
    ]
    chosen = random.permutation(len(doubles))[:pairs]
    points = [DesignPoint("default", default), *(DesignPoint("single", r) for r in singles)]
    points += [DesignPoint("pair", doubles[i]) for i in sorted(chosen)]
    room = count - len(points)
    if room < 1:
        raise InputError(f"multiverse: {count} readings leave none for a sample; at least {len(points) + 1} are needed")
    points += [DesignPoint("sample", r) for r in space_filling_sample(found, room, min(simulations, room), random)]
    return points


def split_design(points: Sequence[DesignPoint], parts: int) -> list[list[int]]:
    """Return the indices of the readings of every part; readings that share a simulation stay together.

    Parts are filled in order of cost, the heaviest group first into the lightest part.
    """
    groups: dict[tuple, list[int]] = {}
    for i, point in enumerate(points):
        groups.setdefault(tuple(point.reading[name] for name in SIMULATION), []).append(i)

    def cost(group: list[int]) -> float:
        # Seconds on one core, roughly: a simulation, ten times as long for sixty days, and each reading on it.
        reading = points[group[0]].reading
        long = 6.0 if reading["training_length"] != "hours_120" else 1.0
        each = 0.5 if reading["disturbance_return"] != "coupled" else 0.3
        return long + each * len(group)

    filled: list[tuple[float, list[int]]] = [(0.0, []) for _ in range(parts)]
    for group in sorted(groups.values(), key=cost, reverse=True):
        lightest = min(range(parts), key=lambda k: (filled[k][0], k))
        filled[lightest] = (filled[lightest][0] + cost(group), filled[lightest][1] + group)
    return [sorted(indices) for _, indices in filled]


def write_design(path: str | Path, points: Sequence[DesignPoint]) -> None:
    """Write a design as CSV: reading, kind and one column a dimension; Snakemake's Paramspace reads it as it is."""
    names = list(points[0].reading)
    lines = [",".join(["reading", "kind", *names])]
    lines += [",".join([str(i), p.kind, *(str(p.reading[k]) for k in names)]) for i, p in enumerate(points)]
    replace_text(path, "\n".join(lines) + "\n")


def read_design(path: str | Path) -> list[DesignPoint]:
    """Read a design that :func:`write_design` wrote.

    Raises
    ------
    InputError : if the file is missing or is not a design.
    """
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    if not rows or "kind" not in rows[0]:
        raise InputError(f"{path}: not a design of readings; delete it and run again")
    numeric = {"wear_shape": float, "consecutive_hours": int}
    return [
        DesignPoint(row["kind"], {k: numeric.get(k, str)(v) for k, v in row.items() if k not in ("reading", "kind")})
        for row in rows
    ]
