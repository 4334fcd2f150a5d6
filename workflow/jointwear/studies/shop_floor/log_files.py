"""A robot-month as a user's logs: one file a day in three formats, robot files, and the config of the fleet.

Run as a command to write a fleet:

    PYTHONPATH=workflow python -m jointwear.studies.shop_floor.log_files FOLDER --seeds choose --robots 10
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import yaml
from pyarrow import csv, parquet

from jointwear.files.storage import Variable, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.studies.shop_floor.arms import ARM_TYPES, robot_data
from jointwear.studies.shop_floor.cell import SEEDS, Cell, draw_cell
from jointwear.studies.shop_floor.closed_loop import RATE
from jointwear.studies.shop_floor.confounders import present
from jointwear.studies.shop_floor.month import DAY, DAYS
from jointwear.studies.shop_floor.plant_entry import STATED, entry_of
from jointwear.studies.shop_floor.sensing import Signals, signals_of

FORMATS = (".parquet", ".csv", ".nc")
#: Of a messy plant's days: share with rows written twice, with a clock set back within the day, kept as a second file.
TWICE, SET_BACK, COPIED = 0.1, 0.05, 0.05
#: The clock is set back by an hour.
BACK = 3600.0


def columns_of(cell: Cell, signals: Sequence[Signals]) -> dict[str, np.ndarray]:
    """Return the columns of a log of all windows of `signals`, in order of time."""
    windows = sorted(((s, row) for s in signals for row in range(len(s.index))), key=lambda p: p[0].begin[p[1]])

    def all_of(of) -> np.ndarray:
        return np.concatenate([of(s, row)[: s.samples[row]] for s, row in windows])

    def each(values: float | np.ndarray, s: Signals) -> np.ndarray:
        return np.broadcast_to(values, (s.torque.shape[1], *np.shape(values)))

    columns = {"time": all_of(lambda s, row: s.begin[row] + np.arange(s.torque.shape[1]) / RATE)}
    roles = {"position": lambda s, row: s.position[row], "torque": lambda s, row: s.torque[row]}
    if cell.arm.logs_velocity:
        roles["velocity"] = lambda s, row: s.velocity[row]
    if cell.thermometer == "each axis":
        roles["temperature"] = lambda s, row: each(s.temperature[row], s)
    for role, of in roles.items():
        columns |= {f"{role}_{j + 1}": x for j, x in enumerate(all_of(of).T)}
    if cell.thermometer == "one":
        columns["temperature"] = all_of(lambda s, row: each(s.temperature[row, 0], s))
    columns["program"] = all_of(lambda s, row: each(cell.month.program[cell.logged[s.index[row]]], s))
    return columns


def write_log(path: Path, columns: dict[str, np.ndarray]) -> None:
    """Write a log with UTC stamps; the ending of its name decides the format."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".nc":
        _write_netcdf(path, columns)
        return
    stamps = pa.array(np.round(columns["time"] * 1e3).astype(np.int64)).cast(pa.timestamp("ms", tz="UTC"))
    kinds = {"position": np.float64, "program": np.int32}
    rest = {
        name: pa.array(np.round(values, 7).astype(kinds.get(name.partition("_")[0], np.float32)))
        for name, values in columns.items()
        if name != "time"
    }
    table = pa.table({"time": stamps, **rest})
    if path.suffix == ".parquet":
        parquet.write_table(table, path, compression="zstd")
    else:
        csv.write_csv(table, path, csv.WriteOptions(quoting_style="none"))


def _write_netcdf(path: Path, columns: dict[str, np.ndarray]) -> None:
    units = {"position": "rad", "velocity": "rad/s", "torque": "N m", "temperature": "degC"}
    clock = "seconds since 1970-01-01T00:00:00Z"
    variables = {"time": Variable(("time",), columns["time"], "time", clock, compressed=True)}
    for role, unit in units.items():
        axes = [columns[name] for name in columns if name.startswith(f"{role}_")]
        if axes:
            kind = "f8" if role == "position" else "f4"
            variables[role] = Variable(
                ("time", "joint"), np.stack(axes, axis=1), role, unit, kind=kind, compressed=True
            )
        elif role in columns:
            variables[role] = Variable(("time",), columns[role], role, unit, kind="f4", compressed=True)
    write_dataset(path, variables, {"title": "log of a simulated arm"})


def write_robot_logs(cell: Cell, folder: Path, days: range = range(DAYS)) -> list[Path]:
    """Write the logs of one robot, one a day, and return their paths; a messy plant writes some of them badly."""
    random = cell.random("files")
    ending = FORMATS[int(random.integers(len(FORMATS)))]
    messy, fates = "messy" in present(cell.scenario), random.random((DAYS, 3))
    paths = []
    for day in days:
        chosen = np.flatnonzero(cell.logged // DAY == day)
        if not len(chosen):
            continue
        columns = columns_of(cell, list(signals_of(cell, chosen)))
        rows = len(columns["time"])
        twice, back, copied = messy * (fates[day] < (TWICE, SET_BACK, COPIED))
        if back:
            columns["time"] = np.where(np.arange(rows) < rows // 2, columns["time"], columns["time"] - BACK)
        if twice:
            again = np.concatenate([np.arange(2 * rows // 3), np.arange(rows // 3, rows)])
            columns = {name: values[again] for name, values in columns.items()}
        names = [f"day_{day + 1:02d}{ending}", *([f"day_{day + 1:02d}_copy{ending}"] if copied else [])]
        for name in names:
            write_log(folder / name, columns)
            paths.append(folder / name)
    return paths


def write_fleet(folder: str | Path, seed_set: str, indices: Sequence[int], days: range = range(DAYS)) -> dict[str, Any]:
    """Write logs, robot files and `fleet.yaml`, the config; return the config.

    Parameters
    ----------
    days : of the month that are written.
    """
    folder = Path(folder)
    for arm in ARM_TYPES.values():
        replace_text(folder / "robots" / f"{arm.name}.yaml", yaml.safe_dump(robot_data(arm), sort_keys=False))
    robots = {}
    for index in indices:
        cell = draw_cell(seed_set, index)
        write_robot_logs(cell, folder / "logs" / cell.name, days)
        place = {"logs": [f"logs/{cell.name}/*"], "robot": f"robots/{cell.arm.name}.yaml"}
        robots[cell.name] = place | entry_of(cell, STATED)
    config = {"monitor": {"robots": robots}}
    replace_text(folder / "fleet.yaml", yaml.safe_dump(config, sort_keys=False))
    return config


def main(arguments: Sequence[str] | None = None) -> None:
    """Write a fleet."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--seeds", choices=sorted(SEEDS), default="choose")
    parser.add_argument("--robots", type=int, default=10)
    given = parser.parse_args(arguments)
    write_fleet(given.folder, given.seeds, range(given.robots))


if __name__ == "__main__":
    main()
