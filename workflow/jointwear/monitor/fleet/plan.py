"""Which robots share a job, and what the job depends on. Read by the Snakefile at every call: nothing heavy here."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from jointwear.files.digests import digest
from jointwear.monitor.plan import log_sources

#: Robots of a job at most, because starting a job costs as much as judging one or two robots; at least, where there are
#: so many; and jobs that a fleet is cut into before they grow: as many cores work on a small fleet too.
ROBOTS_PER_JOB, FEWEST_PER_JOB, JOBS = 50, 5, 16
#: Processes in which a job reads logs at most: beyond, the judgement, which one process does, takes most of the time.
MOST_PROCESSES = 4


def robots_of_job(count: int) -> int:
    """Return how many robots of a fleet of `count` share a job."""
    return min(max(-(-count // JOBS), FEWEST_PER_JOB), ROBOTS_PER_JOB)


def processes_of_job(jobs: int, cores: int | None) -> int:
    """Return in how many processes each of `jobs` jobs reads on so many `cores`: those that no job would use."""
    return max(min((cores or 1) // max(jobs, 1), MOST_PROCESSES), 1)


def batches(robots: Sequence[str]) -> dict[str, list[str]]:
    """Return robots by the name of their job, in order.

    A job is named after its robots, so that the jobs of two configurations do not take each other for their own.
    """
    size = robots_of_job(len(robots))
    groups = [list(robots[start : start + size]) for start in range(0, len(robots), size)]
    return {digest(group)[:12]: group for group in groups}


def seen(logs: Sequence[str], reason: str = "") -> str:
    """Return a digest of the logs as they are on disk (names, sizes, times) and of why some cannot be reached."""
    return digest([[stamp_of(log) for log in logs], reason])


def stamp_of(log: str) -> list[list[str | int]]:
    """Return path, size and time of change of the files of a log; a file that is gone has none."""
    stamps: list[list[str | int]] = []
    for path in log_sources(log):
        try:
            found = Path(path).stat()
            stamps.append([path, found.st_size, found.st_mtime_ns])
        except OSError:
            stamps.append([path])
    return stamps
