"""The checksum of a picture: a last line that readers of SVG skip and :func:`unsealed` holds to the rest."""

from __future__ import annotations

import re
import zlib

from jointwear.files.errors import InputError

_SEAL = re.compile(r"<!-- crc32 ([0-9a-f]{8}) -->\n?\Z")


def sealed(text: str) -> str:
    """Return the text of an SVG file with its checksum."""
    return f"{text}<!-- crc32 {zlib.crc32(text.encode()):08x} -->\n"


def unsealed(text: str, name: object) -> str:
    """Return the text of an SVG file without its checksum; one that never had any stays as it is.

    Raises
    ------
    InputError : naming the file, if it was changed since it was written.
    """
    seal = _SEAL.search(text)
    if seal is None:
        return text
    content = text[: seal.start()]
    if f"{zlib.crc32(content.encode()):08x}" != seal[1]:
        raise InputError(f"{name}: was changed or damaged since it was written; delete it and run again")
    return content
