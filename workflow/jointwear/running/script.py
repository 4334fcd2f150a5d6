"""How every script of the workflow reports an error: one line, exit 1, no traceback for what a user can mend."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from jointwear.files.errors import InputError


@contextmanager
def reported(log: str | None = None) -> Iterator[None]:
    """Turn an :class:`InputError` into one line on standard error (and in the rule's log) and exit 1."""
    try:
        yield
    except InputError as error:
        message = f"jointwear: {error}"
        print(message, file=sys.stderr)
        if log:
            with open(log, "a", encoding="utf-8") as file:
                print(message, file=file)
        sys.exit(1)
