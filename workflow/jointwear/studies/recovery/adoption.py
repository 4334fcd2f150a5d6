"""Copy the recovered experiment into `config/`, and hold the copies to a new recovery."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from jointwear.files.errors import InputError
from jointwear.files.text_files import replace_text
from jointwear.files.wording import count
from jointwear.robots.robot_file import read_robot_file
from jointwear.robots.task_file import read_task_file
from jointwear.studies.recovery.export import write_yaml

_FROM = "written by `snakemake recover` from Tables V and VI of the paper"


def adopt_robot(recovered: str | Path, copy: str | Path) -> None:
    """Put the payload of the recovered robot file into the copy; its torque limits and comments stay.

    Raises
    ------
    InputError : if a file is missing or the copy has no payload to replace.
    """
    payload = read_robot_file(recovered)["payload"]
    text = Path(copy).read_text(encoding="utf-8")
    line = f"payload: {{mass: {payload['mass']}, com: {payload['com']}}}   # kg; m in the last link frame"
    text, replaced = re.subn(r"(?m)^payload:.*$", line, text)
    if replaced != 1:
        raise InputError(f"{copy}: has {replaced} lines that start with 'payload:', one is needed")
    head = text.partition("provenance:")[0]
    source = (
        f"mdl_puma560 of the MATLAB Robotics Toolbox 10.4; payload: results/recovery/robot.yaml, {_FROM}; "
        "torque limits: Armstrong, Khatib and Burdick 1986, maximum torques"
    )
    note = (
        "The arm of the paper's experiment. The paper never mentions a payload, but its torques are out of reach "
        "without one. Mass and offset are not determined one by one; other payloads fit nearly as well."
    )
    replace_text(copy, f'{head}provenance:\n  source: "{source}"\n  note: "{note}"\n')


def adopt_task(recovered: str | Path, copy: str | Path) -> None:
    """Write the recovered task file as the copy, saying where it comes from."""
    data = yaml.safe_load(Path(recovered).read_text(encoding="utf-8"))
    source = f"results/recovery/tasks/{Path(recovered).name}, {_FROM}, whose text gives no poses"
    write_yaml(copy, {**data, "provenance": {**data["provenance"], "source": source}})


def adopt_wear_shape(recovered: str | Path, config: str | Path) -> None:
    """Put the recovered wear shape into the configuration file.

    Raises
    ------
    InputError : if the configuration has no wear shape.
    """
    shape = yaml.safe_load(Path(recovered).read_text(encoding="utf-8"))["wear"]["shape"]
    text, replaced = re.subn(
        r"(?m)^(wear:\n(?:  .*\n)*?  shape: ).*$", rf"\g<1>{shape}", Path(config).read_text(encoding="utf-8")
    )
    if replaced != 1:
        raise InputError(f"{config}: has no key wear.shape to replace")
    replace_text(config, text)


def adopt_experiment(
    robot: str | Path,
    tasks: Sequence[str | Path],
    wear: str | Path,
    robot_copy: str | Path,
    task_copies: Sequence[str | Path],
    config: str | Path,
) -> None:
    """Copy what was recovered (`robot`, `tasks`, `wear`) into the files that the default experiment names."""
    adopt_robot(robot, robot_copy)
    for recovered, copy in zip(tasks, task_copies, strict=True):
        adopt_task(recovered, copy)
    adopt_wear_shape(wear, config)


def _values(data: Any, key: str = "") -> Iterator[tuple[str, float]]:
    if isinstance(data, Mapping):
        for name, value in data.items():
            yield from _values(value, f"{key}.{name}" if key else str(name))
    elif isinstance(data, (list, tuple)):
        for place, value in enumerate(data):
            yield from _values(value, f"{key}[{place}]")
    elif isinstance(data, (int, float)) and not isinstance(data, bool):
        yield key, float(data)


def compare_copies(
    recovered: Sequence[str | Path], copies: Sequence[str | Path], output: str | Path, tolerance: float
) -> None:
    """Write every value of the recovered files beside that of the copies, and refuse copies that are out of date.

    Parameters
    ----------
    recovered, copies : robot file first, then task files, in the same order.
    output : CSV file with file, key, copy, recovered, within.
    tolerance : relative for payloads, positions and times, absolute below one.

    Raises
    ------
    InputError : naming the first value out of tolerance; the CSV file is written all the same.
    """
    rows = []
    for k, (new, old) in enumerate(zip(recovered, copies, strict=True)):
        read = (lambda path: {"payload": read_robot_file(path)["payload"]}) if k == 0 else read_task_file
        new_values, old_values = dict(_values(read(new))), dict(_values(read(old)))
        for key in sorted(set(new_values) | set(old_values)):
            a, b = old_values.get(key), new_values.get(key)
            within = a is not None and b is not None and abs(a - b) <= tolerance * max(abs(a), 1.0)
            rows.append({"file": str(old), "key": key, "copy": a, "recovered": b, "within": within})
    text = io.StringIO()
    writer = csv.DictWriter(text, ["file", "key", "copy", "recovered", "within"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    replace_text(output, text.getvalue())
    wrong = [row for row in rows if not row["within"]]
    if wrong:
        first = wrong[0]
        raise InputError(
            f"{first['file']}: {first['key']} is {first['copy']}, recovered {first['recovered']}; "
            f"{len(wrong)} of {count(len(rows), 'value')} differ by more than {tolerance:g}; "
            "`snakemake adopt_recovered` renews the copies"
        )
