"""The documentation as a sequence of steps: files to write, commands and programs to run."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

_BLOCK = re.compile(r"^```(?P<kind>sh|python|yaml)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"# file: (?P<path>\S+)\n")


@dataclass(frozen=True)
class Step:
    """One block of a page: `kind` is file, sh or python; `path` is set for files."""

    kind: str
    text: str
    path: str | None = None


def steps(page: Path) -> list[Step]:
    """Return the blocks of a page in order; a block without a language is output and is left out.

    Raises
    ------
    ValueError : for a YAML block that does not say which file it is; nobody could follow it.
    """
    found = []
    for block in _BLOCK.finditer(page.read_text(encoding="utf-8")):
        file = _FILE.match(block["text"])
        if file:
            found.append(Step("file", block["text"][file.end() :], file["path"]))
        elif block["kind"] == "yaml":
            raise ValueError(f"{page.name}: a YAML block names no file: {block['text'][:60]!r}")
        else:
            found.append(Step(block["kind"], block["text"]))
    return found
