"""Results of monitoring: files, times, what the page says, and that nothing from a log gets into it as markup."""

import csv
import json
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st
from monitor_logs import ROBOT, START, columns, make_log, model, write_parquet

from jointwear.files.errors import InputError
from jointwear.measurement.flags import Flag
from jointwear.monitor.assembly import Piece, assemble
from jointwear.monitor.baseline import choose_baseline
from jointwear.monitor.condition import UNRESOLVED, axis_conditions
from jointwear.monitor.drawing import _alone, _pauses, _rests_on, _thin
from jointwear.monitor.episodes import episodes_of
from jointwear.monitor.events import events_of
from jointwear.monitor.fleet.ranking import as_of
from jointwear.monitor.fleet.table import table_row
from jointwear.monitor.friction import window_friction
from jointwear.monitor.judge import CHANGED, UNJUDGED, judge
from jointwear.monitor.judge_settings import settings_of
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.page import write_page
from jointwear.monitor.reading_stages import accumulate_windows, survey_logs
from jointwear.monitor.stages import judge_windows
from jointwear.monitor.standing import NOTHING, standing
from jointwear.monitor.state import ALARM_COLUMNS, read_state, stamp, write_alarms, write_state
from jointwear.monitor.summaries import UNKNOWN, axis_summary, headline, why_unjudged
from jointwear.monitor.temperature import temperature_share
from jointwear.monitor.window_files import read_statistics
from jointwear.monitor.words import sure_words, todo

