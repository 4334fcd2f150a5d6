"""Results of monitoring as files: the state of every axis in every window, and the alarms."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.json_documents import parse_json
from jointwear.files.json_values import as_json
from jointwear.files.storage import Variable, open_dataset, read_attribute, read_variable, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.measurement.timestamps import stamp
from jointwear.monitor.judging.judge import Judgement
from jointwear.monitor.normal.friction import window_friction
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.assembly import History, Piece
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.limits import LimitDate
from jointwear.monitor.watching.records import DETECTORS, Reason
from jointwear.robots.robot import Robot

ALARM_COLUMNS = (
    "time", "axis", "quantity", "change", "change_low", "change_high", "unit", "growth_percent", "growth_percent_low",
    "growth_percent_high", "limit_percent", "probability_axis", "hours_to_limit", "hours_to_limit_low",
    "hours_to_limit_high", "limited_by", "detector",
)  # fmt: skip
#: Dimensions of most variables of a state file.
PAIR = ("window", "axis")
#: Moments of a :class:`~jointwear.monitor.watching.limits.LimitDate` -> their names in a state file.
LIMIT_HOURS = {"median": "hours_to_limit", "low": "hours_to_limit_low", "high": "hours_to_limit_high"}
#: Begin of the names of the errors of now in a state file.
NOW_ERROR = "error_now_"


def write_alarms(path: str | Path, alarms: Iterable[Mapping[str, Any]], dated: bool) -> None:
    """Write alarms (`time` in seconds) as CSV, in order of time; unknown values stay empty."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(ALARM_COLUMNS)
    for alarm in sorted(alarms, key=lambda a: (a["time"], a["axis"] or 0, a["detector"])):
        row = {name: _cell(alarm[name]) for name in ALARM_COLUMNS}
        writer.writerow([*({**row, "time": stamp(float(alarm["time"]), dated)}).values()])
    replace_text(path, buffer.getvalue())


def _cell(value: Any) -> str:
    if value is None or (isinstance(value, (float, np.floating)) and math.isnan(value)):
        return ""
    if isinstance(value, (float, np.floating)):
        return f"{value:.6g}"
    return str(value)


def write_state(
    path: str | Path,
    judgement: Judgement,
    history: History,
    baseline: np.ndarray,
    robot: Robot,
    entry: Mapping[str, Any],
    name: str,
) -> None:
    """Write the state of every axis in every window: status, estimates, what they rest on, and the logs.

    Parameters
    ----------
    baseline : (w,) bool, windows of the baseline. name : of `entry` in the config.
    """
    s = history.statistics
    friction = window_friction(s, robot, baseline)
    variables = {
        **_window_variables(s, robot),
        "baseline": Variable(("window",), baseline.astype(np.int32), "1 in windows of the baseline", "1", kind="i4"),
        "status": Variable(PAIR, np.array(judgement.status), "state of the axis"),
        "friction_speed": Variable(("axis",), friction.speed, "speed that `friction` is for", "rad/s"),
        **_estimate_variables(estimates_of(judgement) | {"friction": (friction.value, friction.std, "N m")}),
        **_verdict_variables(judgement, s.axes, float(s.end[-1])),
        **_log_variables(history.pieces, _clock(s)),
    }
    attributes = provenance.attributes("state of every axis", dict(entry))
    attributes |= {
        "monitored": name,
        "robot": robot.name,
        "dated": int(s.dated),
        "laid_end_to_end": int(history.shifted),
        "alarms": json.dumps(as_json(judgement.alarms)),
        "findings": json.dumps(as_json(judgement.findings)),
    }
    write_dataset(path, variables, attributes)


def _clock(statistics: WindowStatistics) -> str:
    return "seconds since 1970-01-01T00:00:00Z" if statistics.dated else "s"


def _window_variables(s: WindowStatistics, robot: Robot) -> dict[str, Variable]:
    """Return what is known of the windows before they are judged."""
    return {
        "axis": Variable(("axis",), np.arange(1, s.axes + 1), "axis of the robot", "1"),
        "joint": Variable(("axis",), np.array(robot.joint_names), "name of the joint"),
        "start": Variable(("window",), s.start, "start of the window", _clock(s)),
        "end": Variable(("window",), s.end, "end of the window", _clock(s)),
        "temperature": Variable(PAIR, s.temperature, "mean temperature, NaN where unknown", "degC"),
        "share_used": Variable(PAIR, s.share_used, "share of the samples that show friction", "1"),
        "count": Variable(PAIR, s.count, "samples that show friction", "1", kind="i4"),
        "travel": Variable(PAIR, s.travel, "path of the joint", "rad"),
        "torque_peak": Variable(PAIR, s.torque_peak, "largest absolute torque", "N m"),
        "flags": Variable(PAIR, s.flags, "what was found in reading, a bit field", "1", kind="i4"),
    }


