"""The program that a sample belongs to, as one text: from columns of the log, or from the log's name."""

from __future__ import annotations

from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.formats.layout import Layout

#: Between the parts of a label.
BETWEEN = " / "
#: Most programs of a block of samples: a column with more holds a measured quantity.
MOST_PROGRAMS = 500


def label_of(value: Any) -> str:
    """Return a value of a column as text: numbers by their value (80 and 80.0 are one program), empty if missing."""
    if value is None:
        return ""
    text = str(value).strip()
    try:
        number = float(text.replace(",", "."))
    except ValueError:
        return text
    return f"{number:.6g}" if np.isfinite(number) else ""


def joined_labels(path: Path, columns: Sequence[np.ndarray]) -> np.ndarray:
    """Return the label (m,) of every sample from the values of one or more columns, each (m,).

    Raises
    ------
    InputError : where a column takes more values than programs can have.
    """
    labels: np.ndarray | None = None
    for given in columns:
        texts = [label_of(v) for v in given] if given.dtype.kind == "O" else given
        names, place = np.unique(np.asarray(texts), return_inverse=True)
        if len(names) > MOST_PROGRAMS:
            raise InputError(
                f"{path}: a column of 'program.columns' takes {len(names)} values, '{names[0]}' and '{names[1]}' among "
                f"them (allowed: at most {MOST_PROGRAMS}); it names no programs"
            )
        told = np.array([label_of(name) for name in names], dtype=object)[place]
        labels = told if labels is None else labels + BETWEEN + told
    return labels if labels is not None else np.zeros(0, dtype=object)


def with_log_name(path: Path, layout: Layout, labels: np.ndarray | None, count: int) -> np.ndarray | None:
    """Return labels (m,) with the program that the log's name stands for before them; None where nothing tells.

    The first pattern that fits the path of the log counts.
    """
    named = next((name for pattern, name in layout.program_of if fnmatchcase(path.as_posix(), pattern)), None)
    if named is None:
        return labels
    if labels is None:
        return np.full(count, str(named), dtype=object)
    return f"{named}{BETWEEN}" + labels
