"""A robot-month as a user's logs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointwear.studies.shop_floor.cell import Cell
from jointwear.studies.shop_floor.closed_loop import RATE
from jointwear.studies.shop_floor.sensing import Signals


def columns_of(cell: Cell, signals: Sequence[Signals]) -> dict[str, np.ndarray]:
    """Return the columns of a log of all windows of `signals`, in order of time."""
    pieces = []
    for s in signals:
        for row in range(len(s.index)):
            count = int(s.samples[row])
            pieces.append((s.begin[row], s, row, count))
    pieces.sort(key=lambda p: p[0])

    def all_of(of) -> np.ndarray:
        return np.concatenate([of(s, row)[:count] for _, s, row, count in pieces])

    n = len(cell.arm.home)
    columns = {"time": np.concatenate([b + np.arange(count) / RATE for b, _, _, count in pieces])}
    roles = {"position": lambda s, row: s.position[row], "torque": lambda s, row: s.torque[row]}
    if cell.arm.logs_velocity:
        roles["velocity"] = lambda s, row: s.velocity[row]
    if cell.thermometer != "none":
        roles["temperature"] = lambda s, row: np.broadcast_to(s.temperature[row], s.torque[row].shape)
    for role, of in roles.items():
        values = all_of(of)
        if role == "temperature" and cell.thermometer == "one":
            columns["temperature"] = values[:, 0]
            continue
        columns |= {f"{role}_{j + 1}": values[:, j] for j in range(n)}
    labels = [np.full(count, int(cell.month.program[cell.logged[s.index[row]]])) for _, s, row, count in pieces]
    columns["program"] = np.concatenate(labels)
    return columns


def write_parquet(path: Path, columns: dict[str, np.ndarray]) -> None:
    """Write a log as Parquet with UTC stamps."""
    import pyarrow as pa
    from pyarrow import parquet

    stamps = pa.array(np.round(columns["time"] * 1e3).astype(np.int64)).cast(pa.timestamp("ms", tz="UTC"))
    kinds = {"position": np.float64, "program": np.int32}
    rest = {
        name: pa.array(values.astype(kinds.get(name.partition("_")[0], np.float32)))
        for name, values in columns.items()
        if name != "time"
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    parquet.write_table(pa.table({"time": stamps, **rest}), path, compression="zstd")
