"""Programs that a log names: columns and names of logs, read in every format, judged each against its own normal."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, write_dataset
from jointwear.measurement.formats import layout_of, read_log
from jointwear.measurement.formats.programs import MOST_PROGRAMS, joined_labels, label_of

AXES, ROWS = 2, 12
TASK, SPEED = ["weld", "weld", "pick"] * 4, [80.0, 80.0, 100.0] * 4


def write(path: Path) -> Path:
    names = [f"{role}_{j}" for role in ("position", "torque") for j in (1, 2)]
    table = {"time": np.arange(ROWS) / 10} | {name: np.linspace(0, 1, ROWS) for name in names}
    if path.suffix == ".nc":
        pair = {role: np.stack([table[f"{role}_{j}"] for j in (1, 2)], axis=1) for role in ("position", "torque")}
        variables = {"time": Variable(("time",), table["time"], "time", "s")}
        variables |= {role: Variable(("time", "joint"), values, role) for role, values in pair.items()}
        variables["task"] = Variable(("time",), np.array(TASK, dtype=object), "task")
        variables["speed"] = Variable(("time",), np.array(SPEED), "speed", "1")
        write_dataset(path, variables, {"title": "log"})
        return path
    whole = pa.table({**table, "task": TASK, "speed": SPEED})
    (parquet.write_table if path.suffix == ".parquet" else csv.write_csv)(whole, path)
    return path


def labels(path, program):
    layout = layout_of({"program": program}, [f"axis_{j + 1}" for j in range(AXES)])
    return [chunk.program for chunk in read_log(path, layout)]


@pytest.mark.parametrize("ending", [".csv", ".parquet", ".nc"])
def test_columns_of_a_log_name_its_programs(tmp_path, ending):
    path = write(tmp_path / f"log{ending}")
    assert np.concatenate(labels(path, {"columns": ["task", "speed"]})).tolist() == [
        f"{task} / {speed:g}" for task, speed in zip(TASK, SPEED, strict=True)
    ]
    assert np.concatenate(labels(path, {"columns": "task"})).tolist() == TASK
    assert set(np.concatenate(labels(path, {"logs": {"*/log.*": "shift 1"}}))) == {"shift 1"}
    assert labels(path, {"logs": {"*/other.*": "x"}}) == [None]
    with pytest.raises(InputError, match=r"'tusk'.*'task'"):
        labels(path, {"columns": ["tusk"]})


def test_equal_numbers_are_one_program_and_measured_columns_are_none():
    assert label_of("80.0") == label_of(80) == label_of(" 80 ") == "80"
    assert label_of(None) == label_of(float("nan")) == ""
    with pytest.raises(InputError, match="names no programs"):
        joined_labels(Path("log"), [np.linspace(0, 1, MOST_PROGRAMS + 1)])
