"""The stages of ``snakemake monitor`` that read logs, one function each: files in, files out.

Kept apart from judging (:mod:`jointwear.monitor.stages`), so that an edit of that reads no log again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from jointwear.files.json_documents import write_json
from jointwear.measurement.formats import Layout, layout_of
from jointwear.monitor.lengths_of_time import window_seconds
from jointwear.monitor.reading.assembly import Piece
from jointwear.monitor.reading.kept_surveys import keep_survey, kept_survey
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.piece_files import write_pieces
from jointwear.monitor.reading.survey import Survey, read_survey, survey_log
from jointwear.robots.robot import load_robot
from jointwear.running.processes import in_processes


def survey_logs(log: str, robot: str | Path, entry: Mapping[str, Any], output: str | Path) -> None:
    """Survey the first log of a robot; `entry` holds the keys that decide how logs are read.

    Raises
    ------
    InputError : if the log cannot be read, or contradicts the model.
    """
    model = TorqueModel(load_robot(robot))
    layout = layout_of(entry, model.robot.joint_names)
    survey_log(log, layout, model, window_seconds(entry.get("window", "1h")), entry.get("dead_band")).write(output)


def survey_first_log(log: str, robot: str | Path, entry: Mapping[str, Any], output: str | Path) -> None:
    """Survey the first log as :func:`survey_logs` and keep the survey; of a log that is gone take what was kept.

    Raises
    ------
    InputError : if the log cannot be read, or contradicts the model.
    """
    kept = None if Path(log).exists() else kept_survey(output, robot, entry)
    if kept is not None:
        write_json(output, kept)
        return
    survey_logs(log, robot, entry, output)
    keep_survey(output, robot, entry)


def log_pieces(
    logs: Sequence[str], survey: str | Path, robot: str | Path, entry: Mapping[str, Any], processes: int = 1
) -> list[Piece]:
    """Return the statistics of logs, each a piece of its own; a log that is refused is a piece that says so.

    Parameters
    ----------
    processes : in which logs are read at a time; the pieces do not depend on it.
    """
    model = TorqueModel(load_robot(robot))
    layout, found = layout_of(entry, model.robot.joint_names), read_survey(survey)
    length = window_seconds(entry.get("window", "1h"))
    return in_processes(partial(_log_piece, layout=layout, model=model, survey=found, length=length), logs, processes)


def _log_piece(log: str, layout: Layout, model: TorqueModel, survey: Survey, length: float) -> Piece:
    done = log_statistics(log, layout, model, survey, length)
    return Piece(log, done.statistics, done.first, done.last, done.refused, cut=done.cut, loads=done.loads)


def accumulate_windows(
    logs: Sequence[str], survey: str | Path, robot: str | Path, entry: Mapping[str, Any], output: str | Path
) -> list[str]:
    """Turn a batch of logs into window statistics; return what was refused, which is told in the file too."""
    pieces = log_pieces(logs, survey, robot, entry)
    write_pieces(pieces, output, entry)
    return [line for piece in pieces for line in piece.refused]
