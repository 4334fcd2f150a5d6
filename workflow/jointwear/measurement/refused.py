"""The refusal of a recording or a log, and how many samples a joint needs before anything is said of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from jointwear.files.errors import InputError

#: Samples of a joint in motion below which it is not asked: a few parameters are fitted to them.
FEWEST_OF_JOINT = 40


class Refused(InputError):
    """A recording that must not be judged.

    Attributes
    ----------
    suggestion : what to mend, in words. by_keys : it names keys of the configuration or of the robot file, which hold
        for all logs of a robot: where others are right, such a key would spoil them.
    readings : kinds of the readings of the axes that would be right, the likeliest first; empty where it is no reading.
    """

    def __init__(self, reason: str, suggestion: str, by_keys: bool = False, readings: Sequence[str] = ()) -> None:
        super().__init__(reason)
        self.reason, self.suggestion, self.by_keys, self.readings = reason, suggestion, by_keys, tuple(readings)


@contextmanager
def telling(left_out: str) -> Iterator[None]:
    """Tell beside any refusal what was left out when the recording was read: it may be the cause.

    Parameters
    ----------
    left_out : in words, empty where all was read.

    Raises
    ------
    Refused : with what it suggests.
    """
    try:
        yield
    except Refused as error:
        if not left_out:
            raise
        told = f"{error.reason} (as it was read, {left_out})"
        raise Refused(told, error.suggestion, error.by_keys, error.readings) from None


def what_mends(error: InputError) -> str:
    """Return what mends a data set that is refused: what its refusal suggests, or where to look."""
    return getattr(error, "suggestion", "mend the entry or the file that the reason names")
