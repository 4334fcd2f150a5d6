"""Choose a reading on one half of the pose sets and score it on the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.studies.multiverse.evaluation import Outcomes
from jointwear.studies.multiverse.records import pooled, taken
from jointwear.studies.multiverse.scoring import HOUR_CAP, Target, score


@dataclass(frozen=True)
class Choice:
    """The reading that did best on the choosing half, and what it does on the other.

    `reading` is its place among the candidates; `penalty` (k, s) of every candidate on every pose set; `choosing`
    and `reporting` (s,) masks of pose sets; `chosen_score` and `honest_score` are its pooled scores on the halves;
    `probability` (t, c, n) of detection on the reporting half; `hour` (t, c, n) median hour there, NaN where less
    than half are detected.
    """

    reading: int
    penalty: np.ndarray
    agreement: np.ndarray
    choosing: np.ndarray
    reporting: np.ndarray
    chosen_score: dict[str, float]
    honest_score: dict[str, float]
    probability: np.ndarray
    hour: np.ndarray


def halves(count: int, seed: int, seen: Sequence[int] = ()) -> tuple[np.ndarray, np.ndarray]:
    """Return masks (count,) of the pose sets for choosing and for reporting, drawn from the seed.

    Parameters
    ----------
    seen : pose sets on which the candidates were found; they always belong to the choosing half.
    """
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(0x68616C66,))))
    order = list(random.permutation(count))
    order = [*seen, *(k for k in order if k not in seen)]
    choosing = np.zeros(count, dtype=bool)
    choosing[order[: (count + 1) // 2]] = True
    return choosing, ~choosing


def choose(outcomes: Outcomes, target: Target, seed: int, seen: Sequence[int] = ()) -> Choice:
    """Choose among k candidates by their mean penalty over the choosing half of the pose sets.

    Parameters
    ----------
    outcomes : arrays (s, k, ...) of s pose sets and k candidates. No pose set shares its random numbers with
        another, so that halves of the pose sets are halves of the seeds too.
    seen : pose sets on which the candidates were found.
    """
    count = len(outcomes.onset)
    by_pose = [score(taken(outcomes, s), target) for s in range(count)]
    penalty = np.stack([b["penalty"] for b in by_pose], axis=1)
    cells = np.stack([b["agreement"] for b in by_pose], axis=1)
    choosing, reporting = halves(count, seed, seen)
    best = int(np.argmin(penalty[:, choosing].mean(axis=1)))

    def pooled_scores(mask: np.ndarray) -> dict[str, float]:
        whole = pooled(taken(outcomes, mask))
        found = {k: float(v[best]) for k, v in score(whole, target).items()}
        found["mean_agreement_of_pose_sets"] = float(cells[best, mask].mean())
        found["pose_sets_at_least_32"] = float((cells[best, mask] >= 32).mean())
        # The two demands of the aim together, on every pose set by itself.
        close = np.array([b["hour_error"][best] <= 10 for b in by_pose])[mask]
        found["pose_sets_that_meet_the_aim"] = float(((cells[best, mask] >= 32) & close).mean())
        return found

    honest = pooled(taken(outcomes, reporting))
    onset = honest.onset[best]
    return Choice(
        reading=best,
        penalty=penalty,
        agreement=cells,
        choosing=choosing,
        reporting=reporting,
        chosen_score=pooled_scores(choosing),
        honest_score=pooled_scores(reporting),
        probability=np.isfinite(onset).mean(axis=-1),
        hour=median_hour(onset),
    )


def median_hour(onset: np.ndarray) -> np.ndarray:
    """Return the median hour over the replicates that detect, (..., r) -> (...); NaN where less than half do."""
    with np.errstate(all="ignore"):
        hour = np.ma.median(np.ma.masked_invalid(onset), axis=-1).filled(np.nan)
    return np.where(np.isfinite(onset).mean(axis=-1) >= 0.5, hour, np.nan)


def wrong_everywhere(probability: np.ndarray, target: Target) -> np.ndarray:
    """Return (t, c, n) the share of readings (m, t, c, n) whose detection disagrees with the paper in each cell."""
    return ((probability >= 0.5) != target.detected).mean(axis=0)


@dataclass(frozen=True)
class Mixture:
    """One reading with the pose set of every task chosen by looking at Table IV.

    `reading`; `pose_set` (t,) places of the chosen solutions; `bound` (k,) cells that every candidate would reach
    if its poses were chosen so.
    """

    reading: int
    pose_set: np.ndarray
    bound: np.ndarray


def best_mixture(outcomes: Outcomes, target: Target) -> Mixture:
    """Choose a reading and, task by task, the solution that comes closest to Table IV.

    The tasks of a solution do not depend on each other but through the payload, so that the best of each may be
    put together. This uses Table IV to choose poses: it says whether poses exist that explain all tables, not that
    the reading predicts Table IV. Ties go to the smaller error of the hours.

    Parameters
    ----------
    outcomes : arrays (s, k, ...) of s pose sets and k candidates.
    """
    onset = outcomes.onset  # (s, k, t, c, n, r)
    detected = np.isfinite(onset).mean(axis=-1) >= 0.5
    right = (detected == target.detected).sum(axis=(-2, -1))
    error = np.where(detected, np.minimum(np.abs(median_hour(onset) - target.hours), HOUR_CAP), HOUR_CAP)
    error = np.where(target.detected, error, 0.0).sum(axis=(-2, -1)) / max(target.detected.sum(), 1)
    # Ten hours of mean error over all detected cells weigh as much as one cell.
    value = right - 0.1 * error
    best = value.argmax(axis=0)  # (k, t)
    bound = np.take_along_axis(right, right.argmax(axis=0)[None], axis=0)[0].sum(axis=1)
    total = np.take_along_axis(value, best[None], axis=0)[0].sum(axis=1)
    reading = int(total.argmax())
    return Mixture(reading, best[reading], bound)


def first_of_each(keys: Sequence[bytes], count: int) -> list[int]:
    """Return the places of the first `count` different keys."""
    first = {key: place for place, key in reversed(list(enumerate(keys)))}
    return sorted(first.values())[:count]
