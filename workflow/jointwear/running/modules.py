"""Which library modules a script imports, and which files these read beside themselves, found by reading them.

Snakemake does not see imported modules.
"""

from __future__ import annotations

import hashlib
import os
import re
from functools import cache
from pathlib import Path

LIBRARY = Path(__file__).resolve().parents[1]
#: The library of effects, one file each under ``entries``.
EFFECTS = LIBRARY / "effects"
# Read as text: parsing to syntax trees takes four times as long, at every call of Snakemake.
_FROM = re.compile(r"^\s*from\s+(jointwear[\w.]*)\s+import\s+(\([^)]*\)|[^\n#]+)", re.MULTILINE)
_IMPORT = re.compile(r"^\s*import\s+(jointwear[\w.]*)", re.MULTILINE)
#: How a module names a file of values that lies beside it.
_BESIDE = re.compile(r"\bPath\(__file__\)\.with_name\(\"([\w.-]+)\"\)")
_WHOLE_PACKAGE = re.compile(r"^WHOLE_PACKAGE = True", re.MULTILINE)


def lend_to_children() -> None:
    """Put this library first on the PYTHONPATH of every process started from now on."""
    earlier = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(LIBRARY.parent), *([earlier] if earlier else [])])


@cache
def _path_of(module: str) -> Path | None:
    """Return the file of a module of this library, or None for a name that is not a module."""
    base = LIBRARY.joinpath(*module.split(".")[1:])
    if base.is_dir():
        return base / "__init__.py"
    return base.with_suffix(".py") if base.with_suffix(".py").is_file() else None


@cache
def _direct(path: Path) -> frozenset[Path]:
    """Return the library files that one file imports, inside functions too, and those that it reads beside itself."""
    if path.suffix != ".py":
        return frozenset()
    text = path.read_text(encoding="utf-8")
    names = set(_IMPORT.findall(text))
    for module, imported in _FROM.findall(text):
        names.add(module)
        names.update(f"{module}.{name}" for name in re.findall(r"\w+", re.sub(r"\bas\s+\w+", "", imported)))
    found: set[Path] = set()
    for name in names:
        # Importing a.b.c also runs a and a.b.
        pieces = name.split(".")
        found.update(p for k in range(1, len(pieces) + 1) if (p := _path_of(".".join(pieces[:k]))))
    if path.name == "__init__.py" and _WHOLE_PACKAGE.search(text):
        found.update(path.parent.glob("*.py"))
    found.update(beside for name in _BESIDE.findall(text) if (beside := path.with_name(name)).is_file())
    return frozenset(found)


@cache
def imported_by(script: Path, effects: frozenset[str] | None = None) -> tuple[Path, ...]:
    """Return every library file that `script` imports, directly or through others, sorted, and what these read.

    A package whose ``__init__`` says ``WHOLE_PACKAGE = True``, because its modules are found by listing it, counts
    with all of them.

    Parameters
    ----------
    effects : effects that the robot of the job has. Of the effects those files alone count, and none at all where the
        robot has no effect: the job then never looks at the library. None: all of them count.

    Raises
    ------
    FileNotFoundError : if the script does not exist.
    """
    seen: set[Path] = set()
    waiting = [script]
    while waiting:
        for path in _direct(waiting.pop()):
            if path not in seen and _wanted(path, effects):
                seen.add(path)
                waiting.append(path)
    return tuple(sorted(seen))


def _wanted(path: Path, effects: frozenset[str] | None) -> bool:
    """Whether a module counts for a job whose robot has these effects."""
    if effects is None or not path.is_relative_to(EFFECTS):
        return True
    if path.parent == EFFECTS / "entries" and path.stem != "__init__":
        return path.stem in effects
    return bool(effects)


@cache
def code_of(script: str) -> str:
    """Return a digest of the library files that a script of the workflow needs, as they are when first asked for."""
    found = hashlib.sha256()
    for path in imported_by(LIBRARY.parent / "scripts" / f"{script}.py"):
        found.update(path.read_bytes())
    return found.hexdigest()
