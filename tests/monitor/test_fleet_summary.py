"""The page, table, metrics and history of a fleet: urgency first, nothing refused or silent looks healthy."""

import csv
import json
import re
from types import SimpleNamespace

import numpy as np
import pyarrow.parquet as parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st
from prometheus_client.parser import text_string_to_metric_families

from jointwear.files.errors import InputError
from jointwear.monitor.findings.findings import fell_words
from jointwear.monitor.findings.read_findings import DRIVES, drives_words
from jointwear.monitor.findings.told_together import told_together
from jointwear.monitor.fleet.history import ESTIMATES, join_histories
from jointwear.monitor.fleet.metrics import write_metrics
from jointwear.monitor.fleet.page import robot_item, write_fleet_page
from jointwear.monitor.fleet.ranking import ASKS, ORDER, REFUSED, as_of, ranked
from jointwear.monitor.fleet.summary import summarise_fleet
from jointwear.monitor.fleet.table import table_row
from jointwear.monitor.judging.open_alarms import OPEN_ALARM
from jointwear.monitor.local_time import local_time, zone_of
from jointwear.monitor.presentation.condition import CHANGED, HEALTHY, UNJUDGED, UNRESOLVED
from jointwear.monitor.presentation.page import finding_rows
from jointwear.monitor.presentation.standing import NOTHING, rhythm_hours
from jointwear.monitor.presentation.words import MAY_BE_REACHED, change_words, outlook_words
from jointwear.monitor.reading.inspection import ALL_LOGS
from jointwear.monitor.watching.backlash import BACKLASH

NOW = 1_767_225_600.0
DAY = 86400.0


def axis(number=1, level=HEALTHY, **more):
    calm = {"reached": False, "growth": 0.1, "growth_std": 0.1, "limit": 20.0, "hours": None, "quantity": "",
            "change": None, "unit": "", "since": None, "alarms": 0, "check": "", "viscous_growth": None}  # fmt: skip
    if level in (CHANGED, UNRESOLVED):
        calm |= {"quantity": "coulomb friction", "since": NOW - DAY, "alarms": 3, "check": "check the gear"}
    return {"axis": number, "joint": f"joint_{number}", "level": level, **calm, **more}


def robot(name, *axes, **more):
    found = {"robot": name, "folder": name, "result": "judged", "logs": 10, "windows": 240, "last_sample": NOW - 3600,
             "rhythm_hours": 24.0, "dated": True, "axes": list(axes) or [axis()]}  # fmt: skip
    return {**NOTHING, **found, **more}


FLEET = [
    robot("calm"),
    robot("worn", axis(2, CHANGED, growth=12.0, hours=[200.0, 90.0, None])),
    robot("sooner", axis(3, CHANGED, growth=9.0, viscous_growth=31.0, hours=[80.0, 40.0, 400.0])),
    robot("done", axis(1, CHANGED, growth=23.0, hours=[0.0, 0.0, 0.0], reached=True)),
    robot("broken", result="refused", reason="degrees <b>", axes=[], refused_logs=10),
    robot("odd", axis(2, UNRESOLVED), copied_logs=3),
    robot("silent", last_sample=NOW - 5 * DAY),
    robot("still", axis(1, UNJUDGED), unjudged_logs=10, unjudged_windows=240),
]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fleet")
    (folder / "batch.json").write_text(json.dumps({"robots": FLEET}))
    names = ("fleet.csv", "index.html", "metrics.prom", "history.parquet", "rows.json")
    files = (folder / name for name in names)
    message = {"channel": "shift", "since": NOW, "attempts": 1, "title": "t", "body": "b"}
    (folder / "outbox.json").write_text(json.dumps({"told": {}, "waiting": [message] * 2}))
    more = {"time_zone": "America/New_York", "now": NOW, "outbox": folder / "outbox.json"}
    summarise_fleet([folder / "batch.json"], folder / "robots", *files, **more)
    return folder


