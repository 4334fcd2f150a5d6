"""Numbers as JSON and YAML have them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def finite(value: Any) -> float | None:
    """Return a float, or None where it is not finite: JSON has neither NaN nor infinity."""
    value = float(value)
    return value if math.isfinite(value) else None


def six_digits(value: Any) -> float | None:
    """Return a float with six significant digits, or None where it is not finite; more would show the round-off."""
    value = finite(value)
    return None if value is None else float(f"{value:.6g}")


def builtin(value: Any) -> Any:
    """Return a value with the types of numpy replaced by those of Python, in mappings and sequences too."""
    if isinstance(value, dict):
        return {k: builtin(v) for k, v in value.items()}
    if isinstance(value, (np.ndarray, list, tuple)):
        return [builtin(v) for v in value]
    return value.item() if isinstance(value, np.generic) else value


def as_json(value: Any) -> Any:
    """Return a value as JSON has it: text keys, no types of numpy, no NaN or infinity (None instead)."""
    if isinstance(value, Mapping):
        return {str(k): as_json(v) for k, v in value.items()}
    value = builtin(value)
    if isinstance(value, list):
        return [as_json(v) for v in value]
    return finite(value) if isinstance(value, float) else value
