"""Tables II, IV, V and VI of several experiments beside the paper's, as plain data for the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jointwear.files.documents import read_yaml
from jointwear.files.json_documents import write_json
from jointwear.publishing.report.result_tables import (
    Row,
    score_detection,
    score_lags,
    score_values,
)
from jointwear.reproduction.readings import ambiguities
from jointwear.reproduction.tables import read_table

#: Of each table: the columns that name a cell, and the one that is compared. Tables V and VI are read at the paper's
#: hours, so that a wrong hour of detection does not count again as a wrong torque.
COMPARED = {
    "table_ii": (("row_axis", "column_axis"), "reproduced"),
    "table_iv": (("task", "axis", "increase_percent"), "hour_median"),
    "table_v": (("task", "axis", "increase_percent"), "at_published_hour"),
    "table_vi": (("task", "axis", "increase_percent"), "at_published_hour"),
}

#: Share of the replicates from which on a cell counts as detected, as in the scores of Table IV.
DETECTED = 0.5


def beside(tables: Mapping[str, Sequence[Row]], key: Sequence[str], column: str) -> list[Row]:
    """Return one row a cell: its name, `published`, and `column` of each experiment under the experiment's name.

    Parameters
    ----------
    tables : rows of one table by the name of the experiment; all of them have the same cells in the same order.

    Raises
    ------
    ValueError : if they have not.
    """
    result = []
    for rows in zip(*tables.values(), strict=True):
        name = {k: rows[0][k] for k in key}
        if any(row[k] != name[k] for row in rows for k in key):
            raise ValueError(f"cells of two experiments differ: {name}")
        values = {experiment: row[column] for experiment, row in zip(tables, rows, strict=True)}
        result.append({**name, "published": rows[0]["published"], **values})
    return result


def changed_readings(config: str | Path) -> list[dict[str, str]]:
    """Return the points of the text that a configuration file takes otherwise than the default, and why it may."""
    chosen = read_yaml(config).get("reading", {})
    known = ambiguities()
    return [
        {
            "name": name,
            "chosen": value,
            "default": known[name].default,
            "question": known[name].question,
            "paper": known[name].paper,
            "meaning": " ".join((known[name].alternatives[value].__doc__ or "").split()),
        }
        for name, value in chosen.items()
        if value != known[name].default
    ]


def as_printed(row: Row) -> Row:
    """Return a row as the paper would print it: no hour where less than half of the replicates detect."""
    if row.get("detection_probability", 1.0) >= DETECTED:
        return row
    return {**row, "hour_median": None}


def scores_of(rows: Mapping[str, list[Row]]) -> dict[str, Any]:
    """Return how well the tables of one experiment reproduce the paper, by the verdicts and errors of the report."""
    return {
        "table_ii": score_lags(rows["table_ii"]),
        "table_iv": score_detection(rows["table_iv"]),
        "table_v": score_values(rows["table_v"], relative=True),
        "table_vi": score_values(rows["table_vi"], relative=False),
    }


def write_chapter(folders: Mapping[str, str | Path], output: str | Path) -> None:
    """Write everything that the chapter says as JSON.

    Parameters
    ----------
    folders : working directory of each experiment by its name, with `config/config.yaml` and `results/tables`.

    Raises
    ------
    InputError : naming the file, if one is missing or damaged.
    """
    rows = {
        name: {table: read_table(Path(folder) / "results/tables" / f"{table}.nc") for table in COMPARED}
        for name, folder in folders.items()
    }
    tables = {
        table: beside({name: [as_printed(row) for row in found[table]] for name, found in rows.items()}, key, column)
        for table, (key, column) in COMPARED.items()
    }
    # Table II is antisymmetric.
    tables["table_ii"] = [row for row in tables["table_ii"] if row["row_axis"] < row["column_axis"]]
    content = {
        "experiments": {
            name: {
                "scores": scores_of(rows[name]),
                "readings": changed_readings(Path(folder) / "config/config.yaml"),
            }
            for name, folder in folders.items()
        },
        "tables": tables,
    }
    write_json(output, content)
