"""Panels without a drawing library: what is drawn where, ticks, and that the page can take the file."""

import re
from datetime import UTC, datetime
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.publishing.figures import palette
from jointwear.publishing.figures.panels import Panel, Scale, limits, write_panels
from jointwear.publishing.figures.ticks import MOST_DATES, date_ticks, number_ticks
from jointwear.publishing.report.inline import inline_svg

ZONES = [UTC, ZoneInfo("Europe/Berlin"), ZoneInfo("Asia/Kolkata"), ZoneInfo("America/New_York")]


def panel():
    return Panel(Scale(0.0, 10.0, 100.0, 300.0), Scale(-1.0, 1.0, 200.0, 50.0), 1)


def numbers(text):
    return [float(x) for x in re.findall(r"-?\d+\.\d\d", text)]


def test_a_line_goes_through_its_points_and_breaks_where_one_is_missing():
    drawn = panel()
    drawn.line(np.array([0.0, 5.0, 6.0, 10.0]), np.array([-1.0, 1.0, np.nan, 0.0]), "#0072b2")
    (path,) = drawn.drawn
    assert path.count("M") == 2
    assert numbers(path)[:6] == [100.0, 200.0, 200.0, 50.0, 300.0, 125.0]


def test_a_band_lies_between_its_edges():
    drawn = panel()
    drawn.band(np.array([0.0, 10.0]), np.array([-0.5, -0.5]), np.array([0.5, 0.5]), "#0072b2")
    assert numbers(drawn.drawn[0])[1::2] == [162.5, 162.5, 87.5, 87.5]


def test_bars_leave_out_what_is_not_known():
    drawn = panel()
    drawn.bars(np.array([1.0, 2.0]), np.array([0.0, np.nan]), np.array([0.5, 0.5]), "#0072b2")
    assert sum("circle" in part for part in drawn.drawn) == 1


def test_nothing_finite_has_limits_all_the_same():
    assert limits(np.array([np.nan])) == (0.0, 1.0)
    low, high = limits(np.array([3.0, 3.0]))
    assert low < 3.0 < high


@given(st.floats(-1e6, 1e6), st.floats(1e-4, 1e6))
def test_ticks_of_numbers_are_round_inside_and_not_too_many(low, span):
    ticks = number_ticks(low, low + span)
    assert len(ticks.places) == len(ticks.labels) <= 6
    assert len(ticks.places) >= 2
    assert (ticks.places >= low - 1e-6 * span).all()
    assert (ticks.places <= low + span * (1 + 1e-6)).all()
    steps = np.diff(ticks.places)
    assert np.allclose(steps, steps[0], rtol=1e-3)


@settings(max_examples=200)
@given(st.integers(10**9, 2 * 10**9), st.integers(5, 20 * 365 * 86400), st.sampled_from(ZONES))
def test_ticks_of_time_are_round_in_their_zone(low, span, zone):
    ticks = date_ticks(float(low), float(low + span), zone)
    assert 1 <= len(ticks.places) == len(ticks.labels) <= MOST_DATES + 1
    assert (ticks.places >= low).all()
    assert (ticks.places <= low + span).all()
    assert (np.diff(ticks.places) > 0).all()
    if span > 10 * 86400:
        assert all(datetime.fromtimestamp(t, tz=zone).hour in (0, 1) for t in ticks.places)


def test_a_day_without_an_hour_keeps_its_midnights():
    zone = ZoneInfo("Europe/Berlin")
    first = datetime(2026, 3, 27, tzinfo=zone).timestamp()
    ticks = date_ticks(first, first + 5 * 86400, zone)
    assert ticks.labels == ("27 Mar", "28 Mar", "29 Mar", "30 Mar", "31 Mar", "1 Apr")[: len(ticks.labels)]
    assert ticks.common == "2026"


@pytest.mark.parametrize("words", ["axis 1 < 2 & more", "plain"])
def test_the_page_takes_the_file_with_its_colours_and_words(tmp_path, words):
    drawn = panel()
    drawn.ticks_of_x(number_ticks(0.0, 10.0), name=words)
    drawn.ticks_of_y(number_ticks(-1.0, 1.0), (words,))
    drawn.upright(3.0, palette.DASHES[1])
    drawn.frame()
    write_panels(tmp_path / "a.svg", (400.0, 250.0), [drawn], "title", words)
    page = inline_svg(tmp_path / "a.svg", "one")
    assert "var(--ink)" in page
    assert "#dadade" not in page
    assert f'aria-label="{words.replace("&", "&amp;").replace("<", "&lt;")}"' in page.replace("&#34;", '"')
    first = (tmp_path / "a.svg").read_bytes()
    write_panels(tmp_path / "a.svg", (400.0, 250.0), [drawn], "title", words)
    assert (tmp_path / "a.svg").read_bytes() == first
