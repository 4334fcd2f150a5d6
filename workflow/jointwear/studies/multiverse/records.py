"""Outcomes and scores of readings as netCDF files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.studies.multiverse.evaluation import Outcomes

SCORES = {
    "agreement": ("cells of Table IV on which detection agrees at probability 1/2, of 36", "1"),
    "balanced_agreement": ("mean of the shares of detected and of undetected cells that agree", "1"),
    "single_run_agreement": ("mean number of cells on which one run of every cell agrees, as the paper ran it", "1"),
    "single_run_at_least_32": ("share of replicates in which at least 32 cells agree", "1"),
    "hour_error": ("median error of the hour over the cells that the paper detected", "h"),
    "lag_sign_agreement": ("share of the 30 lags of Table II whose sign is right", "1"),
    "located_share": ("share of detected runs in which the worn axis is named", "1"),
    "components_in_range": ("share of models with 3 to 4 components", "1"),
    "mean_components": ("mean number of components", "1"),
    "kl_maximum": ("largest KL divergence of the run of Table II, in nat", "1"),
    "figure_3_error": ("distance of the nearest median onset at the lowest increase from that of Figure 3", "h"),
    "false_alarms": ("alarms in a normal week", "1"),
    "share_above_limit": ("share of the hours of a normal week above the limit", "1"),
    "normal_week_located": ("share of normal weeks in which the rule names an axis", "1"),
    "rest_torque": ("largest |torque| in an hour of the axis that Table V prints as 0.000", "N m"),
    "penalty": ("weighted shortfall from the paper, 0 is the paper itself", "1"),
}
CLAIMS = {
    "five_two_two": "five axes detected in one task and two in the others, in one column at least",
    "all_but_one_located": "located in all detected cells, or in all but one",
    "all_located": "located in all detected cells",
    "three_days": "no detected cell has a median hour of 72 or less",
    "three_days_mostly": "the median over the detected cells is beyond 72 h",
}
_DIMENSIONS = {
    "onset": ("task", "increase", "axis", "replicate"),
    "source": ("task", "increase", "axis", "replicate"),
    "kept": ("task", "replicate"),
    "alarms": ("task", "replicate"),
    "above": ("task", "replicate"),
    "normal_source": ("task", "replicate"),
    "kl_maximum": ("replicate",),
    "lag": ("replicate", "row_axis", "column_axis"),
    "rest_torque": ("replicate",),
}
_MEANING = {
    "onset": ("hour of detection, NaN if none", "h"),
    "source": ("axis named by the location rule, 0 = none", "1"),
    "kept": ("principal components", "1"),
    "alarms": ("alarms in a normal week", "1"),
    "above": ("share of the hours of a normal week above the limit", "1"),
    "normal_source": ("axis named in a normal run, 0 = none", "1"),
    "kl_maximum": ("largest KL divergence of the run of Table II, in nat", "1"),
    "lag": ("lag at maximum correlation in the run of Table II", "h"),
    "rest_torque": ("largest |torque| in an hour of the axis that Table V shows at rest", "N m"),
}


def write_outcomes(
    path: str | Path, outcomes: Outcomes, indices: Sequence[int], settings: Mapping[str, Any], names: Sequence[str] = ()
) -> None:
    """Write outcomes; with `names` of pose sets the arrays have that dimension first, before `reading`.

    Parameters
    ----------
    indices : (r,) indices of the readings in the design.
    """
    first = ("pose_set", "reading") if names else ("reading",)
    variables = {"reading": Variable(("reading",), np.asarray(indices), "number of the reading in the design", "1")}
    if names:
        variables["pose_set"] = Variable(("pose_set",), np.array(names), "pose set")
    for f in fields(Outcomes):
        text, unit = _MEANING[f.name]
        variables[f.name] = Variable(
            (*first, *_DIMENSIONS[f.name]), getattr(outcomes, f.name), text, unit, compressed=True
        )
    write_dataset(path, variables, provenance.attributes("outcomes of readings of the paper", settings))


def read_outcomes(path: str | Path) -> tuple[Outcomes, np.ndarray]:
    """Return outcomes and the indices of their readings (r,) in the design."""
    with open_dataset(path) as dataset:
        values = [read_variable(dataset, path, f.name) for f in fields(Outcomes)]
        return Outcomes(*values), read_variable(dataset, path, "reading")


def joined(parts: Sequence[Outcomes], axis: int = 0) -> Outcomes:
    """Return outcomes of several parts as one, along `axis`."""
    return Outcomes(*(np.concatenate([getattr(p, f.name) for p in parts], axis=axis) for f in fields(Outcomes)))


def taken(outcomes: Outcomes, index: Any) -> Outcomes:
    """Return the outcomes at an index of the first dimension."""
    return Outcomes(*(getattr(outcomes, f.name)[index] for f in fields(Outcomes)))


def pooled(outcomes: Outcomes) -> Outcomes:
    """Return outcomes (pose set, reading, ...) with pose sets counted as further replicates."""

    def merge(values: np.ndarray, name: str) -> np.ndarray:
        place = 1 + _DIMENSIONS[name].index("replicate")  # of the replicates, without the pose sets
        moved = np.moveaxis(values, 0, place)
        shape = moved.shape
        return moved.reshape(*shape[:place], shape[place] * shape[place + 1], *shape[place + 2 :])

    return Outcomes(*(merge(getattr(outcomes, f.name), f.name) for f in fields(Outcomes)))


def detections(outcomes: Outcomes, reading: int) -> bytes:
    """Return what a reading detects, as a key: equal for readings that differ only in what reaches no detector."""
    return np.nan_to_num(outcomes.onset[reading]).tobytes()


def choice_variables(readings: Sequence[Mapping[str, Any]]) -> dict[str, Variable]:
    """Return what readings choose, one variable a point of the text along the dimension "reading"."""
    return {
        f"choice_{k}": Variable(("reading",), np.array([str(r[k]) for r in readings]), f"choice of {k}")
        for k in readings[0]
    }