EVIL = "<script>alert(1)</script>"
HOURS, WORN = 60, 2


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A robot monitored over 60 hours, 12 s of motion in each; axis 3 wears from hour 40 on. One log is refused."""
    folder = tmp_path_factory.mktemp("monitored")
    parts = []
    for hour in range(HOURS):
        log = make_log(12.0, seed=hour, start=START + 3600.0 * hour, noise=0.02)
        more = 0.05 * max(hour - 40, 0) * np.sign(log.velocity[:, WORN])
        log.torque[:, WORN] += more
        parts.append(log)
    names = ("time", "position", "velocity", "acceleration", "torque")
    whole = {n: np.concatenate([getattr(p, n) for p in parts]) for n in names}
    log = replace(parts[0], **whole)
    entry = {"logs": ["x"], "robot": str(ROBOT), "window": "1h", "baseline": {"windows": 36}}
    logs = [str(write_parquet(folder / f"{EVIL.replace('/', '')}.parquet", columns(log)))]
    logs.append(str(folder / "cut.parquet"))
    (folder / "cut.parquet").write_bytes((folder / logs[0]).read_bytes()[:-100])
    survey_logs(logs[0], ROBOT, entry, folder / "survey.json")
    windows = [str(folder / f"{k}.nc") for k in range(2)]
    for path, log in zip(windows, logs, strict=True):
        accumulate_windows([log], folder / "survey.json", ROBOT, entry, path)
    judge_windows(windows, ROBOT, entry, folder / "state.nc", folder / "alarms.csv", folder / "recall.json", "cell_3")
    write_page(read_state(folder / "state.nc"), folder / "monitor.html", folder / "figures")
    return folder, windows, entry


def test_the_worn_axis_alarms_and_nothing_else(built):
    folder, _, _ = built
    rows = list(csv.DictReader((folder / "alarms.csv").read_text().splitlines()))
    assert rows
    assert tuple(rows[0]) == ALARM_COLUMNS
    ours = [row for row in rows if row["detector"] == "model"]
    assert {row["axis"] for row in ours} == {str(WORN + 1)}
    assert ours[0]["time"].startswith("2026-01-0")
    assert ours[0]["time"].endswith("Z")
    assert float(ours[0]["probability_axis"]) > 0.9


def test_the_state_opens_with_xarray(built):
    folder, _, _ = built
    with xarray.open_dataset(folder / "state.nc") as state:
        assert set(state.status.dims) == {"window", "axis"}
        assert set(np.unique(state.status)) <= {"healthy", "changed", "cannot be judged"}
        assert (state.status[:, 5] == UNJUDGED).all()
        assert (state.status[-1, WORN] == CHANGED).all()
        assert state.sizes["window"] == HOURS
        assert str(state.start.values[0]).startswith("2026-01-01")
        assert np.isfinite(state.coulomb_std[:, 0]).all()


class Tags(HTMLParser):
    """Collects the names of tags, and attributes that could run something."""

    def __init__(self) -> None:
        super().__init__()
        self.tags, self.handlers = set(), set()

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.handlers |= {name for name, _ in attrs if name.startswith("on")}


def test_the_page_escapes_what_comes_from_logs(built):
    folder, _, _ = built
    text = (folder / "monitor.html").read_text()
    found = Tags()
    found.feed(text)
    assert "script" not in found.tags
    assert not found.handlers
    assert "&lt;script&gt;" in text


def test_the_page_says_what_an_engineer_needs(built):
    folder, _, _ = built
    text = (folder / "monitor.html").read_text()
    assert "Friction has changed: axis 3" in text
    assert "Cannot be judged: axis 6. That is no sign of health" in text
    assert "<b>Axis 3 (joint_3)</b>" in text
    assert "Coulomb friction +" in text
    assert text.index("Check the gear and bearings") < text.index("Every axis at a glance")
    assert "cell_3, robot puma560" in text
    assert "truncated or not a Parquet file" in text
    state = read_state(folder / "state.nc")
    assert why_unjudged(state, 5) == "at rest, or too slow to show friction"
    assert headline([axis_summary(state, 5)])[0] == "No axis can be judged"
    assert axis_summary(state, 5)["remark"] == ""


def test_an_axis_that_stops_moving_is_no_longer_called_healthy(built):
    folder, _, _ = built
    state = read_state(folder / "state.nc")
    status = state.status.copy()
    status[50:, 0] = UNJUDGED
    found = axis_summary(replace(state, status=status), 0)
    assert "last judged" in found["remark"]
    status[state.baseline :, 0] = UNJUDGED
    assert axis_summary(replace(state, status=status), 0)["status"] == UNJUDGED


def test_play_alone_is_no_change_of_friction_and_is_told_as_it_is_now(built):
    folder, _, _ = built
    state = read_state(folder / "state.nc")
    alarm = {
        **state.alarms[-1], "axis": 1, "quantity": "backlash", "detector": "model", "unit": "%",
        "change": 26.0, "change_low": 20.0, "change_high": 30.0, "time": float(state.end[50]),
    }  # fmt: skip
    status = np.full_like(state.status, "healthy")
    status[50:, 0] = CHANGED
    shape = state.status.shape
    estimates = {**state.estimates, "backlash": (np.full(shape, 70.0), np.ones(shape), "%")}
    other = replace(state, alarms=[alarm], status=status, estimates=estimates)
    summaries = [axis_summary(other, j) for j in range(state.axes)]
    assert headline(summaries)[0] == "Backlash has grown: axis 1"
    (found,) = [c for c in axis_conditions(other) if c.level == CHANGED]
    assert found.change == pytest.approx(70.0)
    said = {"time": float(other.end[55]), "axes": [1], "kind": "acknowledged"}
    known = axis_summary(replace(other, entry=other.entry | {"events": [said]}), 0)
    assert headline([known])[0] == "Backlash has grown: axis 1"
    summaries[2]["status"] = CHANGED
    assert headline(summaries)[0] == "Friction has changed: axis 3; backlash has grown: axis 1"
    write_page(other, folder / "play.html", folder / "play")
    assert (folder / "play" / "timeline_backlash.svg").is_file()
    assert not (folder / "play" / "timeline_viscous.svg").exists()
    assert _rests_on(alarm, "backlash")
    assert not _rests_on(alarm, "coulomb")


def test_newest_logs_that_are_refused_are_not_healthy(built):
    """The samples of days 4 on contradict the model: what an axis was like before is no verdict on now."""
    folder, _, _ = built
    state = read_state(folder / "state.nc")
    log = {"logs": ["a.csv", "b.csv"], "refused": ["", "b.csv: the sign looks flipped"], "copy_of": ["", ""]}

    def judged(until, hours):
        rest = np.arange(HOURS) >= until
        end = np.where(rest, state.end + (hours - (HOURS - until)) * 3600, state.end)
        found = np.where(rest[:, None] | np.zeros_like(state.status, dtype=bool), UNJUDGED, "healthy").astype(object)
        marked = np.where(found == UNJUDGED, int(Flag.REFUSED | Flag.AT_REST), 0)
        first, last = np.array([state.start[0], state.start[until]]), np.array([state.end[until - 1], end[-1]])
        return replace(state, status=found, flags=marked, end=end, first=first, last=last, alarms=[], **log)

    lately, long_ago = judged(50, 10.0), judged(50, 100.0)
    for other, level in ((lately, "healthy"), (long_ago, UNJUDGED)):
        row = standing(other)
        assert row["refused_newest"] == 1
        assert as_of({**NOTHING, "robot": "x", "result": "judged", **row}, other.end[-1])["urgency"] == "refused"
        summary = axis_summary(other, 0)
        assert summary["status"] == level
        assert "since then: the log contradicts the model" in summary["remark"]
        heading, sentences = headline([summary], refused=row["refused_newest"])
        assert heading == "The newest logs are refused"
        assert "as of then" in sentences[0]
    silent = replace(long_ago, refused=["", ""])
    assert standing(silent)["refused_newest"] == 0


def test_newest_logs_without_any_sample_are_not_healthy(built):
    """They have no time of their own; where they stand in the list tells that they are the newest."""
    folder, _, _ = built
    state = read_state(folder / "state.nc")
    # The log of the fixture that is cut short comes after the one that was read.
    assert state.refused[1]
    assert standing(state)["refused_newest"] == 1
    empty, nan = "b.csv: holds no samples", np.nan
    begin, end = float(state.start[0]), float(state.end[-1])

    def refused(told, first, last):
        names = [f"{k}.csv" for k in range(len(told))]
        times = {"first": np.array(first), "last": np.array(last)}
        return standing(replace(state, logs=names, refused=told, copy_of=[""] * len(told), **times))["refused_newest"]

    assert refused(["", empty], [begin, nan], [end, nan]) == 1
    assert refused(["", empty, empty], [begin, nan, nan], [end, nan, nan]) == 2
    # An old one, before logs that could be read, is no news.
    assert refused(["", empty, ""], [begin, nan, end - 60], [begin + 60, nan, end]) == 0
    assert refused([empty, ""], [nan, begin], [nan, end]) == 0


def test_a_reason_of_another_version_is_no_failure(built):
    folder, _, _ = built
    state = read_state(folder / "state.nc")
    other = replace(state, reason=np.full_like(state.reason, 99), flags=np.zeros_like(state.flags))
    assert "too small against the noise" in why_unjudged(other, 5)


def test_an_axis_whose_limit_cannot_be_seen_says_from_where_on(built):
    folder, _, _ = built
    state = read_state(folder / "state.nc")
    found = {"time": 0.0, "axes": [1], "kind": "coarse", "least": 0.34, "words": ""}
    summaries = [axis_summary(replace(state, findings=[found]), j) for j in (0, 1)]
    assert summaries[0]["remark"] == "only changes above 34 % can be seen"
    assert summaries[1]["remark"] == ""
    heading, sentences = headline(summaries)
    assert heading == "No change of friction found where it can be judged"
    assert "Only changes beyond the limit can be seen: axis 1." in sentences


def changed(state, quantity, j=0, **more):
    """The state with one alarm of an axis, which counts as changed since."""
    alarm = {
        **state.alarms[-1], "axis": j + 1, "quantity": quantity, "detector": "model", "unit": "N m s/rad",
        "change": 2.0, "change_low": 1.0, "change_high": 3.0, "probability_axis": 0.99, "time": float(state.end[50]),
    } | more  # fmt: skip
    status = np.full_like(state.status, "healthy")
    status[50:, j] = CHANGED
    return replace(state, alarms=[alarm], status=status, hours_to_limit=np.full_like(state.hours_to_limit, np.nan))


def with_estimates(state, **values):
    """The state with estimates that are the same everywhere."""
    shape = state.status.shape
    more = {name: (np.full(shape, value), np.ones(shape), "%") for name, value in values.items()}
    return replace(state, estimates={**state.estimates, **more}, now_error={})


def test_viscous_growth_beyond_its_limit_has_reached_it(built):
    folder, _, _ = built
    state = changed(read_state(folder / "state.nc"), "viscous friction")
    worn = with_estimates(state, coulomb_percent=0.2, viscous_percent=56.0, viscous=2.1)
    row = standing(worn)
    first = row["axes"][0]
    assert (first["axis"], first["reached"], first["viscous_growth"]) == (1, True, 56.0)
    judged = as_of({**NOTHING, "robot": "x", "result": "judged", **row}, worn.end[-1])
    assert judged["urgency"] == "limit reached"
    assert table_row(judged)["viscous_growth_percent"] == 56.0
    found = todo(row, first, zone_of(None))
    assert found["bar"] == 100.0
    assert found["outlook"] == "limit reached"
    words = found["change"].replace("\u00a0", " ")
    assert words.startswith("Viscous friction +56.0 % now (+2.1 N m s/rad), limit 20 %; Coulomb friction +0.2 % now")
    # Of an axis that alarmed for another quantity its noise says nothing.
    other = with_estimates(changed(state, "coulomb friction"), coulomb_percent=5.0, viscous_percent=56.0)
    assert not axis_conditions(other)[0].reached


def test_an_axis_that_is_back_to_normal_heads_no_red_card(built):
    folder, _, _ = built
    state = with_estimates(changed(read_state(folder / "state.nc"), "coulomb friction"), coulomb_percent=0.1)
    assert axis_conditions(state)[0].level == CHANGED
    back = replace(state, back=np.arange(state.axes) == 0)
    found = axis_conditions(back)[0]
    assert (found.level, found.outlook) == (UNRESOLVED, None)
    assert found.check.startswith("friction is back to normal, and nobody has said why")
    play = axis_conditions(replace(changed(state, "backlash"), back=back.back))[0]
    assert play.check.startswith("play is back to normal")
    # Neither status nor alarms are touched.
    assert (back.status[-1, 0], len(back.alarms)) == (CHANGED, 1)


def test_how_sure_an_axis_is_stands_beside_it(built):
    folder, _, _ = built
    state = with_estimates(changed(read_state(folder / "state.nc"), "coulomb friction"), coulomb_percent=5.0)
    unsure = replace(state, alarms=[{**state.alarms[0], "probability_axis": 0.33}])
    assert axis_conditions(unsure)[0].check.startswith("compare the other axes before opening anything")
    write_page(unsure, folder / "unsure.html", folder / "unsure")
    text = (folder / "unsure.html").read_text().replace("\u00a0", " ")
    assert text.count("33 % likely to be this axis") == 2
    assert "compare" not in axis_conditions(state)[0].check
    assert (
        todo(standing(state), standing(state)["axes"][0], zone_of(None))["sure"] == "99\u00a0% likely to be this axis"
    )
    assert sure_words(0.999) == ">\u00a099\u00a0% likely to be this axis"
    assert sure_words(None) == ""


def test_a_number_that_is_not_known_says_why(built):
    folder, _, _ = built
    state = read_state(folder / "state.nc")
    (told,) = axis_summary(state, 5)["unknown"]
    assert told.endswith("not judged in the last day: at rest, or too slow to show friction")
    hidden = with_estimates(state, coulomb_percent=np.nan)
    hidden.estimates["coulomb_percent"][0][:30] = 0.0
    assert axis_summary(hidden, 0)["unknown"] == [f"Coulomb friction: {UNKNOWN['coulomb_percent']}"]
    assert not axis_summary(state, 0)["unknown"]
    assert "Not known (–):" in (folder / "monitor.html").read_text()


def test_alarms_of_the_paper_since_a_changed_scale_may_be_that(built):
    folder, _, _ = built
    state = changed(read_state(folder / "state.nc"), "torque histogram", detector="paper")
    found = {"axes": [1], "kind": "scale", "words": "The scale changed."}
    for time, told in ((state.start[40], True), (state.start[55], False)):
        stepped = replace(state, findings=[{**found, "time": float(time)}])
        write_page(stepped, folder / "s.html", folder / "s")
        assert ("alarms of this detector since then may be that step" in (folder / "s.html").read_text()) == told
        asked = [c.check for c in axis_conditions(stepped) if c.episodes]
        assert any("torque constant and firmware" in check for check in asked) == told


def greased(state, entry_of):
    """The state after the friction came back, with what the config says of it."""
    status = state.status.copy()
    status[-1, WORN] = "healthy"
    return replace(state, status=status, entry=state.entry | entry_of)


def test_an_axis_with_alarms_that_nobody_explained_is_never_green(built):
    folder, _, _ = built
    state = greased(read_state(folder / "state.nc"), {})
    found = axis_conditions(state)[WORN]
    assert found.level == UNRESOLVED
    assert "nobody has said why" in found.check
    assert axis_summary(state, WORN)["badge"] == "close"
    heading, sentences = headline([axis_summary(state, j) for j in range(state.axes)])
    assert heading == "Alarms that nobody has explained: axis 3"
    assert "No change: axes 1, 2, 4 and 5." in sentences


@pytest.mark.parametrize(
    ("event", "level"),
    [
        ({"time": "2027-01-01T00:00:00Z", "axes": [3], "kind": "service"}, "healthy"),
        ({"time": "2027-01-01T00:00:00+01:00", "kind": "acknowledged"}, "healthy"),
        ({"time": "2027-01-01T00:00:00Z", "axes": [2], "kind": "service"}, UNRESOLVED),
        ({"time": "2026-01-01T00:00:00Z", "axes": [3], "kind": "service"}, UNRESOLVED),
    ],
)
def test_an_event_of_the_axis_after_its_alarms_explains_them(built, event, level):
    folder, _, _ = built
    state = greased(read_state(folder / "state.nc"), {"events": [event]})
    found = axis_conditions(state)[WORN]
    assert found.level == level
    assert bool(found.past) == (level == "healthy")


def test_alarms_of_one_story_are_one_episode():
    def alarm(time, axis=1, detector="model"):
        return {"time": time, "axis": axis, "quantity": "coulomb friction", "detector": detector}

    rows = [alarm(1.0), alarm(2.0), alarm(9.0), alarm(3.0, axis=2), alarm(4.0, detector="paper")]
    found = episodes_of(rows, events_of({"events": [{"time": 5.0, "axes": [1], "kind": "service", "note": "grease"}]}))
    assert [(e.axis, e.detector, len(e.alarms), e.resolved is None) for e in found] == [
        (1, "model", 1, True),
        (2, "model", 1, True),
        (1, "paper", 1, False),
        (1, "model", 2, False),
    ]
    assert found[0].before.note == found[2].resolved.note == "grease"
    assert len({e.key for e in found}) == 4


def test_friction_of_every_window(built):
    _, windows, _ = built
    found = window_friction(read_statistics(windows[0]), model().robot, 36)
    robot, speed = model().robot, found.speed
    truth = (robot.coulomb_positive - robot.coulomb_negative) / 2 + robot.viscous * speed
    error = (found.value[:40, :5] - truth[:5]) / found.std[:40, :5]
    assert 0.5 < np.sqrt(np.mean(error**2)) < 1.5
    assert np.isnan(found.value[:, 5]).all()
    assert (found.value[50:, WORN] > truth[WORN] + 0.4).all()


def test_baselines(built):
    _, windows, _ = built
    statistics = read_statistics(windows[0])
    assert choose_baseline(statistics, {"windows": 20}).count == 20
    assert choose_baseline(statistics, {"windows": 200}).count == HOURS
    assert choose_baseline(statistics, {"until": "2026-01-02T00:00:00Z"}).count == 24
    assert choose_baseline(statistics, {"until": "2026-01-02T00:00:00"}).count == 24
    short = choose_baseline(statistics, {"until": "2026-01-01T02:30:00Z"})
    assert short.count > 8
    assert "too few to know what is normal; it goes on until 2026-01-01T" in short.words
    waiting = choose_baseline(statistics, {"windows": 200})
    assert not waiting.complete
    assert "nothing is judged until 140 more have come" in waiting.words
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


def test_logs_without_dates_that_start_anew_are_laid_end_to_end(built):
    _, windows, _ = built
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


def test_no_usable_log_ends_in_one_line(tmp_path, built):
    _, windows, entry = built
    with pytest.raises(InputError, match=r"no log could be used: .*truncated"):
        judge_windows([windows[1]], ROBOT, entry, tmp_path / "s.nc", tmp_path / "a.csv", tmp_path / "r.json")


def test_times_as_text():
    assert stamp(START, True) == "2026-01-01T00:00:00Z"
    assert stamp(START + 0.25, True) == "2026-01-01T00:00:00.250Z"
    assert stamp(3600.0, False) == "3600"


def test_unknown_numbers_of_an_alarm_stay_empty(tmp_path):
    alarm = dict.fromkeys(ALARM_COLUMNS, float("nan")) | {
        "time": 7200.0,
        "axis": 2,
        "quantity": "x",
        "detector": "paper",
    }
    write_alarms(tmp_path / "a.csv", [alarm | {"unit": ""}], False)
    assert (tmp_path / "a.csv").read_text().splitlines()[1] == "7200,2,x,,,,,,,,,paper"


def test_refusals_are_kept_in_the_state(tmp_path, built):
    _, windows, entry = built
    statistics = read_statistics(windows[0])
    history = assemble([Piece("a.csv", statistics, 0.0, 1.0, (EVIL,))])
    robot = model().robot
    judgement = judge(statistics, 36, settings_of(robot, entry))
    write_state(tmp_path / "state.nc", judgement, history, 36, robot, entry, EVIL)
    state = read_state(tmp_path / "state.nc")
    assert state.refused == (EVIL,)
    assert state.entry == json.loads(json.dumps(entry))
    write_page(read_state(tmp_path / "state.nc"), tmp_path / "p.html", tmp_path / "figures")
    assert EVIL not in (tmp_path / "p.html").read_text()


def test_share_of_the_temperature():
    random = np.random.default_rng(2)
    temperature = np.linspace(20, 40, 60) + random.standard_normal(60)
    std = np.full(60, 0.1)
    noise = 0.1 * random.standard_normal(60)
    warm = temperature_share(5 - 0.05 * temperature + noise, std, temperature)
    assert warm.slope == pytest.approx(-0.05, abs=4 * warm.slope_std)
    assert warm.explained > 0.8
    assert warm.with_time > 0.9
    assert temperature_share(5 + noise, std, temperature).explained < 0.1
    assert temperature_share(5 + noise, std, np.full(60, 30.0)) is None
    assert temperature_share(5 + noise, std, np.full(60, np.nan)) is None


@given(st.integers(1, 40), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_thinned_windows_are_weighted_means_of_those_that_are_known(count, parts, seed):
    random = np.random.default_rng(seed)
    values, std = random.normal(size=count), random.uniform(0.1, 2.0, count)
    values[random.random(count) < 0.3] = np.nan
    groups = np.array_split(random.permutation(count), min(parts, count))
    mean, error = _thin(values, std, groups)
    for k, group in enumerate(groups):
        good = group[np.isfinite(values[group])]
        if not len(good):
            assert np.isnan(mean[k])
            continue
        weight = 1 / std[good] ** 2
        assert mean[k] == pytest.approx(np.average(values[good], weights=weight), rel=1e-9, abs=1e-12)
        assert error[k] == pytest.approx(weight.sum() ** -0.5, rel=1e-9)


def test_a_line_over_time_is_interrupted_where_nothing_was_measured():
    hours = np.concatenate([24 * day + np.arange(6, 14) for day in (0, 1, 4)])
    assert _pauses(hours).tolist() == [8, 16]
    assert not len(_pauses(24.0 * np.array([0, 1, 2, 5, 6])))
    assert not len(_pauses(np.zeros(1)))
    broken = np.insert(np.arange(4.0), [1, 2], np.nan)
    assert np.flatnonzero(_alone(broken)).tolist() == [0, 2]
