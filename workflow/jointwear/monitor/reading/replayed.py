"""Logs that hold the torques of another one under other times: a replay, which measures nothing."""

from __future__ import annotations

from collections.abc import Sequence, Set

import numpy as np

from jointwear.monitor.reading.windows import WindowStatistics


def torque_marks(statistics: WindowStatistics) -> tuple | None:
    """Return what the torques of two logs have in common only where each sample is that of the other; None of a log
    that shows no friction, as the torques of a robot at rest may well be those of yesterday, or that has no dates.

    The numbers of samples in every bin of the histogram of each axis, and the largest torques, depend on no time and no
    window. Two runs of one program differ in them by their noise: in a few hundred bins, each by the root of its number
    of samples.
    """
    if (
        not statistics.windows
        or not statistics.dated
        or not statistics.count.any()
        or not statistics.torque_histogram.any()
    ):
        return None
    histogram = np.asarray(statistics.torque_histogram, dtype=np.int64).sum(axis=0)
    # Rounded, because formats keep numbers to different digits.
    peaks = tuple(f"{x:.6g}" for x in statistics.torque_peak.max(axis=0))
    return (int(statistics.samples.sum()), peaks, histogram.tobytes())


def replayed(
    statistics: Sequence[WindowStatistics],
    first: Sequence[float],
    keys: Sequence[tuple | None],
    apart: Set[int],
) -> dict[int, int]:
    """Return, by its place, every log that holds the torques of another one under other times, with the other's place:
    that of the first of them in time.

    Parameters
    ----------
    statistics : (p,) of each log. first : (p,) times of the first samples [s]. keys : (p,) what logs with the same
        samples at the same times share, None where nothing tells; such copies are none of these. apart : places of
        logs that take no part.
    """
    alike: dict[tuple, list[int]] = {}
    known: set[tuple] = set()
    for k, (own, key) in enumerate(zip(statistics, keys, strict=True)):
        marks = torque_marks(own)
        if k in apart or marks is None or key in known:
            continue
        if key is not None:
            known.add(key)
        alike.setdefault(marks, []).append(k)
    found = {}
    for same in alike.values():
        original = min(same, key=lambda k: first[k])
        found |= {k: original for k in same if k != original}
    return found


def replayed_words(log: str, other: str, apart: float) -> str:
    """Return in words that a log holds the torques of another one, `apart` [s] before."""
    hours = abs(apart) / 3600
    when = f"{hours / 24:.0f} days later" if hours >= 48 else f"{hours:.3g} h later"
    return (
        f"{log}: holds the torques of {other} to the last sample under other times, {when}, which two measurements "
        "never do; was it replayed, or exported again with other dates? Leave it out, or write what was measured"
    )
