"""Statistics of logs as files: each log stays a piece of its own, so that one can be replaced without the others."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.json_documents import parse_json
from jointwear.files.storage import Variable, open_dataset, read_attribute, read_variable
from jointwear.monitor.reading.assembly import Piece
from jointwear.monitor.reading.loads_of_windows import PER_LOAD, LoadsOfWindows, all_loads, no_loads
from jointwear.monitor.reading.window_files import statistics_in, variables_beside, write_statistics
from jointwear.monitor.reading.windows import PER_WINDOW, WindowStatistics

#: What the names of the windows with doubtful loads begin with.
_DOUBTFUL = "doubtful_"
#: Dimensions, meaning and unit of every field with one row a load.
_LOADS: dict[str, tuple[tuple[str, ...], str, str | None]] = {
    "start": (("load",), "start of the window that shows a load", "s"),
    "moments": (("load", "moment_of_load"), "mass [kg] and first moments [kg m] at the flange", None),
    "fall": (("load",), "log of the factor by which it lets the variance fall", "1"),
    "information": (("load", "moment_of_load", "moment_of_load_2"), "what that falls by for other moments", None),
    "clear": (("load",), "whether the statistics of the windows hold it", "1"),
}


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
    counts, beside = _loads_beside([p.loads for p in pieces])
    write_statistics(
        statistics, path, "statistics of the windows of logs", dict(settings), {**more, **counts}, beside=beside
    )


def _loads_beside(loads: Sequence[LoadsOfWindows]) -> tuple[dict[str, np.ndarray], dict[str, Variable]]:
    """Return how many loads and doubtful windows each log has, and these, as attributes and variables; nothing where no
    log has any."""
    total = all_loads(loads)
    if not len(total):
        return {}, {}
    variables = {
        f"load_{name}": Variable(dimensions, getattr(total, name), meaning, unit)
        for name, (dimensions, meaning, unit) in _LOADS.items()
    }
    doubtful = [x.doubtful for x in loads]
    counts = {
        "loads": np.array([len(x) for x in loads], dtype=np.int32),
        "doubtful": np.array([0 if x is None else x.windows for x in doubtful], dtype=np.int32),
    }
    if counts["doubtful"].any():
        whole = concatenated([x for x in doubtful if x is not None])
        variables |= variables_beside(whole, _DOUBTFUL, "doubtful_window", "with the loads that are not clear")
    return counts, variables


def _loads_in(dataset: netCDF4.Dataset, path: str | Path, logs: int) -> list[LoadsOfWindows]:
    """Return the loads of each of the `logs` of an open file; none of a file that is older than loads are kept.

    Raises
    ------
    InputError : naming the file, if it is broken.
    """
    if "loads" not in dataset.ncattrs():
        return [no_loads()] * logs
    counts = [np.atleast_1d(read_attribute(dataset, path, name)) for name in ("loads", "doubtful")]
    columns = {name: read_variable(dataset, path, f"load_{name}") for name in PER_LOAD}
    columns["clear"] = columns["clear"].astype(bool)
    doubtful = statistics_in(dataset, path, _DOUBTFUL) if counts[1].any() else None
    of_loads, of_windows = (np.concatenate([[0], np.cumsum(n)]) for n in counts)
    held = len(columns["start"]), 0 if doubtful is None else doubtful.windows
    if {len(n) for n in counts} != {logs} or (of_loads[-1], of_windows[-1]) != held:
        raise InputError(f"{path}: its logs and loads do not belong together; delete it and run again")
    return [
        LoadsOfWindows(
            **{name: values[a:b] for name, values in columns.items()},
            doubtful=None if doubtful is None or c == d else doubtful.part(slice(c, d)),
        )
        for (a, b), (c, d) in zip(pairwise(of_loads.tolist()), pairwise(of_windows.tolist()), strict=True)
    ]


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
        loads = _loads_in(dataset, path, len(logs))
    edges = np.concatenate([[0], np.cumsum(rows)])
    kept = {len(x) for x in (logs, refused, first, last, cut, rows)}
    if len(kept) > 1 or edges[-1] != statistics.windows:
        raise InputError(f"{path}: its logs and windows do not belong together; delete it and run again")
    return [
        Piece(log, statistics.part(slice(a, b)), float(begin), float(end), tuple(told), cut=bool(torn), loads=shown)
        for log, (a, b), begin, end, told, torn, shown in zip(
            logs, pairwise(edges.tolist()), first, last, refused, cut, loads, strict=True
        )
    ]
