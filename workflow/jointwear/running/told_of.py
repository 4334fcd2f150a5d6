"""Which of several configuration files a message is about, in jobs too, which know the values alone.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError

_KEY = re.compile(r"config: (?:unknown key )?'(?P<key>[^']+)'")

#: Variable of the environment by which a call tells its jobs where their values come from.
SOURCES = "JOINTWEAR_CONFIGURATION"


def lend_sources(files: Iterable[str | Path], given: Mapping[str, Any]) -> None:
    """Tell the processes started from now on where the configuration comes from; of `given` the keys alone.

    Parameters
    ----------
    files, given : as of :func:`named_in_file`.
    """
    os.environ[SOURCES] = json.dumps({"files": [str(path) for path in files], "given": _keys(given)})


def named_as_lent(message: str) -> str:
    """Return :func:`named_in_file` of the sources that :func:`lend_sources` told of, the message itself without any."""
    try:
        told = json.loads(os.environ.get(SOURCES, ""))
        return named_in_file(message, told["files"], told["given"])
    except (ValueError, TypeError, KeyError):
        return message


def _keys(values: Any) -> Any:
    """Return mappings inside each other without what they hold, which may be long, or a secret."""
    return {str(k): _keys(v) for k, v in values.items()} if isinstance(values, Mapping) else None


def named_in_file(message: str, files: Iterable[str | Path], given: Mapping[str, Any] | None = None) -> str:
    """Return a message of the configuration with the name of the file that holds its key.

    Parameters
    ----------
    message : as of an :class:`InputError`; one that does not begin with `config:` and a key comes back as it is.
    files : in the order in which their values are laid over each other. Of a key that none of them holds, the one that
        holds the mapping around it is named.
    given : values of ``--config``, which lie over those of the files.
    """
    found = _KEY.match(message)
    if found is None:
        return message
    # Of an entry of a list, told by its name as in 'monitor.notify: shop.robots', the list is looked for.
    parts = [part for part in re.split(r"\.|\[\d+\]", found["key"].split(": ")[0]) if part]
    depths = {str(path): _depth(_read(path), parts) for path in files} | {"--config": _depth(given or {}, parts)}
    deepest = max(depths.values(), default=0)
    if deepest < max(len(parts) - 1, 1):
        return message
    last = [path for path, depth in depths.items() if depth == deepest][-1]
    return last + message.removeprefix("config")


def _read(path: str | Path) -> Mapping[str, Any]:
    """Return what a file holds, nothing where it cannot be read."""
    try:
        return read_yaml(path)
    except (InputError, OSError):
        return {}


def _depth(inside: Any, parts: list[str]) -> int:
    """Return how many parts of a key are there, one inside the other."""
    for depth, part in enumerate(parts):
        if not isinstance(inside, Mapping) or part not in inside:
            return depth
        inside = inside[part]
    return len(parts)
