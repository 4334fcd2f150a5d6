"""The stages of ``snakemake monitor``, one function each: files in, files out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.formats import Layout, layout_of
from jointwear.monitor.assembly import Piece, assemble
from jointwear.monitor.baseline import keep_baseline, with_kept_baseline
from jointwear.monitor.clocks import clock_findings
from jointwear.monitor.findings import COARSE, dead_band_findings, missing_temperature
from jointwear.monitor.judge import UNJUDGED, Judgement, judge, settings_of
from jointwear.monitor.logs import log_statistics
from jointwear.monitor.made_with import made_with
from jointwear.monitor.model import TorqueModel
from jointwear.monitor.piece_files import read_pieces, write_pieces
from jointwear.monitor.plan import window_seconds
from jointwear.monitor.recall import Recall, read_recall, write_recall
from jointwear.monitor.state import write_alarms, write_state
from jointwear.monitor.survey import Survey, read_survey, survey_log
from jointwear.monitor.windows import WindowStatistics
from jointwear.robots.robot import load_robot
from jointwear.running.modules import code_of
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
    return Piece(log, done.statistics, done.first, done.last, done.refused)


def accumulate_windows(
    logs: Sequence[str], survey: str | Path, robot: str | Path, entry: Mapping[str, Any], output: str | Path
) -> list[str]:
    """Turn a batch of logs into window statistics; return what was refused, which is told in the file too."""
    pieces = log_pieces(logs, survey, robot, entry)
    write_pieces(pieces, output, entry)
    return [line for piece in pieces for line in piece.refused]


def judge_windows(
    windows: Sequence[str],
    robot: str | Path,
    entry: Mapping[str, Any],
    state: str | Path,
    alarms: str | Path,
    recall: str | Path,
    name: str | None = None,
    survey: str | Path | None = None,
) -> None:
    """Judge all windows of a robot; write the state of every axis and the alarms.

    Parameters
    ----------
    windows : files of :func:`accumulate_windows`, in the order of their logs.
    entry : the robot's entry of the config. recall : what the baseline told, read if it is there and written for the
        next call. name : of that entry, for the page; default the robot's own.
    survey : file of :func:`survey_logs`, from which it is told that a dead band is all noise.

    Raises
    ------
    InputError : if no log could be used.
    """
    pieces = [piece for path in windows for piece in read_pieces(path)]
    code = code_of("judge_windows")
    told = read_recall(recall, code)
    judge_pieces(pieces, robot, entry, state, alarms, name, told, survey)
    write_recall(recall, told, code)


def judge_pieces(
    pieces: Sequence[Piece],
    robot: str | Path,
    entry: Mapping[str, Any],
    state: str | Path,
    alarms: str | Path,
    name: str | None = None,
    recall: Recall | None = None,
    survey: str | Path | None = None,
    told: Sequence[str] = (),
) -> None:
    """Judge the statistics of logs, in the order of the logs; see :func:`judge_windows`.

    Parameters
    ----------
    recall : of what the baseline told before, :mod:`.recall`. survey : as of :func:`judge_windows`.
    told : what a user must know of these logs as a whole, in words.
    """
    arm = load_robot(robot)
    whole = assemble(pieces)
    if not whole.statistics.windows:
        reasons = [line for p in whole.pieces for line in p.refused]
        raise InputError(f"no log could be used: {reasons[0] if reasons else 'they hold no samples'}")
    kept = Path(state).parent / "baseline.nc"
    given = {**entry["baseline"], "made_with": made_with(robot, entry)}
    statistics, baseline = with_kept_baseline(whole.statistics, given, kept)
    keep_baseline(statistics, baseline, given, kept)
    whole = replace(whole, statistics=statistics)
    judgement = judge(statistics, baseline.mask, settings_of(arm, entry), recall=recall)
    words = [("baseline", baseline.words)] if baseline.words else []
    begin = float(statistics.start[0])
    first = [{"time": begin, "axes": [], "kind": k, "words": w} for k, w in [*words, *(("robot", w) for w in told)]]
    judgement = replace(judgement, findings=[*first, *judgement.findings])
    more = [*clock_findings(whole), *missing_temperature(statistics, arm)]
    if survey is not None:
        more += _dead_bands(read_survey(survey), statistics, judgement, baseline.count)
    judgement = replace(judgement, findings=[*more, *judgement.findings])
    write_state(state, judgement, whole, baseline.count, arm, entry, name or arm.name)
    write_alarms(alarms, judgement.alarms, whole.statistics.dated)


def _dead_bands(
    survey: Survey, statistics: WindowStatistics, judgement: Judgement, baseline: int
) -> list[dict[str, Any]]:
    """Return findings on dead bands of the survey that are all noise."""
    unseen = (judgement.status[baseline:] == UNJUDGED).all(axis=0)
    coarse = {axis for f in judgement.findings if f["kind"] == COARSE for axis in f["axes"]}
    unseen |= np.isin(np.arange(1, len(unseen) + 1), list(coarse))
    return dead_band_findings(statistics, max(baseline, 1), unseen, survey.noisy, survey.dead_band)
