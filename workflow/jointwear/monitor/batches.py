"""Which logs of a robot one job reads, and the names of their results.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import hashlib
import os
import re
import stat
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

#: Logs that one job reads [bytes]: they take as long to read as the job takes to start (a second or two on one core).
BATCH_BYTES = 8e6


def batches_of(logs: Sequence[str], entry: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return key -> logs of every batch; a batch is read by one job and named after its first log.

    A batch ends after a log whose name and size say so, one name in `files_per_job` or, where the entry has none, one
    in :data:`BATCH_BYTES` over its size: a log that is added or removed anywhere changes the batch that it falls into
    and no other.
    """
    groups: list[list[str]] = [[]]
    for log in logs:
        groups[-1].append(log)
        per_job = entry.get("files_per_job") or BATCH_BYTES / _size(log)
        if zlib.crc32(os.fsencode(log)) < 2**32 / per_job:
            groups.append([])
    return {log_key(group[0]): group for group in groups if group}


def log_key(path: str) -> str:
    """Return a name for the results of one log: readable, safe in file names, different for every path."""
    stem = re.sub(r"[^A-Za-z0-9_-]+", "_", Path(path).stem)[:40].strip("_") or "log"
    return f"{stem}-{hashlib.sha256(os.fsencode(path)).hexdigest()[:8]}"


def _size(log: str) -> float:
    """Return the size of a log [bytes], rounded up to a power of two, or a full batch for a folder and a log that is
    yet to be fetched.

    Sizes are asked for at every start of Snakemake, on a cluster for every job: a log that grows meanwhile must not
    move the end of its batch, which it now does only on passing a power of two.
    """
    try:
        found = os.stat(log)
    except OSError:
        return BATCH_BYTES
    return 1 << max(found.st_size - 1, 0).bit_length() if stat.S_ISREG(found.st_mode) else BATCH_BYTES
