"""Ambiguous points of the paper's text, one module each.

A module's docstring is the question, `PAPER` quotes the text, `STAGE` names the stage of the workflow that
asks it, `DEFAULT` is the alternative taken unless the config says otherwise. Every public function is one
alternative: its name is the value in the config, its docstring the meaning. A new alternative is a new
function, a new ambiguity a new module; config schema, reference and report list them from here.

The modules import numpy inside their functions only, because the Snakefile lists them at every call.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from types import ModuleType

from jointwear.files.errors import InputError, nearest

#: Stages of the workflow that may ask an ambiguity.
STAGES = ("simulation", "features", "training", "detection", "location")


@dataclass(frozen=True)
class Ambiguity:
    """One ambiguous point: its alternatives map a config value to the function that implements it."""

    name: str
    question: str
    paper: str
    stage: str
    default: str
    alternatives: dict[str, Callable]


def _describe(module: ModuleType) -> Ambiguity:
    alternatives = {
        name: function
        for name, function in vars(module).items()
        if inspect.isfunction(function) and function.__module__ == module.__name__ and not name.startswith("_")
    }
    question = " ".join((module.__doc__ or "").split())
    return Ambiguity(
        module.__name__.rpartition(".")[2], question, module.PAPER, module.STAGE, module.DEFAULT, alternatives
    )


def _checked(module: ModuleType) -> Ambiguity:
    """Return what a module says of an ambiguity.

    Raises
    ------
    InputError : naming the module and what it lacks.
    """
    where = f"{module.__file__}:"
    for key in ("PAPER", "STAGE", "DEFAULT"):
        if not isinstance(getattr(module, key, None), str):
            raise InputError(f"{where} has no text {key}; every reading says PAPER, STAGE and DEFAULT")
    found = _describe(module)
    if found.stage not in STAGES:
        hint = nearest(found.stage, STAGES)
        raise InputError(f"{where} STAGE is '{found.stage}'; allowed: {', '.join(STAGES)}{hint}")
    if found.default not in found.alternatives:
        hint = nearest(found.default, found.alternatives)
        raise InputError(f"{where} DEFAULT is '{found.default}'; allowed: {', '.join(found.alternatives)}{hint}")
    for name, function in found.alternatives.items():
        if not function.__doc__:
            raise InputError(f"{where} function '{name}' has no docstring, which is its meaning in the reference")
    return found


@cache
def ambiguities() -> dict[str, Ambiguity]:
    """Return every ambiguity by name, in alphabetical order.

    Raises
    ------
    InputError : naming the module that describes none.
    """
    names = sorted(m.name for m in pkgutil.iter_modules(__path__))
    return {name: _checked(importlib.import_module(f"{__name__}.{name}")) for name in names}


def of_stage(stage: str) -> list[str]:
    """Return the names of the ambiguities that `stage` asks about."""
    return [a.name for a in ambiguities().values() if a.stage == stage]


def select(module: ModuleType, value: str) -> Callable:
    """Return the function that implements the alternative `value` of an ambiguity.

    Raises
    ------
    InputError : if there is no such alternative; the message lists those that exist.
    """
    alternatives = _describe(module).alternatives
    if value not in alternatives:
        name = module.__name__.rpartition(".")[2]
        allowed = f"{', '.join(alternatives)}{nearest(value, alternatives)}"
        raise InputError(f"reading.{name} is '{value}'; allowed: {allowed}")
    return alternatives[value]
