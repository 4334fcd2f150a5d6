"""How well a reading reproduces the paper: Tables II and IV, Figures 2 and 3, components, location, alarms, rest."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from jointwear.reproduction.grid import Cell
from jointwear.reproduction.published import Published
from jointwear.reproduction.verdicts import REST_TORQUE
from jointwear.studies.multiverse.evaluation import Outcomes

FIGURE_2_TOP = 10.0  # nat
HOUR_CAP = 40.0  # h; an error beyond counts as this much

# What an error of 1 in each score costs. Table IV is what the paper is about, so that it weighs as much as all
# the rest; its hours come second.
WEIGHTS = {
    "detection": 4.0,
    "hours": 2.0,
    "lag_signs": 1.0,
    "location": 1.0,
    "components": 0.5,
    "kl_range": 0.5,
    "figure_3": 0.25,
    "false_alarms": 0.75,
    "rest_torque": 1.0,
}


@dataclass(frozen=True)
class Target:
    """What the paper prints, as arrays: `hours` (t, c, n) of Table IV, NaN where not detected; `lag_sign` (n, n) of
    Table II; `figure_3_onset` [h]; `components` lowest and highest number.
    """

    hours: np.ndarray
    lag_sign: np.ndarray
    figure_3_onset: float
    components: tuple[int, int]

    @property
    def detected(self) -> np.ndarray:
        """(t, c, n) whether the paper detected the wear."""
        return np.isfinite(self.hours)


def target_of(published: Published, tasks: list[str], increases: list[float], axes: list[int]) -> Target:
    """Return what the paper prints for these runs."""
    hours = [[[published.detection_hour(Cell(t, c, a)) or np.nan for a in axes] for c in increases] for t in tasks]
    n = len(axes)
    lag = [[published.lag(i, j) or 0 for j in range(1, n + 1)] for i in range(1, n + 1)]
    low, high = published.data["text_claims"]["principal_components"]
    return Target(
        np.array(hours, dtype=float),
        np.sign(np.array(lag)),
        float(published.data["figures"]["fig_3"]["onset_hours_after_start_of_wear"]),
        (int(low), int(high)),
    )


def _median(values: np.ndarray) -> np.ndarray:
    with warnings.catch_warnings():
        # A cell that is never detected has no hour; its median is NaN.
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.nanmedian(values, axis=-1)


def agreement(probability: np.ndarray, detected: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the number of cells on which detection (at probability 1/2) agrees, and the balanced share.

    Parameters
    ----------
    probability : (m, t, c, n); detected : (t, c, n) whether the paper detected.
    """
    found = probability >= 0.5
    cells = (-3, -2, -1)
    plain = (found == detected).sum(axis=cells)
    hits = (found & detected).sum(axis=cells) / max(detected.sum(), 1)
    rejections = (~found & ~detected).sum(axis=cells) / max((~detected).sum(), 1)
    return plain, (hits + rejections) / 2


def hour_error(onset: np.ndarray, target: Target) -> np.ndarray:
    """Return the median over the detected cells of |median hour - published hour| [h], shape (m,).

    Onset is (m, t, c, n, r). A cell that the paper detected and the reading does not, in half of its
    replicates at least, counts with :data:`HOUR_CAP`, so that nothing is gained by detecting less.
    """
    found = np.isfinite(onset).mean(axis=-1) >= 0.5
    error = np.minimum(np.abs(_median(onset) - target.hours), HOUR_CAP)
    error = np.where(found, error, HOUR_CAP)[:, target.detected]
    return np.median(error, axis=1)


def score(outcomes: Outcomes, target: Target) -> dict[str, np.ndarray]:
    """Return the scores of m readings, each (m,), by name; units as in :mod:`jointwear.studies.multiverse.records`.

    The score `penalty` sums the shortfalls with :data:`WEIGHTS` and divides by their sum: 0 is the paper itself.
    """
    return scores_and_shortfalls(outcomes, target)[0]


