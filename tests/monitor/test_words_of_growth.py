"""How growth, forecasts and times are told."""

from dataclasses import replace

import numpy as np
import pytest
from fleet_rows import axis

from jointwear.files.errors import InputError
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.local_time import local_time, zone_of
from jointwear.monitor.presentation.condition import CHANGED, AxisCondition
from jointwear.monitor.presentation.episodes import Episode
from jointwear.monitor.presentation.page import now_words
from jointwear.monitor.presentation.standing import axis_row
from jointwear.monitor.presentation.words import change_words, outlook_words, row_words
from jointwear.monitor.watching.limits import LimitDate
from jointwear.monitor.watching.records import DETECTORS


def test_a_changed_axis_that_is_not_judged_now_tells_its_newest_alarm():
    told = {**axis(3, CHANGED), "growth": None, "quantity": "coulomb friction", "change": 91.8, "unit": "N m"}
    assert change_words(told) == "Coulomb friction +92 N m at its newest alarm, not judged now; limit 20 %"


@pytest.mark.parametrize(
    ("hours", "words"),
    [
        (None, ""),
        ([0.0, 0.0, 7.0], "limit may be reached by now"),
        ([30.0, 10.0, None], "limit not within 10 h"),
        ([None, 100.0, None], "limit not within 4 days"),
        ([None, None, None], "no limit in sight"),
        ([30.0, 10.0, 100.0], "limit in 30 h (10 h to 4 days)"),
    ],
)
def test_forecasts_in_words(hours, words):
    axis = {"hours": hours, "reached": False}
    assert outlook_words({"dated": False, "last_sample": 0.0}, axis, zone_of(None)) == words


def test_a_limit_is_reached_where_the_growth_that_is_told_has_reached_it():
    row = {"dated": False, "last_sample": 0.0}
    assert outlook_words(row, {"hours": [0.0, 0.0, 0.0], "reached": True}, zone_of(None)) == "limit reached"
    assert outlook_words(row, {"hours": [9.0, 4.0, 20.0], "reached": True}, zone_of(None)) == "limit reached"


@pytest.mark.parametrize(("hours", "words"), [([0.0, 0.0, 0.0], "reached"), ([0.0, 0.0, 9.0], "may be reached by now")])
def test_the_forecast_of_viscous_friction_says_of_which_limit_it_is(hours, words):
    axis = {"hours": hours, "reached": False, "quantity": "viscous friction", "limit": 20.0, "viscous_growth": 21.0}
    told = outlook_words({"dated": False, "last_sample": 0.0}, axis, zone_of(None))
    assert told == f"limit of viscous friction (+20 %) {words}"


@pytest.mark.parametrize(("grown", "words"), [(16.7, "may be reached by now"), (19.96, "reached"), (24.0, "reached")])
def test_a_limit_of_one_quantity_is_reached_where_what_is_told_of_it_is(grown, words):
    """A page told viscous friction of +16.7 %, a limit of 20 %, and that the limit was reached."""
    axis = {"hours": [0.0] * 3, "reached": False, "quantity": "viscous friction", "limit": 20.0, "growth": 1.0}
    told = outlook_words({"dated": False, "last_sample": 0.0}, {**axis, "viscous_growth": grown}, zone_of(None))
    assert told == f"limit of viscous friction (+20 %) {words}"


def test_growth_that_is_hardly_known_may_have_reached_its_limit():
    axis = {"hours": [0.0] * 3, "reached": False, "quantity": "viscous friction", "limit": 20.0, "growth": 1.0}
    told = outlook_words(
        {"dated": False, "last_sample": 0.0}, {**axis, "viscous_growth": 74.0, "unsure": True}, zone_of(None)
    )
    assert told == "limit of viscous friction (+20 %) may be reached by now"


def test_a_forecast_of_the_limit_of_viscous_friction_has_its_growth_beside_it():
    alarm = {"time": 100.0, "change": 0.2, "unit": "N m", "probability_axis": 1.0}
    episode = Episode(3, "coulomb friction", DETECTORS[0], (alarm,), None)
    limit = LimitDate("viscous friction", 0.0, 0.0, 24 * 3600.0)
    told = AxisCondition(3, "elbow", CHANGED, 1.1, 2.7, 20.0, limit, (episode,), (), viscous=17.3, viscous_std=9.0)
    row = axis_row(told, 0.0)
    assert change_words(row).startswith("Coulomb friction +1.1 % now, limit 20 %; viscous friction +17.3 % now")
    where = {"dated": False, "last_sample": 0.0}
    assert outlook_words(where, row, zone_of(None)) == "limit of viscous friction (+20 %) may be reached by now"
    assert axis_row(replace(told, limited=None), 0.0)["viscous_growth"] is None


