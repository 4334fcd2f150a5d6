"""The values that the paper prints, by cell."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointwear.files.documents import read_yaml
from jointwear.reproduction.grid import Cell

#: Hours of wear of every run of the paper: "five days".
HOURS = 120


@dataclass(frozen=True)
class Published:
    """Content of config/paper/published.yaml.

    A cell that the paper does not have (another task, axis or growth) gives None everywhere.
    """

    data: dict[str, Any]

    def _entry(self, table: str, cell: Cell) -> tuple[bool, Any]:
        columns = self.data[table].get(cell.task, {})
        values = columns.get(int(cell.increase_percent)) if float(cell.increase_percent).is_integer() else None
        if values is None or not 1 <= cell.axis <= len(values):
            return False, None
        return True, values[cell.axis - 1]

    def has(self, cell: Cell) -> bool:
        """Whether the paper ran this cell."""
        return self._entry("table_iv_detection_hours", cell)[0]

    def detection_hour(self, cell: Cell) -> float | None:
        """Hours to detection (Table IV); None where not detected or not run."""
        return self._entry("table_iv_detection_hours", cell)[1]

    def evaluation_hour(self, cell: Cell) -> float:
        """Hour at which Tables V and VI are taken: of detection, or the last one where nothing was detected.

        A run that ends before it cannot be compared with the paper's.
        """
        return self.detection_hour(cell) or HOURS

    def maximum_torque(self, cell: Cell) -> float | None:
        """Maximum |torque| [N m] (Table V)."""
        return self._entry("table_v_max_abs_torque_nm", cell)[1]

    def variation(self, cell: Cell) -> float | None:
        """Coefficient of variation of |torque| (Table VI)."""
        return self._entry("table_vi_cov_abs_torque", cell)[1]

    @property
    def lag_cell(self) -> Cell:
        """The cell of Table II."""
        table = self.data["table_ii_lag_hours"]
        return Cell(table["task"], float(table["increase_percent"]), table["axis"])

    def lag(self, row: int, column: int) -> int | None:
        """Lag [h] of Table II between two 1-based axes."""
        rows = self.data["table_ii_lag_hours"]["lag"]
        return rows[row - 1][column - 1] if row <= len(rows) and column <= len(rows) else None


def load_published(path: str | Path) -> Published:
    """Read the paper's values.

    Raises
    ------
    InputError : if the file is missing or not YAML.
    """
    return Published(read_yaml(path))
