"""The figures of the first page are those of the records and of the stored scores."""

from __future__ import annotations

import json
import re

import pytest

from jointwear.files import provenance
from jointwear.files.json_documents import read_json
from jointwear.reproduction.verdicts import AGREES, CLOSE, DIFFERS
from jointwear.running.configuration import layer_files, prepare
from jointwear.studies.shop_floor.scores import rate_over_robots

#: Fleets and benches that are told of by themselves.
NEWEST = 5


@pytest.fixture(scope="module")
def page(root):
    return " ".join((root / "README.md").read_text().split())


def rows_of(root, record):
    """Return the cells of the rows of the first table of a record."""
    lines = (root / "docs/decisions" / record).read_text().partition("|---")[2].splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[1 : lines.index("")]]


def share(*cells):
    """Return good and all of cells such as "3 of 4"."""
    found = [re.match(r"(\d+) of (\d+)", cell) for cell in cells]
    return [sum(int(f[k]) for f in found if f) for k in (1, 2)]


def percent(good, of):
    return f"{100 * good / of:.0f} %"


def over_fleets(counted):
    """Return false alarms, hours, and the rate with its interval over fleets, as they are written."""
    alarms, hours = zip(*counted, strict=True)
    rate, ends = 1000 * sum(alarms) / sum(hours), rate_over_robots(alarms, hours)
    return str(sum(alarms)), f"{sum(hours):,}", f"{rate:.1f} ({ends['robots_low']:.1f} to {ends['robots_high']:.1f})"


def test_fleets_of_other_makers(root, page):
    *fleets, total = rows_of(root, "fleets_of_other_makers.md")
    for fleet in fleets:
        # Which axis is first is asked of those that were found.
        assert share(fleet[6])[1] <= share(fleet[5])[0], fleet[0]
    found, named = share(*(f[5] for f in fleets)), share(*(f[6] for f in fleets))
    newest = int(re.match(r"\d+", fleets[-1][0])[0])
    assert f"{newest} fleets" in page
    counted = [(int(f[2]), int(f[3].replace(",", ""))) for f in fleets if f[2] and f[3]]
    every, newest_five = (over_fleets(part) for part in (counted, counted[-NEWEST:]))
    assert [total[k] for k in (2, 3, 4)] == list(every)
    rate, interval = re.match(r"([\d.]+) \((.*)\)", every[2]).groups()
    assert f"{rate} false alarms per 1,000 h (95 %, over fleets: {interval})" in page
    count, hours, own = newest_five
    assert f"on the newest five {own}" in page
    told = " ".join((root / "docs/decisions/fleets_of_other_makers.md").read_text().split())
    assert f"{count} false alarms in {hours} h, {own} per 1,000 h" in told
    assert (
        f"{percent(*found)} of {found[1]} worn axes found, of these {percent(*named)} with the right axis first" in page
    )
    hours = [int(h) for f in fleets for h in re.findall(r"\d+", f[7])]
    assert f"{min(hours)} to {max(hours)} h after the wear began" in page


def test_benches_of_other_makers(root, page):
    *benches, total = rows_of(root, "outside_benches.md")
    nothing, one, two, outside = (percent(*share(cell)) for cell in total[2:6])
    assert f"{len(benches)} benches, {total[1]} data sets" in page
    assert f"named on {one} with one and {two} with two" in page
    assert f"of models that lack nothing {nothing} left without a name" in page
    newest = [share(*(b[k] for b in benches[-NEWEST:])) for k in (3, 4, 2, 5)]
    *first, last = (percent(*counts) for counts in newest)
    own = f"on the newest five {', '.join(f.removesuffix(' %') for f in first)} and {last}"
    assert f"of disturbances outside the library {outside}, {own}; {total[6]} written files worse" in page
    told = " ".join((root / "docs/decisions/outside_benches.md").read_text().split())
    one, two, nothing, outside = (f"{good} of {of}" for good, of in newest)
    worse, sets = (sum(int(b[k].split()[0]) for b in benches[-NEWEST:]) for k in (6, 1))
    assert (
        f"nothing hidden {nothing}, one effect {one}, two {two}, outside {outside}, {worse or 'none'} of {sets}" in told
    )


def test_verdicts_on_the_paper(root, page, monkeypatch):
    monkeypatch.chdir(root)
    stored = read_json(root / "data/studies/reproduction.json")
    # Of the experiment as it is shipped.
    config = prepare(layer_files({}))
    paper = {key: value for key, value in config.items() if key not in ("recover", "discover", "monitor")}
    assert stored["config_digest"] == provenance.settings_digest(paper)
    hours = stored["scores"]["table_iv"]
    agree, close, differ = (hours["verdicts"][verdict] for verdict in (AGREES, CLOSE, DIFFERS))
    assert f"all {hours['compared']} runs in {config['replicates']} replicates" in page
    assert f"{agree} runs agree, {close} come close and **{differ} differ**" in page
    assert f"detected or not is as printed in {hours['same_pattern']}" in page
    assert stored["verdicts"]["table_iv"] == DIFFERS
    assert {stored["verdicts"][key] for key in ("table_v", "table_vi", "table_ii", "location")} == {CLOSE}
    assert "**Tables V, VI and II and the location of the worn axis come close.**" in page


def test_scores_of_our_own(root, page):
    scores = json.loads((root / "data/benchmarks/challenge_world.json").read_text())["scores"]
    exact, false = scores["exact_set"], scores["false_names"]
    assert f"{100 * exact['value']:.0f} % of {exact['count']} plants in MuJoCo" in page
    assert f"{false['value'] * false['count']:.0f} of {false['count']} that lack nothing" in page
    chapter = json.loads((root / "data/studies/shop_floor/chapter.json").read_text())
    (at_one,) = [r for r in chapter["rates"] if r["rate"] == 1.0]
    assert f"{at_one['false']['per_1000_h']:.1f} false alarms per 1,000 h where 1 is stated" in page
    fast = at_one["coulomb_in_two_weeks"]
    found = f"{fast['found']['count']} of {fast['found']['of']} axes found that grew by 20 % within two weeks"
    assert f"{found}, in the median after {fast['delay']['median']:.0f} h" in page