@pytest.mark.parametrize(
    ("growth", "low", "mild"), [(1.2, 90.0, True), (1.2, 20.0, False), (4.0, 90.0, False), (np.nan, 90.0, False)]
)
def test_small_growth_far_from_its_limit_waits_for_the_next_service(growth, low, mild):
    """A page sent people to the gear for +1.2 % of a limit of 20 % that came months later, if ever."""
    alarm = {"time": 100.0, "change": 0.2, "unit": "N m", "probability_axis": 1.0}
    episode = Episode(3, "coulomb friction", DETECTORS[0], (alarm,), None)
    limit = LimitDate("coulomb friction", np.inf, low * 86400.0, np.inf)
    told = AxisCondition(3, "elbow", CHANGED, growth, 0.5, 20.0, limit, (episode,), (), now=200.0)
    check = "check the gear and bearings"
    assert told.check.startswith("it is small and its limit far off: keep watching it" if mild else check)
    assert check in told.check
    greased = replace(told, growth=-9.0, grown="viscous friction", viscous=1.0)
    assert greased.check.startswith("was it greased?")


def test_the_size_of_backlash_is_told_as_the_least_it_is():
    axis = {"growth": None, "limit": 20.0, "quantity": "backlash", "change": 53.0, "unit": "%"}
    assert change_words(axis) == "backlash: pulses at reversals by +53 % at least"


def test_times_are_local_and_say_so():
    berlin = zone_of("Europe/Berlin")
    assert local_time(1_774_746_000.0, berlin) == "2026-03-29 03:00 CEST"
    assert local_time(1_774_742_400.0, berlin) == "2026-03-29 01:00 CET"
    with pytest.raises(InputError, match="did you mean 'Europe/Berlin'"):
        zone_of("Europe/Berln")


def test_a_forecast_that_is_open_at_both_ends_is_dated_as_from_no_day():
    row = {"dated": True, "last_sample": 0.0}

    def told(*hours):
        moments = [None if h is None else 3600 * h for h in hours]
        return outlook_words(row, {"hours": hours, "limit_at": moments, "reached": False}, zone_of(None))

    for middle in (50.0, None):
        assert told(middle, 0.0, None) == "limit may be reached by now, or never"
    assert "not before" in told(None, 30.0, None)


def test_the_page_says_over_which_windows_now_is_the_mean(monitored):
    folder, _, _ = monitored
    text = (folder / "monitor.html").read_text(encoding="utf-8")
    now = "the mean of the last day (2026-01-02 12:00 UTC to 2026-01-03 12:00 UTC)"
    assert f"Now is {now}." in text
    assert f"T{now[1:]}, ± one standard deviation" in text
    state = read_state(folder / "state.nc")
    long = replace(state, start=20 * state.start, end=20 * state.start + 72000.0)
    assert now_words(long, zone_of(None)).startswith("the mean of the last 3 windows (")


def test_a_row_of_an_alarm_tells_growth_beside_its_limit_and_what_may_have_been():
    """Newton metres stood beside a limit in percent, and "may be reached by now" for what was weeks ago."""
    row = {
        "change": 10.3, "change_low": 9.9, "change_high": 10.6, "unit": "N m", "limit_percent": 20.0,
        "growth_percent": 28.9, "growth_percent_low": 27.8, "growth_percent_high": 30.0,
        "hours_to_limit": 0.0, "hours_to_limit_low": 0.0, "hours_to_limit_high": 0.0,
    }  # fmt: skip
    told = row_words(row)
    assert told["grown"].replace("\u00a0", " ") == "+28.9 %"
    assert (told["of_it"], told["in_unit"], told["ahead"], told["of_ahead"]) == (
        "27.8 to 30",
        "+10.3 N m",
        "reached",
        "",
    )
    below = row_words({**row, "growth_percent": 14.8, "hours_to_limit_high": 135.0})
    assert (below["ahead"], below["of_ahead"]) == ("may have been reached", "in 135 at the latest")
    ahead = row_words({**row, "growth_percent": 7.6, "hours_to_limit": 98.2, "hours_to_limit_high": None})
    assert (ahead["ahead"], ahead["of_ahead"]) == ("98.2", "0 to ∞")
    play = row_words({**row, **dict.fromkeys(k for k in row if k.startswith(("growth", "hours")))})
    assert (play["grown"], play["of_it"], play["in_unit"], play["ahead"]) == ("+10.3 N m", "9.9 to 10.6", "", "–")
