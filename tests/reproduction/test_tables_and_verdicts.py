"""Intervals, verdicts and the layout of the result tables."""

import csv

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from jointwear.publishing.report.result_tables import score_detection, score_values
from jointwear.reproduction import tables
from jointwear.reproduction.grid import Cell
from jointwear.reproduction.published import load_published
from jointwear.reproduction.tables import COLUMNS, write_table
from jointwear.reproduction.verdicts import detection_verdict, torque_verdict, variation_verdict
from jointwear.statistics.intervals import spread_over_replicates, wilson_interval


@given(trials=st.integers(1, 2000), data=st.data())
def test_wilson_interval_agrees_with_scipy(trials, data):
    successes = data.draw(st.integers(0, trials))
    expected = stats.binomtest(successes, trials).proportion_ci(method="wilson")
    assert wilson_interval(successes, trials) == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_nothing_tried_is_nothing_known():
    assert wilson_interval(0, 0) == (0, 1)
    assert np.isnan(spread_over_replicates(np.array([np.nan]))).all()


@pytest.mark.parametrize(
    ("published", "median", "low", "high", "verdict"),
    [
        (10.0, 10.3, 9.9, 10.6, "agrees"),
        (10.0, 10.3, 10.2, 10.4, "close"),  # near, but outside the range
        (10.0, 10.0004, 10.0003, 10.0005, "agrees"),  # the range widened by the rounding of the print
        (10.0, 10.9, 5.0, 15.0, "close"),  # a wide range alone is not agreement
        (10.0, 11.5, 5.0, 15.0, "differs"),
        (0.0, 4e-4, 0, 0, "agrees"),
        (0.0, 6e-4, 0, 0, "differs"),
        (None, 1.0, 0, 2, "not comparable"),
    ],
)
def test_torque_verdicts(published, median, low, high, verdict):
    assert torque_verdict(published, median, low, high) == verdict


def test_variation_verdicts():
    assert variation_verdict(0.2, 0.21, 0.19, 0.22) == "agrees"
    assert variation_verdict(0.2, 0.32, 0.19, 0.4) == "differs"
    assert variation_verdict(0.73, 0.755, 0.7, 0.8, (0.69, 0.82)) == "agrees"
    assert variation_verdict(0.65, 0.755, 0.7, 0.8, (0.69, 0.82)) == "differs"


@pytest.mark.parametrize(
    ("ran", "published", "probability", "hours", "verdict"),
    [
        (True, None, 0.1, (np.nan,) * 3, "agrees"),
        (True, None, 0.6, (80, 70, 90), "close"),
        (True, None, 1.0, (80, 70, 90), "differs"),
        (True, 60.0, 1.0, (58, 51, 66), "agrees"),
        (True, 60.0, 1.0, (75, 55, 90), "close"),
        (True, 60.0, 1.0, (58, 57, 59), "close"),
        (True, 60.0, 1.0, (90, 80, 99), "differs"),
        (True, 60.0, 0.1, (60, 50, 70), "differs"),
        (False, None, 1.0, (60, 50, 70), "not comparable"),
    ],
)
def test_detection_verdicts(ran, published, probability, hours, verdict):
    assert detection_verdict(ran, published, probability, *hours) == verdict


def test_published_numbers(root):
    paper = load_published(root / "config/paper/published.yaml")
    assert paper.detection_hour(Cell("T1", 10.0, 1)) == 60
    assert paper.detection_hour(Cell("T1", 10.0, 2)) is None
    assert paper.evaluation_hour(Cell("T1", 10.0, 2)) == 120
    assert paper.maximum_torque(Cell("T2", 20.0, 6)) == 0.928
    assert paper.variation(Cell("T3", 10.0, 4)) == 0.824
    assert paper.lag(5, 2) == 38
    assert paper.has(Cell("T3", 20.0, 5))
    for cell in (Cell("T4", 10.0, 1), Cell("T1", 12.5, 1), Cell("T1", 15.0, 1), Cell("T1", 10.0, 7)):
        assert not paper.has(cell)
        assert paper.maximum_torque(cell) is None
    lags = np.array([[paper.lag(i, j) for j in range(1, 7)] for i in range(1, 7)])
    assert np.array_equal(lags, -lags.T)


def test_a_table_has_its_columns_in_both_files(tmp_path):
    import xarray

    row = {
        "task": "T1",
        "axis": 1,
        "increase_percent": 10.0,
        "published": None,
        "reproduced": 1.25,
        "reproduced_low": 1.0,
        "reproduced_high": float("nan"),
        "at_published_hour": 1.0,
        "at_published_hour_low": 1.0,
        "at_published_hour_high": 1.0,
        "verdict": "not comparable",
    }
    write_table("table_v", [row], tmp_path / "table_v", {})
    with open(tmp_path / "table_v.csv") as file:
        read = list(csv.DictReader(file))
    assert list(read[0]) == COLUMNS["table_v"].split()
    assert read[0]["published"] == ""
    assert read[0]["reproduced_high"] == ""
    with xarray.open_dataset(tmp_path / "table_v.nc") as data:
        assert list(data.data_vars) == COLUMNS["table_v"].split()
        assert data.verdict.item() == "not comparable"
        assert data.reproduced.units == "N m"


@pytest.mark.parametrize(("hours", "compared"), [(24, False), (120, True)])
def test_an_hour_that_was_not_simulated_is_compared_with_nothing(root, monkeypatch, hours, compared):
    """A run of 24 h printed a torque "at the paper's hour" 50, and was 32 h off in Table IV."""
    paper, random = load_published(root / "config/paper/published.yaml"), np.random.default_rng(2)
    ran = [Cell("T1", 20.0, 1), Cell("T1", 20.0, 2)]
    assert [paper.detection_hour(cell) for cell in ran] == [50, None]
    files = {
        "hour": np.arange(1.0, hours + 1),
        "onset": np.full(4, 18.0),
        "source": np.ones(4),
        "maximum_torque": 35.0 + 0.1 * np.arange(hours)[:, None] + random.normal(size=(4, 1, 6)),
    }
    monkeypatch.setattr(tables, "by_cell", lambda paths: dict.fromkeys(ran, "run.nc"))
    monkeypatch.setattr(tables, "read_variables", lambda path, *names: [files[name] for name in names])
    torque, detection = tables.table_v([], [], paper), tables.table_iv([], [], paper)
    for row in (*torque, *detection):
        assert (row["verdict"] != "not comparable") == compared
    for row, hour in zip(torque, (50, 120), strict=True):
        there = np.median(files["maximum_torque"][:, hour - 1, row["axis"] - 1]) if compared else np.nan
        assert row["at_published_hour"] == pytest.approx(there, nan_ok=True)
    score_detection(detection)
    assert [row["error_h"] for row in detection] == [-32.0 if compared else None, None]
    assert (score_values(torque, relative=True)["median_error"] is not None) == compared


def test_an_empty_table_is_a_table(tmp_path):
    write_table("table_ii", [], tmp_path / "table_ii", {})
    assert (tmp_path / "table_ii.csv").read_text().splitlines() == [",".join(COLUMNS["table_ii"].split())]
