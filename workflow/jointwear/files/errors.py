"""Errors that a user can act on, and how they are shown."""

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

#: Longest value that a message repeats; what is wrong with a longer one shows at its beginning. Characters.
LONGEST_VALUE = 80
#: Longest message: a screen of text. Characters.
LONGEST_MESSAGE = 2000

#: What is said of a file without a byte, of a log without a row, and of a file whose end may be lacking. Each may be
#: one that is still being written.
EMPTY, NO_SAMPLES, TRUNCATED = "is empty", "holds no samples", "is truncated or not a"
#: What is said of rows or cells of a log that do not count, while all others do.
LEFT_OUT = "left out"


class InputError(ValueError):
    """Something that the user gave is wrong: the message is one line naming file, key and what is allowed.

    Line breaks and control characters, which may come from the input itself, are shown as escapes.
    """

    def __init__(self, message: object) -> None:
        super().__init__(_cut(printable(str(message)), LONGEST_MESSAGE))


def printable(text: str) -> str:
    """Return `text` on one line: what a terminal would obey instead of showing is written as an escape."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def shown(value: Any) -> str:
    """Return a value of the input as a message repeats it, cut at :data:`LONGEST_VALUE` characters."""
    try:
        return _cut(printable(repr(value)), LONGEST_VALUE)
    except ValueError:
        # Python writes no integer of more than 4,300 digits.
        return f"a {type(value).__name__} of {value.bit_length()} bits"


def quoted(word: Any) -> str:
    """Return a key between quotation marks, cut like every value that a message repeats."""
    return f"'{shown(str(word))[1:-1]}'"


def _cut(text: str, length: int) -> str:
    return text if len(text) <= length else text[: length - 3] + "..."


def nearest(word: str, allowed: Iterable[str], meant: Mapping[str, str] | None = None) -> str:
    """Return a hint ``; did you mean 'x'?`` for the allowed word closest to `word`, or an empty string.

    Parameters
    ----------
    meant : other words that count as close, and the allowed word that each stands for.
    """
    close = closest(word, [*allowed, *(meant or {})])
    return f"; did you mean '{(meant or {}).get(close, close)}'?" if close else ""


def closest(word: str, allowed: Iterable[str]) -> str:
    """Return the allowed word closest to `word`, empty where none is close."""
    words = [str(a) for a in allowed]
    return next(iter(difflib.get_close_matches(str(word)[:LONGEST_VALUE], words, n=1, cutoff=0.5)), "")
