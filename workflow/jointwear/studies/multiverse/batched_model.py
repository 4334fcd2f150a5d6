"""Normal models of many replicates at once: batched eigenvalues instead of one PCA object a replicate."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jointwear.reproduction.control_limits import q_limit
from jointwear.reproduction.readings import components, scaling, select
from jointwear.reproduction.readings import q_limit as limit_reading


class BatchedModel:
    """Principal components and Q-limit of every replicate; agrees with
    :mod:`jointwear.reproduction.normal_model` to rounding.

    Parameters
    ----------
    series : (r, hours, p) normal operation.
    confidence, variance_share : as in :func:`jointwear.reproduction.normal_model.fit_normal_model`.
    reading : alternatives of the stage "detection".

    Attributes
    ----------
    mean, spread : (r, p); kept : (r,) number of components; limit : (r,) of Q; training_q : (r, hours).
    """

    def __init__(
        self, series: np.ndarray, confidence: float, variance_share: float, reading: Mapping[str, str]
    ) -> None:
        _, hours, p = series.shape
        self.mean = series.mean(axis=1)
        scale = select(scaling, reading["scaling"])
        self.spread = np.stack([scale(values) for values in series])
        z = self._standardise(series)
        # numpy's eigh takes a stack of matrices; eigenvalues come in ascending order.
        eigenvalues, vectors = np.linalg.eigh(z.swapaxes(1, 2) @ z / (hours - 1))
        size = min(hours - 1, p)
        eigenvalues = np.maximum(eigenvalues[:, ::-1][:, :size], 0.0)
        total = eigenvalues.sum(axis=1, keepdims=True)
        share = np.where(total > 0, np.cumsum(eigenvalues, axis=1) / np.where(total > 0, total, 1), 1.0)
        choose = select(components, reading["components"])
        self.kept = np.array([min(choose(s, variance_share), size) for s in share])
        # Residual directions alone give Q; the kept ones become zero.
        residual = np.arange(p) >= self.kept[:, None]
        self._residual = vectors[:, :, ::-1] * residual[:, None, :]
        self.training_q = ((z @ self._residual) ** 2).sum(axis=2)
        limit = select(limit_reading, reading["q_limit"])
        self.limit = np.array(
            [
                limit(q_limit(values[k:], confidence), q, confidence)
                for values, k, q in zip(eigenvalues, self.kept, self.training_q, strict=True)
            ]
        )

    def _standardise(self, series: np.ndarray) -> np.ndarray:
        return (series - self.mean[:, None]) / self.spread[:, None]

    def q(self, series: np.ndarray) -> np.ndarray:
        """Return the Q-statistic (r, hours) of a run (r, hours, p)."""
        return ((self._standardise(series) @ self._residual) ** 2).sum(axis=2)

    def above(self, series: np.ndarray) -> np.ndarray:
        """Return whether Q exceeds its limit, (r, hours)."""
        return self.q(series) > self.limit[:, None]