def test_the_most_urgent_robot_comes_first(built):
    text = (built / "index.html").read_text()
    assert "3 of 10 logs with the samples of another, which count once" in text
    order = re.findall(r"<h3>(?:<a [^>]*>)?(\w+)", text)
    assert order == ["done", "sooner", "worn", "broken", "odd", "silent", "still"]
    assert "7 of 8 robots to look at" in text
    assert "limit not before Sun 2026-01-04" in text
    assert "limit reached" in text
    assert "degrees &lt;b&gt;" in text
    assert "2025-12-31 19:00 EST" in text
    assert "shift 2" in text
    assert "silent for 5 days" in text


def test_of_robots_without_a_forecast_the_one_that_has_grown_most_comes_first():
    scale = {"time": NOW - DAY, "axes": [2], "kind": "scale", "words": "The scale changed."}
    rows = [robot(name, axis(1, CHANGED, growth=grown)) for name, grown in (("a", 3.0), ("b", 11.0), ("c", None))]
    rows += [robot("silent", last_sample=NOW - 5 * DAY), robot("asks", findings=[scale])]
    order = [row["robot"] for row in ranked([as_of(row, NOW) for row in rows])]
    assert order == ["b", "a", "c", "asks", "silent"]


def test_what_cannot_be_judged_of_backlash_is_nothing_to_check():
    found = [
        {"time": NOW, "axes": [1], "kind": BACKLASH, "words": "Backlash of axis 1 cannot be judged."},
        {"time": NOW - DAY, "axes": [2], "kind": "scale", "words": "The scale changed."},
    ]
    row = as_of(robot("arm", findings=found), NOW)
    item = robot_item(row, zone_of(None), "robots")
    assert item["findings"] == ["Wed 2025-12-31: The scale changed."]
    # Somebody has to say what was done to it.
    assert (row["urgency"], item["check"]) == (
        "needs an entry under events",
        "Enter what was done to it, or look for the cause",
    )
    assert as_of(robot("arm", findings=found[:1]), NOW)["urgency"] == "healthy"


@pytest.mark.parametrize("kind", ["contradicted", "outside", "frozen", "missing", "drives", "uneven"])
def test_a_torque_or_position_that_is_none_asks_for_its_cause_while_it_lasts(kind):
    found = {"time": NOW - DAY, "axes": [3], "kind": kind, "words": "The torque of axis 3 is none."}
    assert (
        as_of({**robot("arm", findings=[found]), "last_sample": NOW - 60.0}, NOW)["urgency"]
        == "needs an entry under events"
    )
    for end, urgency in ((NOW + 60.0, "needs an entry under events"), (NOW - DAY / 2, "healthy")):
        row = robot("arm", findings=[{**found, "end": end}])
        assert as_of({**row, "last_sample": NOW - 60.0}, NOW)["urgency"] == urgency


def test_spells_that_are_over_are_told_once_and_last():
    spells = [
        {"time": NOW - k * DAY, "end": NOW - k * DAY + 3600, "axes": [], "kind": "shared", "words": f"Spell {k}."}
        for k in (5, 2, 9)
    ]
    scale = {"time": NOW - 20 * DAY, "axes": [2], "kind": "scale", "words": "The scale changed."}
    for count, told in (
        (1, "Sat 2025-12-27: Spell 5."),
        (2, "Tue 2025-12-30: Spell 2. It was so once before."),
        (3, "Tue 2025-12-30: Spell 2. It was so 2 times before."),
    ):
        row = as_of(robot("arm", findings=[*spells[:count], scale]), NOW)
        assert robot_item(row, zone_of(None), "robots")["findings"] == ["Fri 2025-12-12: The scale changed.", told]


def test_a_service_that_is_proposed_asks_for_its_event_until_one_is_entered():
    found = {"time": NOW, "axes": [2], "kind": "proposed_service", "words": "Friction of axis 2 fell."}
    assert as_of(robot("arm", findings=[found]), NOW)["urgency"] == "needs an entry under events"
    assert as_of(robot("arm", findings=[{**found, "answered": True}]), NOW)["urgency"] == "healthy"