def _estimate_variables(estimates: Mapping[str, tuple[np.ndarray, np.ndarray, str]]) -> dict[str, Variable]:
    """Return the variables of estimates, name -> (values, standard deviations, unit)."""
    variables = {}
    for key, (values, std, unit) in estimates.items():
        words = key.replace("_", " ")
        variables[key] = Variable(PAIR, values, words, unit)
        variables[f"{key}_std"] = Variable(PAIR, std, f"standard deviation of {words}", unit)
    return variables


def _verdict_variables(judgement: Judgement, axes: int, end: float) -> dict[str, Variable]:
    """Return what is told of each axis, and why it is not judged where it is not; `end` of the last window [s]."""
    variables = _limit_variables(judgement.limits, end)
    quantities = np.array(judgement.grown, dtype=object)
    variables["grown"] = Variable(("axis",), quantities, "what the newest alarm of friction is of, as known today")
    for key, errors in judgement.now_error.items():
        unit = judgement.units[key]
        words = f"standard deviation of the mean of {key.replace('_', ' ')} over the last day"
        variables[f"{NOW_ERROR}{key}"] = Variable(("axis",), errors, words, unit)
    back = np.zeros(axes, dtype=bool) if judgement.back is None else judgement.back
    variables["back"] = Variable(("axis",), back.astype(np.int32), "1 where what alarmed is as before", "1", kind="i4")
    variables["unjudged_reason"] = Variable(PAIR, judgement.reason, "why an axis is not judged", "1", kind="i4")
    variables["unjudged_reason"].attributes.update(
        flag_values=np.array([int(r) for r in Reason], dtype=np.int32),
        flag_meanings=" ".join(r.name.lower() for r in Reason),
    )
    return variables


def _limit_variables(limits: Sequence[LimitDate | None], end: float) -> dict[str, Variable]:
    """Return the variables of the dates of limits, as hours from the `end` of the last window [s]: no calendar has a
    date that may never come."""
    variables = {}
    for moment, name in LIMIT_HOURS.items():
        hours = np.array([math.nan if limit is None else (getattr(limit, moment) - end) / 3600 for limit in limits])
        words = "hours from the end of the last window to the limit, below 0 where that has passed since the axis was "
        words += "judged last; infinite where it may never be reached"
        variables[name] = Variable(("axis",), hours, words, "h")
    quantities = np.array(["" if limit is None else limit.quantity for limit in limits], dtype=object)
    variables["limited_by"] = Variable(("axis",), quantities, "quantity whose limit the hours are to")
    return variables


def _log_variables(pieces: Sequence[Piece], clock: str) -> dict[str, Variable]:
    """Return what is known of the logs; `clock`: the unit of their times."""
    text = {
        "log": ([p.log for p in pieces], "log"),
        "log_refused": (["; ".join(p.refused) for p in pieces], "what was refused in the log, empty if nothing"),
        "log_copy_of": ([p.copy_of for p in pieces], "log with the same samples, which count once; empty if none"),
    }
    return {
        **{key: Variable(("log",), np.array(values, dtype=object), words) for key, (values, words) in text.items()},
        "log_first": Variable(("log",), np.array([p.first for p in pieces]), "first sample", clock),
        "log_last": Variable(("log",), np.array([p.last for p in pieces]), "last sample", clock),
    }


def estimates_of(judgement: Judgement) -> dict[str, tuple[np.ndarray, np.ndarray, str]]:
    """Return name -> (values, standard deviations, unit) of the estimates, each (window, axis)."""
    return {
        name: (judgement.estimates[name], judgement.std[name], judgement.units[name]) for name in judgement.estimates
    }


