"""Judge a batch of robots in one process; one robot that is refused does not stop the others."""

from __future__ import annotations

import csv
import io
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.storage import open_dataset
from jointwear.files.text_files import replace_text
from jointwear.monitor.plan import READING_KEYS
from jointwear.monitor.stages import accumulate_windows, judge_windows, survey_logs

COLUMNS = ("robot", "result", "alarms", "axes_changed", "reason")


def watch_robot(name: str, entry: Mapping[str, Any], logs: Sequence[str], folder: Path) -> dict[str, Any]:
    """Survey, accumulate and judge the logs of one robot; files go to `folder`/`name`.

    Returns `robot`, `result` (judged or refused), `alarms`, `axes_changed` and `reason` (of a refusal).
    """
    own = folder / name
    own.mkdir(parents=True, exist_ok=True)
    reading = {key: entry[key] for key in READING_KEYS if key in entry}
    row = {"robot": name, "result": "judged", "alarms": 0, "axes_changed": "", "reason": ""}
    try:
        survey_logs(logs[0], entry["robot"], reading, own / "survey.json")
        accumulate_windows(logs, own / "survey.json", entry["robot"], reading, own / "windows.nc")
        judge_windows([str(own / "windows.nc")], entry["robot"], entry, own / "state.nc", own / "alarms.csv")
    except InputError as error:
        return {**row, "result": "refused", "reason": str(error)}
    with (own / "alarms.csv").open(encoding="utf-8") as file:
        row["alarms"] = sum(1 for _ in csv.DictReader(file))
    with open_dataset(own / "state.nc") as state:
        last = state["status"][-1]
        row["axes_changed"] = " ".join(str(axis + 1) for axis, word in enumerate(last) if word == "changed")
    return row


def watch_robots(
    entries: Mapping[str, Mapping[str, Any]], logs: Mapping[str, Sequence[str]], folder: str | Path, output: str | Path
) -> None:
    """Judge every robot of a batch and write what came out as JSON.

    Parameters
    ----------
    entries : entries of ``monitor.robots`` by name.
    logs : the logs of every robot, in order of time.
    folder : where each robot gets a folder of its own.
    output : the JSON file: `robots`, one row each, and `process_seconds`, the processor time of the judging alone.
    """
    begin = time.process_time()
    rows = [watch_robot(name, entry, logs[name], Path(folder)) for name, entry in entries.items()]
    spent = time.process_time() - begin
    replace_text(output, json.dumps({"robots": rows, "process_seconds": round(spent, 3)}, indent=1) + "\n")


def summarise_fleet(batches: Sequence[str | Path], output: str | Path) -> None:
    """Write one CSV table of all robots: result, alarms, axes changed at the end, reason of a refusal."""
    text = io.StringIO()
    table = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    table.writeheader()
    for path in batches:
        table.writerows(json.loads(Path(path).read_text(encoding="utf-8"))["robots"])
    replace_text(output, text.getvalue())