def test_an_axis_on_which_the_limit_would_not_show_is_not_plain_healthy():
    told = [{"time": NOW, "axes": [2], "kind": "coarse", "least": 0.3, "words": "only large changes"}]
    row = as_of(robot("big", axis(1), axis(2), axis(3, UNJUDGED), findings=told), NOW)
    item = robot_item(row, zone_of(None), "robots")
    assert (item["unjudged"], item["coarse"]) == ("axis 3", "axis 2")


def test_logs_with_one_fault_take_one_line():
    told = [f"logs/{k}.csv: positions reach {k}; state units" for k in (1, 2, 3)] + ["logs/4.csv: is empty"]
    row = as_of(robot("arm", refusals=told), NOW)
    assert robot_item(row, zone_of(None), "robots")["refusals"] == [
        ("logs/3.csv: positions reach 3; likewise logs/1.csv and logs/2.csv", "state units"),
        ("logs/4.csv: is empty", ""),
    ]
    told = [
        "1.csv: another multiple (1.5 on joint 1); times 0.667 for joint 1; anew",
        "2.csv: another multiple (-1e+03 on joint 1, 2 on joint 12); times -0.001 for joint 1, 3 for joint 12; anew",
    ]
    (line,) = robot_item(as_of(robot("arm", refusals=told), NOW), zone_of(None), "robots")["refusals"]
    assert line[0] == "2.csv: another multiple (-1e+03 on joint 1, 2 on joint 12); likewise 1.csv"


def test_what_mends_refused_logs_comes_first(tmp_path):
    told = [
        "logs/1.csv: the torque is another multiple; it looks like a current; write the torque as the first log has it",
        "logs/2.csv: the torque is another multiple; it looks like mN m; write the torque as the first log has it",
        "logs/3.csv: is text in UTF-16; save it as UTF-8",
        "logs/4.csv: is empty",
        "logs/5.csv: the torque lags the motion by 0.2 s; join torque and motion by one clock",
    ]
    row = as_of(robot("arm", refusals=told, refused_logs=5, refused_newest=5), NOW)
    assert robot_item(row, zone_of(None), "robots")["mends"] == [
        "Write the torque as the first log has it",
        "Save it as UTF-8",
        "Join torque and motion by one clock",
    ]
    write_fleet_page([row], tmp_path / "index.html", zone_of(None), NOW)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert page.index("Write the torque as the first log has it.") < page.index("logs/4.csv")


def test_one_log_in_another_unit_is_mended_by_no_key_of_the_robot():
    """ "State units: {position: deg}." stood on top for one log of 20; obeyed, it refuses the other 19."""
    why = "they look like degrees; state units: {position: deg}"
    told = [f"logs/{k}.csv: positions of joint {k} reach 71; {why}{ALL_LOGS}" for k in (3, 5)]
    swapped = "logs/7.csv: the torques of joints 2 and 3 look swapped against the first log; exchange them"
    row = as_of(robot("arm", refusals=[*told, f"{swapped}{ALL_LOGS}"], refused_logs=3, logs=20), NOW)
    then = "Write it as in the others; a key of the robot would hold for these too"
    assert robot_item(row, zone_of(None), "robots")["mends"] == [
        f"Mend logs/3.csv and logs/5.csv alone, of 20 logs: positions look like degrees. {then}",
        f"Mend logs/7.csv alone, of 20 logs: the torques of joints 2 and 3 look swapped. {then}",
    ]
    # Of a robot that is refused as a whole a key mends all.
    whole = robot("arm", result="refused", reason=told[0], refusals=told[:1], refused_logs=20, logs=20, axes=[])
    assert robot_item(as_of(whole, NOW), zone_of(None), "robots")["mends"][0] == "State units: {position: deg}"


