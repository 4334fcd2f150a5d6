"""The text of a file that is made anew while it is read, piece by piece."""

from __future__ import annotations

import io
from abc import abstractmethod
from typing import BinaryIO


class Pieces(io.RawIOBase):
    """The text that :meth:`_piece` makes of a file, which is closed with it."""

    def __init__(self, file: BinaryIO) -> None:
        super().__init__()
        self._file, self._ready = file, b""

    @abstractmethod
    def _piece(self) -> bytes:
        """Return what comes next, empty at the end."""

    def readable(self) -> bool:
        """Return that it can be read."""
        return True

    def readinto(self, buffer: memoryview) -> int:
        """Put the next bytes into a buffer and return how many, 0 at the end."""
        self._ready = self._ready or self._piece()
        given, self._ready = self._ready[: len(buffer)], self._ready[len(buffer) :]
        buffer[: len(given)] = given
        return len(given)

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()
