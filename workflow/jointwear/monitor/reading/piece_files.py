"""Statistics of logs as files: each log stays a piece of its own, so that one can be replaced without the others."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.json_documents import parse_json
from jointwear.files.storage import open_dataset, read_attribute
from jointwear.monitor.reading.assembly import Piece
from jointwear.monitor.reading.window_files import statistics_in, write_statistics
from jointwear.monitor.reading.windows import PER_WINDOW, WindowStatistics


def concatenated(parts: Sequence[WindowStatistics]) -> WindowStatistics:
    """Put the windows of logs one after the other without adding any up.

    Raises
    ------
    ValueError : if the logs were read with different references of the torque, so that histograms do not compare.
    """
    first = next((p for p in parts if p.windows), parts[0])
    filled = [p for p in parts if p.windows]
    if any(not np.allclose(p.torque_reference, first.torque_reference) for p in filled):
        raise ValueError("statistics with different torque references cannot share a file")
    if not filled:
        return first
    rows = {name: np.concatenate([getattr(p, name) for p in filled]) for name in PER_WINDOW}
    return replace(first, **rows, dated=all(p.dated for p in filled))


def write_pieces(pieces: Sequence[Piece], path: str | Path, settings: Mapping[str, Any]) -> None:
    """Write the statistics of logs; `settings` tells how they were read."""
    more = {
        "logs": json.dumps([p.log for p in pieces]),
        "refused": json.dumps([list(p.refused) for p in pieces]),
        "first": np.array([p.first for p in pieces]),
        "last": np.array([p.last for p in pieces]),
        "cut": np.array([p.cut for p in pieces], dtype=np.int32),
        "rows": np.array([p.statistics.windows for p in pieces], dtype=np.int32),
    }
    statistics = concatenated([p.statistics for p in pieces])
    write_statistics(statistics, path, "statistics of the windows of logs", dict(settings), more)


def read_pieces(path: str | Path) -> list[Piece]:
    """Read what :func:`write_pieces` wrote.

    Raises
    ------
    InputError : naming the file, if it is missing, broken, or was written by another version of this library.
    """
    with open_dataset(path) as dataset:
        statistics = statistics_in(dataset, path)
        logs, refused = (
            parse_json(str(read_attribute(dataset, path, name)), path, list) for name in ("logs", "refused")
        )
        first, last, rows = (np.atleast_1d(read_attribute(dataset, path, name)) for name in ("first", "last", "rows"))
        # Files of a log that is gone may be older than what they say of its end.
        cut = np.atleast_1d(read_attribute(dataset, path, "cut") if "cut" in dataset.ncattrs() else 0 * rows)
    edges = np.concatenate([[0], np.cumsum(rows)])
    kept = {len(x) for x in (logs, refused, first, last, cut, rows)}
    if len(kept) > 1 or edges[-1] != statistics.windows:
        raise InputError(f"{path}: its logs and windows do not belong together; delete it and run again")
    return [
        Piece(log, statistics.part(slice(a, b)), float(begin), float(end), tuple(told), cut=bool(torn))
        for log, (a, b), begin, end, told, torn in zip(
            logs, pairwise(edges.tolist()), first, last, refused, cut, strict=True
        )
    ]
