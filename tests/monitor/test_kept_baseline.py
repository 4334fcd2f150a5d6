"""A kept baseline outlives its logs, whatever words its keys have, and is not chosen anew behind anybody's back."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.files.errors import InputError
from jointwear.measurement.timestamps import moment_of
from jointwear.monitor.events import events_of
from jointwear.monitor.judging.baseline import baseline_of, choose_baseline, keep_baseline, with_kept_baseline
from jointwear.monitor.reading.windows import blank_statistics

DAY, COUNT = 86400.0, 40
UNTIL = "1970-01-04T00:00:00Z"
GIVEN = {"until": UNTIL, "made_with": "a"}


def month():
    """Windows of three hours of two axes, some moving samples in each."""
    start = np.arange(COUNT) * DAY / 8
    statistics = blank_statistics(start, DAY / 8, np.ones(2), dated=True)
    statistics.count[:], statistics.samples[:] = 50, 60
    return statistics


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "baseline.nc"
    whole, baseline = with_kept_baseline(month(), GIVEN, path)
    assert baseline.mask.sum() == 24
    keep_baseline(whole, baseline, GIVEN, path)
    return path


def later():
    return month().part(slice(16, None))


def test_one_moment_in_other_words_is_the_same_baseline(path):
    for until in ("1970-01-04T01:00:00+01:00", "1970-01-04", 3 * DAY):
        whole, baseline = with_kept_baseline(later(), GIVEN | {"until": until}, path)
        assert (whole.windows, baseline.mask.sum()) == (COUNT, 24)


def test_another_baseline_is_chosen_of_the_windows_that_are_kept_too(path):
    whole, baseline = with_kept_baseline(later(), {"windows": 10, "made_with": "a"}, path)
    assert (whole.windows, baseline.mask.sum()) == (COUNT, 10)


def test_another_model_does_not_choose_anew_among_what_is_left(path):
    changed = GIVEN | {"made_with": "b"}
    with pytest.raises(InputError, match=r"16 windows of the baseline came of logs that are gone"):
        with_kept_baseline(later(), changed, path)
    surveyed_anew = replace(later(), torque_reference=np.full(2, 3.0))
    with pytest.raises(InputError, match="another survey"):
        with_kept_baseline(surveyed_anew, GIVEN, path)
    assert path.exists()
    assert with_kept_baseline(month(), changed, path)[1].mask.sum() == 24
    assert not path.exists()


def test_a_baseline_goes_on_until_its_end_has_passed(tmp_path):
    # Called after every window, as a timer does: eight windows in three shifts would be enough to learn from.
    path = tmp_path / "baseline.nc"
    for known in range(1, COUNT + 1):
        statistics, baseline = with_kept_baseline(month().part(slice(0, known)), GIVEN, path)
        keep_baseline(statistics, baseline, GIVEN, path)
        assert baseline.mask.sum() == min(known, 24)
        assert path.exists() == (known > 24)


def test_a_baseline_of_so_many_windows_is_complete_with_the_last_of_them(tmp_path):
    for given in ({"windows": 20}, {"windows": 20, "until": UNTIL}):
        assert choose_baseline(month().part(slice(0, 20)), given).complete


def test_a_baseline_that_begins_after_the_newest_log_says_so():
    chosen = choose_baseline(month(), {"from": "1970-02-05T00:00:00Z", "until": "1970-03-01T00:00:00Z"})
    assert (chosen.mask.sum(), chosen.complete) == (0, False)
    assert chosen.words.startswith(
        "'from' of the baseline (1970-02-05T00:00Z) is later than the newest log (1970-01-06T00:00Z)"
    )
    assert "Give a time from 1970-01-01T00:00Z to 1970-01-06T00:00Z" in chosen.words


def test_hours_are_no_end_of_the_baseline_of_logs_with_dates():
    dated = replace(month(), start=month().start + 1e9, end=month().end + 1e9)
    with pytest.raises(InputError, match=r"'baseline\.until' is 72, which is no date, .* or .* 'windows: 72'"):
        choose_baseline(dated, {"until": 72})
    assert choose_baseline(dated, {"until": 1e9 + 3 * DAY}).mask.sum() == 24
    assert choose_baseline(replace(dated, dated=False), {"until": 1e9 + 3 * DAY}).mask.sum() == 24


def test_times_without_a_zone_are_those_of_the_logs():
    # Berlin is an hour ahead of UTC in January 1970.
    entry = {"time_zone": "Europe/Berlin", "baseline": {"from": "1970-01-01T01:00:00", "until": "1970-01-04T01:00:00"}}
    assert choose_baseline(month(), baseline_of(entry)).mask.sum() == 24
    assert choose_baseline(month(), entry["baseline"]).mask.sum() != 24
    named = {"until": "1970-01-04T00:00:00Z", "from": 5.0, "windows": 9}
    given = baseline_of({"time_zone": "Europe/Berlin", "baseline": named})
    assert (given["from"], given["windows"]) == (5.0, 9)
    assert moment_of(given["until"]) == 3 * DAY
    times = {"events": [{"time": "1970-01-02T01:00:00"}, {"time": "1970-01-03T00:00:00Z"}, {"time": 3 * DAY}]}
    assert [e.time for e in events_of(entry | times)] == [DAY, 2 * DAY, 3 * DAY]
    assert events_of(times)[0].time == DAY + 3600
