"""Hourly features of the torque: histograms, their KL divergence to a reference, and plain statistics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.reproduction.grid import run_attributes
from jointwear.reproduction.readings import (
    empty_bin_floor,
    kl_direction,
    out_of_range,
    reference_distribution,
    select,
    torque_normalisation,
    torque_sign,
)

_CHUNK = 50  # replicates held in memory at once: 50 x 120 h x 60 samples x 6 axes are 86 MB


@dataclass(frozen=True)
class Reference:
    """Normal operation in brief, per replicate r and axis n.

    `hour_maximum` (r, n): largest |torque| [N m] of the first hour; `period_maximum` (r, n): of the whole
    training; `histogram` (r, hours, n, bins): normalised histograms of training.
    """

    hour_maximum: np.ndarray
    period_maximum: np.ndarray
    histogram: np.ndarray


def hourly_maximum(torque: np.ndarray) -> np.ndarray:
    """Return the largest |torque| of every hour: (r, hours, samples, n) -> (r, hours, n)."""
    return np.maximum(torque.max(axis=-2), -torque.min(axis=-2))


def histograms(torque: np.ndarray, scale: np.ndarray, bins: int, reading: Mapping[str, str]) -> np.ndarray:
    """Return normalised histograms of every hour and axis, mass 1, shape (r, hours, n, bins).

    Parameters
    ----------
    torque : (r, hours, samples, n) [N m].
    scale : (r, hours or 1, n) maximum by which the torque is divided [N m]; 0 counts as 1.
    bins : number of equal bins on [0, 1].

    Raises
    ------
    InputError : if a torque is not finite.
    """
    safe = np.where(scale == 0, 1.0, scale)[:, :, None, :]
    position = select(torque_sign, reading["torque_sign"])(torque / safe)
    if not np.isfinite(position).all():
        # As whole numbers they would be anything.
        raise InputError("a torque, or its share of the largest, is not finite; its histogram means nothing")
    index = np.floor(position * bins).astype(np.intp)
    # The maximum itself belongs to the last bin, not beyond it.
    index[(index == bins) & (position <= 1)] = bins - 1
    index, kept = select(out_of_range, reading["out_of_range"])(index, bins)
    r, hours, _, n = torque.shape
    cell = (np.arange(r * hours).reshape(r, hours, 1, 1) * n + np.arange(n)) * bins
    flat = (index + cell).ravel() if kept is None else (index + cell)[kept]
    counts = np.bincount(flat, minlength=r * hours * n * bins).reshape(r, hours, n, bins)
    total = counts.sum(axis=-1, keepdims=True)
    # An hour of which nothing is left counts as evenly spread, so that it has mass 1 like every other.
    return np.where(total > 0, counts, 1) / np.where(total > 0, total, bins)


def kl_divergence(hour: np.ndarray, reference: np.ndarray, reading: Mapping[str, str]) -> np.ndarray:
    """Return the Kullback-Leibler divergence [nat] of histograms (..., bins), >= 0 and 0 for equal ones.

    Empty bins get the floor of the reading, then both histograms are normalised again.
    """
    floor = select(empty_bin_floor, reading["empty_bin_floor"])()
    hour, reference = np.maximum(hour, floor), np.maximum(reference, floor)
    hour, reference = hour / hour.sum(axis=-1, keepdims=True), reference / reference.sum(axis=-1, keepdims=True)
    return select(kl_direction, reading["kl_direction"])(hour, reference)


def hourly_features(
    torque: np.ndarray, reference: Reference, bins: int, reading: Mapping[str, str]
) -> dict[str, np.ndarray]:
    """Return all features of a run, each (r, hours, n), the histogram (r, hours, n, bins).

    `maximum_torque` and `mean_absolute_torque` in N m, `variation` is the coefficient of variation of |torque|
    (sample standard deviation over mean, Table VI), `kl_divergence` in nat.
    """
    size = np.abs(torque)
    mean = size.mean(axis=-2)
    deviation = size.std(axis=-2, ddof=1)
    hourly = hourly_maximum(torque)
    scale = select(torque_normalisation, reading["torque_normalisation"])(
        hourly, reference.hour_maximum, reference.period_maximum
    )
    histogram = histograms(torque, scale, bins, reading)
    chosen = select(reference_distribution, reading["reference_distribution"])(histogram, reference.histogram)
    return {
        "histogram": histogram,
        "kl_divergence": kl_divergence(histogram, chosen, reading),
        "maximum_torque": hourly,
        "mean_absolute_torque": mean,
        "variation": np.divide(deviation, mean, out=np.zeros_like(mean), where=mean > 0),
    }


def build_reference(torque: np.ndarray, bins: int, reading: Mapping[str, str]) -> Reference:
    """Summarise normal operation, torque (r, hours, samples, n) [N m]."""
    hourly = hourly_maximum(torque)
    first, period = hourly[:, 0], hourly.max(axis=1)
    scale = select(torque_normalisation, reading["torque_normalisation"])(hourly, first, period)
    return Reference(first, period, histograms(torque, scale, bins, reading))


def _chunks(path: str | Path):
    """Yield the torque of a run in chunks of replicates, in double precision."""
    with open_dataset(path) as dataset:
        count = dataset.dimensions["replicate"].size
        for start in range(0, count, _CHUNK):
            yield read_variable(dataset, path, "torque", slice(start, start + _CHUNK)).astype(float)


def write_reference(torque: str | Path, output: str | Path, settings: Mapping[str, Any]) -> None:
    """Summarise the normal operation of a task; see :class:`Reference` for what the file holds."""
    parts = [build_reference(chunk, settings["bins"], settings["reading"]) for chunk in _chunks(torque)]
    hour_maximum = np.concatenate([p.hour_maximum for p in parts])
    period_maximum = np.concatenate([p.period_maximum for p in parts])
    histogram = np.concatenate([p.histogram for p in parts])
    by_axis = ("replicate", "axis")
    write_dataset(
        output,
        {
            "axis": Variable(("axis",), np.arange(1, hour_maximum.shape[1] + 1), "axis of the robot", "1"),
            "hour_maximum": Variable(by_axis, hour_maximum, "largest |torque| of the first hour", "N m"),
            "period_maximum": Variable(by_axis, period_maximum, "largest |torque| of the training period", "N m"),
            "histogram": Variable(
                ("replicate", "hour", "axis", "bin"),
                histogram,
                "normalised histogram of training",
                "1",
                kind="f4",
                compressed=True,
            ),
        },
        provenance.attributes("normal operation in brief", settings, [torque]),
    )


def write_features(torque: str | Path, reference: str | Path, output: str | Path, settings: Mapping[str, Any]) -> None:
    """Compute the features of a run.

    Parameters
    ----------
    torque, reference : files of :func:`jointwear.reproduction.simulation.simulate_run` and :func:`write_reference`.
    output : netCDF file; see :func:`hourly_features` for its variables.
    settings : `bins` and `reading`.
    """
    with open_dataset(reference) as dataset:
        parts, start = [], 0
        for chunk in _chunks(torque):
            part = slice(start, start + len(chunk))
            known = Reference(
                *(
                    read_variable(dataset, reference, name, part).astype(float)
                    for name in ("hour_maximum", "period_maximum", "histogram")
                )
            )
            parts.append(hourly_features(chunk, known, settings["bins"], settings["reading"]))
            start += len(chunk)
    joined = {name: np.concatenate([p[name] for p in parts]) for name in parts[0]}
    hours, n = joined["kl_divergence"].shape[1:]
    by_hour = ("replicate", "hour", "axis")
    write_dataset(
        output,
        {
            "hour": Variable(("hour",), np.arange(1, hours + 1), "time since the start of the run", "h"),
            "axis": Variable(("axis",), np.arange(1, n + 1), "axis of the robot", "1"),
            "histogram": Variable(
                (*by_hour, "bin"),
                joined["histogram"],
                "normalised histogram of the torque",
                "1",
                kind="f4",
                compressed=True,
            ),
            "kl_divergence": Variable(
                by_hour, joined["kl_divergence"], "KL divergence to the reference", "1", attributes={"unit": "nat"}
            ),
            "maximum_torque": Variable(by_hour, joined["maximum_torque"], "largest |torque| of the hour", "N m"),
            "mean_absolute_torque": Variable(by_hour, joined["mean_absolute_torque"], "mean |torque|", "N m"),
            "variation": Variable(by_hour, joined["variation"], "coefficient of variation of |torque|", "1"),
        },
        {
            **provenance.attributes("hourly features of the torque", settings, [torque, reference]),
            **run_attributes(torque),
        },
    )
