"""The table, the metrics and the history of a fleet, which other tools read."""

import csv
import json
import re

import numpy as np
import pyarrow.parquet as parquet
import pytest
from fleet_rows import DAY, NOW, axis, robot
from prometheus_client.parser import text_string_to_metric_families

from jointwear.files.errors import InputError
from jointwear.monitor.fleet.history import ESTIMATES, join_histories
from jointwear.monitor.fleet.metrics import write_metrics
from jointwear.monitor.fleet.page import robot_item
from jointwear.monitor.fleet.ranking import as_of
from jointwear.monitor.fleet.summary import summarise_fleet
from jointwear.monitor.fleet.table import table_row
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.presentation.condition import CHANGED, UNJUDGED, UNRESOLVED


def test_the_table_counts_what_was_refused_stale_or_not_judged(built_fleet):
    with (built_fleet / "fleet.csv").open() as file:
        rows = {row["robot"]: row for row in csv.DictReader(file)}
    assert list(rows) == ["done", "sooner", "worn", "broken", "odd", "silent", "still", "calm"]
    assert (rows["broken"]["urgency"], rows["broken"]["refused_logs"]) == ("refused", "10")
    assert (rows["odd"]["copied_logs"], rows["odd"]["refused_logs"]) == ("3", "0")
    assert (rows["silent"]["stale_logs"], rows["silent"]["stale_windows"]) == ("5", "120")
    assert (rows["still"]["unjudged_logs"], rows["still"]["unjudged_windows"]) == ("10", "240")
    assert (rows["still"]["urgency"], rows["still"]["axes_unjudged"]) == (UNJUDGED, "1")
    assert (rows["worn"]["hours_to_limit_low"], rows["worn"]["hours_to_limit_high"]) == ("90.0", "")
    assert rows["calm"]["what_to_check"] == ""
    known = table_row(as_of(robot("x", axis(1, CHANGED, alarms=0), axis(2, CHANGED)), NOW))
    assert known["axes_unresolved"] == "2"


def test_the_table_says_why_the_newest_logs_are_refused_and_what_mends_them():
    told = "b.csv: positions of joint 1 reach 95.58; they look like degrees; state units: {position: deg}"
    cells = table_row(as_of(robot("x", axis(), refused_newest=1, refused_logs=1, refusals=["a.csv: old", told]), NOW))
    assert (cells["urgency"], cells["reason"]) == ("refused", told)
    assert cells["what_to_check"] == "State units: {position: deg}"
    nameless = as_of(robot("x", axis(), refused_newest=1, refusals=["a.csv: is empty"]), NOW)
    assert "see 'reason'" in table_row(nameless)["what_to_check"]
    # A log that was refused before the newest is none to mend first.
    assert table_row(as_of(robot("x", axis(), refused_logs=1, refusals=["a.csv: old"]), NOW))["reason"] == ""


def test_the_table_says_what_asks_for_an_entry_under_events():
    words = "The torque of axis 4 keeps one value in motion: the sensor, or the log."
    found = {"time": NOW - DAY, "end": NOW, "axes": [4], "kind": "frozen", "words": words}
    cells = table_row(as_of(robot("x", axis(), findings=[found]), NOW))
    assert cells["urgency"] == "needs an entry under events"
    assert cells["what_to_check"].startswith("Enter what was done to it")
    assert words in cells["what_to_check"]


@pytest.mark.parametrize(
    ("more", "urgency", "first"),
    [
        ({}, UNJUDGED, ""),
        ({"last_sample": NOW - 5 * DAY}, "stale", ""),
        ({"refused_newest": 1, "refused_logs": 1, "refusals": ["b.csv: is empty"]}, "refused", "Mend what refuses"),
    ],
)
def test_a_key_of_the_baseline_that_keeps_a_robot_from_being_judged_is_told_whatever_else_is_wrong(
    more, urgency, first
):
    key = "Set 'baseline.from' to a time between the first window and the newest"
    found = {"time": NOW - DAY, "axes": [], "kind": "baseline", "words": "Later than the newest log.", "advice": key}
    row = as_of(robot("x", axis(1, UNJUDGED), findings=[found], **more), NOW)
    cells = table_row(row)
    assert cells["urgency"] == urgency
    assert cells["what_to_check"].startswith(first)
    assert cells["what_to_check"].endswith(key)
    assert key[1:] in robot_item(row, zone_of(None), "robots")["check"]


