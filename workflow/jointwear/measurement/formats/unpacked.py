"""Text that a logger packed by gzip, as far as it can be unpacked: a file that was cut ends at its last whole line."""

from __future__ import annotations

import io
import zlib
from pathlib import Path
from typing import BinaryIO, cast

#: Packed bytes that are read at a time.
_PACKED = 1 << 14
#: Longest line of which the end is waited for.
_LONGEST = 1 << 20
#: Window of a gzip file for zlib.
_GZIP = 16 + zlib.MAX_WBITS


class Unpacked(io.RawIOBase):
    """The text of a gzip file, of several packed parts one after another too.

    Attributes
    ----------
    broken : whether the file was cut or damaged; what comes before that, up to the last line end, was given.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._file, self._unpack = path.open("rb"), zlib.decompressobj(_GZIP)
        self._line, self._ready, self._ended = b"", b"", False
        self._begun, self.broken = False, False

    def readable(self) -> bool:
        """Return that it can be read."""
        return True

    def readinto(self, buffer: memoryview) -> int:
        """Put the next bytes into a buffer and return how many, 0 at the end."""
        while not self._ready and not self._ended:
            self._more()
        given, self._ready = self._ready[: len(buffer)], self._ready[len(buffer) :]
        buffer[: len(given)] = given
        return len(given)

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()

    def _more(self) -> None:
        """Unpack the next bytes; what may be half a line waits for its end."""
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
        self._ready, self._line = text[:whole], text[whole:]


def open_text(path: Path) -> BinaryIO:
    """Open the text of a log; that of a packed one is read from an :class:`Unpacked`, its ``raw``."""
    return cast(BinaryIO, io.BufferedReader(Unpacked(path)) if is_packed(path) else path.open("rb"))


def is_packed(path: Path) -> bool:
    """Return whether a log is packed by gzip, by its name."""
    return path.suffix.lower() == ".gz"


def is_broken(file: BinaryIO) -> bool:
    """Return whether a file that :func:`open_text` opened was cut or damaged, as far as it has been read."""
    return bool(getattr(getattr(file, "raw", None), "broken", False))
