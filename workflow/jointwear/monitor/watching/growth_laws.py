"""Laws of growth on the whole way to a limit, and how likely they are a priori.

Growth limit (exp(B x) - 1) / (exp(B) - 1) with x = (t - t0) / T: it begins at t0 and is at the limit T later, bent on
all the way: saturating for negative B, straight for 0, accelerating for positive.
"""

from __future__ import annotations

import numpy as np

#: Bend of growth over the whole way to the limit; mean and standard deviation of its prior. Of the way and not of what
#: is past: at an alarm a small part of the way is gone, on which any law is nearly straight, and a prior of the bend
#: so far would let a good part of the laws come to rest below the limit.
BENDS = np.linspace(-4.0, 5.0, 15)
BEND, BEND_SPREAD = 0.4, 1.5
#: Onsets between the normal period and now, as shares of the time between.
ONSETS = np.concatenate([np.linspace(0.0, 0.9, 13), [0.94, 0.97]])
#: Times from onset to limit over that from onset to now, as likely a priori per log of them as this power of their rate
#: says: 0 would be flat in the log of the time, which leaves a quarter of the ends open, 1 in the rate. This, the bend,
#: :data:`SCALE` and the unevenness together have the best interval score (docs/decisions/forecasts.md).
LENGTHS, HASTE = np.geomspace(0.25, 100.0, 45), 0.3
#: What growth is told as over what it is, and the standard deviation of its log: its share in the friction that is
#: judged and its size under the conditions of the day are known no better, and a part of it is taken for the normal
#: state (docs/decisions/forecasts.md).
TOLD, SCALE = 0.9, 0.15
#: Points and weights of the normal law for it.
POINTS = ((-1.35, 0.25), (0.0, 0.5), (1.35, 0.25))


def ways(start: float, now: float, lengths: np.ndarray = LENGTHS) -> tuple[np.ndarray, np.ndarray]:
    """Return the onsets (o,) [h] between the end of the normal period `start` [h] and `now` [h], and the times (o, l)
    [h] from each to the limit; `lengths` (l,): over that to now."""
    onset = start + ONSETS * (now - start)
    return onset, (now - onset)[:, None] * lengths


def laws_at(time: np.ndarray, onset: np.ndarray, length: np.ndarray, bends: np.ndarray = BENDS) -> np.ndarray:
    """Return growth over that at the limit (b, o, l, s) at times (s,) [h] on :func:`ways`, 0 before the onset."""
    x = np.maximum(time - onset[:, None], 0.0)[:, None, :] / length[..., None]
    bend = bends.reshape(-1, *[1] * x.ndim)
    straight = np.abs(bend) < 1e-9
    safe = np.where(straight, 1.0, bend)
    return np.where(straight, x, np.expm1(np.minimum(safe * x, 300.0)) / np.expm1(safe))


def prior_of_lengths(lengths: np.ndarray = LENGTHS) -> np.ndarray:
    """Return the log (l,) of how likely times to the limit are a priori, up to a constant."""
    return -HASTE * np.log(lengths)


def sizes(limit: float) -> list[tuple[float, float]]:
    """Return what the limit may be in the growth that is told, `limit` as it most likely is, each with the log of its
    weight."""
    return [(limit * np.exp(SCALE * point), np.log(weight)) for point, weight in POINTS]


def prior_of_bends(bends: np.ndarray = BENDS) -> np.ndarray:
    """Return how likely bends (b,) are a priori."""
    prior = np.exp(-0.5 * ((bends - BEND) / BEND_SPREAD) ** 2)
    return prior / prior.sum()
