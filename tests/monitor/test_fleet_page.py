"""The page of a fleet and the cards of its robots: what somebody has to do stands first."""

import json
import re
from types import SimpleNamespace

import pytest
from fleet_rows import DAY, NOW, axis, began, fall, findings_on_card, robot

from jointwear.monitor.findings.findings import fell_words
from jointwear.monitor.findings.loud import LOUD
from jointwear.monitor.findings.odd_motion import STOPPED
from jointwear.monitor.findings.read_findings import DRIVES, drives_words
from jointwear.monitor.findings.told_together import told_together
from jointwear.monitor.fleet.folders import own_folder
from jointwear.monitor.fleet.page import fleet_heading, robot_item, write_fleet_page
from jointwear.monitor.fleet.ranking import as_of
from jointwear.monitor.fleet.summary import summarise_fleet
from jointwear.monitor.fleet.table import table_row
from jointwear.monitor.judging.open_alarms import OPEN_ALARM
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.notify.notices import notices
from jointwear.monitor.presentation.condition import CHANGED, UNJUDGED
from jointwear.monitor.presentation.page import finding_rows
from jointwear.monitor.reading.inspection import ALL_LOGS


def test_the_most_urgent_robot_comes_first(built_fleet):
    text = (built_fleet / "index.html").read_text()
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


@pytest.mark.parametrize(
    ("robots", "told"),
    [
        ({"mine": "one", "gone": "one", "broken": ""}, None),
        (
            {"theirs": "two"},
            "1 robot of another configuration is not on this page, which took the place of theirs: theirs.",
        ),
        ({f"r_{k:02}": "two" for k in range(12)}, "12 robots of another configuration are not on this page"),
    ],
)
def test_robots_of_another_configuration_are_told_of(tmp_path, robots, told):
    """A second configuration in one folder takes the page; what it leaves out must not look healthy."""
    for name, configuration in robots.items():
        own_folder(tmp_path / "robots", name, {"logs": [f"{name}/*.csv"]}, (), configuration).mkdir(exist_ok=True)
    (tmp_path / "rows.json").write_text(json.dumps({"robots": [robot("arm", axis(1))]}))
    outputs = [tmp_path / name for name in ("fleet.csv", "index.html", "metrics.prom", "history.parquet", "rows.json")]
    summarise_fleet(
        [tmp_path / "rows.json"], tmp_path / "robots", *outputs, configuration="one", time_zone=None, now=NOW
    )
    text = outputs[1].read_text()
    assert ("of another configuration" in text) == (told is not None)
    if told:
        assert told in text
        assert ("r_09 and 2 more." in text) == (len(robots) > 10)


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
        assert findings_on_card(row) == ["Fri 2025-12-12: The scale changed.", told]


def test_an_axis_on_which_the_limit_would_not_show_is_not_plain_healthy():
    told = [{"time": NOW, "axes": [2], "kind": "coarse", "least": 0.3, "words": "only large changes"}]
    row = as_of(robot("big", axis(1), axis(2), axis(3, UNJUDGED), findings=told), NOW)
    item = robot_item(row, zone_of(None), "robots")
    assert (item["unjudged"], item["coarse"]) == ("axis 3", "axis 2")


def test_friction_that_is_higher_and_logs_that_were_refused_stand_beside_a_healthy_robot(tmp_path):
    told = "Coulomb friction +15.0 % now, with a standard error of 4.8 %, of the limit of 20 %: keep an eye on it."
    old = "a.csv: positions look like degrees; state units"
    rows = [
        as_of(robot("up", axis(1), axis(3, growth=15.0, rising=told)), NOW),
        as_of(robot("calm", axis(1), refused_logs=1, refusals=[old]), NOW),
    ]
    assert [row["urgency"] for row in rows] == ["healthy", "healthy"]
    assert [table_row(row)["axes_higher"] for row in rows] == ["3", ""]
    assert fleet_heading(rows) == "No alarm on 2 robots, friction higher on 1"
    assert fleet_heading(rows[1:]) == "Nothing to check"
    write_fleet_page(rows, tmp_path / "index.html", zone_of(None), NOW)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "nothing to check" not in page
    up, calm = page.split(">up</th>")[1].split("</tr>")[0], page.split(">calm</th>")[1].split("</tr>")[0]
    assert "higher, no alarm" in up
    assert "Axis 3: Coulomb friction +15.0 % now" in up
    assert "refused: a.csv: positions look like degrees" in calm
    write_fleet_page(rows[1:], tmp_path / "index.html", zone_of(None), NOW)
    assert "Healthy: nothing to check" in (tmp_path / "index.html").read_text(encoding="utf-8")


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


