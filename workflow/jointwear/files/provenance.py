"""What every result says about its origin."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from jointwear import __version__


def digest(value: Any) -> str:
    """Return the SHA-256 of a value made of dicts, lists, numbers and text, independent of key order."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def attributes(title: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the global attributes of a result.

    Parameters
    ----------
    title : what the file holds, in one phrase.
    settings : the config values that the result depends on, `seed` among them where chance is involved. The
        digest covers these alone, so that a file does not change with settings that it does not use.
    """
    result: dict[str, Any] = {
        "title": title,
        "source": f"jointwear {__version__}",
        "workflow_version": __version__,
        "config_digest": digest(dict(settings)),
        "config": json.dumps(dict(settings), sort_keys=True),
    }
    if "seed" in settings:
        result["seed"] = settings["seed"]
    return result