@pytest.mark.parametrize(("refused", "told"), [(3, ""), (4, "1 log more refused"), (11, "8 logs more refused")])
def test_refused_logs_that_the_page_does_not_name_are_counted(tmp_path, refused, told):
    named = [f"logs/{k}.csv: positions reach {k}; state units" for k in (1, 2, 3)]
    row = robot("arm", axis(1, CHANGED), refusals=named, refused_logs=refused, logs=20)
    (tmp_path / "batch.json").write_text(json.dumps({"robots": [row]}))
    files = (tmp_path / name for name in ("fleet.csv", "index.html", "metrics.prom", "history.parquet", "rows.json"))
    summarise_fleet([tmp_path / "batch.json"], tmp_path / "robots", *files, now=NOW)
    assert re.findall(r"\d+ logs? more refused", (tmp_path / "index.html").read_text()) == ([told] if told else [])


def test_a_changed_axis_that_is_not_judged_now_tells_its_newest_alarm():
    told = {**axis(3, CHANGED), "growth": None, "quantity": "coulomb friction", "change": 91.8, "unit": "N m"}
    assert change_words(told) == "Coulomb friction +92 N m at its newest alarm, not judged now; limit 20 %"


def test_what_is_to_be_mended_comes_before_what_is_only_told():
    """And what still lasts is not over: a card said that its robot asks for something, and not for what."""
    missing = {"time": NOW - 9 * DAY, "end": NOW, "axes": [3], "kind": "missing", "words": "No torque of axis 3."}
    uneven = {"time": NOW - 8 * DAY, "axes": [2], "kind": "uneven", "words": "The torque of axis 2 grew uneven."}
    shared = {"time": NOW - DAY, "axes": [], "kind": "shared", "words": "All axes moved together."}
    row = as_of(robot("arm", findings=[shared, began(2), missing, uneven]), NOW)
    assert robot_item(row, zone_of(None), "robots")["findings"] == [
        "Wed 2025-12-24: The torque of axis 2 grew uneven.",
        "Tue 2025-12-23: No torque of axis 3.",
        "Wed 2025-12-31: All axes moved together.",
    ]


def test_an_axis_over_its_limit_without_an_alarm_is_not_called_healthy():
    told = "viscous friction +23.5 % now, Coulomb friction −13.5 %: over the limit of 20 % without an alarm."
    row = as_of(robot("arm", axis(5, over=told), findings=[began(1)]), NOW)
    item = robot_item(row, zone_of(None), "robots")
    assert item["urgency"] == "needs an entry under events"
    assert item["findings"][0] == f"Axis 5: {told}"
    assert as_of(robot("arm", axis(5, over="")), NOW)["urgency"] == "healthy"


def test_axes_whose_limit_cannot_be_seen_take_one_sentence():
    coarse = [
        {"time": NOW, "axes": [a], "kind": "coarse", "least": s, "words": f"axis {a}"}
        for a, s in ((4, 0.33), (1, 0.2), (2, 0.25))
    ]
    other = {"time": NOW - DAY, "axes": [3], "kind": "proposed_service", "words": "Friction of axis 3 fell"}
    row = as_of(robot("x", findings=[*coarse[:2], other, coarse[2]]), NOW)
    service, told = robot_item(row, zone_of(None), "robots")["findings"]
    assert told.startswith("Of axes 1, 2 and 4 only changes above 20 to 33 % can be seen")
    assert service == "Wed 2025-12-31: Friction of axis 3 fell"
    assert [f["words"] for f in told_together([coarse[0], other])] == ["axis 4", "Friction of axis 3 fell"]
    alike = [{**f, "least": 0.3} for f in coarse]
    assert "only changes above 30 % can be seen" in told_together(alike)[0]["words"]