def scores_and_shortfalls(outcomes: Outcomes, target: Target) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the scores of :func:`score` and the shortfalls behind the penalty, 0 to 1, by the names of WEIGHTS."""
    detects = np.isfinite(outcomes.onset)
    probability = detects.mean(axis=-1)
    plain, balanced = agreement(probability, target.detected)
    cells = target.hours.size
    single = (detects == target.detected[..., None]).sum(axis=(1, 2, 3))
    axes = np.arange(1, outcomes.onset.shape[3] + 1)[:, None]
    runs = (1, 2, 3, 4)
    located = (detects & (outcomes.source == axes)).sum(axis=runs) / np.maximum(detects.sum(axis=runs), 1)
    low, high = target.components
    in_range = ((outcomes.kept >= low) & (outcomes.kept <= high)).mean(axis=(1, 2))
    off_diagonal = ~np.eye(len(target.lag_sign), dtype=bool)
    same_sign = (np.sign(outcomes.lag) == target.lag_sign)[..., off_diagonal].mean(axis=(1, 2))
    kl = _median(outcomes.kl_maximum)
    kl_off = np.abs(np.log(np.maximum(kl, 1e-3) / FIGURE_2_TOP)) / np.log(FIGURE_2_TOP)
    onsets = np.where(probability[:, :, 0] >= 0.5, _median(outcomes.onset[:, :, 0]), np.nan)
    nearest = np.abs(onsets - target.figure_3_onset).reshape(len(onsets), -1)
    figure_3 = np.min(np.where(np.isfinite(nearest), nearest, HOUR_CAP), axis=1)
    alarms = outcomes.alarms.mean(axis=(1, 2))
    hours = hour_error(outcomes.onset, target)
    rest = _median(outcomes.rest_torque)
    missing = {
        "detection": 1 - (plain / cells + balanced) / 2,
        "hours": hours / HOUR_CAP,
        "lag_signs": 1 - same_sign,
        "location": 1 - located,
        "components": 1 - in_range,
        "kl_range": np.minimum(np.nan_to_num(kl_off, nan=1.0), 1.0),
        "figure_3": np.minimum(figure_3, HOUR_CAP) / HOUR_CAP,
        "false_alarms": np.minimum(alarms, 1.0),
        # Table V prints 0.000: a reading that shows more there is not what was done.
        "rest_torque": (rest >= REST_TORQUE).astype(float),
    }
    return {
        "agreement": plain.astype(float),
        "balanced_agreement": balanced,
        "single_run_agreement": single.mean(axis=-1),
        "single_run_at_least_32": (single >= 32).mean(axis=-1),
        "hour_error": hours,
        "lag_sign_agreement": same_sign,
        "located_share": located,
        "components_in_range": in_range,
        "mean_components": outcomes.kept.mean(axis=(1, 2)),
        "kl_maximum": kl,
        "figure_3_error": figure_3,
        "false_alarms": alarms,
        "share_above_limit": outcomes.above.mean(axis=(1, 2)),
        "normal_week_located": (outcomes.normal_source > 0).mean(axis=(1, 2)),
        "rest_torque": rest,
        "penalty": sum(WEIGHTS[k] * v for k, v in missing.items()) / sum(WEIGHTS.values()),
    }, missing


def claims(outcomes: Outcomes) -> dict[str, np.ndarray]:
    """Return whether each reading would have supported the claims of the abstract, each (m,).

    A cell counts as detected, or located, where more than half of its replicates are. `five_two_two`: in one
    column at least one task has five axes detected and the others two. `all_but_one_located`: the worn axis is
    named in all detected cells, or all but one. `all_located`: in all, as section V says. `three_days`: no
    detected cell has a median hour of 72 or less; `three_days_mostly`: the median over the cells is beyond 72.
    """
    detects = np.isfinite(outcomes.onset)
    detected = detects.mean(axis=-1) >= 0.5
    axes = np.arange(1, outcomes.onset.shape[3] + 1)[:, None]
    right = (detects & (outcomes.source == axes)).sum(axis=-1) >= 0.5 * np.maximum(detects.sum(axis=-1), 1)
    missed = (detected & ~right).sum(axis=(1, 2, 3))
    counts = np.sort(detected.sum(axis=3), axis=1)
    pattern = np.array([2] * (counts.shape[1] - 1) + [5])[:, None]
    hours = np.where(detected, _median(outcomes.onset), np.nan).reshape(len(detected), -1)
    some = detected.any(axis=(1, 2, 3))
    earliest = np.min(np.where(np.isfinite(hours), hours, np.inf), axis=1)
    return {
        "five_two_two": (counts == pattern).all(axis=1).any(axis=1),
        "all_but_one_located": some & (missed <= 1),
        "all_located": some & (missed == 0),
        "three_days": some & (earliest > 72),
        "three_days_mostly": some & (_median(hours) > 72),
    }
