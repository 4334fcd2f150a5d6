"""The numbers of the report."""

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from jointwear.files import shown_numbers as numbers
from jointwear.files.json_values import as_json
from jointwear.files.shown_numbers import with_std
from jointwear.files.storage import Variable, read_variables, write_dataset
from jointwear.publishing.report import detection_rates, drivers
from jointwear.publishing.report.assembly import assumptions, paper_facts
from jointwear.publishing.report.figure_scores import score_components
from jointwear.publishing.report.result_tables import lag_verdict, score_detection, score_values
from jointwear.publishing.report.torque_limits import limit_use
from jointwear.reproduction.published import load_published
from jointwear.reproduction.tables import read_table


def test_summary_file_holds_the_numbers_of_the_page(experiment, data):
    content = json.loads(Path(experiment.path("report/summary.json")).read_text(encoding="utf-8"))
    assert content["scores"] == as_json(data["scores"])
    assert content["location"] == as_json(data["location"])
    assert content["config_digest"] == data["config_digest"]
    rows = read_table(experiment.path("tables/table_iv.nc"))
    counted = Counter(r["verdict"] for r in rows)
    assert content["scores"]["table_iv"]["verdicts"]["agrees"] == counted["agrees"]
    assert "times" not in content


def test_location_is_counted_among_detected_replicates(experiment, data):
    row = next(r for r in data["location"]["runs"] if (r["task"], r["axis"], r["increase_percent"]) == ("T1", 1, 20))
    (onset,) = read_variables(experiment.path("detection/T1/axis1_20percent.nc"), "onset")
    (source,) = read_variables(experiment.path("location/T1/axis1_20percent.nc"), "source_raw")
    found = np.isfinite(onset)
    assert row["raw"]["total"] == found.sum()
    assert row["raw"]["count"] == (source[found] == 1).sum()
    everything = sum(r["raw"]["total"] for r in data["location"]["runs"])
    assert data["location"]["pooled"]["raw"]["total"] == everything


def test_false_alarms_are_those_of_the_normal_run(experiment, data):
    path = experiment.path("detection/T2/normal.nc")
    alarms, q, limit = read_variables(path, "alarms", "q", "q_limit")
    found = data["detection"]["normal"]["T2"]["q"]
    assert found["alarms_per_week"]["mean"] == pytest.approx(alarms.mean() / (48 / 168))
    assert found["hours_above_limit"]["mean"] == pytest.approx((q > limit[:, None]).mean())
    assert found["periods_with_alarm"]["count"] == (alarms > 0).sum()


def test_models_that_keep_everything_are_counted(tmp_path):
    def model(path, eigenvalues, kept):
        variables = {
            "eigenvalues": Variable(("replicate", "component"), np.array(eigenvalues), "variance", "1"),
            "kept": Variable(("replicate",), np.array(kept), "number kept", "1"),
        }
        write_dataset(path, variables, {})
        return str(path)

    models = {
        "Reach": model(tmp_path / "reach.nc", [[1.8, 0.2], [1.9, 0.1]], [2, 1]),
        "Hold": model(tmp_path / "hold.nc", [[2.0, 1e-17], [2.0, 0.0]], [1, 1]),
    }
    found = detection_rates.models_without_residual(models)
    assert [(found[t]["count"], found[t]["total"]) for t in ("Reach", "Hold")] == [(1, 2), (2, 2)]


def test_no_alarm_still_leaves_room_for_some():
    assert detection_rates.mean_interval(np.zeros(100), 1.0) == {"mean": 0, "low": 0, "high": pytest.approx(0.03)}


@given(values=st.lists(st.integers(0, 5), min_size=2, max_size=50).filter(any))
def test_mean_interval_holds_the_mean(values):
    found = detection_rates.mean_interval(np.array(values), 2.0)
    assert found["low"] <= found["mean"] == pytest.approx(np.mean(values) / 2)
    assert found["mean"] <= found["high"]


def test_torque_limits(tmp_path):
    for name, shares in (("axis1_10percent", [0.2, 0.6]), ("normal", [np.nan, np.nan])):
        path = tmp_path / "T1" / f"{name}.nc"
        write_dataset(path, {"limit_share": Variable(("axis",), np.array(shares), "share", "1")}, {})
    worn, normal = limit_use([str(p) for p in sorted((tmp_path / "T1").glob("*.nc"))])
    assert (worn["axis"], worn["share"], worn["over_half"], worn["over_limit"]) == (2, 0.6, True, False)
    assert (normal["axis"], normal["share"], normal["over_half"]) == (None, None, False)


numbers_with_ties = st.lists(st.integers(0, 4), min_size=4, max_size=12)


@given(x=numbers_with_ties, data=st.data())
def test_rank_correlation_agrees_with_scipy(x, data):
    y = data.draw(st.lists(st.integers(0, 4), min_size=len(x), max_size=len(x)))
    np.testing.assert_array_equal(drivers.ranks(np.array(x)), stats.rankdata(x))
    ours = drivers.rank_correlation(np.array(x), np.array(y))
    if len(set(x)) == 1 or len(set(y)) == 1:
        assert np.isnan(ours)
    else:
        assert ours == pytest.approx(stats.spearmanr(x, y).statistic, abs=1e-12)