def test_axes_without_friction_at_one_time_take_one_sentence():
    found = [{"time": NOW, "axes": [a], "kind": DRIVES, "words": drives_words([a])} for a in (2, 1)]
    later = {**found[0], "time": NOW + DAY}
    told = told_together([*found, later])
    assert [f["axes"] for f in told] == [[1, 2], [2]]
    assert told[0]["words"].startswith("Friction of axes 1 and 2 came out at zero or below")


def fall(axis, days=0, **more):
    found = {"time": NOW - days * DAY, "axes": [axis], "kind": "proposed_service", "words": fell_words([axis])}
    return {**found, "fell": True, **more}


def began(days, judged_after=4.0):
    told = {"time": NOW - days * DAY, "axes": [], "kind": "program", "words": "A program began.", "ran": 6.0}
    return {**told, "judged_after": judged_after}


def test_what_asks_for_an_answer_is_not_crowded_out():
    programs = [began(1), began(2, None), began(3)]
    row = as_of(robot("arm", findings=[fall(5, 9), *programs, fall(1, 9), fall(2, 8)]), NOW)
    newest, both, program = robot_item(row, zone_of(None), "robots")["findings"]
    assert newest.startswith("Wed 2025-12-24: Friction of axis 2 fell: was it serviced")
    assert both.startswith("Tue 2025-12-23: Friction of axes 1 and 5 fell: were they serviced")
    assert program.startswith(
        "Wed 2025-12-31: The motion shows 3 programs that the baseline did not have, 18 h in all; in 1 "
    )


def test_products_that_came_again_and_again_take_one_sentence():
    def product(days, moved, judged=True):
        told = {"time": NOW - days * DAY, "axes": [], "kind": "program", "words": "The torque changed.", "moved": moved}
        return {**told, "judged": judged}

    row = as_of(robot("arm", findings=[product(3, [1, 6]), product(1, [2, 3, 4], False), product(2, [1, 6])]), NOW)
    (told,) = robot_item(row, zone_of(None), "robots")["findings"]
    assert told.startswith("Wed 2025-12-31: The torque changed at once 3 times, as with parts that")
    assert "(axes 1 and 6; axes 2, 3 and 4)" in told
    assert told.endswith("; with 1 of them most axes cannot be judged yet.")
    row["findings"] = row["findings"][:1]
    assert robot_item(row, zone_of(None), "robots")["findings"] == ["Mon 2025-12-29: The torque changed."]


def test_an_alarm_that_was_open_under_another_program_is_told_first():
    told = {"time": NOW - 9 * DAY, "axes": [2], "kind": OPEN_ALARM, "words": "An alarm was open."}
    newer = [{"time": NOW - k * DAY, "axes": [], "kind": "shared", "words": f"Told {k}."} for k in range(4)]
    row = as_of(robot("arm", findings=[*newer, told]), NOW)
    assert robot_item(row, zone_of(None), "robots")["findings"][0].endswith(": An alarm was open.")


def test_what_an_event_has_answered_is_no_more_to_check():
    row = as_of(robot("arm", findings=[fall(5, 9, answered=True), fall(1, 9)]), NOW)
    (told,) = robot_item(row, zone_of(None), "robots")["findings"]
    assert "Friction of axis 1 fell" in told
    # The page of the robot keeps both, each by itself.
    assert [f["axes"] for f in told_together(row["findings"])] == [[5], [1]]


def test_one_program_and_logs_without_a_date_stay_as_they_are():
    row = as_of(robot("arm", findings=[began(1), fall(2)], dated=False), NOW)
    assert robot_item(row, zone_of(None), "robots")["findings"] == [fell_words([2]), "A program began."]


def test_logs_that_are_not_there_are_none_of_those_that_are(built):
    page = (built / "index.html").read_text()
    assert "Due from silent robots since their newest logs: 5 logs of about 120 windows." in page
    assert "overdue" not in page


def test_the_table_counts_what_was_refused_stale_or_not_judged(built):
    with (built / "fleet.csv").open() as file:
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


