"""How joint experiments compare with what is printed, and what they are to reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointwear.studies.joint_fit.paper import Paper

# What the joint fit is to reach on random numbers that took no part: name of the score, limits, unit.
AIMS = {
    "cells": (32.0, 36.0, "of 36"),
    "hour_error": (0.0, 8.0, "h"),
    "torque_median": (0.0, 0.01, "share"),
    "torque_worst": (0.0, 0.06, "share"),
    "variation_median": (0.0, 0.01, "1"),
    "variation_worst": (0.0, 0.04, "1"),
    "signs": (11.0, 15.0, "of 15"),
    "kl": (8.0, 12.0, "nat"),
}


@dataclass(frozen=True)
class Scores:
    """How experiments e compare with the paper, each (e,): `cells` of Table IV with the same outcome, `hour_error` [h]
    median over cells that both detect; `torque_median`, `torque_worst` relative errors of Table V; the same of
    Table VI; `signs` median number of pairs of Table II; `kl` median of the largest divergence [nat]; `figure_3` [h]
    onset of axis 1 of T1 at 10 %, the run of Figures 2 and 3.
    """

    cells: np.ndarray
    hour_error: np.ndarray
    torque_median: np.ndarray
    torque_worst: np.ndarray
    variation_median: np.ndarray
    variation_worst: np.ndarray
    signs: np.ndarray
    kl: np.ndarray
    figure_3: np.ndarray


def score(found: Mapping[str, np.ndarray], paper: Paper, at: int = 0) -> Scores:
    """Return the scores of confirmed experiments.

    Parameters
    ----------
    found : arrays of the fields of :class:`Confirmed` along a first dimension of experiments.
    at : 0 reads Tables V and VI at the printed hours, 1 at the experiment's own.
    """
    tables = paper.tables
    hours = tables.hours.swapaxes(1, 2)
    wanted = np.isfinite(hours)
    right = (found["probability"] >= 0.5) == wanted
    late = np.where(right & wanted, np.abs(found["hour"] - hours), np.nan)
    moving = np.broadcast_to(~tables.at_rest[..., None], tables.maximum.shape).swapaxes(1, 2)
    torque = np.abs(found["maximum"][:, at] / np.where(moving, tables.maximum.swapaxes(1, 2), 1.0) - 1)[:, moving]
    variation = np.abs(found["variation"][:, at] - tables.variation.swapaxes(1, 2))[:, moving]
    return Scores(
        cells=right.sum(axis=(1, 2, 3)),
        hour_error=np.nanmedian(late.reshape(len(late), -1), axis=1),
        torque_median=np.median(torque, axis=1),
        torque_worst=torque.max(axis=1),
        variation_median=np.median(variation, axis=1),
        variation_worst=variation.max(axis=1),
        signs=np.median(found["signs"], axis=1),
        kl=np.median(found["kl_maximum"], axis=1),
        figure_3=found["hour"][:, 0, 0, 0],
    )


def aims_met(scores: Scores) -> np.ndarray:
    """Return how many of :data:`AIMS` each experiment meets, (e,)."""
    return sum(
        ((getattr(scores, name) >= low) & (getattr(scores, name) <= high)).astype(int)
        for name, (low, high, _) in AIMS.items()
    )