def test_metrics_are_what_prometheus_reads(built_fleet):
    found = {}
    for family in text_string_to_metric_families((built_fleet / "metrics.prom").read_text()):
        for sample in family.samples:
            found[sample.name, *sorted(sample.labels.values())] = sample.value
    assert found["jointwear_axis_coulomb_growth_ratio", "2", "joint_2", "worn"] == 0.12
    growths = [key for key in found if key[0] == "jointwear_axis_viscous_growth_ratio"]
    assert growths == [("jointwear_axis_viscous_growth_ratio", "3", "joint_3", "sooner")]
    assert found[growths[0]] == 0.31
    assert found["jointwear_axis_hours_to_limit", "2", "high", "joint_2", "worn"] == np.inf
    assert found["jointwear_robot_urgency", "broken", "refused"] == 1
    assert found["jointwear_robot_stale_logs", "silent"] == 5
    assert found["jointwear_run_timestamp_seconds",] == NOW


def test_growth_from_before_an_event_is_no_growth_of_now(tmp_path):
    """An axis that was served on the last day: the table has no number, and a board would count down from the old."""
    served = {"event": {"time": NOW - 3600, "kind": "service", "note": ""}, "until": NOW - 7200}
    aged = axis(3, UNRESOLVED, growth=25.0, viscous_growth=31.0)
    rows = [as_of(robot("served", {**aged, **served}), NOW), as_of(robot("worn", aged), NOW)]
    write_metrics(rows, NOW, tmp_path / "metrics.prom")
    lines = (tmp_path / "metrics.prom").read_text().splitlines()
    told = sorted(line for line in lines if re.match(r"jointwear_axis_\w+_(growth|limit)_ratio\{", line))
    assert told == [
        'jointwear_axis_coulomb_growth_ratio{axis="3",joint="joint_3",robot="worn"} 0.25',
        'jointwear_axis_coulomb_limit_ratio{axis="3",joint="joint_3",robot="worn"} 0.2',
        'jointwear_axis_viscous_growth_ratio{axis="3",joint="joint_3",robot="worn"} 0.31',
    ]
    for row, growths in zip(rows, (["", ""], [25.0, 31.0]), strict=True):
        cells = table_row(row)
        assert [cells["growth_percent"], cells["viscous_growth_percent"]] == growths


def test_every_metric_is_documented(built_fleet, root):
    """In full, or as its end beside one of the same beginning, where the words before that end are named."""
    told = (root / "docs/howto/metrics.md").read_text()
    kinds = re.findall(r"`(\w+_)`", told)
    named = set(re.findall(r"`(jointwear_\w+)`", told)) | {"jointwear_robot_windows"}
    named |= {f"jointwear_robot_{kind}{what}" for kind in kinds for what in ("logs", "windows")}
    there = set(re.findall(r"^# TYPE (\w+)", (built_fleet / "metrics.prom").read_text(), re.MULTILINE))
    assert "`jointwear_robot_logs`, `_windows`" in told
    assert there <= named
    assert named - {"jointwear_messages_waiting"} <= there


def test_an_empty_history_is_a_table_all_the_same(built_fleet, tmp_path):
    table = parquet.read_table(built_fleet / "history.parquet")
    assert table.num_rows == 0
    assert {"robot", "axis", "end", "status", *ESTIMATES} <= set(table.column_names)
    (tmp_path / "x.parquet").write_bytes(b"PAR1")
    with pytest.raises(InputError, match=r"x\.parquet: is no history"):
        join_histories([tmp_path / "x.parquet"], tmp_path / "all.parquet")
    assert not (tmp_path / "all.parquet").exists()


def test_a_broken_batch_is_named(tmp_path):
    (tmp_path / "b.json").write_text("[]")
    files = [tmp_path / name for name in "cpmhr"]
    with pytest.raises(InputError, match=r"b\.json"):
        summarise_fleet([tmp_path / "b.json"], tmp_path / "robots", *files)


def test_the_board_asks_for_metrics_that_there_are(built_fleet, root):
    board = json.loads((root / "config/examples/grafana_fleet.json").read_text())
    asked = {
        name
        for panel in board["panels"]
        for target in panel["targets"]
        for name in re.findall(r"jointwear_\w+", target["expr"])
    }
    there = set(re.findall(r"^# TYPE (\w+)", (built_fleet / "metrics.prom").read_text(), re.MULTILINE))
    assert asked - {"jointwear_messages_waiting"} <= there
    assert len(asked) >= 8
