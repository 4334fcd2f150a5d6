"""The refusal of a recording or a log, and how many samples a joint needs before anything is said of it."""

from __future__ import annotations

from collections.abc import Sequence

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


def what_mends(error: InputError) -> str:
    """Return what mends a data set that is refused: what its refusal suggests, or where to look."""
    return getattr(error, "suggestion", "mend the entry or the file that the reason names")
