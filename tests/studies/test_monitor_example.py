"""The shipped logs are those that the shipped code makes, and the example finds what is in them."""

import numpy as np
from monitor_logs import ROBOT, ROOT, layout, model

from jointwear.measurement.formats import read_log
from jointwear.monitor.found_logs import find_logs
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.judging.judge_settings import settings_of
from jointwear.monitor.reading.assembly import Piece, assemble
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.survey import survey_log
from jointwear.monitor.watching.records import CHANGED, UNJUDGED
from jointwear.studies.monitor_study.example import DAYS, HEALTHY_HOURS, START, WORN_AXIS, write_example

SHIPPED = find_logs([str(ROOT / "data/examples/monitor_puma560/day_*")])


def test_the_shipped_logs_are_what_the_code_makes(tmp_path):
    assert len(SHIPPED) == DAYS
    made = [tmp_path / path.rpartition("/")[2] for path in SHIPPED]
    write_example(ROBOT, made)
    for shipped, path in zip(SHIPPED, made, strict=True):
        for old, new in zip(read_log(shipped, layout()), read_log(path, layout()), strict=True):
            np.testing.assert_allclose(old.time, new.time, atol=1e-6)
            np.testing.assert_allclose(old.position, new.position, atol=2e-5)
            np.testing.assert_allclose(old.torque, new.torque, atol=2e-3)


def test_the_example_finds_the_worn_axis_alone():
    survey = survey_log(SHIPPED[0], layout(), model(), 3600.0)
    done = [log_statistics(path, layout(), model(), survey, 3600.0) for path in SHIPPED]
    assert all(d.refused == () for d in done)
    pieces = [Piece(path, d.statistics, d.first, d.last) for path, d in zip(SHIPPED, done, strict=True)]
    history = assemble(pieces).statistics
    assert history.windows == 24 * DAYS
    judgement = judge(history, 48, settings_of(model().robot, {}))
    alarms = [a for a in judgement.alarms if a["detector"] == "model"]
    assert {a["axis"] for a in alarms} == {WORN_AXIS}
    assert START + 3600 * HEALTHY_HOURS < alarms[0]["time"] < START + 3600 * (HEALTHY_HOURS + 48)
    assert (judgement.status[:, 5] == UNJUDGED).all()
    assert judgement.status[-1, WORN_AXIS - 1] == CHANGED
