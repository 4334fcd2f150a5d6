"""Programs as the motion shows them: windows whose axes move alike are one regime.

The signature of a window does not change with a speed override or a load: of each axis its speed over the mean of all
axes, and the ratio of root mean square and mean speed. Regimes are found one after the other in the baseline (a window
joins the nearest one that lies within :data:`SAME_PROGRAM`, else it founds one); a regime counts from
:data:`FEWEST_OF_REGIME` windows on. A later window that lies near none is a program that was never seen: it founds a
regime too, and is not judged before its constant has been learnt (:func:`.normal_state.introduced`). So does a run of
later windows that lies near a regime, yet farther from it than windows of the baseline do, all on one side. Where most
windows of the baseline lie near no regime, each being a mixture of its own, none is told apart. An axis without a
torque in a window shows no motion either; such a later window is told by its other axes, and founds no regime.
"""

from __future__ import annotations

import numpy as np

from jointwear.measurement.flags import Flag
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Largest difference of signatures (logs) that still is one program, and beyond which a window is unseen.
SAME_PROGRAM, UNSEEN = 0.15, 0.3
#: Usual are distances up to so many times the one from its own regime that this share of the baseline's windows keeps.
CLOSE, MOST = 2.0, 0.9
#: Fewest windows of a regime; share of the baseline's windows that regimes must hold.
FEWEST_OF_REGIME, COVERED = 4, 0.7
#: Share of the windows of a program that lie beside another of it, from which on they follow each other.
IN_A_ROW = 0.5
#: Windows of a program in the baseline that its usual is told from.
USUAL = 3


def signatures(statistics: WindowStatistics) -> np.ndarray:
    """Return the signature (w, 2 n) of every window, NaN where an axis rests."""
    gram = statistics.gram
    with np.errstate(invalid="ignore", divide="ignore"):
        count = np.where(statistics.count > 0, statistics.count, np.nan).astype(float)
        speed = np.sqrt(gram[..., 2, 2] / count)
        mean = (gram[..., 0, 2] + gram[..., 1, 2]) / count
        logs = np.log(speed)
        share = logs - np.nanmean(np.where(np.isfinite(logs), logs, 0.0), axis=1, keepdims=True)
    return np.concatenate([share, np.log(speed / mean)], axis=1)


def without_torque(statistics: WindowStatistics) -> np.ndarray:
    """Return the axes (w, n) that have no torque in a window, so that nothing tells whether they moved."""
    return (statistics.count == 0) & (statistics.flags & int(Flag.NOT_FINITE) != 0)


