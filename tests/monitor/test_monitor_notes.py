"""Notes of the page beside its values: how sure they are, why one is missing; nothing of a log gets in as markup."""

from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from monitor_states import changed, with_estimates

from jointwear.measurement.flags import FLAG_WORDS, Flag
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.presentation.condition import axis_conditions
from jointwear.monitor.presentation.page import _flag_rows, write_page
from jointwear.monitor.presentation.standing import standing
from jointwear.monitor.presentation.summaries import UNKNOWN, axis_summary, headline, why_unjudged
from jointwear.monitor.presentation.temperature import temperature_share
from jointwear.monitor.presentation.words import sure_words, todo
from jointwear.monitor.watching.records import UNJUDGED


class Tags(HTMLParser):
    """Collects the names of tags, and attributes that could run something."""

    def __init__(self) -> None:
        super().__init__()
        self.tags, self.handlers = set(), set()

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.handlers |= {name for name, _ in attrs if name.startswith("on")}


def test_the_page_escapes_what_comes_from_logs(monitored):
    folder, _, _ = monitored
    text = (folder / "monitor.html").read_text()
    found = Tags()
    found.feed(text)
    assert "script" not in found.tags
    assert not found.handlers
    assert "&lt;script&gt;" in text


def test_the_page_says_what_an_engineer_needs(monitored):
    folder, _, _ = monitored
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


def test_what_asks_for_an_answer_is_not_folded_away(monitored, tmp_path):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    programs = [{"time": state.end[-1 - k], "axes": [], "kind": "program", "words": f"Told {k}."} for k in range(7)]
    asked = {"time": state.end[0], "axes": [2], "kind": "scale", "words": "The scale changed."}
    write_page(replace(state, findings=[*programs, asked]), tmp_path / "page.html", tmp_path / "figures")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    first = text.index("What to check first")
    assert (
        first < text.index("The scale changed.") < text.index("Told 4.") < text.index("2 older") < text.index("Told 5.")
    )


def test_a_reason_of_another_version_is_no_failure(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    other = replace(state, reason=np.full_like(state.reason, 99), flags=np.zeros_like(state.flags))
    assert "too small against the noise" in why_unjudged(other, 5)


def test_how_sure_an_axis_is_stands_beside_it(monitored):
    folder, _, _ = monitored
    state = with_estimates(changed(read_state(folder / "state.nc"), "coulomb friction"), coulomb_percent=5.0)
    unsure = replace(state, alarms=[{**state.alarms[0], "probability_axis": 0.33}])
    assert axis_conditions(unsure)[0].check.startswith("compare the other axes before opening anything")
    write_page(unsure, folder / "unsure.html", folder / "unsure")
    text = (folder / "unsure.html").read_text().replace("\u00a0", " ")
    assert text.count("33 % this axis rather than another") == 2
    assert "This is a shipped example" not in text
    write_page(unsure, folder / "unsure.html", folder / "unsure", example=True)
    assert "This is a shipped example" in (folder / "unsure.html").read_text()
    assert "compare" not in axis_conditions(state)[0].check
    told = todo(standing(state), standing(state)["axes"][0], zone_of(None))
    assert told["sure"] == "99\u00a0% this axis rather than another"
    assert sure_words(0.999) == ">\u00a099\u00a0% this axis rather than another"
    assert sure_words(None) == ""


def test_a_value_that_is_not_known_says_why(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    (told,) = axis_summary(state, 5)["unknown"]
    assert told.endswith("not judged in the last day: at rest, or too slow to show friction")
    hidden = with_estimates(state, coulomb_percent=np.nan)
    hidden.estimates["coulomb_percent"][0][:30] = 0.0
    assert axis_summary(hidden, 0)["unknown"] == [f"Coulomb friction: {UNKNOWN['coulomb_percent']}"]
    assert not axis_summary(state, 0)["unknown"]
    assert "Not known (–):" in (folder / "monitor.html").read_text()


def test_a_robot_of_which_nothing_can_be_judged_has_a_page(monitored, tmp_path):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    nothing = {
        name: (np.full_like(x, np.nan), np.full_like(s, np.nan), u) for name, (x, s, u) in state.estimates.items()
    }
    status = np.full_like(state.status, UNJUDGED)
    state = replace(
        state, estimates=nothing, status=status, alarms=[], temperature=np.full_like(state.temperature, np.nan)
    )
    write_page(state, tmp_path / "p.html", tmp_path / "figures")
    assert "Friction has changed" not in (tmp_path / "p.html").read_text()
    assert not list((tmp_path / "figures").iterdir())


def test_share_of_the_temperature():
    random = np.random.default_rng(2)
    temperature = np.linspace(20, 40, 60) + random.standard_normal(60)
    std, time = np.full(60, 0.1), 3600.0 * np.arange(60)
    noise = 0.1 * random.standard_normal(60)
    warm = temperature_share(5 - 0.05 * temperature + noise, std, temperature, time)
    assert warm.slope == pytest.approx(-0.05, abs=4 * warm.slope_std)
    assert warm.explained > 0.8
    assert warm.with_time > 0.9
    assert temperature_share(5 + noise, std, temperature, time).explained < 0.1
    assert temperature_share(5 + noise, std, np.full(60, 30.0), time) is None
    assert temperature_share(5 + noise, std, np.full(60, np.nan), time) is None


def test_pauses_count_in_how_far_temperature_goes_with_time():
    """Two mornings alike, eleven days apart: by the order of the windows the temperature rose."""
    time = np.array([0.0, 1, 2, 3, 264, 265, 266, 267])
    temperature = np.array([20.0, 25, 30, 35, 22, 27, 32, 37])
    share = temperature_share(np.arange(8.0) + 5, np.ones(8), temperature, time)
    assert share.with_time == pytest.approx(np.corrcoef(time, temperature)[0, 1])
    assert share.with_time < 0.2


@pytest.mark.parametrize(
    ("pages", "logs", "told"),
    [("Europe/Berlin", None, True), ("Europe/Berlin", "UTC", False), ("Europe/Berlin", "Europe/Berlin", False),
     (None, None, False)],
)  # fmt: skip
def test_a_page_in_local_time_says_that_logs_without_a_zone_are_read_as_utc(monitored, tmp_path, pages, logs, told):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    entry = {key: value for key, value in state.entry.items() if key != "time_zone"}
    state = replace(state, dated=True, entry=entry if logs is None else {**entry, "time_zone": logs})
    write_page(state, tmp_path / "page.html", tmp_path / "figures", pages)
    words = "Times in the logs that name no zone count as UTC"
    assert (words in (tmp_path / "page.html").read_text(encoding="utf-8")) == told


def test_what_keeps_no_window_from_being_judged_says_so(monitored):
    """Another part on half of all days stood without a word in the table of what cannot be judged."""
    state = read_state(monitored[0] / "state.nc")
    flags = np.full_like(state.flags, int(Flag.UNEXPLAINED))
    flags[0] |= int(Flag.TORQUE_FROZEN)
    words = {row["words"] for row in _flag_rows(replace(state, flags=flags))}
    assert words == {
        f"{FLAG_WORDS[Flag.UNEXPLAINED]} (keeps no window from being judged)",
        FLAG_WORDS[Flag.TORQUE_FROZEN],
    }
