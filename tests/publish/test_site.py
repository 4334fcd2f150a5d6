"""The static site: complete, links lead somewhere, checksums hold, nothing private; and Snakemake's own report."""

import hashlib
import json
import re
import shutil
import zipfile
from html.parser import HTMLParser

import pytest
from scratch_project import Project

from jointwear.publishing.site.contents import size_words, without_dead_links
from jointwear.publishing.site.edits import EDITS
from jointwear.publishing.site.writing import write_site

pytestmark = pytest.mark.publish


class Links(HTMLParser):
    """Targets of links and anchors of one page."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if tag == "a" and attributes.get("href"):
            self.targets.append(attributes["href"])
        if attributes.get("id"):
            self.anchors.add(attributes["id"])


@pytest.fixture(scope="module")
def site(published):
    return published.folder / "site"


def test_every_link_leads_to_a_file_or_an_anchor(site):
    pages = sorted(site.rglob("*.html"))
    assert {"index.html", "data.html", "change.html"} <= {p.name for p in pages}
    for page in pages:
        links = Links(page.read_text())
        for target in links.targets:
            path, _, anchor = target.partition("#")
            if target.startswith(("http:", "https:", "data:")):
                continue
            there = (page.parent / path).resolve() if path else page
            assert there.exists(), f"{page.name}: {target}"
            if anchor and not path:
                assert anchor in links.anchors, f"{page.name}: {target}"


def test_checksums_hold_for_the_files_of_the_site(site):
    lines = (site / "SHA256SUMS").read_text().splitlines()
    assert len(lines) > 30
    for line in lines:
        checksum, path = line.split("  ")
        assert hashlib.sha256((site / path).read_bytes()).hexdigest() == checksum


def test_the_index_lists_every_result_with_size_and_checksum(published, site):
    page = (site / "data.html").read_text()
    for path in (published.folder / "results").rglob("*.nc"):
        assert path.relative_to(published.folder / "results").as_posix() in page
        assert hashlib.sha256(path.read_bytes()).hexdigest() in page


def test_the_archive_opens_and_holds_tables_and_figures(site):
    with zipfile.ZipFile(site / "jointwear-results.zip") as archive:
        assert archive.testzip() is None
        names = archive.namelist()
    assert "jointwear-results/tables/table_iv.csv" in names
    assert "jointwear-results/figures/figure_1.svg" in names


def test_torque_samples_are_not_published_and_nobody_links_to_them(site):
    assert not (site / "results/simulation").exists()
    assert "../simulation/" not in (site / "results/report/index.html").read_text()


def test_nothing_private_is_in_it(published, site):
    for path in (p for p in site.rglob("*") if p.is_file() and p.suffix in (".html", ".json", ".csv", ".svg", ".yaml")):
        text = path.read_text()
        assert str(published.folder) not in text, path
        assert not re.search(r"/(home|root|Users)/", text), path


def test_the_same_results_give_the_same_bytes(published, site, tmp_path):
    write_site(tmp_path / "site", edits=EDITS, root=published.folder)
    for path in (p for p in (tmp_path / "site").rglob("*") if p.is_file()):
        assert path.read_bytes() == (site / path.relative_to(tmp_path / "site")).read_bytes(), path


def test_pages_that_are_built_later_are_taken_in(published, tmp_path):
    root = tmp_path / "project"
    (root / "results/report").mkdir(parents=True)
    shutil.copy2(published.folder / "results/report/index.html", root / "results/report")
    (root / "results/monitor/arm_7").mkdir(parents=True)
    (root / "results/monitor/arm_7/monitor.html").write_text("<!doctype html><html><title>arm</title></html>")
    (root / "data/benchmarks").mkdir(parents=True, exist_ok=True)
    times = [{"command": EDITS[0]["command"], "seconds": 4.2, "jobs": 3, "rules": ["draw_figures"]}]
    (root / "data/benchmarks/results.json").write_text(json.dumps({"reruns": {"edits": times}}))
    write_site(tmp_path / "site", edits=EDITS, root=root)
    assert "results/monitor/arm_7/monitor.html" in (tmp_path / "site/index.html").read_text()
    assert "<td>4.2</td>" in (tmp_path / "site/change.html").read_text()


def test_a_link_to_what_is_not_held_becomes_words():
    page = '<a href="../a/x.nc">x</a> <a href="../b/y.nc">y</a> <a href="#z">z</a> <a href="summary.json">s</a>'
    assert without_dead_links(page, ["b/y.nc"], "report") == (
        'x <a href="../b/y.nc">y</a> <a href="#z">z</a> <a href="summary.json">s</a>'
    )
    assert size_words(999) == "999 B"
    assert size_words(3_400_000) == "3.4 MB"


def test_snakemakes_own_report_has_captions_categories_and_labels(published, tmp_path):
    copy = Project(tmp_path / "project")
    shutil.copytree(published.folder, copy.folder, symlinks=True)
    copy.snakemake("--report", "report.zip")
    with zipfile.ZipFile(copy.folder / "report.zip") as archive:
        text = "\n".join(archive.read(n).decode() for n in archive.namelist() if n.endswith((".js", ".html")))
    for words in ("Hour of detection of every combination", "Friction torque of the worn axis", "Tables", "Figures"):
        assert words in text