@dataclass(frozen=True)
class RobotState:
    """What :func:`write_state` wrote. Arrays (window, axis) unless stated; `estimates`: name -> (values, std, unit).

    `baseline`, `start`, `end` (window): whether it is one of the baseline, and its borders [s].
    `findings`: what is no alarm but must be told; `reason`: of :class:`~jointwear.monitor.watching.records.Reason`;
    `grown`, `limits` (axis): of :class:`~jointwear.monitor.judging.judge.Judgement`;
    `now_error`: name of an estimate -> (axis,) standard deviation of its mean over the last day; `back`
    (axis) bool: what alarmed since the last event is as it was before.
    """

    name: str
    robot: str
    joints: tuple[str, ...]
    dated: bool
    baseline: np.ndarray
    laid_end_to_end: bool
    start: np.ndarray
    end: np.ndarray
    status: np.ndarray
    temperature: np.ndarray
    share_used: np.ndarray
    flags: np.ndarray
    count: np.ndarray
    friction_speed: np.ndarray
    estimates: dict[str, tuple[np.ndarray, np.ndarray, str]]
    alarms: list[dict[str, Any]]
    findings: list[dict[str, Any]]
    reason: np.ndarray
    grown: tuple[str, ...]
    limits: tuple[LimitDate | None, ...]
    now_error: dict[str, np.ndarray]
    back: np.ndarray
    logs: tuple[str, ...]
    refused: tuple[str, ...]
    copy_of: tuple[str, ...]
    first: np.ndarray
    last: np.ndarray
    entry: dict[str, Any]

    @property
    def counted(self) -> list[dict[str, Any]]:
        """The alarms that count: those of the model-based detector."""
        return [alarm for alarm in self.alarms if alarm["detector"] == DETECTORS[0]]

    @property
    def compared(self) -> list[dict[str, Any]]:
        """The alarms of the paper's detector, which decide nothing: it keeps no stated rate where parts, programs or
        temperature change what it looks at (docs/decisions/when_to_alarm.md)."""
        return [alarm for alarm in self.alarms if alarm["detector"] != DETECTORS[0]]

    @property
    def axes(self) -> int:
        """Number of axes."""
        return len(self.joints)

    @property
    def after(self) -> np.ndarray:
        """Windows (w,) bool after the last one of the baseline, those that are judged."""
        return after_baseline(self.baseline)

    @property
    def length(self) -> float:
        """Length of a window [s]."""
        return float(self.end[0] - self.start[0])

    @property
    def short(self) -> bool:
        """Whether the logs have no date and span less than two hours, so that seconds say more than hours."""
        return not self.dated and float(self.end[-1] - self.start[0]) < 7200


def _limits(get: Callable[[str], np.ndarray]) -> tuple[LimitDate | None, ...]:
    """Return the dates of the limits of the axes; `get` returns a variable of the file by its name."""
    end = float(get("end")[-1])
    moments = np.stack([end + 3600 * get(name) for name in LIMIT_HOURS.values()], axis=1)
    return tuple(
        LimitDate(str(quantity), *map(float, own)) if quantity else None
        for quantity, own in zip(get("limited_by"), moments, strict=True)
    )


def read_state(path: str | Path) -> RobotState:
    """Read a state file."""
    with open_dataset(path) as dataset:

        def get(name: str) -> np.ndarray:
            return read_variable(dataset, path, name)

        estimates = {}
        for name in dataset.variables:
            if f"{name}_std" in dataset.variables:
                estimates[name] = (get(name), get(f"{name}_std"), str(dataset.variables[name].units))
        return RobotState(
            name=str(read_attribute(dataset, path, "monitored")),
            robot=str(read_attribute(dataset, path, "robot")),
            joints=tuple(str(j) for j in get("joint")),
            dated=bool(read_attribute(dataset, path, "dated")),
            baseline=get("baseline").astype(bool),
            laid_end_to_end=bool(read_attribute(dataset, path, "laid_end_to_end")),
            start=get("start"),
            end=get("end"),
            status=get("status"),
            temperature=get("temperature"),
            share_used=get("share_used"),
            flags=get("flags"),
            count=get("count"),
            friction_speed=get("friction_speed"),
            estimates=estimates,
            alarms=parse_json(read_attribute(dataset, path, "alarms"), path, list),
            findings=parse_json(read_attribute(dataset, path, "findings"), path, list),
            reason=get("unjudged_reason"),
            grown=tuple(str(x) for x in get("grown")),
            limits=_limits(get),
            now_error={
                name.removeprefix(NOW_ERROR): get(name) for name in dataset.variables if name.startswith(NOW_ERROR)
            },
            back=get("back").astype(bool),
            logs=tuple(str(x) for x in get("log")),
            refused=tuple(str(x) for x in get("log_refused")),
            copy_of=tuple(str(x) for x in get("log_copy_of")),
            first=get("log_first"),
            last=get("log_last"),
            entry=parse_json(read_attribute(dataset, path, "config"), path),
        )
