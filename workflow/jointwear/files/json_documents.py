"""Read JSON files: one reader, with errors of one line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.regular_files import read_text

#: Largest JSON file; the largest that the workflow writes, the chapter of a long study, has a hundredth of it. Bytes.
LARGEST_JSON = 256 << 20


def read_json(path: str | Path, kind: type = dict) -> Any:
    """Read a JSON file that this workflow wrote.

    Parameters
    ----------
    path : the file.
    kind : `dict` or `list`, what the file holds at its top.

    Raises
    ------
    InputError : naming the file, if it is missing, truncated, not JSON, holds another kind of value, or NaN or
        infinity, which JSON does not have.
    """
    return parse_json(read_text(path, LARGEST_JSON), path, kind)


def parse_json(text: str, name: object, kind: type = dict) -> Any:
    """Read JSON text as :func:`read_json` reads a file; `name` is what a message calls it."""
    try:
        data = json.loads(text, parse_constant=_refuse, parse_float=_finite)
    except RecursionError:
        raise InputError(f"{name}: is nested too deeply") from None
    except ValueError as error:
        raise InputError(f"{name}: cannot be read as JSON ({error}); delete it and run again") from None
    if not isinstance(data, kind):
        wanted = {dict: "a mapping", list: "a list"}.get(kind, kind.__name__)
        raise InputError(f"{name}: must hold {wanted}, holds {type(data).__name__}; delete it and run again")
    return data


def _refuse(word: str) -> float:
    raise ValueError(f"holds {word}, which JSON does not have")


def _finite(text: str) -> float:
    value = float(text)
    if value in (float("inf"), float("-inf")):
        raise ValueError(f"holds {text[:20]}, which is not finite")
    return value
