"""Window statistics of simulated robots, kept on disk: a judge is tried many times on the same months."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.storage import open_dataset
from jointwear.measurement.refused import Refused
from jointwear.monitor.reading.survey import Survey
from jointwear.monitor.reading.window_files import read_statistics, write_statistics
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.studies.shop_floor.cell import Cell, draw_cell
from jointwear.studies.shop_floor.fast_path import statistics_of, survey_of
from jointwear.studies.shop_floor.plan import batch_of, robots_of

#: What stays of the torque that the model does not explain, until the first log is accepted: the survey needs a little
#: of it to tell how long the noise remembers.
LEFT = (1.0, 0.02, 0.0)


def simulate_batch(seed_set: str, batch: str, output: str | Path) -> None:
    """Simulate the robots of a batch into a folder of window statistics.

    A stage of ``snakemake shop_floor``, here and not beside the others: an edited judge must not simulate again.
    """
    simulate_robots(seed_set, robots_of(batch), output)


def simulate_robots(seed_set: str, indices: Iterable[int], folder: str | Path) -> None:
    """Simulate robots of a seed set and keep their window statistics as `folder`/INDEX.nc."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    for index in indices:
        cell = draw_cell(seed_set, index)
        survey, refused = survey_cell(cell)
        path = Path(folder) / f"{index:03d}.nc"
        write_statistics(
            statistics_of(cell, survey), path, "windows of a simulated robot-month", _drawn(cell), {"refused": refused}
        )


def survey_cell(cell: Cell) -> tuple[Survey, str]:
    """Return the survey of the first log, and why the product refused it (empty if it did not).

    Raises
    ------
    InputError : if it is refused even with the torque of the robot file.
    """
    reason = ""
    for left in LEFT:
        try:
            return survey_of(cell, left), reason
        except Refused as refusal:
            reason = reason or str(refusal).rpartition(".parquet: ")[2]
    raise InputError(f"{cell.name}: its first log is refused even with the torque of the robot file")


def kept_robot(seed_set: str, index: int, folder: str | Path) -> tuple[Cell, WindowStatistics, str]:
    """Return a robot, its window statistics, and why the product refused its first log.

    Parameters
    ----------
    folder : holds `SEED_SET`/windows/BATCH/INDEX.nc; what is missing is simulated.
    """
    batch = Path(folder) / seed_set / "windows" / batch_of(index)
    path = batch / f"{index:03d}.nc"
    if not path.exists():
        simulate_robots(seed_set, [index], batch)
    with open_dataset(path) as dataset:
        refused = str(dataset.refused)
    return draw_cell(seed_set, index), read_statistics(path), refused


def _drawn(cell: Cell) -> dict[str, Any]:
    """What was drawn, for the file's own record."""
    wear = None if cell.wear is None else vars(cell.wear)
    events = [{**vars(e), "axes": list(e.axes)} for e in cell.events]
    told = {"name": cell.name, "scenario": cell.scenario, "arm": cell.arm.name, "thermometer": cell.thermometer}
    return told | {"wear": wear, "events": events}