def test_bootstrap_interval_covers_and_repeats():
    random = np.random.default_rng(1)
    x = random.standard_normal(40)
    y = x + 0.5 * random.standard_normal(40)
    first = drivers.correlate(x, y, seed=3)
    assert first == drivers.correlate(x, y, seed=3)
    assert 0 < first["low"] < first["value"] < first["high"] <= 1
    assert drivers.correlate(x[:3], y[:3], 3)["value"] is None
    assert drivers.correlate(np.ones(10), x[:10], 3)["value"] is None


def test_half_of_the_replicates_decide_the_median_onset():
    assert drivers.median_onset(np.array([50.0, 60, np.nan])) == 60
    assert drivers.median_onset(np.array([50.0, np.nan, np.nan])) == np.inf


def test_growth_of_friction_as_a_share_of_the_torque(experiment, data):
    rows = {(r["task"], r["axis"], r["increase_percent"]): r for r in data["drivers"]["cells"]}
    # Axis 6 of T1 is at rest: its wear does not change the commanded torque.
    assert rows["T1", 6, 20]["growth_share"] == 0
    assert rows["T2", 1, 20]["growth_share"] == pytest.approx(2 * rows["T2", 1, 10]["growth_share"], rel=1e-3)
    assert 0.05 < rows["T2", 1, 10]["growth_share"] < 0.1


@pytest.mark.parametrize(
    ("published", "reproduced", "low", "high", "verdict"),
    [
        (-3, -5, -20, 0, "agrees"),
        (-3, -23, -40, 0, "close"),  # sign and range, but far
        (0, 7, -40, 40, "close"),  # near, another sign
        (-38, -1, -52, 28, "close"),
        (32, -13, -21, 18, "differs"),
        (0, 43, -73, 90, "differs"),  # a wide range alone is nothing
    ],
)
def test_verdict_on_a_lag(published, reproduced, low, high, verdict):
    assert lag_verdict(published, reproduced, low, high) == verdict


def test_pattern_of_detection_is_counted_both_ways():
    def row(published, probability, hour, verdict="agrees"):
        return {
            "published": published,
            "detection_probability": probability,
            "hour_median": hour,
            "verdict": verdict,
        }

    score = score_detection(
        [row(60.0, 1.0, 52.0), row(None, 0.0, None), row(None, 0.9, 70.0), row(90.0, 0.1, 95.0),
         row(None, 1.0, 5.0, "not comparable")]
    )  # fmt: skip
    assert score["compared"] == 4
    assert (score["both_detect"], score["neither_detects"]) == (1, 1)
    assert (score["only_we_detect"], score["only_paper_detects"]) == (1, 1)
    assert score["median_error_h"] == score["largest_error_h"] == 8


def test_errors_of_values_leave_out_what_the_paper_prints_as_zero():
    rows = [
        {"published": 10.0, "reproduced": 11.0, "at_published_hour": 9.0, "verdict": "close"},
        {"published": 0.0, "reproduced": 1e-5, "at_published_hour": 1e-5, "verdict": "agrees"},
        {"published": None, "reproduced": 3.0, "at_published_hour": None, "verdict": "not comparable"},
    ]
    score = score_values(rows, relative=True)
    assert score["median_error"] == pytest.approx(0.1)
    assert rows[0]["error_at_published_hour"] == pytest.approx(-0.1)
    assert rows[1]["error"] is None


def test_number_of_components_is_only_compared_for_tasks_of_the_paper(root):
    printed = load_published(root / "config/paper/published.yaml")
    kept = np.array([3, 4, 5, 5])
    assert score_components({"T1": kept}, printed)["verdict"] == "agrees"
    assert score_components({"T1": np.array([5] * 9 + [4])}, printed)["verdict"] == "close"
    assert score_components({"Weld": kept}, printed)["verdict"] == "not comparable"


def test_what_the_paper_says_about_itself(root):
    facts = paper_facts(load_published(root / "config/paper/published.yaml"))
    assert facts["detected"] == {"T1": {10: 2, 20: 2}, "T2": {10: 5, 20: 5}, "T3": {10: 1, 20: 4}}
    assert (facts["detected_total"], facts["within_three_days"]) == (19, 6)
    assert facts["axis_1_torque_change"]["T1"] == pytest.approx(1.204)
    assert facts["axis_1_torque_change"]["T2"] == pytest.approx(-0.230)


@pytest.mark.parametrize(
    ("value", "std", "said"),
    [
        (0.00788, 0.0131, "+0.008 ± 0.013"),
        (5.33e-4, 0.0022, "+0.0005 ± 0.0022"),
        (-166.2, 3.04, "−166.2 ± 3.0"),
        (1234.0, 55.0, "+1234 ± 55"),
        (1.0, 0.0996, "+1.00 ± 0.10"),
        (2.5, None, "+2.5"),
        (2.5, 0.0, "+2.5"),
        (None, 1.0, "–"),
    ],
)
def test_a_number_has_as_many_decimals_as_its_deviation(value, std, said):
    assert with_std(value, std, plus=True) == said


def test_assumptions_tell_what_was_chosen(default_reading):
    chosen = {**default_reading, "cross_correlation": "means_removed"}
    entry = next(a for a in assumptions(chosen) if a["name"] == "cross_correlation")
    assert entry["chosen"] == "means_removed"
    assert [o["name"] for o in entry["others"]] == ["raw"]
    assert entry["default"] == "raw"


def test_units_read_as_in_a_text():
    assert [numbers.unit(u) for u in ("kg m2", "degC", "N m/rad3", "(N m)^(1-p)", "1", "N m s/rad")] == [
        "kg m²",
        "°C",
        "N m/rad³",
        "(N m)^(1-p)",
        "1",
        "N m s/rad",
    ]
