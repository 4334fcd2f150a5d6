"""From windows to the state: friction of every window, the baseline, logs without dates, what is refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray
from matplotlib.axes import Axes
from monitor_logs import ROBOT, model
from monitor_states import EVIL, HOURS, WORN
from pyarrow import parquet

from jointwear.files.errors import InputError
from jointwear.monitor.fleet.history import write_history
from jointwear.monitor.fleet.page import robot_item
from jointwear.monitor.fleet.ranking import as_of, asks
from jointwear.monitor.fleet.table import table_row
from jointwear.monitor.judging.baseline import ELSEWHERE, choose_baseline
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.judging.judge_settings import settings_of
from jointwear.monitor.judging.state import read_state, write_state
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.normal.friction import window_friction
from jointwear.monitor.normal.series import usual_speed
from jointwear.monitor.presentation.drawing import draw_timeline
from jointwear.monitor.presentation.page import write_page
from jointwear.monitor.presentation.standing import NOTHING, standing
from jointwear.monitor.reading.assembly import Piece, assemble
from jointwear.monitor.reading.window_files import read_statistics
from jointwear.monitor.stages import judge_windows
from jointwear.monitor.watching.records import CHANGED, UNJUDGED

#: Windows of the baseline of the robot of the fixture `monitored`.
BASELINE = np.arange(HOURS) < 36


def test_friction_of_every_window(monitored):
    _, windows, _ = monitored
    found = window_friction(read_statistics(windows[0]), model().robot, BASELINE)
    robot, speed = model().robot, found.speed
    truth = (robot.coulomb_positive - robot.coulomb_negative) / 2 + robot.viscous * speed
    error = (found.value[:40, :5] - truth[:5]) / found.std[:40, :5]
    assert 0.5 < np.sqrt(np.mean(error**2)) < 1.5
    assert np.isnan(found.value[:, 5]).all()
    assert (found.value[50:, WORN] > truth[WORN] + 0.4).all()


def test_baselines(monitored):
    _, windows, _ = monitored
    statistics = read_statistics(windows[0])
    assert choose_baseline(statistics, {"windows": 20}).mask.sum() == 20
    assert choose_baseline(statistics, {"windows": 200}).mask.sum() == HOURS
    assert choose_baseline(statistics, {"until": "2026-01-02T00:00:00Z"}).mask.sum() == 24
    assert choose_baseline(statistics, {"until": "2026-01-02T00:00:00"}).mask.sum() == 24
    short = choose_baseline(statistics, {"until": "2026-01-01T02:30:00Z"})
    assert short.mask.sum() > 8
    assert "too few to know what is normal; it goes on until 2026-01-01T" in short.words
    waiting = choose_baseline(statistics, {"windows": 200})
    assert not waiting.complete
    assert "nothing is judged until 140 more have come" in waiting.words
    assert "until 1 more has come" in choose_baseline(statistics, {"windows": HOURS + 1}).words
    day = choose_baseline(statistics.part(np.arange(HOURS) < 7), {"until": "2026-01-02T00:00:00Z"})
    assert not day.complete
    future = choose_baseline(statistics, {"until": "2027-01-01T00:00:00Z"})
    assert not future.complete
    assert "baseline ends at 2027-01-01T00:00Z, not before the newest window does" in future.words
    assert "nothing is judged until a window has come from after its end" in future.words
    assert "holds 7 windows in 1 shift; 8 windows with motion in 3 shifts are needed" in day.words
    assert choose_baseline(statistics, {"from": "2026-01-01T10:00:00Z", "windows": 20}).mask.nonzero()[0][0] == 10
    with pytest.raises(InputError, match="the logs have no dates"):
        choose_baseline(replace(statistics, dated=False), {"until": "2026-01-02"})


def test_logs_without_dates_that_start_anew_are_laid_end_to_end(monitored):
    _, windows, _ = monitored
    statistics = read_statistics(windows[0]).part(slice(0, 3))
    undated = replace(statistics, start=np.arange(3) * 3600.0, end=np.arange(1, 4) * 3600.0, dated=False)
    pieces = [Piece(name, undated, 0.0, 7212.0) for name in "ab"]
    history = assemble(pieces)
    assert history.shifted
    assert history.statistics.start.tolist() == [3600.0 * k for k in range(6)]
    following = assemble([pieces[0], replace(pieces[1], first=7300.0, last=15000.0)])
    assert not following.shifted
    assert following.statistics.windows == 3
    assert (following.statistics.count == 2 * undated.count).all()


def test_no_usable_log_ends_in_one_line(tmp_path, monitored):
    _, windows, entry = monitored
    with pytest.raises(InputError, match=r"no log could be used: .*truncated"):
        judge_windows([windows[1]], ROBOT, entry, tmp_path / "s.nc", tmp_path / "a.csv", tmp_path / "r.json")


def test_the_state_opens_with_xarray(monitored):
    folder, _, _ = monitored
    with xarray.open_dataset(folder / "state.nc") as state:
        assert set(state.status.dims) == {"window", "axis"}
        assert set(np.unique(state.status)) <= {"healthy", "changed", "cannot be judged"}
        assert (state.status[:, 5] == UNJUDGED).all()
        assert (state.status[-1, WORN] == CHANGED).all()
        assert state.sizes["window"] == HOURS
        assert str(state.start.values[0]).startswith("2026-01-01")
        assert np.isfinite(state.coulomb_std[:, 0]).all()


def test_refusals_are_kept_in_the_state(tmp_path, monitored):
    _, windows, entry = monitored
    statistics = read_statistics(windows[0])
    history = assemble([Piece("a.csv", statistics, 0.0, 1.0, (EVIL,))])
    robot = model().robot
    judgement = judge(statistics, 36, settings_of(robot, entry))
    write_state(tmp_path / "state.nc", judgement, history, BASELINE, robot, entry, EVIL)
    state = read_state(tmp_path / "state.nc")
    assert state.refused == (EVIL,)
    assert state.entry == json.loads(json.dumps(entry))
    write_page(read_state(tmp_path / "state.nc"), tmp_path / "p.html", tmp_path / "figures")
    assert EVIL not in (tmp_path / "p.html").read_text()


def test_what_came_before_the_baseline_is_no_part_of_it_wherever_it_is_told(tmp_path, monitored, monkeypatch):
    """The windows up to the end of the baseline had been marked as its own in history and figures."""
    _, windows, entry = monitored
    entry = {**entry, "baseline": {"from": "2026-01-01T12:00:00Z", "windows": 24}}
    judge_windows(windows[:1], ROBOT, entry, tmp_path / "s.nc", tmp_path / "a.csv", tmp_path / "r.json")
    state = read_state(tmp_path / "s.nc")
    own = (np.arange(HOURS) >= 12) & (np.arange(HOURS) < 36)
    assert np.array_equal(state.baseline, own)
    assert np.array_equal(state.after, np.arange(HOURS) >= 36)
    speed = usual_speed(read_statistics(windows[0]), own)
    np.testing.assert_allclose(state.friction_speed, speed, rtol=1e-6)
    write_history(tmp_path / "history.parquet", state, "arm")
    told = parquet.read_table(tmp_path / "history.parquet", columns=["baseline"])["baseline"].to_numpy()
    assert np.array_equal(told.reshape(HOURS, -1), np.repeat(own[:, None], state.axes, axis=1))
    spans = []
    monkeypatch.setattr(Axes, "axvspan", lambda _, begin, end, **more: spans.append((begin, end)))
    for baseline in (own, np.zeros(HOURS, dtype=bool)):
        draw_timeline(replace(state, baseline=baseline), "coulomb_percent", tmp_path / "t.svg")
    assert len(spans) == 1
    assert 24 * (spans[0][1] - spans[0][0]) == pytest.approx(23)


@pytest.mark.parametrize(
    ("until", "level", "told"),
    [
        ("2099-01-15", UNJUDGED, "Set 'baseline.until' to a time between the first"),
        ("2001-01-15", "healthy", "lies before the first log: is its year right?"),
    ],
)
def test_a_baseline_beside_the_logs_is_told_alike_by_state_table_and_page(tmp_path, monitored, until, level, told):
    """One after the newest log had left every window healthy and said 'let it move'; one before all was not told."""
    _, windows, entry = monitored
    entry = {**entry, "baseline": {"until": until}}
    judge_windows(windows[:1], ROBOT, entry, tmp_path / "s.nc", tmp_path / "a.csv", tmp_path / "r.json")
    state = read_state(tmp_path / "s.nc")
    assert (state.status[:5, :5] == level).all()
    row = {**NOTHING, "robot": "arm", "folder": "arm", "result": "judged", **standing(state)}
    row = as_of(row, state.end[-1])
    assert row["refused_newest"] == 0
    if level == UNJUDGED:
        assert (row["unjudged_windows"], row["urgency"]) == (len(state.start), UNJUDGED)
        assert told in table_row(row)["what_to_check"]
        assert robot_item(row, zone_of(None), "robots")["check"].startswith(told)
    else:
        assert asks(row)
        (found,) = [f for f in state.findings if f["kind"] == ELSEWHERE]
        assert told in found["words"]
