"""Tables II to VI of the paper, each published value beside ours, as CSV and netCDF."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, read_variables, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.reproduction.grid import Cell, by_cell
from jointwear.reproduction.published import Published, load_published
from jointwear.reproduction.verdicts import NOT_COMPARABLE, detection_verdict, torque_verdict, variation_verdict
from jointwear.statistics.intervals import spread_over_replicates, wilson_interval

Row = dict[str, Any]


def _named(cell: Cell) -> Row:
    return {"task": cell.task, "axis": cell.axis, "increase_percent": cell.increase_percent}


def table_ii(locations: list[str], published: Published, replicate: int) -> list[Row]:
    """Return the lags [h] of Table II: one named replicate (1-based) and the 5 to 95 % range over replicates."""
    cell = published.lag_cell
    path = by_cell(locations).get(cell)
    if path is None:
        return []
    (lag,) = read_variables(path, "lag")
    rows = []
    for i in range(lag.shape[1]):
        for j in range(lag.shape[2]):
            _, low, high = spread_over_replicates(lag[:, i, j])
            rows.append(
                {
                    **_named(cell),
                    "row_axis": i + 1,
                    "column_axis": j + 1,
                    "published": published.lag(i + 1, j + 1),
                    "reproduced": int(lag[replicate - 1, i, j]),
                    "reproduced_low": low,
                    "reproduced_high": high,
                }
            )
    return rows


def table_iii(detections: list[str]) -> list[Row]:
    """Return the design: every run with its number of replicates."""
    return [
        {**_named(cell), "replicates": len(read_variables(path, "onset")[0])}
        for cell, path in by_cell(detections).items()
    ]


def table_iv(detections: list[str], locations: list[str], published: Published) -> list[Row]:
    """Return detection and location: probability with Wilson's 95 % interval, hours with 90 % range."""
    located = by_cell(locations)
    rows = []
    for cell, path in by_cell(detections).items():
        onset, hours = read_variables(path, "onset", "hour")
        (source,) = read_variables(located[cell], "source")
        detected = np.isfinite(onset)
        probability = float(detected.mean())
        low, high = wilson_interval(int(detected.sum()), len(detected))
        hour, hour_low, hour_high = spread_over_replicates(onset)
        hour_published = published.detection_hour(cell)
        rows.append(
            {
                **_named(cell),
                "published": hour_published,
                "detection_probability": probability,
                "probability_low": low,
                "probability_high": high,
                "hour_median": hour,
                "hour_low": hour_low,
                "hour_high": hour_high,
                "located_probability": float((source[detected] == cell.axis).mean()) if detected.any() else np.nan,
                "verdict": detection_verdict(
                    _reached(published, cell, hours[-1]), hour_published, probability, hour, hour_low, hour_high
                ),
            }
        )
    return rows


def _reached(published: Published, cell: Cell, last: float) -> bool:
    """Whether the paper ran this cell, and ours lasts, to hour `last`, until the paper's is evaluated."""
    return published.has(cell) and published.evaluation_hour(cell) <= last


def _at_hours(values: np.ndarray, hours: np.ndarray) -> np.ndarray:
    """Pick each replicate's value at its 1-based hour: (r, hours), (r,) -> (r,)."""
    return np.take_along_axis(values, hours.astype(int)[:, None] - 1, axis=1)[:, 0]


def _torque_table(features: list[str], detections: list[str], published: Published, name: str) -> list[Row]:
    onset_files = by_cell(detections)
    printed = published.maximum_torque if name == "maximum_torque" else published.variation
    rows = []
    for cell, path in by_cell(features).items():
        values = read_variables(path, name)[0][:, :, cell.axis - 1]
        last = values.shape[1]
        (onset,) = read_variables(onset_files[cell], "onset")
        own = _at_hours(values, np.where(np.isnan(onset), last, onset))
        median, low, high = spread_over_replicates(own)
        value, there = printed(cell), (np.nan, np.nan, np.nan)
        reached = _reached(published, cell, last)
        if reached:
            there = spread_over_replicates(values[:, int(published.evaluation_hour(cell)) - 1])
        if not reached:
            verdict = NOT_COMPARABLE
        elif name == "maximum_torque":
            verdict = torque_verdict(value, median, low, high)
        else:
            rest = published.maximum_torque(cell) == 0
            noise_range = tuple(np.quantile(own, [0.025, 0.975])) if rest else None
            verdict = variation_verdict(value, median, low, high, noise_range)
        rows.append(
            {
                **_named(cell),
                "published": value,
                "reproduced": median,
                "reproduced_low": low,
                "reproduced_high": high,
                **dict(
                    zip(("at_published_hour", "at_published_hour_low", "at_published_hour_high"), there, strict=True)
                ),
                "verdict": verdict,
            }
        )
    return rows


