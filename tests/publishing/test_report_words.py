"""The words of the report, and where its numbers come from."""

import json
import re
import subprocess
from pathlib import Path

import pytest

from jointwear.files import shown_numbers as numbers
from jointwear.publishing.report import drivers, origin, wording
from jointwear.publishing.report.first_screen import claims, left_out
from jointwear.publishing.report.inline import inline_svg
from jointwear.publishing.report.page import read_chapter
from jointwear.publishing.report.rendering import environment
from jointwear.reproduction.grid import Cell


def test_summary_counts_what_the_tables_say(data):
    summary = wording.summary(data)
    verdicts = [data["scores"][t]["verdicts"] for t in ("table_ii", "table_iv", "table_v", "table_vi")]
    assert summary["totals"]["agrees"] == sum(v["agrees"] for v in verdicts)
    assert len({s["key"] for s in summary["statements"]}) == len(summary["statements"])


@pytest.mark.parametrize(
    ("variation", "load", "verdict"),
    [((-0.9, -0.3), (0.2, 0.8), "agrees"), ((-0.5, 0.5), (0.2, 0.8), "close"), ((0.1, 0.9), (0.2, 0.8), "differs"),
     ((-0.5, 0.5), (-0.2, 0.8), "not decided")],
)  # fmt: skip
def test_the_claim_is_judged_by_its_intervals(data, variation, load, verdict):
    def entry(predictor, low, high):
        return {
            "increase_percent": 10.0,
            "predictor": predictor,
            "earliness": {"value": (low + high) / 2, "low": low, "high": high},
        }

    measured = [entry("variation", *variation), entry("load", *load), entry("growth_share", 0.3, 0.9)]
    told = wording.summary({**data, "drivers": {**data["drivers"], "measured": measured}})
    statement = next(s for s in told["statements"] if s["key"] == "claim")
    assert statement["verdict"] == verdict
    assert statement["conclusion"] in statement["text"]


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(0.0141, 2, "0.014"), (13.96, 3, "14"), (1234.4, 2, "1234"), (-0.5, 2, "−0.5"), (1e-5, 2, "1·10⁻⁵"), (0.0, 3, "0"),
     (3.2e5, 2, "3.2·10⁵"), (None, 2, "–"), (float("nan"), 2, "–"), (float("inf"), 2, "∞"), (2.948, 4, "2.948")],
)  # fmt: skip
def test_numbers_as_text(value, digits, text):
    assert numbers.number(value, digits) == text


def test_ranges_as_text():
    assert numbers.span(51, 66, 0) == "51–66"
    assert numbers.span(-5, 3, 0) == "−5 to 3"
    assert numbers.span(0.00001, 0.00002, 3) == "0.000"
    assert numbers.span(None, 3, 0) == "–"
    assert numbers.fixed(-0.0001, 2, plus=True) == "0.00"
    assert numbers.percent(0.096) == "10\u202f%"
    assert numbers.run_name("axis2_12.5percent") == "axis 2, 12.5\u202f%"
    assert numbers.run_name("normal") == "normal"


def test_templates_fail_loudly_on_a_name_that_is_missing():
    from jinja2 import UndefinedError

    with pytest.raises(UndefinedError):
        environment().from_string("{{ missing }}").render()


def test_a_job_with_two_outputs_counts_once(tmp_path):
    record = {"rule": "tabulate", "starttime": 10.0, "endtime": 12.0, "log": ["results/logs/a.log"]}
    (tmp_path / "one").write_text(json.dumps(record))
    (tmp_path / "two").write_text(json.dumps({**record, "starttime": 10.001}))
    (tmp_path / "three").write_text(json.dumps({**record, "endtime": 15.0, "log": ["results/logs/b.log"]}))
    (tmp_path / "broken").write_text("{")
    (tmp_path / "other").write_text("{}")
    assert origin.rule_times(tmp_path) == [{"rule": "tabulate", "jobs": 2, "total": 7.0, "longest": 5.0}]
    assert origin.rule_times(tmp_path / "nothing") == []


def test_commit_is_told_only_for_the_project_itself(tmp_path):
    assert origin.commit(tmp_path) is None

    def git(*arguments):
        names = ["-c", "user.name=a", "-c", "user.email=a@b"]
        subprocess.run(["git", "-C", str(tmp_path), *names, *arguments], check=True, capture_output=True)

    git("init")
    (tmp_path / "file").write_text("1")
    git("add", "file")
    git("commit", "-m", "first")
    found = origin.commit(tmp_path)
    assert re.fullmatch(r"[0-9a-f]{40}", found["identifier"])
    assert found["changed"] is False
    (tmp_path / "file").write_text("2")
    assert origin.commit(tmp_path)["changed"] is True
    (tmp_path / "inside").mkdir()
    assert origin.commit(tmp_path / "inside") is None


def test_the_first_screen_says_what_one_experiment_explains(data):
    chapter = read_chapter("data/studies/joint_fit/chapter.json")
    first = left_out(data, {"joint_fit": chapter})[0]
    assert first["anchor"] == "joint_fit"
    assert "the outcome of 32 of 36 runs and Table V within 0.9" in first["finding"]
    assert "14.0 h apart" in first["finding"]


def test_inlined_figures_do_not_share_identifiers_and_bring_no_script(tmp_path):
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 100 50">'
        "<title>t</title><desc>says &lt;all&gt;</desc><script>alert(1)</script>"
        '<defs><clipPath id="c"><rect/></clipPath></defs><g clip-path="url(#c)" onclick="alert(2)">'
        '<use xlink:href="#c" style="fill: #1c1c1f; stroke: #123456"/><use xlink:href="http://a/b"/></g></svg>'
    )
    text = str(inline_svg(tmp_path / "a.svg", "one"))
    assert 'id="one-c"' in text
    assert "url(#one-c)" in text
    assert 'href="#one-c"' in text
    assert "script" not in text
    assert "onclick" not in text
    assert "http:" not in text
    assert "fill: var(--ink)" in text
    assert "#123456" in text
    assert 'aria-label="says &lt;all&gt;"' in text


def test_predictors_need_no_published_run(experiment):
    found = drivers.predictors(
        dict(experiment.results.training_features), [experiment.path("simulation/T2/axis6_10percent.nc")]
    )
    assert set(found) == {Cell("T2", 10.0, 6)}


def test_every_line_of_the_first_screen_leads_somewhere(data, experiment):
    page = Path(experiment.path("report/index.html")).read_text(encoding="utf-8")
    lines = [*claims(data, wording.summary(data)["statements"]), *left_out(data, {})]
    assert len(lines) == 11
    for line in lines:
        assert f'id="{line["anchor"]}"' in page, line
        assert line["claim"] in page.replace("&#39;", "'"), line
        assert not line["finding"].endswith("."), line
