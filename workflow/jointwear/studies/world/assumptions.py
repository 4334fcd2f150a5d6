"""What 30 % more or less of what discovery assumes of noise, band and drives does to its answers.

These limits stand before the decision: the noise, the whole search and the written model are asked again for each. Part
of :mod:`jointwear.studies.world.sensitivity`.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from jointwear.discovery import assumed
from jointwear.discovery.settings import Settings
from jointwear.studies.challenge.judge import judge
from jointwear.studies.world.answers import answer, is_right
from jointwear.studies.world.case import WorldCase, generate
from jointwear.studies.world.plan import Case
from jointwear.studies.world.setting import INERTIAL_PRIOR

#: Names of the record, in its order.
LIMITS = tuple(name for name in vars(assumed) if name.isupper())
#: Limits of the settings that only the written model asks.
WRITTEN = ("not_worse",)


def moves(factors: tuple[float, ...]) -> dict[tuple[str, float], tuple[float, float]]:
    """Return every limit asked here with each factor: (name, factor) -> value, and what it is moved to."""
    values = {name: getattr(assumed, name) for name in LIMITS}
    found = {(name, factor): (value, factor * value) for name, value in values.items() for factor in factors}
    for name in WRITTEN:
        # A ratio of errors: what it is about is how far it is from one.
        value = getattr(Settings(), name)
        found |= {(name, factor): (value, 1.0 + factor * (value - 1.0)) for factor in factors}
    return found


@contextmanager
def moved(name: str, value: float) -> Iterator[None]:
    """Let discovery assume `value` for one limit of the record within a block, in this process alone."""
    before = getattr(assumed, name)
    setattr(assumed, name, value)
    try:
        yield
    finally:
        setattr(assumed, name, before)


def answers(case: Case, factors: tuple[float, ...]) -> dict[str, Any]:
    """Return what a case is and, for the record as it is and each move, names, whether they are right, and worse axes.

    Raises
    ------
    InputError : if the packages of the plants are not installed.
    """
    with tempfile.TemporaryDirectory() as folder:
        world = generate(case, folder)
        found = {" 1": told(world)}
        for (name, factor), (_, value) in moves(factors).items():
            if name in WRITTEN:
                settings = replace(Settings(inertial_prior=INERTIAL_PRIOR), **{name: value})
                found[f"{name} {factor:g}"] = told(world, settings)
                continue
            with moved(name, value):
                found[f"{name} {factor:g}"] = told(world)
    facts = world.facts
    nothing = judge(facts, {"verdict": "none", "effects": []}, None, None)
    identifiable = nothing["identifiable"] is not False
    return {"case": facts["case"], "kind": facts["kind"], "identifiable": identifiable, "found": found}


def told(world: WorldCase, settings: Settings | None = None) -> dict[str, Any]:
    """Return the names of a case, whether they are right (None where the question does not apply), and worse axes."""
    row = answer(world, settings)
    return {
        "names": sorted(map(str, row["named"])),
        "right": is_right(row),
        "worse": list(row.get("worse") or []),
    }
