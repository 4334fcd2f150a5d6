"""Window statistics as netCDF files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.measurement.flags import FLAG_WORDS, Flag
from jointwear.measurement.timestamps import LATEST
from jointwear.monitor.reading.windows import HISTOGRAM_BINS, HISTOGRAM_SPAN, PER_WINDOW, REGRESSORS, WindowStatistics

_WA = ("window", "axis")
#: Dimensions, meaning and unit of every field with one row a window; mixed units are those of the regressors.
_LAYOUT: dict[str, tuple[tuple[str, ...], str, str | None]] = {
    "start": (("window",), "start of the window", "s"),
    "end": (("window",), "end of the window", "s"),
    "gram": ((*_WA, "regressor", "regressor_2"), "sum of x x' over the used samples", None),
    "moment": ((*_WA, "regressor"), "sum of x times residual torque", None),
    "square": (_WA, "sum of squared residual torque", "N2 m2"),
    "count": (_WA, "used samples", "1"),
    "samples": (("window",), "samples of the log", "1"),
    "residual_square": (_WA, "sum of squares left by the regression of each piece", "N2 m2"),
    "freedom": (_WA, "degrees of freedom of residual_square", "1"),
    "lag_square": (_WA, "sum of products of neighbouring residuals of that regression", "N2 m2"),
    "lag_count": (_WA, "products in lag_square", "1"),
    "score": ((*_WA, "regressor", "regressor_2"), "sum of outer products of the block sums of x e", None),
    "blocks": (_WA, "blocks in score", "1"),
    "stretches": (_WA, "uninterrupted stretches of motion", "1"),
    "travel": (_WA, "path of the joint", "rad"),
    "torque_peak": (_WA, "largest absolute torque", "N m"),
    "temperature": (_WA, "mean temperature, NaN where unknown", "degC"),
    "temperature_count": (_WA, "samples of the mean temperature", "1"),
    "torque_histogram": ((*_WA, "bin"), "samples of torque in equal bins", "1"),
    "pulse_near": (_WA, "sum of squares of the quick part of the residual, near reversals of the load", "N2 m2"),
    "pulse_far": (_WA, "the same away from them", "N2 m2"),
    "near_count": (_WA, "samples in pulse_near", "1"),
    "far_count": (_WA, "samples in pulse_far", "1"),
    "turns": (_WA, "reversals of the load in motion", "1"),
    "turned": (_WA, "angle of each joint's zero times turned_shown", "rad-1"),
    "turned_shown": (_WA, "what all axes tell of that angle, inverse variance", "rad-2"),
    "labels": (("window",), "samples of each program that the log names", None),
    "flags": (_WA, "what was found in reading, a bit field", "1"),
}


def write_statistics(
    statistics: WindowStatistics,
    path: str | Path,
    title: str,
    settings: Mapping[str, Any],
    more: Mapping[str, Any] | None = None,
    beside: Mapping[str, Variable] | None = None,
) -> None:
    """Write statistics; `title` and `settings` tell the origin, `more` and `beside` are further attributes and
    variables."""
    n = statistics.axes
    edge = HISTOGRAM_SPAN * np.linspace(-1, 1, HISTOGRAM_BINS + 1)
    variables = {
        "axis": Variable(("axis",), np.arange(1, n + 1), "axis of the robot", "1"),
        "regressor": Variable(("regressor",), np.array(REGRESSORS), "regressor"),
        "bin_low": Variable(("bin",), edge[:-1], "lower edge of the bin over torque_reference", "1"),
        "torque_reference": Variable(("axis",), statistics.torque_reference, "torque that scales the bins", "N m"),
    }
    variables |= {name: _variable(statistics, name) for name in PER_WINDOW}
    bits = list(Flag)
    variables["flags"].attributes.update(
        flag_masks=np.array([int(f) for f in bits], dtype=np.int32),
        flag_meanings=" ".join(f.name.lower() for f in bits),
        comment="; ".join(f"{f.name.lower()}: {FLAG_WORDS[f]}" for f in bits),
    )
    attributes = provenance.attributes(title, settings) | {"dated": int(statistics.dated)} | dict(more or {})
    write_dataset(path, {**variables, **(beside or {})}, attributes)


def _variable(statistics: WindowStatistics, name: str) -> Variable:
    """Return a field with one row a window as it is written."""
    dimensions, meaning, unit = _LAYOUT[name]
    values = np.asarray(getattr(statistics, name))
    kind = "i4" if values.dtype.kind == "i" else None
    compressed = name in ("torque_histogram", "gram", "score")
    return Variable(dimensions, values, meaning, unit, kind=kind, compressed=compressed)


def variables_beside(statistics: WindowStatistics, prefix: str, windows: str, what: str) -> dict[str, Variable]:
    """Return statistics as variables beside those of a file.

    Parameters
    ----------
    prefix : of their names. windows : the dimension of these windows. what : in words what windows they are.
    """
    found = {}
    for name in PER_WINDOW:
        own = _variable(statistics, name)
        dimensions = tuple(windows if d == "window" else d for d in own.dimensions)
        found[prefix + name] = replace(own, dimensions=dimensions, long_name=f"{own.long_name}; {what}")
    return found


def read_statistics(path: str | Path) -> WindowStatistics:
    """Read what :func:`write_statistics` wrote.

    Raises
    ------
    InputError : naming the file, if it is missing, broken, or was written by another version of this library.
    """
    with open_dataset(path) as dataset:
        return statistics_in(dataset, path)


def statistics_in(dataset: netCDF4.Dataset, path: str | Path, prefix: str = "") -> WindowStatistics:
    """Return the statistics of an open file; `prefix` of the names of those beside (:func:`variables_beside`).

    Raises
    ------
    InputError : as :func:`read_statistics`.
    """
    whole = {"regressor", *(prefix + name for name in PER_WINDOW)} <= set(dataset.variables)
    if not whole or tuple(read_variable(dataset, path, "regressor")) != REGRESSORS:
        raise InputError(f"{path}: holds no window statistics of this version; delete it and run again")
    values = {name: read_variable(dataset, path, prefix + name) for name in PER_WINDOW}
    reference, dated = read_variable(dataset, path, "torque_reference"), bool(dataset.dated)
    values = {k: v.astype(np.int64) if v.dtype.kind == "i" else v for k, v in values.items()}
    clock = np.concatenate([np.ravel(values["start"]), np.ravel(values["end"])])
    timely = np.abs(clock[np.isfinite(clock)]) < LATEST
    if not (np.isfinite(reference).all() and (reference > 0).all() and timely.all()):
        raise InputError(f"{path}: a torque reference or a time in it is impossible; delete it and run again")
    values["labels"] = np.array([str(text) for text in values["labels"]], dtype=object)
    return WindowStatistics(**values, torque_reference=reference, dated=dated)
