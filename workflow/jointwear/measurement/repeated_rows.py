"""Rows that a logger wrote twice: they hold the same time and the same values as the row before."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from jointwear.files.wording import count as counted
from jointwear.measurement.formats.chunk import Chunk


def without_repeated_rows(log: Chunk) -> tuple[Chunk, str]:
    """Return a log without rows that repeat the row before to the last digit, and what was left out in words.

    Rows of one time that differ in anything are kept: which of them holds is not known.
    """
    columns = {f.name: x for f in fields(log) if isinstance(x := getattr(log, f.name), np.ndarray)}
    repeated = np.ones(max(len(log.time) - 1, 0), bool)
    for values in columns.values():
        before, after = values[:-1], values[1:]
        same = before == after
        if values.dtype.kind == "f":
            same |= np.isnan(before) & np.isnan(after)
        repeated &= same.reshape(len(repeated), -1).all(axis=1)
    if not repeated.any():
        return log, ""
    kept = np.concatenate([[True], ~repeated])
    copies = int(repeated.sum())
    were = "was left out as a copy" if copies == 1 else "were left out as copies"
    words = f"{counted(copies, 'row')} {were} of the row before, time and all"
    return replace(log, **{name: values[kept] for name, values in columns.items()}), words