def test_metrics_are_what_prometheus_reads(built):
    found = {}
    for family in text_string_to_metric_families((built / "metrics.prom").read_text()):
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


def test_every_metric_is_documented(built, root):
    """In full, or as its end beside one of the same beginning, where the words before that end are named."""
    told = (root / "docs/howto/metrics.md").read_text()
    kinds = re.findall(r"`(\w+_)`", told)
    named = set(re.findall(r"`(jointwear_\w+)`", told)) | {"jointwear_robot_windows"}
    named |= {f"jointwear_robot_{kind}{what}" for kind in kinds for what in ("logs", "windows")}
    there = set(re.findall(r"^# TYPE (\w+)", (built / "metrics.prom").read_text(), re.MULTILINE))
    assert "`jointwear_robot_logs`, `_windows`" in told
    assert there <= named
    assert named - {"jointwear_messages_waiting"} <= there


def test_an_empty_history_is_a_table_all_the_same(built, tmp_path):
    table = parquet.read_table(built / "history.parquet")
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


@given(
    st.lists(st.sampled_from([HEALTHY, CHANGED, UNRESOLVED, UNJUDGED]), min_size=1, max_size=6),
    st.floats(0, 2000),
    st.integers(0, 3),
    st.booleans(),
)
def test_healthy_means_that_nothing_is_known_against_it(levels, silence, refused, judged):
    axes = [axis(k + 1, level) for k, level in enumerate(levels)]
    more = {} if judged else {"result": "refused", "axes": []}
    row = robot("x", *axes, logs=3, refused_newest=refused, last_sample=NOW - 3600 * silence, **more)
    found = as_of(row, NOW)
    fine = judged and silence <= 72 and not refused and HEALTHY in levels and not {CHANGED, UNRESOLVED} & set(levels)
    assert (found["urgency"] == HEALTHY) == fine
    assert (found["stale_windows"] > 0) == (found["stale_logs"] > 0) == (silence > 72)
    assert found["urgency"] in ORDER


def test_a_robot_whose_every_log_lacks_a_torn_row_is_judged_all_the_same():
    assert as_of(robot("x", logs=3, refused_logs=3), NOW)["urgency"] == HEALTHY
    assert as_of(robot("x", axis(1, UNJUDGED), logs=3, refused_logs=3), NOW)["urgency"] == UNJUDGED
    assert as_of(robot("x", axis(1, UNJUDGED), logs=3, refused_logs=3, refused_newest=3), NOW)["urgency"] == REFUSED


def test_a_log_counts_as_overdue_once_the_next_one_would_be_due_too():
    found = as_of(robot("x", logs=10, windows=240, rhythm_hours=24.0, last_sample=NOW - 100 * 3600), NOW)
    assert (found["stale_logs"], found["stale_windows"]) == (4, 96)


@pytest.mark.parametrize(
    ("dated", "last", "ahead"),
    [(True, NOW + 400 * DAY, "400 days"), (True, NOW + 14 * 3600, ""), (False, NOW + 400 * DAY, ""), (True, None, "")],
    ids=["a wrong clock", "a wrong time zone", "no dates", "no sample"],
)
def test_a_robot_whose_newest_log_is_dated_ahead_of_now_is_not_healthy(dated, last, ahead):
    found = as_of(robot("x", dated=dated, last_sample=last), NOW)
    assert found["urgency"] == (ASKS if ahead else HEALTHY)
    assert [f["words"].partition(" ahead")[0] for f in found["findings"]] == (
        [f"The newest sample is dated {ahead}"] if ahead else []
    )


def test_nights_and_weekends_count_into_the_rhythm_of_logs():
    shifts = [day * 86400 + hour * 3600.0 for day in range(40) if day % 7 < 5 for hour in range(6, 22)]
    rhythm = rhythm_hours(np.array([np.nan, *shifts]))
    # 16 logs on five of seven days.
    assert 18 * 24 / rhythm == pytest.approx(18 * 16 * 5 / 7, rel=0.1)
    assert rhythm_hours(np.array([0.0, 40 * 86400.0])) == 960
    assert rhythm_hours(np.array([5.0])) is None


