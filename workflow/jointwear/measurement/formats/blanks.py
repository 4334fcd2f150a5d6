"""Text whose columns are separated by blanks, as the recorder of a controller or a table in columns has them."""

from __future__ import annotations

import io
import re
from typing import BinaryIO, cast

from jointwear.measurement.formats.pieces import Pieces
from jointwear.measurement.formats.unpacked import is_broken

#: What is between two columns once there is one of it.
BLANK = " "
#: Blanks between two columns, or before the first and behind the last.
_BETWEEN, _AROUND = re.compile(rb"[ \t]+"), re.compile(rb"(?m)^[ ]+|[ ]+(?=\r?$)")
_BLOCK = 1 << 20


def single(line: str) -> str:
    """Return a line with one blank between columns and none around them."""
    return BLANK.join(line.split())


class SingleBlanks(Pieces):
    """The text of a file with one blank between columns and none around them, line by line."""

    @property
    def broken(self) -> bool:
        """Whether the file was cut or damaged, as far as it has been read."""
        return is_broken(self._file)

    def _piece(self) -> bytes:
        lines = b"".join(self._file.readlines(_BLOCK))
        return _AROUND.sub(b"", _BETWEEN.sub(b" ", lines))


def with_single_blanks(file: BinaryIO) -> BinaryIO:
    """Return the text of an open file as :class:`SingleBlanks` has it."""
    return cast(BinaryIO, io.BufferedReader(SingleBlanks(file)))
