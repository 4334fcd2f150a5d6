"""Digests by which files that were made before are known again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence


def digest(content: Mapping | Sequence | str) -> str:
    """Return the SHA-256 of what JSON can hold, independent of key order."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()
