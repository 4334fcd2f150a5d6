"""What every result says about its origin."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from jointwear import __version__
from jointwear.files.errors import InputError, shown
from jointwear.files.json_documents import parse_json
from jointwear.files.storage import open_dataset

#: Attribute with the settings of a result and of everything that it was made from.
LINEAGE = "lineage"


def settings_digest(settings: Any) -> str:
    """Return the SHA-256 of settings made of dicts, lists, numbers and text, independent of key order."""
    text = json.dumps(settings, sort_keys=True, separators=(",", ":"), default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def attributes(
    title: str,
    settings: Mapping[str, Any],
    made_from: Iterable[str | Path] = (),
    own: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the global attributes of a result.

    Parameters
    ----------
    title : what the file holds, in one phrase.
    settings : the config values that the result depends on, `seed` among them where chance is involved. The
        digest covers these alone, so that a file does not change with settings that it does not use.
    made_from : results that this one was made from.
    own : what names this result among those of the same settings, such as the length of its run.

    Raises
    ------
    InputError : naming the file, if what this result was made from and its own settings contradict each other.
    """
    lineage: dict[str, Any] = {}
    for path in made_from:
        lineage = _joined(path, lineage, lineage_of(path))
    lineage = _joined(title, lineage, json.loads(json.dumps(settings)))
    settings = {**settings, **(own or {})}
    result: dict[str, Any] = {
        "title": title,
        "source": f"jointwear {__version__}",
        "workflow_version": __version__,
        "config_digest": settings_digest(dict(settings)),
        "config": json.dumps(dict(settings), sort_keys=True),
        LINEAGE: json.dumps(lineage, sort_keys=True),
    }
    if "seed" in settings:
        result["seed"] = settings["seed"]
    return result


def lineage_of(path: str | Path) -> dict[str, Any]:
    """Return the settings of a result and of everything that it was made from; empty for a file that does not say.

    Raises
    ------
    InputError : naming the file, if it cannot be read.
    """
    with open_dataset(path) as dataset:
        if LINEAGE not in dataset.ncattrs():
            return {}
        return parse_json(str(dataset.getncattr(LINEAGE)), path)


def check_lineage(paths: Iterable[str | Path], settings: Mapping[str, Any]) -> None:
    """Check that results were made with `settings`, as far as these say anything of a key.

    Raises
    ------
    InputError : naming the first file that was made with others, and the key.
    """
    wanted = json.loads(json.dumps(settings))
    for path in paths:
        _joined(path, wanted, lineage_of(path))


def _joined(name: str | Path, first: Mapping[str, Any], second: Mapping[str, Any], where: str = "") -> dict[str, Any]:
    """Return both mappings in one; a key of both must have the same value in both."""
    result = dict(first)
    for key, value in second.items():
        if isinstance(value, Mapping) and isinstance(result.get(key), Mapping):
            result[key] = _joined(name, result[key], value, f"{where}{key}.")
        elif key in result and result[key] != value:
            raise InputError(
                f"{name}: was made with '{where}{key}' = {shown(value)}, the rest with "
                f"{shown(result[key])}; delete it and run again"
            )
        else:
            result[key] = value
    return result
