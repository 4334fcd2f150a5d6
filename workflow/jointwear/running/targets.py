"""Which targets of the command line nothing makes, and what was meant.

Snakemake answers them with an exception of its own that names neither a target like it nor the option that a file of
values belongs to. Imported by the Snakefile at every call.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterable
from pathlib import Path

from jointwear.files.errors import InputError, nearest, shown

#: How a file of values ends.
_VALUES = (".yaml", ".yml", ".json")


def asked_for() -> list[str]:
    """Return the targets of the call of Snakemake that reads the Snakefile just now, of which it tells it nothing.

    They are in its own record of the command line, further up the stack; to read that line once more takes a third of a
    second. Empty where no such record is found.
    """
    frame = inspect.currentframe()
    while frame is not None:
        found = getattr(frame.f_locals.get("args"), "targets", None)
        if frame.f_globals.get("__name__") == "snakemake.cli" and isinstance(found, (list, tuple, set, frozenset)):
            return sorted(map(str, found))
        frame = frame.f_back
    return []


def check_targets(
    targets: Iterable[str], rules: Iterable[str], made: Callable[[str], bool], files: Iterable[str] = ()
) -> None:
    """Check that every target is a rule, or a file that one makes.

    Parameters
    ----------
    targets : of the command line. rules : that can be targets, by name. made : whether any rule makes a file.
    files : names of files that rules make, with wildcards in braces or without.

    Raises
    ------
    InputError : naming the target and the nearest one.
    """
    rules = list(rules)
    for target in targets:
        if target in rules or made(os.path.normpath(target)):
            continue
        if target.endswith(_VALUES) and Path(target).is_file():
            raise InputError(f"target {shown(target)} is a file of values, given as --configfile {target}")
        if "/" not in target:
            # A file name without a folder is rather a rule; rules are in small letters with _.
            raise InputError(
                f"target {shown(target)}: nothing makes it{nearest(target.lower().replace('-', '_'), rules)}"
            )
        raise InputError(f"target {shown(target)}: nothing makes it{_nearest_file(os.path.relpath(target), files)}")


def _nearest_file(target: str, files: Iterable[str]) -> str:
    """Return a hint at the file nearest to a target, whose wildcards are filled from the target's own folders."""
    parts = target.split("/")
    filled = (_filled(file.split("/"), parts) for file in files if file.count("/") == target.count("/"))
    return nearest(target, dict.fromkeys(file for file in filled if "{" not in file))


def _filled(pattern: list[str], parts: list[str]) -> str:
    """Return a pattern whose parts that are one wildcard are those of a target."""
    return "/".join(
        part if known.startswith("{") and known.endswith("}") else known
        for known, part in zip(pattern, parts, strict=True)
    )
