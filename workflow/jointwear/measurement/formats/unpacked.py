"""Text that a logger packed by gzip, as far as it can be unpacked: a file that was cut ends at its last whole line."""

from __future__ import annotations

import io
import zlib
from pathlib import Path
from typing import BinaryIO, cast

from jointwear.measurement.formats.pieces import Pieces

#: Packed bytes that are read at a time.
_PACKED = 1 << 14
#: Longest line of which the end is waited for.
_LONGEST = 1 << 20
#: Window of a gzip file for zlib.
_GZIP = 16 + zlib.MAX_WBITS


class Unpacked(Pieces):
    """The text of a gzip file, of several packed parts one after another too.

    Attributes
    ----------
    broken : whether the file was cut or damaged; what comes before that, up to the last line end, was given.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path.open("rb"))
        self._unpack = zlib.decompressobj(_GZIP)
        self._line, self._ended = b"", False
        self._begun, self.broken = False, False

    def _piece(self) -> bytes:
        text = b""
        while not text and not self._ended:
            text = self._lines()
        return text

    def _lines(self) -> bytes:
        """Unpack the next bytes and return what is whole of them; what may be half a line waits for its end."""
        packed, text = self._file.read(_PACKED), self._line
        self._ended = not packed
        try:
            while packed:
                text, self._begun = text + self._unpack.decompress(packed), True
                packed = self._unpack.unused_data
                if self._unpack.eof:
                    # Some writers fill up the last block.
                    packed = packed.lstrip(b"\0")
                    self._unpack, self._begun = zlib.decompressobj(_GZIP), False
        except zlib.error:
            self._ended = self.broken = True
        self.broken |= self._ended and self._begun
        whole = text.rfind(b"\n") + 1
        if self._ended != self.broken or (not self._ended and len(text) - whole > _LONGEST):
            whole = len(text)
        self._line = text[whole:]
        return text[:whole]


def open_text(path: Path) -> BinaryIO:
    """Open the text of a log; that of a packed one is read from an :class:`Unpacked`, its ``raw``."""
    return cast(BinaryIO, io.BufferedReader(Unpacked(path)) if is_packed(path) else path.open("rb"))


def is_packed(path: Path) -> bool:
    """Return whether a log is packed by gzip, by its name."""
    return path.suffix.lower() == ".gz"


def is_broken(file: BinaryIO) -> bool:
    """Return whether a file that :func:`open_text` opened was cut or damaged, as far as it has been read."""
    return bool(getattr(getattr(file, "raw", None), "broken", False))
