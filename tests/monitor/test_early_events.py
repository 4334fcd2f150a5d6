"""Events before what is judged are told: what they do, why, and what is allowed."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_windows import SETTINGS, residuals, statistics_of

from jointwear.monitor.events import Event, acting, events_of, planned_events
from jointwear.monitor.judging.early_events import early_event_findings, early_events, planned_event_findings
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.local_time import with_local_times, zone_of
from jointwear.monitor.reading.windows import blank_statistics
from jointwear.running.closing import EARLY_EVENT, PLANNED_EVENT

#: Midnight of 2026-01-01 UTC [s].
BEGIN = 1_767_225_600.0
BASELINE = (np.arange(48) >= 12) & (np.arange(48) < 36)


def windows(dated=True):
    return blank_statistics((BEGIN if dated else 0.0) + 3600.0 * np.arange(48), 3600.0, np.ones(3), dated=dated)


@pytest.mark.parametrize(
    ("hour", "what"),
    [(-24.0, "changes nothing: it lies before"), (5.0, "changes nothing: it lies before"),
     (11.9, "changes nothing: it lies before"), (12.0, ""), (12.1, "closes no alarm: it lies within"),
     (20.0, "closes no alarm: it lies within"), (36.0, ""), (400.0, "")],
)  # fmt: skip
def test_an_event_before_the_end_of_the_baseline_is_told(hour, what):
    events = [Event(BEGIN + 3600.0 * hour, (2,), "service")]
    found = early_event_findings(windows(), events, BASELINE)
    assert [what in f["words"] for f in found] == ([True] if what else [])
    assert all((f["kind"], f["axes"]) == (EARLY_EVENT, [3]) for f in found)


def test_an_event_before_the_first_log_is_told_also_where_the_baseline_begins_with_it():
    events = [Event(BEGIN, (2,), "service")]
    assert early_event_findings(windows(), events, np.arange(48) < 36)


def test_it_names_the_event_and_what_is_allowed_in_the_time_of_the_page():
    found = early_event_findings(windows(), [Event(BEGIN - 86400.0, (), "sensor")], BASELINE)
    (words,) = early_events([*found, {"kind": "scale", "words": "else"}], "Europe/Berlin")
    assert words.startswith("The event of 2025-12-31 01:00 CET (sensor, all axes) changes nothing")
    assert "Give a time after 2026-01-02 13:00 CET" in words
    (undated,) = early_event_findings(windows(dated=False), [Event(3600.0, (0, 1), "service")], BASELINE)
    assert "The event of 1 h (service, axes 1 and 2)" in undated["words"]


def test_without_a_baseline_nothing_is_told():
    assert not early_event_findings(windows(), [Event(BEGIN, (), "service")], np.zeros(48, dtype=bool))


@pytest.mark.long
def test_an_event_before_a_baseline_that_begins_later_leaves_the_axis_judged():
    """The baseline had been learnt from before the first event alone, of which there was nothing."""
    growth = np.zeros((260, 3))
    growth[160:, 1] = 0.1
    baseline = (np.arange(260) >= 24) & (np.arange(260) < 144)
    early = Event(10 * 3600.0, (1,), "service")
    plain, told = (
        judge(statistics_of(residuals(260, growth, 17)), baseline, replace(SETTINGS, events=events))
        for events in ((), (early,))
    )
    assert (plain.status == told.status).all()
    assert [a["time"] for a in plain.alarms] == [a["time"] for a in told.alarms]


def test_times_in_findings_are_those_of_the_zone_of_the_page():
    words = "The baseline ends at 2027-01-15T00:00Z, 'from' is 2026-07-05T00:00:00Z; 2026-07-01T10:30Z."
    assert with_local_times(words, zone_of("Europe/Berlin")) == (
        "The baseline ends at 2027-01-15 01:00 CET, 'from' is 2026-07-05T00:00:00Z; 2026-07-01 12:30 CEST."
    )


def test_an_event_that_is_yet_to_come_acts_from_its_time_on_and_is_told_until_then():
    """A planned service had stopped every robot of the file."""
    dates = ["2025-12-20T06:00:00Z", "2026-01-09T06:00:00", "2031-02-01"]
    events = [{"time": date, "axes": [1], "kind": "service"} for date in dates]
    entry = {"events": [*events, {"time": 5e9, "kind": "program"}], "time_zone": "Europe/Berlin"}
    now = acting(entry, BEGIN)
    assert [e.kind for e in events_of(now)] == ["service", "program"]
    soon, far = planned_events(now)
    assert soon[0].time == BEGIN + 8 * 86400 + 5 * 3600
    assert (soon[1], far[1]) == (False, True)
    found = planned_event_findings(windows(), [soon, far])
    assert [f["kind"] for f in found] == [PLANNED_EVENT, EARLY_EVENT]
    told = early_events(found, "Europe/Berlin")
    assert told[0] == (
        "The event of 2026-01-09 06:00 CET (service, axis 1) is yet to come: it closes no alarm until then."
    )
    assert "is its year a typo?" in told[1]
    later = acting(entry, BEGIN + 9 * 86400)
    assert (len(events_of(later)), len(planned_events(later))) == (3, 1)
    # An entry without any is as it was given, so that nothing is judged again.
    assert acting({"events": events[:1]}, BEGIN) == {"events": events[:1]}


@pytest.mark.parametrize(
    ("time", "time_zone", "acts"),
    [
        ("2026-01-01T04:00:00Z", None, False),
        ("2026-01-01T04:00:00+00:00", "Europe/Berlin", False),
        ("2026-01-01T04:00:00", "Europe/Berlin", False),
        ("2026-01-01T01:30:00", "Europe/Berlin", False),
        ("2026-01-01T01:00:00", "Europe/Berlin", True),
        ("2026-01-01T00:00:00Z", None, True),
        # Of a clock that may be ahead of UTC, as the stamps of its logs.
        ("2026-01-01T14:00:00", None, True),
        ("2026-01-01T14:30:00", None, False),
    ],
)
def test_an_event_of_tonight_closes_no_alarm_of_now(time, time_zone, acts):
    """A service that was entered for the evening had closed all open alarms in the morning."""
    entry = {"events": [{"time": time}]} | ({"time_zone": time_zone} if time_zone else {})
    now = acting(entry, BEGIN)
    assert (len(events_of(now)), len(planned_events(now))) == ((1, 0) if acts else (0, 1))
