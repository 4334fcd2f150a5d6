"""What a judgement works out of the baseline alone, kept from day to day.

Every entry stands under a digest of all that determines it, so that an entry that is found is what would be worked out
again, to the last bit; a changed window, setting or library finds none.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.schemas import check

_ROW = {"type": "array", "items": {"type": ["number", "null"]}}
#: Layout of the file: entries are lists of rows.
_RECORD = {
    "type": "object",
    "required": ["made_with", "entries"],
    "properties": {
        "made_with": {"type": "string"},
        "entries": {"type": "object", "additionalProperties": {"type": "array", "items": _ROW}},
    },
}
Rows = list[list[float | None]]


class Recall:
    """Rows of values by digest; `used`: the entries that were asked for, which are all that is worth keeping."""

    def __init__(self, known: Mapping[str, Rows] | None = None) -> None:
        self._known = known or {}
        self.used: dict[str, Rows] = {}

    def __call__(self, key: str, make: Callable[[], Rows]) -> Rows:
        """Return the entry of a key of :func:`key_of`, made where there is none."""
        if key not in self.used:
            self.used[key] = self._known[key] if key in self._known else make()
        return self.used[key]


def key_of(*parts: Any) -> str:
    """Return a digest of arrays (dtype, shape, bytes) and of what else has a `repr` that says all."""
    found = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            found.update(f"{part.dtype.str} {part.shape} ".encode())
            found.update(np.ascontiguousarray(part).tobytes())
        else:
            found.update(repr(part).encode())
        found.update(b"\0")
    return found.hexdigest()


def _made_with(code: str) -> str:
    return key_of(code, np.__version__, scipy.__version__)


def read_recall(path: str | Path, code: str) -> Recall:
    """Return what a file of :func:`write_recall` holds; nothing where it is missing, broken or of other code."""
    try:
        record = read_json(path)
        check(record, _RECORD, path)
    except InputError:
        return Recall()
    return Recall(record["entries"] if record["made_with"] == _made_with(code) else None)


def write_recall(path: str | Path, recall: Recall, code: str) -> None:
    """Keep what was asked for; `code` is a digest of the library."""
    write_json(path, {"made_with": _made_with(code), "entries": dict(sorted(recall.used.items()))})
