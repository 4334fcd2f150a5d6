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


@cache
def ambiguities() -> dict[str, Ambiguity]:
    """Return every ambiguity by name, in alphabetical order."""
    names = sorted(m.name for m in pkgutil.iter_modules(__path__))
    return {name: _describe(importlib.import_module(f"{__name__}.{name}")) for name in names}


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
