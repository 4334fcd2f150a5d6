"""The judging stage of ``snakemake monitor``: files in, files out.

Logs are read in :mod:`jointwear.monitor.reading.reading_stages`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.monitor.events import events_of, planned_events
from jointwear.monitor.findings.clocks import clock_findings
from jointwear.monitor.findings.misfits import misfit_findings
from jointwear.monitor.findings.read_findings import missing_temperature
from jointwear.monitor.findings.seen_growth import COARSE, dead_band_findings
from jointwear.monitor.findings.short_logs import short_log_findings
from jointwear.monitor.judging.baseline import (
    ELSEWHERE,
    baseline_of,
    keep_baseline,
    learnt_elsewhere,
    with_kept_baseline,
)
from jointwear.monitor.judging.early_events import early_event_findings, planned_event_findings
from jointwear.monitor.judging.judge import Judgement, judge
from jointwear.monitor.judging.judge_settings import settings_of
from jointwear.monitor.judging.state import write_alarms, write_state
from jointwear.monitor.made_with import made_with
from jointwear.monitor.normal.recall import Recall, read_recall, write_recall
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.assembly import Piece, assemble
from jointwear.monitor.reading.at_rest import without_noise_at_rest
from jointwear.monitor.reading.logs_of_windows import logs_of_windows
from jointwear.monitor.reading.piece_files import read_pieces
from jointwear.monitor.reading.settled_loads import with_settled_loads
from jointwear.monitor.reading.survey import Survey, read_survey
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.records import UNJUDGED
from jointwear.robots.robot import load_robot
from jointwear.running.modules import code_of


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
    windows : files of :func:`jointwear.monitor.reading.reading_stages.accumulate_windows`, in the order of their logs.
    entry : the robot's entry of the config. recall : what the baseline told, read if it is there and written for the
        next call. name : of that entry, for the page; default the robot's own.
    survey : file of :func:`jointwear.monitor.reading.reading_stages.survey_logs`, from which it is told that a dead
        band is all noise.

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

    Raises
    ------
    InputError : if no log could be used.
    """
    arm = load_robot(robot)
    whole = assemble(with_settled_loads(pieces), entry.get("time_zone"))
    if not whole.statistics.windows:
        reasons = [line for p in whole.pieces for line in p.refused]
        raise InputError(f"no log could be used: {reasons[0] if reasons else 'they hold no samples'}")
    kept = Path(state).parent / "baseline.nc"
    given = {**baseline_of(entry), "made_with": made_with(robot, entry)}
    statistics, baseline = with_kept_baseline(whole.statistics, given, kept)
    keep_baseline(statistics, baseline, given, kept)
    statistics = without_noise_at_rest(statistics)
    whole = replace(whole, statistics=statistics)
    judgement = judge(
        statistics,
        baseline.mask,
        settings_of(arm, entry),
        recall=recall,
        logs=logs_of_windows(whole.pieces, statistics),
    )
    if not baseline.complete:
        # While normal is being learnt nothing is judged; what is learnt from counts as healthy only once it is chosen.
        judgement = replace(judgement, status=np.full_like(judgement.status, UNJUDGED))
    kind = ELSEWHERE if learnt_elsewhere(statistics, baseline, given) else "baseline"
    words = [(kind, baseline.words)] if baseline.words else []
    begin = float(statistics.start[0])
    first = [{"time": begin, "axes": [], "kind": k, "words": w} for k, w in [*words, *(("robot", w) for w in told)]]
    if baseline.advice:
        first[0] |= {"advice": baseline.advice}
    judgement = replace(judgement, findings=[*first, *judgement.findings])
    early = early_event_findings(statistics, events_of(entry), baseline.mask)
    early += planned_event_findings(statistics, planned_events(entry))
    more = [*early, *clock_findings(whole), *short_log_findings(whole), *missing_temperature(statistics, arm)]
    if survey is not None:
        seen = read_survey(survey)
        more += _dead_bands(seen, statistics, judgement, baseline.mask)
        more += misfit_findings(statistics, seen, events_of(entry))
    judgement = replace(judgement, findings=[*more, *judgement.findings])
    write_state(state, judgement, whole, baseline.mask, arm, entry, name or arm.name)
    write_alarms(alarms, judgement.alarms, whole.statistics.dated)


def _dead_bands(
    survey: Survey, statistics: WindowStatistics, judgement: Judgement, baseline: np.ndarray
) -> list[dict[str, Any]]:
    """Return findings on dead bands of the survey that are all noise; `baseline` (w,) bool."""
    unseen = (judgement.status[after_baseline(baseline)] == UNJUDGED).all(axis=0)
    coarse = {axis for f in judgement.findings if f["kind"] == COARSE for axis in f["axes"]}
    unseen |= np.isin(np.arange(1, len(unseen) + 1), list(coarse))
    return dead_band_findings(statistics, baseline, unseen, survey.noisy, survey.dead_band)
