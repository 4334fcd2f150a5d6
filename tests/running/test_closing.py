"""What a run says at its end."""

import json
import os
import time

from jointwear.running.closing import closing_lines


def page(path, age=0.0):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("page")
    os.utime(path, (time.time() - age,) * 2)
    return path


def test_the_report_comes_with_its_scores(tmp_path):
    page(tmp_path / "results/report/index.html")
    statements = [{"title": f"Claim {k}", "verdict": "agrees", "text": "All. More words."} for k in range(7)]
    (tmp_path / "results/report/summary.json").write_text(json.dumps({"summary": {"statements": statements}}))
    lines = closing_lines(tmp_path, time.time() - 60)
    assert lines == [f"Claim {k}: agrees. All." for k in range(5)] + ["report: results/report/index.html"]


def test_pages_of_earlier_runs_are_not_told(tmp_path):
    page(tmp_path / "results/discover/old/discover.html", age=600)
    page(tmp_path / "results/discover/new/discover.html")
    assert closing_lines(tmp_path, time.time() - 60) == ["page: results/discover/new/discover.html"]


def test_a_damaged_summary_costs_no_run(tmp_path):
    page(tmp_path / "results/report/index.html")
    (tmp_path / "results/report/summary.json").write_text("{")
    assert closing_lines(tmp_path, time.time() - 60) == ["report: results/report/index.html"]


def test_of_a_fleet_it_is_told_what_waits_and_why_a_robot_is_refused(tmp_path):
    page(tmp_path / "results/fleet/index.html")
    robots = [
        {"robot": "a", "urgency": "limit reached", "result": "judged", "reason": ""},
        {"robot": "b", "urgency": "refused", "result": "refused", "reason": "day.csv: has no column 'A3'"},
        {"robot": "d", "urgency": "refused", "result": "judged", "reason": "", "refusals": ["1.csv", "2.csv: new"]},
        {"robot": "c", "urgency": "healthy", "result": "judged", "reason": "", "refusals": ["1.csv: a torn row"]},
    ]
    rows = tmp_path / "results/fleet/rows.json"
    for shown, lines in (
        (
            robots,
            [
                "fleet: 3 of 4 robots to look at: 1 limit reached, 2 refused",
                "refused: b: day.csv: has no column 'A3'",
                "refused: d: 2.csv: new",
            ],
        ),
        (robots[3:], ["fleet: 0 of 1 robot to look at"]),
        ([], []),
        ("damaged", []),
    ):
        rows.write_text(json.dumps({"robots": shown}), encoding="utf-8")
        assert closing_lines(tmp_path, time.time() - 60) == [*lines, "page: results/fleet/index.html"]


def test_what_a_robot_learnt_is_told(tmp_path):
    for name, adopted in (("a", "friction"), ("b", "given"), ("c", None)):
        page(tmp_path / f"results/learned/{name}/learned.json").write_text(
            json.dumps({"adopted": adopted} if adopted else {})
        )
    assert closing_lines(tmp_path, time.time() - 60) == [
        "learnt: results/learned/a/learned.json, the friction model is used from now on",
        "learnt: results/learned/b/learned.json, the given model stays",
        "learnt: results/learned/c/learned.json",
    ]


def test_of_a_fleet_early_events_and_what_is_left_of_robots_are_told(tmp_path):
    page(tmp_path / "results/fleet/index.html")
    found = [{"kind": "scale", "words": "Else."}, {"kind": "early_event", "words": "The event changes nothing."}]
    row = {"robot": "a", "urgency": "healthy", "result": "judged", "reason": "", "findings": found}
    for kept in ("fleet/robots/old", "learned/old"):
        (tmp_path / "results" / kept).mkdir(parents=True)
    (tmp_path / "results/fleet/rows.json").write_text(json.dumps({"robots": [row], "left": ["old"]}))
    assert closing_lines(tmp_path, time.time() - 60) == [
        "fleet: 0 of 1 robot to look at",
        "event: a: The event changes nothing.",
        (
            "left: old is no longer in the configuration; what is known of it is kept in results/fleet/robots/old and "
            "results/learned/old; delete that if the robot does not come back"
        ),
        "page: results/fleet/index.html",
    ]
