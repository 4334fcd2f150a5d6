"""History of the states as Parquet: one row per robot, window and axis, for tools that ask in SQL or data frames."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from jointwear.files.errors import InputError
from jointwear.files.regular_files import check_regular
from jointwear.monitor.judging.state import RobotState

#: Estimates that have a column each and one for the standard deviation; empty where a robot has none.
ESTIMATES = ("coulomb_percent", "coulomb", "viscous_percent", "viscous", "friction", "backlash")
_MOMENT = pa.timestamp("ms", tz="UTC")
SCHEMA = pa.schema(
    [
        pa.field("robot", pa.string()),
        pa.field("axis", pa.int16()),
        pa.field("joint", pa.string()),
        pa.field("start", _MOMENT),
        pa.field("end", _MOMENT),
        pa.field("end_seconds", pa.float64()),
        pa.field("status", pa.string()),
        pa.field("baseline", pa.bool_()),
        pa.field("alarms", pa.int32()),
        pa.field("temperature", pa.float64()),
        *(pa.field(f"{name}{part}", pa.float64()) for name in ESTIMATES for part in ("", "_std")),
    ]
)


@contextmanager
def _whole(path: Path):
    """A writer whose file appears under its name when it is complete."""
    part = path.with_name(path.name + ".part")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with parquet.ParquetWriter(
            part, SCHEMA, compression="zstd", use_dictionary=["robot", "joint", "status"]
        ) as out:
            yield out
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def write_history(path: str | Path, state: RobotState, robot: str) -> None:
    """Write the windows of one robot; `robot` is its name in the config."""
    w, n = state.status.shape
    alarms = np.zeros((w, n), dtype=np.int32)
    for alarm in state.counted:
        if alarm["axis"]:
            alarms[np.clip(np.searchsorted(state.end, alarm["time"]), 0, w - 1), alarm["axis"] - 1] += 1

    def moments(seconds: np.ndarray) -> pa.Array:
        if not state.dated:
            return pa.nulls(w * n, _MOMENT)
        return pa.array(np.repeat(np.rint(1000 * seconds).astype("datetime64[ms]"), n), _MOMENT)

    nothing = np.full((w, n), np.nan)
    columns = {
        "robot": pa.array([robot] * (w * n), pa.string()),
        "axis": np.tile(np.arange(1, n + 1), w),
        "joint": pa.array(list(state.joints) * w, pa.string()),
        "start": moments(state.start),
        "end": moments(state.end),
        "end_seconds": np.repeat(state.end, n),
        "status": pa.array([str(s) for s in state.status.ravel()], pa.string()),
        "baseline": np.repeat(state.baseline, n),
        "alarms": alarms.ravel(),
        "temperature": state.temperature.ravel(),
    }
    for name in ESTIMATES:
        values, std, _ = state.estimates.get(name, (nothing, nothing, ""))
        columns |= {name: values.ravel(), f"{name}_std": std.ravel()}
    arrays = [pa.array(columns[f.name], f.type, from_pandas=True) for f in SCHEMA]
    with _whole(Path(path)) as out:
        out.write_table(pa.Table.from_arrays(arrays, schema=SCHEMA))


def join_histories(parts: Iterable[str | Path], output: str | Path) -> None:
    """Write the histories of robots one after the other, a robot at a time in memory.

    Raises
    ------
    InputError : naming the file, if one is broken.
    """
    with _whole(Path(output)) as out:
        for path in parts:
            check_regular(path)
            try:
                with parquet.ParquetFile(path) as file:
                    same, table = file.schema_arrow.equals(SCHEMA), file.read()
            except (OSError, pa.ArrowException) as error:
                words = next(iter(str(error).splitlines()), type(error).__name__)
                raise InputError(f"{path}: is no history of this version ({words}); delete it and run again") from None
            if not same:
                raise InputError(f"{path}: is no history of this version (other columns); delete it and run again")
            out.write_table(table)
