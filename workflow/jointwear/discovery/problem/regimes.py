"""Residual torque by regime: what a mean over bins of one argument explains of the residual, in N m and as a share."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.storage import read_variables

#: Bins of equal count over each argument. As many for every argument, so that their shares compare; few, so that the
#: share that noise alone explains (about bins over independent samples) stays below a few per cent.
BINS = 8
#: Usable samples that a joint needs for each bin to mean anything.
LEAST_SAMPLES = 10 * BINS


@dataclass(frozen=True)
class ModelSamples:
    """Samples of models.nc: arrays (N, joints) but for `time` (N,) [s]; torques and residuals in N m."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    temperature: np.ndarray
    load: np.ndarray
    usable: np.ndarray
    retuned: np.ndarray
    augmented: np.ndarray

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self.position.shape[1]


@dataclass(frozen=True)
class Regimes:
    """Residual torque after retuning, by joint and argument.

    rms, share : (joints, arguments) root mean square of the binned mean [N m] and its share of the mean square
    residual; NaN where there is nothing to bin.
    residual : (joints,) RMS of the residual [N m], NaN for a joint at rest.
    """

    arguments: tuple[str, ...]
    rms: np.ndarray
    share: np.ndarray
    residual: np.ndarray

    def largest(self) -> dict[str, Any] | None:
        """Return joint (1-based), argument, rms, share and residual of the largest torque that one regime explains."""
        if not np.isfinite(self.rms).any():
            return None
        j, k = np.unravel_index(int(np.nanargmax(self.rms)), self.rms.shape)
        return {
            "joint": int(j) + 1,
            "argument": self.arguments[k],
            "rms": float(self.rms[j, k]),
            "share": float(self.share[j, k]),
            "residual": float(self.residual[j]),
        }


def read_model_samples(models: str | Path) -> ModelSamples:
    """Read models.nc of a data set; its retuned and augmented torques become residuals, measured less model."""
    names = ("time", "position", "velocity", "acceleration", "temperature", "load", "usable")
    *found, torque, retuned, augmented = read_variables(models, *names, "torque", "retuned", "augmented")
    values = dict(zip(names, found, strict=True))
    values["usable"] = values["usable"] > 0
    return ModelSamples(**values, retuned=torque - retuned, augmented=torque - augmented)


def binned_mean(residual: np.ndarray, argument: np.ndarray, carrier: np.ndarray) -> np.ndarray:
    """Return the least-squares fit of a multiple of `carrier` in each of BINS bins of equal count, all of shape (N,).

    With a carrier of ones it is the mean of the bin.
    """
    edges = np.unique(np.quantile(argument, np.linspace(0, 1, BINS + 1)))
    count = max(len(edges) - 1, 1)
    place = np.clip(np.searchsorted(edges, argument, side="right") - 1, 0, count - 1)
    power = np.bincount(place, carrier**2, count)
    factor = np.bincount(place, carrier * residual, count) / np.where(power > 0, power, 1.0)
    return factor[place] * carrier


def _regimes(samples: ModelSamples, axis: int) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Yield name, argument (N,) and carrier (N,) of every regime of one 0-based axis."""
    q, v = samples.position[:, axis], samples.velocity[:, axis]
    one, sense = np.ones(len(q)), np.sign(v)
    warm = samples.temperature[:, axis]
    yield "position", q, one
    yield "position x direction", q, sense
    yield "velocity", v, one
    yield "acceleration", samples.acceleration[:, axis], one
    yield "load", samples.load[:, axis], one
    yield "load x direction", samples.load[:, axis], sense
    yield "temperature", warm, one
    yield "temperature x direction", warm, sense
    yield "temperature x velocity", warm, v
    yield "time", samples.time, one
    yield "time x direction", samples.time, sense
    for other in range(samples.joints):
        if other != axis:
            yield "position of another joint", samples.position[:, other], one
            yield "velocity of another joint", samples.velocity[:, other], one


def residual_by_regime(samples: ModelSamples) -> Regimes:
    """Return what binned means over each argument explain of the residual after retuning, all samples.

    Of several other joints the one that explains most counts. Arguments that no joint has are left out.
    """
    names: list[str] = []
    cells: dict[tuple[int, str], tuple[float, float]] = {}
    residual_rms = np.full(samples.joints, np.nan)
    for axis in range(samples.joints):
        chosen = samples.usable[:, axis] & np.isfinite(samples.retuned[:, axis])
        if chosen.sum() < LEAST_SAMPLES:
            continue
        residual = samples.retuned[chosen, axis]
        whole = float(np.mean(residual**2))
        residual_rms[axis] = np.sqrt(whole)
        for name, argument, carrier in _regimes(samples, axis):
            values = argument[chosen]
            if not np.isfinite(values).all() or np.ptp(values) == 0 or whole == 0:
                continue
            square = float(np.mean(binned_mean(residual, values, carrier[chosen]) ** 2))
            if name not in names:
                names.append(name)
            if square > cells.get((axis, name), (-1.0, 0.0))[0] ** 2 or (axis, name) not in cells:
                cells[axis, name] = (np.sqrt(square), square / whole)
    shape = (samples.joints, len(names))
    rms, share = np.full(shape, np.nan), np.full(shape, np.nan)
    for (axis, name), found in cells.items():
        rms[axis, names.index(name)], share[axis, names.index(name)] = found
    return Regimes(tuple(names), rms, share, residual_rms)


def axis_of_most(samples: ModelSamples) -> int:
    """Return the 0-based axis whose sum of squared residuals falls most from the retuned to the augmented model."""
    square = np.where(samples.usable, samples.retuned**2 - samples.augmented**2, 0.0)
    return int(np.argmax(np.nansum(square, axis=0)))


def pose_of_most(samples: ModelSamples, axis: int) -> int:
    """Return the 0-based joint whose position explains most of what the effects add to the torque of `axis`."""
    chosen = samples.usable[:, axis]
    added = (samples.retuned - samples.augmented)[chosen, axis]
    explained = [
        np.mean(binned_mean(added, samples.position[chosen, j], np.ones(len(added))) ** 2) if len(added) else 0.0
        for j in range(samples.joints)
    ]
    return int(np.argmax(explained))
