"""Errors that a user can act on, and how they are shown."""

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Something that the user gave is wrong: the message is one line naming file, key and what is allowed."""


def nearest(word: str, allowed: Iterable[str]) -> str:
    """Return a hint ``; did you mean 'x'?`` for the allowed word closest to `word`, or an empty string."""
    close = difflib.get_close_matches(str(word), [str(a) for a in allowed], n=1, cutoff=0.5)
    return f"; did you mean '{close[0]}'?" if close else ""