def test_what_mends_one_log_names_it():
    """ "Write the torque of this log as the first log has it" stood alone above three logs."""
    mend = "write the torque of this log as the first log has it: 'units' hold for all logs"
    told = [f"logs/{k}.csv: the torque is {k} times that of the first log; {mend}" for k in (2, 3)]
    row = as_of(robot("arm", refused_newest=2, refused_logs=2, refusals=told), NOW)
    (line,) = robot_item(row, zone_of(None), "robots")["mends"]
    assert line.startswith("Write the torque of logs/2.csv and logs/3.csv as the first log has it")
    (line,) = robot_item({**row, "refused_logs": 5}, zone_of(None), "robots")["mends"]
    assert "logs/3.csv and others as the first" in line
    nameless = as_of(robot("arm", refused_newest=1, refused_logs=1, refusals=[f"is odd; {mend}"]), NOW)
    assert "Write the torque of this log as" in robot_item(nameless, zone_of(None), "robots")["mends"][0]


def test_a_column_that_got_another_name_mends_the_logs_that_lack_it():
    rename = "rename the column 'trq_act_3', which nothing reads, to 'torque_3' in this log if it is that one"
    empty = "log 'torque_3', or write it as an empty column to have the other axes monitored"
    told = [f"{name}: the columns 'torque_1', 'torque_2' ... have gaps; {rename}; {empty}" for name in ("a", "b")]
    row = as_of(robot("arm", refused_newest=2, refused_logs=2, refusals=told), NOW)
    mends = robot_item(row, zone_of(None), "robots")["mends"]
    assert mends == ["R" + rename[1:].replace("this log", "a and b"), "L" + empty[1:]]


def test_logs_that_come_and_are_refused_are_no_silence(tmp_path):
    rows = {"robots": [robot("arm", last_sample=NOW - 5 * DAY, refused_newest=n, refused_logs=n) for n in (9, 0)]}
    rows["robots"][1]["robot"] = "other"
    page = tmp_path / "index.html"
    write_fleet_page([as_of(row, NOW) for row in rows["robots"]], page, zone_of(None), NOW, "robots", [])
    text = page.read_text()
    assert "5 days ago: 9 logs that came since are refused" in text
    assert text.count("silent for 5 days") == 1
    told = [n.words for n in notices([as_of(row, NOW) for row in rows["robots"]], zone_of(None))]
    assert told[1:] == ["no log that can be judged for 5 days", "no new log for 5 days"]


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


def test_a_position_that_stands_still_comes_before_what_follows_from_it():
    """An engineer had been sent to the torque of another axis."""
    stopped = {"time": NOW - DAY, "end": NOW, "axes": [2], "kind": STOPPED, "words": "The position of axis 2 stays."}
    loud = {"time": NOW - DAY / 2, "axes": [3], "kind": LOUD, "words": "The torque of axis 3 grew uneven."}
    row = as_of(robot("arm", findings=[loud, stopped]), NOW)
    assert "stays" in findings_on_card(row)[0]
    assert "stays" in table_row(row)["what_to_check"]


def test_what_is_to_be_mended_comes_before_what_is_only_told():
    """And what still lasts is not over: a card said that its robot asks for something, and not for what."""
    missing = {"time": NOW - 9 * DAY, "end": NOW, "axes": [3], "kind": "missing", "words": "No torque of axis 3."}
    uneven = {"time": NOW - 8 * DAY, "axes": [2], "kind": "uneven", "words": "The torque of axis 2 grew uneven."}
    shared = {"time": NOW - DAY, "axes": [], "kind": "shared", "words": "All axes moved together."}
    row = as_of(robot("arm", findings=[shared, began(2), missing, uneven]), NOW)
    assert findings_on_card(row) == [
        "Wed 2025-12-24: The torque of axis 2 grew uneven.",
        "Tue 2025-12-23: No torque of axis 3.",
        "Wed 2025-12-31: All axes moved together.",
    ]


