"""Which software a run uses."""

from __future__ import annotations

import platform
from importlib import metadata


def software() -> dict[str, str]:
    """Return the version of Python and of every installed distribution, by name in lower case."""
    found = {d.metadata["Name"].lower(): d.version for d in metadata.distributions() if d.metadata["Name"]}
    return {"python": platform.python_version(), **dict(sorted(found.items()))}
