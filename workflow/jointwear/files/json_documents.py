"""Write and read JSON files: one writer, one reader, with errors of one line.

What the writer wrote carries a checksum of its content, so that a damaged digit is found like a damaged brace. Read by
the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError, shown
from jointwear.files.regular_files import read_text
from jointwear.files.text_files import replace_text

#: Largest JSON file; the largest that the workflow writes, the chapter of a long study, has a hundredth of it. Bytes.
LARGEST_JSON = 256 << 20

#: Key of the checksum, the last of a file.
CHECKSUM = "checksum"


def write_json(path: str | Path, content: Mapping[str, Any]) -> None:
    """Write a mapping as JSON for :func:`read_json`: numbers that are not finite as null, and a checksum of the rest.

    Raises
    ------
    InputError : if it cannot be written.
    """
    # Imports numpy, which a reader has no use for.
    from jointwear.files.json_values import as_json

    data = as_json(content)
    replace_text(path, json.dumps({**data, CHECKSUM: _checksum(data)}, indent=1, ensure_ascii=False) + "\n")


def _checksum(data: Mapping[str, Any]) -> str:
    """Return the CRC-32 of content, whatever the layout of the file; it is there to find damage, not forgery."""
    return f"{zlib.crc32(json.dumps(data, allow_nan=False).encode()):08x}"


def read_json(path: str | Path, kind: type = dict) -> Any:
    """Read a JSON file; of one that :func:`write_json` wrote the checksum is held to the content and left out.

    Parameters
    ----------
    path : the file.
    kind : `dict` or `list`, what the file holds at its top.

    Raises
    ------
    InputError : naming the file, if it is missing, truncated, not JSON, holds another kind of value, or NaN or
        infinity, which JSON does not have, or a key twice, or was changed since it was written.
    """
    data = parse_json(read_text(path, LARGEST_JSON), path, kind)
    if isinstance(data, dict) and CHECKSUM in data and data.pop(CHECKSUM) != _checksum(data):
        raise InputError(f"{path}: was changed or damaged since it was written; delete it and run again")
    return data


def parse_json(text: str, name: object, kind: type = dict) -> Any:
    """Read JSON text as :func:`read_json` reads a file; `name` is what a message calls it.

    Raises
    ------
    InputError : if the text is no JSON, or holds another `kind` than is asked for.
    """
    try:
        data = json.loads(text, parse_constant=_refuse, parse_float=_finite, object_pairs_hook=_mapping)
    except RecursionError:
        raise InputError(f"{name}: is nested too deeply") from None
    except ValueError as error:
        raise InputError(f"{name}: cannot be read as JSON ({error}); delete it and run again") from None
    if not isinstance(data, kind):
        wanted = {dict: "a mapping", list: "a list"}.get(kind, kind.__name__)
        raise InputError(f"{name}: must hold {wanted}, holds {type(data).__name__}; delete it and run again")
    return data


def _mapping(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return a mapping; of a key that is given twice one reader takes the first value and another the last."""
    data = dict(pairs)
    if len(data) < len(pairs):
        seen: set[str] = set()
        twice = next(key for key, _ in pairs if key in seen or seen.add(key))
        raise ValueError(f"holds the key {shown(twice)} twice")
    return data


def _refuse(word: str) -> float:
    raise ValueError(f"holds {word}, which JSON does not have")


def _finite(text: str) -> float:
    value = float(text)
    if value in (float("inf"), float("-inf")):
        raise ValueError(f"holds {text[:20]}, which is not finite")
    return value