def table_v(features: list[str], detections: list[str], published: Published) -> list[Row]:
    """Return the maximum |torque| [N m] at our own onset (last hour if none) and at the paper's hour, NaN where the run
    ends before it."""
    return _torque_table(features, detections, published, "maximum_torque")


def table_vi(features: list[str], detections: list[str], published: Published) -> list[Row]:
    """Return the coefficient of variation of |torque| at our own onset and at the paper's hour."""
    return _torque_table(features, detections, published, "variation")


COLUMNS = {
    "table_ii": "task axis increase_percent row_axis column_axis published reproduced reproduced_low reproduced_high",
    "table_iii": "task axis increase_percent replicates",
    "table_iv": "task axis increase_percent published detection_probability probability_low probability_high "
    "hour_median hour_low hour_high located_probability verdict",
    "table_v": "task axis increase_percent published reproduced reproduced_low reproduced_high at_published_hour "
    "at_published_hour_low at_published_hour_high verdict",
}
COLUMNS["table_vi"] = COLUMNS["table_v"]
_UNIT_OF_TABLE = {"table_ii": "h", "table_iv": "h", "table_v": "N m", "table_vi": "1"}
_WITHOUT_UNIT = {"task", "verdict"}
_OWN_UNIT = {"axis", "row_axis", "column_axis", "replicates"}
_SHARES = ("detection_probability", "probability_low", "probability_high", "located_probability")


def _text(value: Any) -> str:
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def write_table(
    name: str, rows: list[Row], stem: str | Path, settings: Mapping[str, Any], made_from: Sequence[str] = ()
) -> None:
    """Write the table `name` as `stem`.csv and `stem`.nc.

    The netCDF file has one dimension, `row`, and one variable a column; what is missing is NaN.
    """
    columns = COLUMNS[name].split()
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_text(row[c]) for c in columns] for row in rows)
    variables = {}
    for column in columns:
        values = [row[column] for row in rows]
        if column in _WITHOUT_UNIT:
            content, units = np.array(values, dtype=object).astype(str), None
        elif column in _OWN_UNIT:
            content, units = np.array(values, dtype=int), "1"
        else:
            content = np.array([np.nan if v is None else v for v in values], dtype=float)
            units = "percent" if column == "increase_percent" else "1" if column in _SHARES else _UNIT_OF_TABLE[name]
        variables[column] = Variable(("row",), content, column.replace("_", " "), units)
    write_dataset(f"{stem}.nc", variables, provenance.attributes(name.replace("_", " "), settings, made_from))
    replace_text(f"{stem}.csv", buffer.getvalue())


def read_table(path: str | Path) -> list[Row]:
    """Return the rows of a table from its netCDF file; what is missing is None."""
    with open_dataset(path) as dataset:
        columns = {name: read_variable(dataset, path, name).tolist() for name in dataset.variables}
    return [
        {k: None if isinstance(v, float) and np.isnan(v) else v for k, v in zip(columns, values, strict=True)}
        for values in zip(*columns.values(), strict=True)
    ]


def write_tables(
    name: str,
    stem: str | Path,
    published: str | Path,
    *,
    features: list[str] = (),
    detections: list[str] = (),
    locations: list[str] = (),
    replicate: int = 1,
) -> None:
    """Compute and write one of the paper's tables from the files of all worn runs.

    Parameters
    ----------
    name : table_ii to table_vi.
    stem : path without ending of the two files to write.
    published : the paper's values.
    features, detections, locations : files of the worn runs, as far as the table needs them.
    replicate : the named replicate of Table II, 1-based.
    """
    printed = load_published(published)
    rows = {
        "table_ii": lambda: table_ii(locations, printed, replicate),
        "table_iii": lambda: table_iii(detections),
        "table_iv": lambda: table_iv(detections, locations, printed),
        "table_v": lambda: table_v(features, detections, printed),
        "table_vi": lambda: table_vi(features, detections, printed),
    }[name]()
    settings = {"table": name, "replicate": replicate} if name == "table_ii" else {"table": name}
    # Runs of the same settings alone may stand in one table.
    write_table(name, rows, stem, settings, sorted({*features, *detections, *locations}))


def tabulate_results(
    names: Sequence[str],
    folder: str | Path,
    published: str | Path,
    *,
    features: list[str],
    detections: list[str],
    locations: list[str],
    replicate: int = 1,
) -> None:
    """Write several tables into a folder, each as CSV and netCDF; see :func:`write_tables`."""
    for name in names:
        write_tables(
            name,
            Path(folder) / name,
            published,
            features=features,
            detections=detections,
            locations=locations,
            replicate=replicate,
        )
