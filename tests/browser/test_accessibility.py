"""Every kind of page by axe-core in headless Chromium: desktop and phone, light and dark, folded parts open, print."""

import itertools
from importlib.util import find_spec
from pathlib import Path

import pytest
from scratch_project import copy_project
from test_report_page import driver, open_details, show

pytestmark = pytest.mark.browser
__all__ = ["driver"]
EXAMPLES = ("discover", "monitor")
KINDS = ("index.html", "data.html", "change.html", "report/index.html", "discover.html", "monitor.html")
# axe's words for what keeps people out; "moderate" and "minor" are matters of taste to it, and are held to zero too.
OUTLINE = """
return [...document.querySelectorAll('h1, h2, h3, h4')].filter(h => h.checkVisibility())
  .map(h => [Number(h.tagName[1]), h.textContent.trim()]);
"""
TABLES = """
return [...document.querySelectorAll('table')].filter(t => !t.querySelector('th')).map(t => t.outerHTML.slice(0, 80));
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site of a tiny run, with a page of discovery and one of monitoring."""
    project = copy_project(tmp_path_factory.mktemp("site"))
    for target in EXAMPLES:
        project.snakemake("--cores", "2", target, "--configfile", f"config/examples/{target}_puma560.yaml")
    project.snakemake("--cores", "2", "site")
    return project.folder / "site"


@pytest.fixture(scope="module")
def axe():
    """The text of axe-core, from a package that carries it."""
    spec = find_spec("axe_playwright_python")
    if spec is None:
        pytest.fail("axe_playwright_python not found; make test-browser installs requirements/check.txt")
    return (Path(spec.submodule_search_locations[0]) / "axe.min.js").read_text(encoding="utf-8")


def violations(driver, axe):
    """Run axe on the page shown; return rule, impact and first element of every violation."""
    # The page's own policy forbids scripts; the driver's are not bound by it.
    driver.execute_script(axe)
    found = driver.execute_async_script(
        "const done = arguments[arguments.length - 1]; axe.run(document, {resultTypes: ['violations']}).then("
        "r => done(r.violations.map(v => [v.id, v.impact, v.nodes.length, v.nodes[0].html.slice(0, 160),"
        " v.nodes[0].failureSummary.slice(0, 300)])), e => done([['failed', 'critical', 0, String(e), '']]));"
    )
    return [entry for entry in found if entry[1] in ("serious", "critical", "moderate", "minor")]


def page_of(site, kind):
    """Return one page of a kind."""
    return next(p for p in sorted(site.rglob("*.html")) if p.as_posix().endswith(f"/{kind}"))


def test_axe_is_awake(driver, axe, tmp_path):
    bad = tmp_path / "bad.html"
    bad.write_text("<!doctype html><html><body><img src='data:,'><p style='color:#ccc'>pale</p></body></html>")
    show(driver, bad.as_uri())
    assert {"image-alt", "color-contrast", "html-has-lang"} <= {v[0] for v in violations(driver, axe)}


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(("width", "mobile"), [(1440, False), (390, True)])
@pytest.mark.parametrize("kind", KINDS)
def test_axe_finds_nothing(driver, axe, site, kind, width, mobile, scheme):
    show(driver, page_of(site, kind).as_uri(), width=width, scheme=scheme, mobile=mobile)
    open_details(driver)
    assert violations(driver, axe) == []


@pytest.mark.parametrize("kind", KINDS)
def test_axe_finds_nothing_in_print(driver, axe, site, kind):
    show(driver, page_of(site, kind).as_uri(), scheme="dark")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    assert violations(driver, axe) == []
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


@pytest.mark.parametrize("kind", KINDS)
def test_the_outline_steps_down_one_level_at_a_time(driver, site, kind):
    show(driver, page_of(site, kind).as_uri())
    open_details(driver)
    levels = [level for level, _ in driver.execute_script(OUTLINE)]
    assert levels.count(1) == 1
    assert levels[0] == 1
    assert all(below - above <= 1 for above, below in itertools.pairwise(levels))
    assert driver.execute_script(TABLES) == []


@pytest.mark.parametrize("kind", KINDS)
def test_no_page_scrolls_sideways_on_a_phone(driver, site, kind):
    show(driver, page_of(site, kind).as_uri(), width=390, mobile=True)
    open_details(driver)
    assert driver.execute_script("return document.documentElement.scrollWidth") <= 390
    frames = "[...document.querySelectorAll('figure .scroll')]"
    wide = f"return {frames}.filter(e => e.scrollWidth > e.clientWidth + 2).length"
    assert driver.execute_script(wide) == 0
