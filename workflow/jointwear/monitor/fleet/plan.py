"""Which robots share a job. Read by the Snakefile at every call: nothing heavy is imported here."""

from __future__ import annotations

from collections.abc import Sequence

ROBOTS_PER_JOB = 50


def batches(robots: Sequence[str], size: int = ROBOTS_PER_JOB) -> dict[str, list[str]]:
    """Return robots by the name of their job, in order: `0000`, `0001` ..."""
    starts = range(0, len(robots), size)
    return {f"{index:04d}": list(robots[start : start + size]) for index, start in enumerate(starts)}