def test_what_asks_for_nothing_is_folded_away(tmp_path):
    """Notes of fifty words under most robots hid what was to be answered: 5,600 words for 31 robots of 48."""
    lasting = {"time": NOW - 9 * DAY, "end": NOW, "axes": [3], "kind": "missing", "words": "No torque of axis 3."}
    over = {
        "time": NOW - 8 * DAY,
        "end": NOW - 7 * DAY,
        "axes": [2],
        "kind": "contradicted",
        "words": "Torque of axis 2.",
    }
    unknown = {"time": NOW - DAY, "axes": [], "kind": "robot", "words": "The robot file lacks a load."}
    logs = {**began(3), "words": "All of it lies in one log.", "logs": ["1.csv"]}
    for found, open_one in (
        (fall(1), True), (lasting, True), (unknown, True), (logs, True), (began(2), False), (over, False),
    ):  # fmt: skip
        item = robot_item(as_of(robot("arm", findings=[found]), NOW), zone_of(None), "robots")
        assert [bool(item["open"]), bool(item["notes"])] == [open_one, not open_one], found["kind"]
    row = as_of(robot("arm", axis(1, CHANGED), findings=[over, began(2), fall(2)]), NOW)
    write_fleet_page([row], tmp_path / "index.html", zone_of(None), NOW)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    before, folded = page.split("<summary>2 notes</summary>")
    assert "Friction of axis 2 fell" in before
    notes = folded.split("</details>")[0]
    assert "A program began." in notes
    assert "Torque of axis 2." in notes


def test_axes_whose_limit_cannot_be_seen_take_one_sentence():
    coarse = [
        {"time": NOW, "axes": [a], "kind": "coarse", "least": s, "words": f"axis {a}"}
        for a, s in ((4, 0.33), (1, 0.2), (2, 0.25))
    ]
    other = {"time": NOW - DAY, "axes": [3], "kind": "proposed_service", "words": "Friction of axis 3 fell"}
    row = as_of(robot("x", findings=[*coarse[:2], other, coarse[2]]), NOW)
    service, told = findings_on_card(row)
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


def test_what_asks_for_an_answer_is_not_crowded_out():
    programs = [began(1), began(2, None), began(3)]
    row = as_of(robot("arm", findings=[fall(5, 9), *programs, fall(1, 9), fall(2, 8)]), NOW)
    newest, both, program = findings_on_card(row)
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
    (told,) = findings_on_card(row)
    assert told.startswith("Wed 2025-12-31: The torque changed at once 3 times, as with parts that")
    assert "(axes 1 and 6; axes 2, 3 and 4), the first 2 days before the last:" in told
    assert told.endswith("; with 1 of them most axes cannot be judged yet.")
    row["findings"] = row["findings"][:1]
    assert findings_on_card(row) == ["Mon 2025-12-29: The torque changed."]


def test_an_alarm_that_was_open_under_another_program_is_told_first():
    told = {"time": NOW - 9 * DAY, "axes": [2], "kind": OPEN_ALARM, "words": "An alarm was open."}
    newer = [{"time": NOW - k * DAY, "axes": [], "kind": "shared", "words": f"Told {k}."} for k in range(4)]
    row = as_of(robot("arm", findings=[*newer, told]), NOW)
    assert findings_on_card(row)[0].endswith(": An alarm was open.")


def test_what_an_event_has_answered_is_no_more_to_check():
    row = as_of(robot("arm", findings=[fall(5, 9, answered=True), fall(1, 9)]), NOW)
    (told,) = findings_on_card(row)
    assert "Friction of axis 1 fell" in told
    # The page of the robot keeps both, each by itself.
    assert [f["axes"] for f in told_together(row["findings"])] == [[5], [1]]


def test_one_program_and_logs_without_a_date_stay_as_they_are():
    row = as_of(robot("arm", findings=[began(1), fall(2)], dated=False), NOW)
    assert findings_on_card(row) == [fell_words([2]), "A program began."]


def test_logs_that_are_not_there_are_none_of_those_that_are(built_fleet):
    page = (built_fleet / "index.html").read_text()
    assert "Due from silent robots since their newest logs: 5 logs of about 120 windows." in page
    assert "overdue" not in page


def test_what_comes_and_goes_takes_one_line_on_the_page_of_the_robot():
    """As torques that a product's load took apart on 36 days (fleet 24)."""
    product = [
        {"time": NOW - k * DAY, "end": NOW - k * DAY + 3600, "axes": [4], "kind": "contradicted", "words": "Axis 4."}
        for k in (1, 3, 5)
    ]
    lasting = [
        {"time": NOW - k * DAY, "axes": [2], "kind": "zero", "words": "Joint 2 counts otherwise."} for k in (2, 4)
    ]
    dates = SimpleNamespace(dated=True, short=False)
    rows = finding_rows({"findings": [*product, *lasting], "last_sample": NOW}, dates, zone_of(None))
    assert [r["words"] for r in rows] == ["Axis 4. It was so 2 times before."] + 2 * ["Joint 2 counts otherwise."]
    assert [r["asks"] for r in rows] == [False, True, True]
    assert [r["urgent"] for r in rows] == [False, True, True]
    once = finding_rows({"findings": product[:2], "last_sample": NOW}, dates, zone_of(None))
    assert [r["words"] for r in once] == ["Axis 4. It was so once before."]
