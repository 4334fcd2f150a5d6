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
