"""Window statistics of simulated robots, kept on disk: a judge is tried many times on the same months."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from jointwear.files.storage import open_dataset
from jointwear.measurement.checks import Refused
from jointwear.monitor.window_files import read_statistics, write_statistics
from jointwear.monitor.windows import WindowStatistics
from jointwear.studies.shop_floor.cell import Cell, draw_cell
from jointwear.studies.shop_floor.fast_path import statistics_of, survey_of


def simulate_robots(seed_set: str, indices: list[int], folder: str | Path) -> None:
    """Simulate robots of a seed set and keep their window statistics as `folder`/INDEX.nc."""
    for index in indices:
        path = Path(folder) / f"{index:03d}.nc"
        path.parent.mkdir(parents=True, exist_ok=True)
        cell = draw_cell(seed_set, index)
        refused, survey = "", None
        try:
            survey = survey_of(cell)
        except Refused as refusal:
            refused, survey = str(refusal).rpartition(".parquet: ")[2], survey_of(cell, checked=False)
        statistics = statistics_of(cell, survey)
        write_statistics(statistics, path, "windows of a simulated robot-month", _drawn(cell), {"refused": refused})


def kept_robot(seed_set: str, index: int, folder: str | Path) -> tuple[Cell, WindowStatistics, str]:
    """Return a robot, its window statistics, and why the product refused its first log; simulated if not kept yet."""
    path = Path(folder) / f"{index:03d}.nc"
    if not path.exists():
        simulate_robots(seed_set, [index], folder)
    with open_dataset(path) as dataset:
        refused = str(dataset.refused)
    return draw_cell(seed_set, index), read_statistics(path), refused


def _drawn(cell: Cell) -> dict[str, Any]:
    """What was drawn, in words and numbers, for the file's own record."""
    wear = None if cell.wear is None else vars(cell.wear)
    events = [{**vars(e), "axes": list(e.axes)} for e in cell.events]
    told = {"name": cell.name, "scenario": cell.scenario, "arm": cell.arm.name, "thermometer": cell.thermometer}
    return json.loads(json.dumps({**told, "wear": wear, "events": events}))
