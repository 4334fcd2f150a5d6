"""The page of the report stands on its own, and its links, figures and marks are complete."""

import json
import re
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from html_page import Page
from small_experiment import ROOT, compute, small_config

from jointwear.files import shown_numbers as numbers
from jointwear.files.errors import InputError
from jointwear.publishing.report import rendering
from jointwear.publishing.report.assembly import assemble
from jointwear.publishing.report.page import other_pages
from jointwear.reproduction import readings


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
    code = (
        "import sys, jointwear.publishing.report.page, jointwear.publishing.report.assembly; "
        "print(' '.join(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT / "workflow", capture_output=True, text=True, check=True
    )
    heavy = {"matplotlib", "scipy.stats", "xarray", "pandas", "sklearn", "pinocchio", "snakemake"}
    assert not set(done.stdout.split()) & heavy


def test_a_model_without_residual_is_told(tmp_path, page):
    assert "is left to watch" not in page.text
    config = small_config()
    config.update(replicates=2, tasks=["T2"])
    config["wear"].update(axes=[3], increase_percent=[10])
    config["detection"]["variance_share"] = 0.999
    done = compute(tmp_path, config)
    text = Page(Path(done.path("report/index.html")).read_text(encoding="utf-8")).text
    assert "Task T2: nothing but rounding is left to watch." in text
    assert "In 2 of 2 normal models" in text
    assert "few joints" not in text
    assert "no wear" not in text.split("is left to watch.")[1].split("lower")[0]


@pytest.mark.parametrize(
    ("own", "words"),
    [
        ([], "Payload, poses and wear shape were fitted to Tables V and VI"),
        (["T1"], "Payload, wear shape and the poses of T2 were fitted to Tables V and VI"),
        (["T1", "T2"], "Payload and wear shape, not the poses, were fitted to Tables V and VI"),
    ],
)
def test_captions_say_what_was_fitted(experiment, tmp_path, own, words):
    (tmp_path / "Stack.yaml").write_text("name: Stack\nprovenance: {source: an example}\n")
    files = dict.fromkeys(("T1", "T2"), experiment.results.tasks["T2"]) | dict.fromkeys(
        own, str(tmp_path / "Stack.yaml")
    )
    results = replace(experiment.results, tasks=files)
    robot = assemble(results, experiment.config)["robot"]
    macros = rendering.environment().from_string('{% import "macros.html.j2" as m %}{{ m.fitted(robot) }}')
    assert " ".join(macros.render(robot=robot).split()) == f"{words} at the printed hours."
    assert macros.render(robot={"fitted": {"payload": False, "poses": [], "tasks": []}}).strip() == ""


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
