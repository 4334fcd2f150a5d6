"""The report: its numbers, its words, and a page that stands on its own."""

import json
import re
import shutil
import subprocess
import sys
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from small_experiment import ROOT, compute, small_config, small_experiment

from jointwear import readings
from jointwear.errors import InputError
from jointwear.grid import Cell
from jointwear.published import load_published
from jointwear.report import detection_rates, drivers, numbers, origin, rendering, wording
from jointwear.report.assembly import assemble, assumptions, paper_facts
from jointwear.report.figure_scores import score_components
from jointwear.report.inline import inline_svg
from jointwear.report.page import other_pages, plain
from jointwear.report.rendering import environment
from jointwear.report.result_tables import lag_verdict, read_table, score_detection, score_values
from jointwear.report.torque_limits import limit_use
from jointwear.storage import Variable, read_variables, write_dataset

VOID = {"meta", "link", "br", "img", "input", "hr"}


class Page(HTMLParser):
    """Collects what the tests ask of a page; unbalanced tags are an error."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open, self.ids, self.links, self.sources, self.images = [], [], [], [], []
        self.words = []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        if "id" in found:
            self.ids.append(found["id"])
        if tag == "a":
            self.links.append(found["href"])
        self.sources += [v for k, v in attributes if k in ("src", "srcset", "data", "action", "xlink:href")]
        if tag == "link":
            self.sources.append(found["href"])
        if tag == "svg":
            self.images.append(found)
        assert tag != "script"
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not self.open or self.open[-1] != "style":
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="session")
def experiment():
    return small_experiment()


@pytest.fixture(scope="session")
def data(experiment):
    return assemble(experiment.results, experiment.config)


@pytest.fixture(scope="session")
def markup(experiment):
    return Path(experiment.path("report/index.html")).read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def page(markup):
    return Page(markup)


# --- the page ---------------------------------------------------------------------------------------------------


def test_the_page_needs_nothing_from_elsewhere(page, markup):
    assert all(s.startswith(("data:", "#")) for s in page.sources)
    assert "@import" not in markup
    assert not re.findall(r"url\((?!#)", markup)
    assert not [link for link in page.links if re.match(r"[a-z]+:", link)]


def test_every_link_leads_somewhere(page, experiment):
    folder = Path(experiment.path("report"))
    for link in page.links:
        if link.startswith("#"):
            assert link[1:] in page.ids, link
        else:
            assert (folder / link).exists(), link


def test_identifiers_are_unique(page):
    assert [i for i, n in Counter(page.ids).items() if n > 1] == []


def test_every_figure_has_a_text_instead(page):
    assert len(page.images) == 6
    assert all(image["role"] == "img" and len(image["aria-label"]) > 40 for image in page.images)


def test_all_published_numbers_stand_in_the_page(page, data):
    for name in ("table_iv", "table_v", "table_vi"):
        for row in data["rows"][name]:
            if row["published"] is not None:
                assert numbers.fixed(row["published"], 0 if name == "table_iv" else 3) in page.text


def test_every_assumption_is_named_with_its_alternatives(page):
    for ambiguity in readings.ambiguities().values():
        assert ambiguity.question in page.text
        assert " ".join(ambiguity.paper.split()) in page.text
        assert all(name in page.text for name in ambiguity.alternatives)


def test_a_verdict_is_never_told_by_colour_alone(markup):
    for verdict, symbol in (("agrees", "✓"), ("close", "≈"), ("differs", "✗")):
        badges = re.findall(rf'<span class="badge {verdict}">(.*?)</span>\s*(\w+)', markup)
        assert badges
        assert all(symbol in inner and word == verdict for inner, word in badges)


def test_the_page_does_not_depend_on_when_it_was_made(experiment, markup, tmp_path):
    again = experiment.write_report(output=tmp_path / "report/index.html").read_text(encoding="utf-8")
    here = Path(experiment.path("report", "summary.json")).read_bytes()
    assert (tmp_path / "report/summary.json").read_bytes() == here
    pattern = re.compile(r'<div data-varies="timings">.*?</div>\s*</div>\s*<h3 id="data"', re.DOTALL)
    assert pattern.search(markup)
    # The links to the figures are relative to the page, and this one lies elsewhere.
    link = re.compile(r'href="[^"]*/figures/')
    first, second = (link.sub('href="figures/', pattern.sub("", text)) for text in (again, markup))
    assert first == second


def test_text_from_files_is_escaped(experiment, tmp_path):
    robot = yaml.safe_load(Path(experiment.results.robot).read_text(encoding="utf-8"))
    robot["provenance"] = {"source": "<script>alert(1)</script> & <img src=x onerror=alert(2)>"}
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(robot))
    results = experiment.results.__class__(**{**vars(experiment.results), "robot": str(tmp_path / "robot.yaml")})
    text = experiment.write_report(output=tmp_path / "page.html", results=results).read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert "<img" not in text
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in text
    Page(text)


def test_a_further_chapter_is_one_more_file_and_its_numbers(experiment, tmp_path, monkeypatch):
    shutil.copytree(ROOT / "report", tmp_path / "templates")
    monkeypatch.setattr(rendering, "TEMPLATES", tmp_path / "templates")
    (tmp_path / "templates/chapters/65_discover.html.j2").write_text(
        '{% set title = "What the arm lacks" %}{% if discover is defined %}<p>{{ discover.verdict }}</p>{% endif %}'
    )
    without = experiment.write_report(output=tmp_path / "page.html").read_text(encoding="utf-8")
    assert "What the arm lacks" not in without
    (tmp_path / "discover.json").write_text('{"verdict": "none & nothing"}')
    chapters = {"discover": str(tmp_path / "discover.json")}
    text = experiment.write_report(output=tmp_path / "page.html", chapters=chapters).read_text(encoding="utf-8")
    assert "none &amp; nothing" in text
    assert text.index('id="claim"') < text.index('id="discover"') < text.index('id="paper"')
    (tmp_path / "discover.json").write_text("{")
    with pytest.raises(InputError, match=r"discover\.json: cannot be read as JSON"):
        experiment.write_report(output=tmp_path / "page.html", chapters=chapters)


def test_other_pages_are_linked_where_they_have_been_built(tmp_path):
    for name in ("report/index.html", "recovery/index.html", "challenge/full/challenge.html"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text("")
    assert other_pages(tmp_path) == [
        {"name": "challenge full", "link": "../challenge/full/challenge.html"},
        {"name": "recovery", "link": "../recovery/index.html"},
    ]


def test_building_the_report_imports_nothing_heavy():
    code = "import sys, jointwear.report.page, jointwear.report.assembly; print(' '.join(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT / "workflow", capture_output=True, text=True, check=True
    )
    heavy = {"matplotlib", "scipy.stats", "xarray", "pandas", "sklearn", "pinocchio", "snakemake"}
    assert not set(done.stdout.split()) & heavy


def test_a_missing_or_broken_input_is_named(experiment, tmp_path):
    (tmp_path / "broken.svg").write_text("<svg")
    figures = {"figure_1": str(tmp_path / "broken.svg")}
    with pytest.raises(InputError, match=r"broken\.svg: cannot be read as SVG"):
        experiment.write_report(output=tmp_path / "page.html", figures=figures)
    tables = {**experiment.results.tables, "table_v": str(tmp_path / "table_v.nc")}
    (tmp_path / "table_v.nc").write_bytes(b"CDF")
    results = experiment.results.__class__(**{**vars(experiment.results), "tables": tables})
    with pytest.raises(InputError, match=r"table_v\.nc: is truncated"):
        experiment.write_report(output=tmp_path / "page.html", results=results)
    assert not (tmp_path / "page.html").exists()


def test_a_grid_that_the_paper_never_ran_gives_a_page_too(tmp_path):
    config = small_config()
    config.update(replicates=2, tasks=["T2"])
    config["wear"].update(axes=[3], increase_percent=[12.5])
    done = compute(tmp_path, config)
    page = Page(Path(done.path("report/index.html")).read_text(encoding="utf-8"))
    assert "The paper ran none of them" in page.text
    content = json.loads(Path(done.path("report/summary.json")).read_text(encoding="utf-8"))
    assert content["summary"]["compared"] == 0
    assert content["figures"]["is_published_run"] is False
    assert content["scores"]["table_iv"]["verdicts"]["not comparable"] == 1


# --- its numbers ------------------------------------------------------------------------------------------------


def test_summary_file_holds_the_numbers_of_the_page(experiment, data):
    content = json.loads(Path(experiment.path("report/summary.json")).read_text(encoding="utf-8"))
    assert content["scores"] == plain(data["scores"])
    assert content["location"] == plain(data["location"])
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


def test_assumptions_tell_what_was_chosen(default_reading):
    chosen = {**default_reading, "cross_correlation": "means_removed"}
    entry = next(a for a in assumptions(chosen) if a["name"] == "cross_correlation")
    assert entry["chosen"] == "means_removed"
    assert [o["name"] for o in entry["others"]] == ["raw"]
    assert entry["default"] == "raw"


# --- its words --------------------------------------------------------------------------------------------------


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


# --- where it comes from ----------------------------------------------------------------------------------------


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
