"""Tables IV, V and VI of the paper as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError

TORQUE_ROUNDING = 5e-4  # N m: Table V prints three decimals
_TABLES = {
    "hours": "table_iv_detection_hours",
    "maximum": "table_v_max_abs_torque_nm",
    "variation": "table_vi_cov_abs_torque",
}


@dataclass(frozen=True)
class Tables:
    """Published values; every array has shape (t, n, c): tasks, axes, columns of increase.

    `hours` [h] of detection, NaN where not detected; `maximum` of |torque| [N m]; `variation` its coefficient
    of variation; `increase_percent` (c,) [%]; `run_hours` [h] at which an undetected run ended.
    """

    tasks: tuple[str, ...]
    increase_percent: np.ndarray
    hours: np.ndarray
    maximum: np.ndarray
    variation: np.ndarray
    run_hours: float = 120.0

    @property
    def reading_hours(self) -> np.ndarray:
        """Hour at which Tables V and VI were taken: detection, or the end of the run."""
        return np.where(np.isnan(self.hours), self.run_hours, self.hours)

    @property
    def at_rest(self) -> np.ndarray:
        """(t, n) True where an axis does not move: its maximum is printed as 0.000 in every column."""
        return np.all(self.maximum < TORQUE_ROUNDING, axis=2)

    def task_subset(self, chosen: list[int]) -> Tables:
        """Return the tables of the tasks with the given positions."""
        return Tables(
            tuple(self.tasks[i] for i in chosen),
            self.increase_percent,
            self.hours[chosen],
            self.maximum[chosen],
            self.variation[chosen],
            self.run_hours,
        )


def tables_from_data(data: dict[str, Any], source: str | Path) -> Tables:
    """Build :class:`Tables` from the content of the file of published values.

    Raises
    ------
    InputError : if a table is missing or its tasks, columns or axes differ from those of the first.
    """
    arrays, layout = {}, None
    for role, key in _TABLES.items():
        if key not in data:
            raise InputError(f"{source}: '{key}' is missing")
        table = data[key]
        found = (tuple(table), tuple(next(iter(table.values()))))
        layout = layout or found
        try:
            # null becomes NaN: a cross, not detected.
            rows = np.array([[table[t][c] for c in layout[1]] for t in layout[0]], dtype=float)
        except (KeyError, ValueError, TypeError):
            rows = None
        if found != layout or rows is None or rows.ndim != 3:
            raise InputError(
                f"{source}: '{key}' must hold for tasks {layout[0]} and columns {layout[1]} one number an axis"
            )
        arrays[role] = rows.swapaxes(1, 2)
    if not np.all(arrays["maximum"] >= 0) or not np.all(arrays["variation"] >= 0):
        raise InputError(f"{source}: maxima and coefficients of variation must be numbers >= 0")
    return Tables(layout[0], np.array(layout[1], dtype=float), **arrays)


def read_tables(path: str | Path) -> Tables:
    """Read the published values.

    Raises
    ------
    InputError : as :func:`tables_from_data`, and for a file that is missing or not YAML.
    """
    return tables_from_data(read_yaml(path), path)
