"""Histograms and divergences of all runs of a task, each computed once for all readings that share it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointwear.reproduction.features import kl_divergence
from jointwear.reproduction.readings import (
    out_of_range,
    reference_distribution,
    select,
    torque_normalisation,
    torque_sign,
)
from jointwear.studies.multiverse.shared_torque import SharedTask, cell_offset

Column = tuple[int, float]  # 1-based axis and increase [%]


def count_bins(torque: np.ndarray, scale: np.ndarray, bins: int, reading: Mapping[str, str]) -> np.ndarray:
    """Return how many samples of every hour and axis fall into each bin, (r, hours, n, bins).

    The same as :func:`jointwear.reproduction.features.histograms` before it divides by the number of samples, but
    counted by comparing bytes instead of by sorting indices.

    Parameters
    ----------
    torque : (samples, r, hours, n) [N m].
    scale : (r, hours or 1, n) maximum by which the torque is divided [N m]; 0 counts as 1.
    """
    position = select(torque_sign, reading["torque_sign"])(torque / np.where(scale == 0, 1, scale))
    index = np.floor(position * bins).clip(-1, bins).astype(np.int8)
    index[(index == bins) & (position <= 1)] = bins - 1
    index, kept = select(out_of_range, reading["out_of_range"])(index, bins)
    if kept is not None:
        index = np.where(kept, index, np.int8(bins))
    counts = np.empty((*torque.shape[1:], bins), dtype=np.uint8)
    for b in range(bins):
        np.add.reduce((index == b).view(np.uint8), axis=0, dtype=np.uint8, out=counts[..., b])
    return counts


def as_histogram(counts: np.ndarray) -> np.ndarray:
    """Return counts (..., bins) as histograms of mass 1; an hour of which nothing is left is evenly spread."""
    total = counts.sum(axis=-1, keepdims=True, dtype=float)
    return np.where(total > 0, counts, 1) / np.where(total > 0, total, counts.shape[-1])


@dataclass(frozen=True)
class TaskCounts:
    """Histogram counts and hourly means of a task: training, normal operation, and every worn run.

    `training`, `normal` (r, hours, n, bins); `worn` maps (axis, increase) to (r, hours, n, bins) of a run; the
    plain statistics of |torque| [N m], `mean_absolute_torque` and `maximum_torque`, have the same shapes without
    bins. `hours` are the normal hours whose noise a worn run has.
    """

    training: np.ndarray
    normal: np.ndarray
    worn: dict[Column, np.ndarray]
    training_plain: dict[str, np.ndarray]
    normal_plain: dict[str, np.ndarray]
    worn_plain: dict[Column, dict[str, np.ndarray]]
    hours: dict[Column, np.ndarray]


def _plain(torque: np.ndarray) -> dict[str, np.ndarray]:
    size = np.abs(torque)
    return {"mean_absolute_torque": size.mean(axis=0), "maximum_torque": size.max(axis=0)}


def count_task(
    shared: SharedTask,
    axes: list[int],
    increases: list[float],
    shape: float,
    bins: int,
    reading: Mapping[str, str],
) -> TaskCounts:
    """Count all runs of a task under one reading of normalisation, sign and range."""
    normalise = select(torque_normalisation, reading["torque_normalisation"])
    training_plain, normal_plain = _plain(shared.training), _plain(shared.normal)
    training_maximum = training_plain["maximum_torque"]
    first, period = training_maximum[:, 0], training_maximum.max(axis=1)
    n = shared.normal.shape[-1]

    def count(torque: np.ndarray, hourly: np.ndarray, chosen: slice = slice(None)) -> np.ndarray:
        # The largest of all axes needs all of them, so that the scale is made before an axis is taken.
        scale = normalise(hourly, first, period)[:, :, chosen].astype(np.float32)
        return count_bins(torque, scale, bins, reading)

    training = count(shared.training, training_maximum)
    normal = count(shared.normal, normal_plain["maximum_torque"])
    worn, worn_plain, taken = {}, {}, {}
    for c, increase in enumerate(increases):
        for axis in axes:
            offset = cell_offset(axis, c, n)
            torque = shared.worn(axis, increase, shape, offset)
            # `worn` returns the worn axis alone where the others keep the torque of the normal hours.
            chosen = slice(None) if shared.leaks else slice(axis - 1, axis)
            hours = shared.hours_from(offset)
            counts, plain = normal[:, hours], {k: v[:, hours] for k, v in normal_plain.items()}
            for k, v in _plain(torque).items():
                plain[k][:, :, chosen] = v
            counts[:, :, chosen] = count(torque, plain["maximum_torque"], chosen)
            column = (axis, increase)
            worn[column], worn_plain[column], taken[column] = counts, plain, hours
    return TaskCounts(training, normal, worn, training_plain, normal_plain, worn_plain, taken)


@dataclass(frozen=True)
class TaskSeries:
    """KL divergence [nat] of training, normal operation and worn runs, shapes as in :class:`TaskCounts`."""

    training: np.ndarray
    normal: np.ndarray
    worn: dict[Column, np.ndarray]


def divergences(counts: TaskCounts, reading: Mapping[str, str], leaks: bool) -> TaskSeries:
    """Return the KL divergence of all runs to the reference of the reading.

    Parameters
    ----------
    leaks : whether wear of one axis changes the others; if not, a worn run has their divergence from the normal
        hours, unless each run is its own reference.
    """
    training = as_histogram(counts.training)

    def divergence(run: np.ndarray, axes: slice = slice(None)) -> np.ndarray:
        histogram = as_histogram(run[:, :, axes])
        reference = select(reference_distribution, reading["reference_distribution"])(histogram, training[:, :, axes])
        return kl_divergence(histogram, reference, reading)

    normal = divergence(counts.normal)
    worn = {}
    for (axis, increase), run in counts.worn.items():
        if leaks or reading["reference_distribution"] == "first_hour_of_run":
            worn[axis, increase] = divergence(run)
        else:
            own = slice(axis - 1, axis)
            worn[axis, increase] = series = normal[:, counts.hours[axis, increase]]
            series[:, :, own] = divergence(run, own)
    return TaskSeries(divergence(counts.training), normal, worn)
