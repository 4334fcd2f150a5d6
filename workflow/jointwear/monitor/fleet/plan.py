"""Which robots share a job, and what the job depends on. Read by the Snakefile at every call: nothing heavy here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jointwear.files.digests import digest
from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json
from jointwear.measurement.log_kinds import log_sources

#: Robots of a job at most, because starting a job costs as much as judging one or two robots; at least, where there are
#: so many; and jobs that a fleet is cut into before they grow: as many cores work on a small fleet too.
ROBOTS_PER_JOB, FEWEST_PER_JOB, JOBS = 50, 5, 16
#: Processes in which a job reads logs at most: beyond, the judgement, which one process does, takes most of the time.
MOST_PROCESSES = 4
#: What marks the folder of a robot, whose it is: the first file that is written there.
WHOSE = "whose.txt"
#: Files of every judgement; a page is written where there is something to check.
JUDGEMENT = ("state.nc", "alarms.csv", "history.parquet")


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


def begun(known: str | Path, folder: str | Path) -> dict[str, int]:
    """Return how often each robot of a job was or has to be looked at again because files of it had been taken away:
    its whole folder, or a file of its judgement.

    A parameter of the job, which runs again where it changes. It has to stay once the job has made the folder again, so
    the job notes it.

    Parameters
    ----------
    known : file in which the job notes folders and counts, see :func:`noted`; where it cannot be read nothing is known.
    folder : of the robots.

    Returns
    -------
    dict : by name, of the robots of which files were gone at all.
    """
    try:
        notes = read_json(known)
        counts = {str(name): int(times) for name, times in notes["begun"].items()}
        folders = {str(name): Path(folder) / str(own) for name, own in notes["folders"].items()}
        files = {str(name): [str(file) for file in written] for name, written in notes.get("files", {}).items()}
    except (InputError, OSError, KeyError, TypeError, ValueError, AttributeError):
        return {}
    for name, own in folders.items():
        if not all((own / file).is_file() for file in (WHOSE, *files.get(name, ()))):
            counts[name] = counts.get(name, 0) + 1
    return counts


def noted(rows: Sequence[Mapping[str, Any]], counts: Mapping[str, int]) -> dict[str, dict[str, Any]]:
    """Return what :func:`begun` wants to know the next time, from the rows of robots and what it said before."""
    return {
        "folders": {row["robot"]: row["folder"] for row in rows},
        "files": {row["robot"]: _written(row) for row in rows},
        "begun": dict(counts),
    }


def _written(row: Mapping[str, Any]) -> list[str]:
    """Return the files of a robot's judgement, by its row; a robot that is refused has none."""
    if row.get("result") != "judged":
        return []
    return [*JUDGEMENT, *([row["page"]] if row.get("page") else [])]


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
