"""How every script of the workflow reports an error: one line, exit 1, no traceback for what a user can mend."""

from __future__ import annotations

import errno
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.abc import MetaPathFinder

from jointwear.files.errors import InputError
from jointwear.running.told_of import named_as_lent

#: What the surroundings of a run refuse, not the program: OSErrors of these kinds are no defect to trace back.
SURROUNDINGS = frozenset(
    (
        *(errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO),
        *(errno.ELOOP, errno.ENAMETOOLONG, errno.ENOTDIR, errno.EISDIR, errno.EMFILE, errno.ENFILE),
    )
)
#: Exit status of a job that Ctrl-C ends.
INTERRUPTED = 130


def with_suggestion(error: InputError) -> str:
    """Return what is wrong and, where the error tells it, what to mend."""
    suggestion = getattr(error, "suggestion", "")
    return f"{error}; {suggestion}" if suggestion else str(error)


def message_of(error: BaseException) -> str | None:
    """Return the one line that says what is wrong, None for an error that only a traceback explains.

    A key of the configuration comes with the file that holds it, as before the jobs.
    """
    if isinstance(error, InputError):
        return f"jointwear: {named_as_lent(with_suggestion(error))}"
    if isinstance(error, OSError) and error.errno in SURROUNDINGS:
        return f"jointwear: {error.filename or 'a file'}: {error.strerror}"
    if isinstance(error, MemoryError):
        return "jointwear: there is not enough memory"
    return None


class _Absent(MetaPathFinder):
    """Finds no module of the given names, so that importing them fails as if they were not installed."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names = frozenset(names)

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> None:
        """Raise ModuleNotFoundError for these names; say nothing of others."""
        if fullname in self._names:
            raise ModuleNotFoundError(f"No module named '{fullname}'", name=fullname)


@contextmanager
def reported(log: str | None = None, absent: Sequence[str] = ()) -> Iterator[None]:
    """Turn what a user can mend into one line on standard error (and in the rule's log) and exit 1.

    That is an :class:`InputError`, a file or folder that the system refuses, or want of memory. Of any other error the
    traceback is in the log too: a failed job without a log makes the logger plugin fail beside it. Ctrl-C is noted
    there alone.

    Parameters
    ----------
    log : of the rule. absent : modules that count as absent meanwhile, unless they are imported already: pyarrow would
        import pandas only to ask whether a value is one of its own (docs/decisions/no_pandas.md).
    """
    finder = _Absent(absent)
    sys.meta_path.insert(0, finder)
    try:
        yield
    except Exception as error:
        message = message_of(error)
        if message is None:
            _note(traceback.format_exc(), log)
            raise
        print(message, file=sys.stderr)
        _note(message, log)
        sys.exit(1)
    except KeyboardInterrupt:
        _note("jointwear: interrupted", log)
        sys.exit(INTERRUPTED)
    finally:
        sys.meta_path.remove(finder)


def _note(message: str, log: str | None) -> None:
    try:
        if log:
            with open(log, "a", encoding="utf-8") as file:
                print(message, file=file)
    except OSError:
        # Where the log cannot be written either, standard error has it.
        return