@given(st.permutations(FLEET))
def test_the_order_of_the_config_does_not_matter(rows):
    assert ranked([as_of(r, NOW) for r in rows]) == ranked([as_of(r, NOW) for r in FLEET])


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
    axis = {"hours": hours, "reached": False, "quantity": "viscous friction", "limit": 20.0}
    told = outlook_words({"dated": False, "last_sample": 0.0}, axis, zone_of(None))
    assert told == f"limit of viscous friction (+20 %) {words}"


@pytest.mark.parametrize(("grown", "words"), [(16.7, "may be reached by now"), (19.96, "reached"), (24.0, "reached")])
def test_a_limit_of_one_quantity_is_reached_where_what_is_told_of_it_is(grown, words):
    """A page told viscous friction of +16.7 %, a limit of 20 %, and that the limit was reached."""
    axis = {"hours": [0.0] * 3, "reached": False, "quantity": "viscous friction", "limit": 20.0, "growth": 1.0}
    told = outlook_words({"dated": False, "last_sample": 0.0}, {**axis, "viscous_growth": grown}, zone_of(None))
    assert told == f"limit of viscous friction (+20 %) {words}"


def test_the_size_of_backlash_is_told_as_the_least_it_is():
    axis = {"growth": None, "limit": 20.0, "quantity": "backlash", "change": 53.0, "unit": "%"}
    assert change_words(axis) == "backlash: pulses at reversals by +53 % at least"


def test_table_and_outlook_of_an_axis_tell_a_forecast_of_no_hours_in_the_same_words(root):
    assert f"== 0 %}}{MAY_BE_REACHED}{{% else" in (root / "report/monitor.html.j2").read_text()


def test_times_are_local_and_say_so():
    berlin = zone_of("Europe/Berlin")
    assert local_time(1_774_746_000.0, berlin) == "2026-03-29 03:00 CEST"
    assert local_time(1_774_742_400.0, berlin) == "2026-03-29 01:00 CET"
    with pytest.raises(InputError, match="did you mean 'Europe/Berlin'"):
        zone_of("Europe/Berln")


def test_the_board_asks_for_metrics_that_there_are(built, root):
    board = json.loads((root / "config/examples/grafana_fleet.json").read_text())
    asked = {
        name
        for panel in board["panels"]
        for target in panel["targets"]
        for name in re.findall(r"jointwear_\w+", target["expr"])
    }
    there = set(re.findall(r"^# TYPE (\w+)", (built / "metrics.prom").read_text(), re.MULTILINE))
    assert asked - {"jointwear_messages_waiting"} <= there
    assert len(asked) >= 8


def test_what_comes_and_goes_takes_one_line_on_the_page_of_the_robot():
    """As torques that a product's load took apart on 36 days (fleet 24)."""
    product = [
        {"time": NOW - k * DAY, "end": NOW - k * DAY + 3600, "axes": [4], "kind": "contradicted", "words": "Axis 4."}
        for k in (1, 3, 5)
    ]
    lasting = [
        {"time": NOW - k * DAY, "axes": [2], "kind": "zero", "words": "Joint 2 counts otherwise."} for k in (2, 4)
    ]
    rows = finding_rows({"findings": [*product, *lasting]}, SimpleNamespace(dated=True, short=False), zone_of(None))
    assert [r["words"] for r in rows] == ["Axis 4. It was so 2 times before."] + 2 * ["Joint 2 counts otherwise."]
    assert [r["asks"] for r in rows] == [False, True, True]
    once = finding_rows({"findings": product[:2]}, SimpleNamespace(dated=True, short=False), zone_of(None))
    assert [r["words"] for r in once] == ["Axis 4. It was so once before."]
