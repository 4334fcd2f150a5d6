"""Surveys of a robot that a failed call does not take away.

Snakemake deletes what a rule writes before it runs the rule: after one mistyped key the survey is gone and, where logs
are deleted after a while, so may be the log that it was made of. Each is therefore kept a second time, in
`surveys.json`, under a digest of the robot and of how its logs are read. Read by the Snakefile at every call: nothing
heavy is imported here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.monitor.made_with import made_with

#: Name of the file, beside the survey, and most surveys in it: the latest.
FILE, MOST = "surveys.json", 8


def surveyed_log(survey: str | Path, logs: Sequence[str], robot: str | Path, entry: Mapping[str, Any]) -> str:
    """Return the log that the survey of a robot rests on: one that was surveyed before, else the first.

    A log that sorts before all others, or one that is no longer kept, changes nothing of what was worked out before.

    Parameters
    ----------
    survey : file of the survey, there or not. logs : there now, in order. robot : file of the robot.
    entry : the robot's entry of the config; of it the keys that decide how logs are read.
    """
    known = _known(survey)
    try:
        kept = known.get(made_with(robot, entry))
    except InputError:
        kept = None  # the rule itself says what is wrong with the robot file
    if kept:
        return kept["log"]
    try:
        last = read_json(survey).get("log")
    except InputError:
        last = None
    return last if last in logs else logs[0]


def kept_survey(survey: str | Path, robot: str | Path, entry: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return the survey that was kept of this robot, read like this, or None; see :func:`surveyed_log`."""
    return _known(survey).get(made_with(robot, entry))


def keep_survey(survey: str | Path, robot: str | Path, entry: Mapping[str, Any]) -> None:
    """Keep a survey that has just been written, beside those of other settings; see :func:`surveyed_log`."""
    made = made_with(robot, entry)
    others = [(key, kept) for key, kept in _known(survey).items() if key != made]
    latest = dict([*others, (made, read_json(survey))][-MOST:])
    write_json(Path(survey).with_name(FILE), {"surveys": latest})


def _known(survey: str | Path) -> dict[str, dict[str, Any]]:
    """Return the surveys that are kept; none where the file is missing or damaged."""
    try:
        surveys = read_json(Path(survey).with_name(FILE)).get("surveys")
    except InputError:
        return {}
    sound = isinstance(surveys, dict) and all(isinstance(s, dict) and s.get("log") for s in surveys.values())
    return surveys if sound else {}
