"""Tables II and IV as pictures."""

from __future__ import annotations

from pathlib import Path

from jointwear.publishing.figures.detection_map import draw_detection_map
from jointwear.publishing.figures.lag_map import draw_lag_map


def draw_maps(
    lags: str | Path, detection: str | Path, lags_output: str | Path, detection_output: str | Path, replicate: int
) -> None:
    """Draw the map of lags of one replicate (1-based) from Table II, and the map of detection from Table IV, as SVG."""
    draw_lag_map(lags, lags_output, replicate)
    draw_detection_map(detection, detection_output)