def find_regimes(signature: np.ndarray, baseline: np.ndarray, hidden: np.ndarray | None = None) -> np.ndarray | None:
    """Return the regime (w,) of every window, -1 where unseen; None where the baseline shows no regimes.

    Parameters
    ----------
    signature : (w, 2 n), NaN where an axis rests. baseline : (w,) bool. hidden : (w, n) bool,
    :func:`without_torque`; default none.
    """
    if hidden is None:
        hidden = np.zeros((len(signature), signature.shape[1] // 2), dtype=bool)
    late = hidden & ~baseline[:, None]
    centres: list[np.ndarray] = []
    counts: list[int] = []
    label = np.full(len(signature), -1)
    for k in np.flatnonzero(baseline):
        distance = differences(signature[k], centres)
        best = int(np.argmin(distance)) if len(distance) else -1
        if best < 0 or distance[best] > SAME_PROGRAM:
            centres.append(signature[k].copy())
            counts.append(1)
            best = len(centres) - 1
        else:
            counts[best] += 1
            known = np.isfinite(signature[k]) & np.isfinite(centres[best])
            centres[best][known] += (signature[k] - centres[best])[known] / counts[best]
        label[k] = best
    kept = [c for c, count in zip(centres, counts, strict=True) if count >= FEWEST_OF_REGIME]
    near = np.array([differences(signature[k], kept).min(initial=np.inf) for k in np.flatnonzero(baseline)])
    if not len(kept) or np.sum(near <= UNSEEN) < COVERED * len(near):
        return None
    usual = float(np.clip(CLOSE * np.quantile(near[near <= UNSEEN], MOST), SAME_PROGRAM, UNSEEN))
    known = len(kept)
    result = np.full(len(signature), -1)
    members = [FEWEST_OF_REGIME] * len(kept)
    for k in range(len(signature)):
        distance = differences(signature[k], kept, late[k])
        best = int(np.argmin(distance))
        if distance[best] > UNSEEN and not baseline[k] and not late[k].any() and np.isfinite(signature[k]).any():
            kept.append(signature[k].copy())
            members.append(0)
            best = len(kept) - 1
        elif distance[best] > UNSEEN:
            continue
        members[best] += 1
        result[k] = best
    rare = np.array(members) < FEWEST_OF_REGIME
    result[(result >= 0) & rare[result]] = -1
    _split(result, signature, kept[:known], ~baseline & ~late.any(axis=1), usual)
    return result


def _split(
    regime: np.ndarray, signature: np.ndarray, centres: list[np.ndarray], later: np.ndarray, usual: float
) -> None:
    """Take programs that the baseline lacks out of the regimes (w,) that they are near to.

    Windows of one program that lie beyond what is `usual` are single ones, on all sides of it; those of another
    program follow each other, on one side.

    Parameters
    ----------
    signature : (w, 2 n). centres : of the baseline's regimes. later : (w,) bool, windows after it that are whole.
    """
    near = later & (regime >= 0) & (regime < len(centres))
    distance = np.full(len(regime), np.inf)
    distance[near] = [differences(signature[k], centres).min() for k in np.flatnonzero(near)]
    apart = near & (distance > usual)
    for k in np.flatnonzero(apart):
        run = slice(max(k - FEWEST_OF_REGIME + 1, 0), k + 1)
        if k + 1 < FEWEST_OF_REGIME or not (apart[run] & (regime[run] == regime[k])).all():
            continue
        middle = signature[run].mean(axis=0)
        if differences(middle, centres).min() <= usual:
            continue
        alike = np.flatnonzero(apart)
        alike = alike[[float(differences(signature[a], [middle])[0]) <= usual for a in alike]]
        regime[alike] = regime.max() + 1
        apart[alike] = False


def parts_of_known(signature: np.ndarray, regime: np.ndarray, baseline: np.ndarray) -> list[int]:
    """Return the regimes that the baseline lacks, though their windows are such as it had: a log that is short beside
    the cycle catches another part of it each time, and parts that are rare make no regime in the baseline.

    Half of their windows or more lie near one of the baseline, and nearer where they follow each other, as those of
    another program do.

    Parameters
    ----------
    signature : (w, 2 n). regime : (w,) of :func:`find_regimes`. baseline : (w,) bool.
    """
    before = list(signature[baseline & np.isfinite(signature).any(axis=1)])
    found = []
    for name in np.setdiff1d(regime[~baseline], [*regime[baseline], -1]):
        own = regime == name
        beside = np.concatenate([[False], own[:-1]]) | np.concatenate([own[1:], [False]])
        near = UNSEEN if beside[own].mean() < IN_A_ROW else SAME_PROGRAM
        nearest = [differences(signature[k], before).min(initial=np.inf) for k in np.flatnonzero(own)]
        if np.median(nearest) <= near:
            found.append(int(name))
    return found


def beyond_usual(values: np.ndarray, program: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return values (w, n) less what is usual in the program of each window, NaN where that is not known.

    Parameters
    ----------
    program : (w,) of each window, -1 unknown. normal : (w,) bool, the windows whose median is usual, :data:`USUAL` of
        them.
    """
    result = np.full(values.shape, np.nan)
    for name in np.unique(program[normal & (program >= 0)]):
        there = program == name
        if (there & normal).sum() >= USUAL:
            result[there] = values[there] - known_median(values[there & normal], axis=0)
    return result


def differences(one: np.ndarray, centres: list[np.ndarray], hidden: np.ndarray | None = None) -> np.ndarray:
    """Return the distance of a signature (2 n,) from centres; an axis that rests in one and moves in the other is far,
    and one that is `hidden` (n,) has no say unless all are."""
    if not centres:
        return np.zeros(0)
    step = np.stack(centres) - one
    other = np.isfinite(np.stack(centres)) != np.isfinite(one)
    if hidden is not None and hidden.any() and not hidden.all():
        other[:, np.tile(hidden, 2)] = False
        # Shares are of the mean over all axes: without the hidden ones it is another.
        shares = step[:, : len(hidden)]
        known = np.isfinite(shares)
        shares -= np.where(known, shares, 0.0).sum(axis=1, keepdims=True) / np.maximum(known.sum(axis=1), 1)[:, None]
    step = np.where(other, 1.0, np.nan_to_num(step))
    return np.abs(step).max(axis=1)


def programs_or_one(regime: np.ndarray | None, windows: int) -> np.ndarray:
    """Return the program (w,) of each window, -1 unknown: the `regime` (w,), or the same one where it is None."""
    return np.zeros(windows, dtype=int) if regime is None else regime
