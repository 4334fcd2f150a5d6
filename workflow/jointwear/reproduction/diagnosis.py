"""Detection and location of one run, one after the other: the location may ask for the onset."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointwear.reproduction.detection import write_detection
from jointwear.reproduction.location import write_location


def diagnose_run(
    features: str | Path,
    training: str | Path,
    model: str | Path,
    *,
    detection: str | Path,
    location: str | Path,
    detection_settings: Mapping[str, Any],
    location_settings: Mapping[str, Any],
) -> None:
    """Find the onset of wear in every replicate of a run, then the axis that it comes from.

    Parameters
    ----------
    features, training : features of the run and of the task's normal operation.
    model : normal model of the task.
    detection, location : netCDF files to write, see :func:`jointwear.reproduction.detection.write_detection` and
        :func:`jointwear.reproduction.location.write_location`, which also explain the settings.

    Raises
    ------
    InputError : naming the file, if one is damaged.
    """
    write_detection(features, model, detection, detection_settings)
    write_location(features, training, detection, location, location_settings)
