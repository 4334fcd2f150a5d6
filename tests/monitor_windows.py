"""Statistics of windows for the tests: residual torque of three axes with a known growth of friction."""

from __future__ import annotations

import numpy as np

from jointwear.measurement.flags import Flag
from jointwear.monitor.judging.judge_settings import JudgeSettings
from jointwear.monitor.normal.estimate import change_columns
from jointwear.monitor.reading.windows import HISTOGRAM_BINS, HISTOGRAM_SPAN, blank_statistics

COULOMB = np.array([[10.0, 6.0], [2.0, 2.0], [1.0, 1.5]])
VISCOUS = np.array([3.0, 1.0, 0.5])
NOISE = np.array([0.3, 0.1, 0.05])
PER_WINDOW = 80


def motion(seed: int = 0) -> np.ndarray:
    """Regressors (s, n, 5) of the windows: speeds both ways, gravity and inertial torques."""
    random = np.random.default_rng(seed)
    v = random.uniform(0.2, 1.0, (PER_WINDOW, 3)) * np.where(np.arange(PER_WINDOW) % 2, 1.0, -1.0)[:, None]
    return np.stack(
        [v > 0, -1.0 * (v < 0), v, random.normal(0, 5, v.shape), random.normal(0, 2, v.shape)], axis=-1
    ).astype(float)


def residuals(windows: int, growth: np.ndarray, seed: int, extra: np.ndarray | float = 0.0) -> np.ndarray:
    """Residual torque (w, s, n) with growth (w, n) of the Coulomb friction."""
    x = motion()
    friction = x[..., 0] * COULOMB[:, 0] + x[..., 1] * COULOMB[:, 1]
    noise = NOISE * np.random.default_rng(seed).standard_normal((windows, PER_WINDOW, 3))
    return growth[:, None] * friction + noise + extra


def statistics_of(residual: np.ndarray, still: int | None = None, x: np.ndarray | None = None):
    """Window statistics of residual torque; axis `still` is at rest; `x` (s, n, 5) regressors, :func:`motion`."""
    x, w = motion() if x is None else x, len(residual)
    s = blank_statistics(3600.0 * np.arange(w), 3600.0, np.full(3, 20.0))
    gram = np.einsum("snp,snq->npq", x, x)
    moment = np.einsum("wsn,snp->wnp", residual, x)
    fit = np.linalg.solve(gram, moment[..., None])[..., 0]
    left = np.einsum("wsn,wsn->wn", residual, residual) - np.einsum("wnp,wnp->wn", fit, moment)
    s.gram[:], s.moment[:], s.residual_square[:] = gram, moment, left
    s.count[:], s.freedom[:], s.samples[:] = PER_WINDOW, PER_WINDOW - 5, PER_WINDOW
    torque = np.clip((residual + 8.0) / (HISTOGRAM_SPAN * 20.0), -1, 1)
    s.torque_peak[:] = np.abs(residual + 8.0).max(axis=1)
    index = np.clip(((torque + 1) * HISTOGRAM_BINS / 2).astype(int), 0, HISTOGRAM_BINS - 1)
    for k in range(w):
        for j in range(3):
            s.torque_histogram[k, j] = np.bincount(index[k, :, j], minlength=HISTOGRAM_BINS)
    if still is not None:
        for name in ("gram", "moment", "residual_square", "count", "freedom"):
            getattr(s, name)[:, still] = 0
        s.flags[:, still] = int(Flag.AT_REST)
    return s


def sums(residual: np.ndarray):
    s = statistics_of(residual)
    return change_columns(s.gram, s.moment, s.residual_square, s.freedom, s.count > 0, COULOMB)


SETTINGS = JudgeSettings(coulomb=COULOMB, viscous=VISCOUS, limit_percent=20.0)
