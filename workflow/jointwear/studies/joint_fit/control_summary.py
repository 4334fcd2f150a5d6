"""The results of the controls of the joint fit for the report's chapter, as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import write_json
from jointwear.files.storage import open_dataset

MOMENT_TOLERANCE = 0.15  # share of the payload's first moment within which a fit has found it
_ATTRIBUTES = ("cells", "hour_error", "distance", "moment", "shape", "true_moment", "true_shape")
_COMPARED = ("cells", "hour_error", "distance")


def _range(values: list[float]) -> dict[str, float]:
    return {"low": np.nanmin(values), "middle": np.nanmedian(values), "high": np.nanmax(values)}


def controls(paths: Sequence[str | Path]) -> dict[str, Any]:
    """Return the controls by kind, and what those of known origin recovered."""
    rows = []
    for path in paths:
        with open_dataset(path) as data:
            names = [n for n in data.ncattrs() if n in _ATTRIBUTES or n.startswith(("reading_", "true_reading_"))]
            rows.append({"kind": str(data.kind), **{n: data.getncattr(n) for n in names}})
    result: dict[str, Any] = {"rows": rows}
    for kind in dict.fromkeys(r["kind"] for r in rows):
        own = [r for r in rows if r["kind"] == kind]
        result[kind] = {
            "papers": len(own),
            **{k: [float(r[k]) for r in own] for k in _COMPARED},
            "range": {k: _range([float(r[k]) for r in own]) for k in _COMPARED},
        }
    known = [r for r in rows if r["kind"] == "known"]
    if known:
        fields = ("scaling", "components")
        right = [all(r[f"reading_{f}"] == r[f"true_reading_{f}"] for f in fields) for r in known]
        hours = [r["reading_consecutive_hours"] == r["true_reading_consecutive_hours"] for r in known]
        error = np.array([float(r["moment"]) / float(r["true_moment"]) - 1 for r in known])
        result["known"] |= {
            "moment_error": error,
            "moment_within": int((np.abs(error) <= MOMENT_TOLERANCE).sum()),
            "moment_median_error": np.median(np.abs(error)),
            "reading_right": int(sum(right)),
            "reading_right_with_hours": int(sum(a and b for a, b in zip(right, hours, strict=True))),
        }
    return result


def write_controls(paths: Sequence[str | Path], output: str | Path) -> None:
    """Write what the chapter of the controls says as JSON."""
    write_json(output, controls(paths))
