"""The report in headless Chromium: alone, legible, in light and dark, on a phone and in print."""

import base64
import json
import shutil
import time

import pytest
from small_experiment import small_experiment

pytestmark = pytest.mark.browser
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    programs = {name: shutil.which(name) for name in ("chromium", "chromedriver")}
    missing = [name for name, path in programs.items() if path is None]
    if missing:
        pytest.fail(f"{' and '.join(missing)} not found; on Debian: apt-get install chromium chromium-driver")
    options = webdriver.ChromeOptions()
    options.binary_location = programs["chromium"]
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    browser = webdriver.Chrome(options=options, service=Service(programs["chromedriver"]))
    yield browser
    browser.quit()


@pytest.fixture(scope="module")
def address():
    with open(small_experiment().path("report/index.html"), encoding="utf-8") as page:
        return f"file://{page.name}"


def show(driver, address, width=1280, scheme="light", mobile=False):
    """Load the page in a window of this width [CSS pixels] and colour scheme."""
    driver.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    )
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": mobile},
    )
    driver.get(address)


def open_details(driver):
    driver.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")


def test_no_error_and_no_request_beyond_the_page(driver, address):
    driver.get_log("browser"), driver.get_log("performance")
    show(driver, address)
    open_details(driver)
    time.sleep(0.5)
    assert driver.get_log("browser") == []
    events = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    asked = {e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"}
    assert {url for url in asked if not url.startswith("data:")} == {address}
    assert driver.execute_script("return performance.getEntriesByType('resource').length") == 0


def test_every_figure_has_alternative_text(driver, address):
    show(driver, address)
    labels = driver.execute_script(
        "return [...document.querySelectorAll('svg, img')].map(e => e.getAttribute('aria-label') || e.alt || '')"
    )
    assert len(labels) == 6
    assert all(len(label) > 40 for label in labels)
    names = driver.execute_script(
        "return [...document.querySelectorAll('.scroll')].map(e => e.getAttribute('aria-label'))"
    )
    assert all(names)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("opened", [False, True])
def test_no_horizontal_scroll_on_a_phone(driver, address, scheme, opened):
    show(driver, address, width=390, scheme=scheme, mobile=True)
    if opened:
        open_details(driver)
    assert driver.execute_script("return document.documentElement.scrollWidth") <= 390
    wide = driver.execute_script(
        "return [...document.querySelectorAll('main *')].filter(e => e.getBoundingClientRect().right > 391"
        " && !e.closest('.scroll, pre')).map(e => e.outerHTML.slice(0, 120))"
    )
    assert wide == []
    smallest = driver.execute_script(
        "return Math.min(...[...document.querySelectorAll('svg.plot text')].map(e => e.getBoundingClientRect().height))"
    )
    assert smallest >= 7


# Contrast of text against the nearest background, as WCAG 2 defines it; text inside figures apart, which stands on
# the paper or on a patch whose text colour is chosen for it.
CONTRAST = """
const lum = c => { const v = c.match(/[\\d.]+/g).slice(0, 3).map(x => x / 255)
    .map(x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
  return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]; };
const clear = c => c === 'transparent' || /, 0\\)$/.test(c);
const behind = e => { while (e && clear(getComputedStyle(e).backgroundColor)) e = e.parentElement;
  return e ? getComputedStyle(e).backgroundColor : 'rgb(255, 255, 255)'; };
const ratio = (a, b) => { const [d, l] = [lum(a), lum(b)].sort((x, y) => x - y); return (l + 0.05) / (d + 0.05); };
const texts = [...document.querySelectorAll('body *')].filter(e => !e.closest('svg') && e.checkVisibility()
  && [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim()));
const html = texts.map(e => [ratio(getComputedStyle(e).color, behind(e)), e.textContent.trim().slice(0, 40)]);
const paper = behind(document.body);
const plots = [...document.querySelectorAll('svg.plot')].filter(s => !/Lag \\[h\\]|probability/.test(s.ariaLabel))
  .flatMap(s => [...s.querySelectorAll('text')]).map(e => [ratio(getComputedStyle(e).fill, paper), e.textContent]);
return [html, plots];
"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_contrast_in_both_themes(driver, address, scheme):
    show(driver, address, scheme=scheme)
    open_details(driver)
    page, figures = driver.execute_script(CONTRAST)
    assert len(page) > 300
    assert [entry for entry in page if entry[0] < 4.5] == []
    assert len(figures) > 50
    assert [entry for entry in figures if entry[0] < 3.5] == []


def test_dark_theme_darkens_page_and_figures(driver, address):
    grounds = {}
    for scheme in ("light", "dark"):
        show(driver, address, scheme=scheme)
        grounds[scheme] = driver.execute_script(
            "const p = document.querySelector('#figure-1-patch_1 path');"
            "return [getComputedStyle(document.body).backgroundColor, getComputedStyle(p).fill]"
        )
    assert grounds["light"] == ["rgb(255, 255, 255)"] * 2
    assert grounds["dark"][0] == grounds["dark"][1] != grounds["light"][0]


def test_links_of_the_contents_lead_to_chapters(driver, address):
    show(driver, address)
    broken = driver.execute_script(
        "return [...document.querySelectorAll('a[href^=\"#\"]')].map(a => a.getAttribute('href').slice(1))"
        ".filter(i => !document.getElementById(i))"
    )
    assert broken == []


def test_scrolling_tables_can_be_reached_by_keyboard(driver, address):
    show(driver, address, width=390, mobile=True)
    unreachable = driver.execute_script(
        "return [...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth && e.tabIndex < 0)"
        ".length"
    )
    assert unreachable == 0


def test_print_fits_the_paper_and_opens_what_is_folded(driver, address):
    show(driver, address, width=1280, scheme="dark")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    # A4 less its margins, at 96 pixels an inch.
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": 688, "height": 1000, "deviceScaleFactor": 1, "mobile": False}
    )
    assert driver.execute_script("return document.documentElement.scrollWidth") <= 688
    assert driver.execute_script("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    hidden = driver.execute_script(
        "return [...document.querySelectorAll('details table')].filter(t => !t.checkVisibility()).length"
    )
    assert hidden == 0
    pdf = base64.b64decode(
        driver.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True, "printBackground": True})["data"]
    )
    assert pdf.startswith(b"%PDF")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
