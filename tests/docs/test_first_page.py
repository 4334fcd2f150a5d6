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
def text(root):
    return (root / "README.md").read_text()


@pytest.fixture(scope="module")
def page(text):
    return " ".join(text.split())


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


def share_of(good, of):
    return f"{percent(good, of)} of {of:,}"


def as_table(*rows):
    """Return rows of cells as the first page has them."""
    head, *body = (f"| {' | '.join(row)} |" for row in rows)
    return "\n".join([head, "|---" * len(rows[0]) + "|", *body]) + "\n"


def shown_table(text, corner):
    """Return the table of a page whose first cell is `corner`, to compare with what the records give for it."""
    return re.search(rf"^\| {re.escape(corner)} \|.*?\n(?!\|)", text, re.MULTILINE | re.DOTALL)[0]


def over_fleets(counted):
    """Return false alarms, hours, and the rate with its interval over fleets, as they are written."""
    alarms, hours = zip(*counted, strict=True)
    rate, ends = 1000 * sum(alarms) / sum(hours), rate_over_robots(alarms, hours)
    return str(sum(alarms)), f"{sum(hours):,}", f"{rate:.1f} ({ends['robots_low']:.1f} to {ends['robots_high']:.1f})"


def test_fleets_of_other_makers(root, text):
    *fleets, total = rows_of(root, "fleets_of_other_makers.md")
    for fleet in fleets:
        # Which axis is first is asked of those that were found.
        assert share(fleet[6])[1] <= share(fleet[5])[0], fleet[0]
    counted = [f for f in fleets if f[2] and f[3]]
    rates, found, named, hours = [], [], [], []
    for part, with_hours in ((fleets, counted), (fleets[-NEWEST:], counted[-NEWEST:])):
        rates.append(over_fleets([(int(f[2]), int(f[3].replace(",", ""))) for f in with_hours]))
        found.append(share_of(*share(*(f[5] for f in part))))
        named.append(share_of(*share(*(f[6] for f in part))))
        medians = [int(h) for f in part for h in re.findall(r"\d+", f[7])]
        hours.append(f"{min(medians)} to {max(medians)}")
    assert [total[k] for k in (2, 3, 4)] == list(rates[0])
    number = int(re.match(r"\d+", fleets[-1][0])[0])
    assert shown_table(text, "`monitor`") == (
        as_table(
            ["`monitor`", f"all {number} fleets", "newest five"],
            ["false alarms per 1,000 h, where 1 is stated (95 % interval over fleets)", *(r[2] for r in rates)],
            ["worn axes found", *found],
            ["right axis named first, of those found", *named],
            ["hours from the onset of wear to the alarm: lowest and highest median of a fleet", *hours],
        )
    )
    told = " ".join((root / "docs/decisions/fleets_of_other_makers.md").read_text().split())
    count, in_hours, own = rates[1]
    assert f"{count} false alarms in {in_hours} h, {own} per 1,000 h" in told


def test_benches_of_other_makers(root, text):
    *benches, total = rows_of(root, "outside_benches.md")
    newest = benches[-NEWEST:]
    of_newest = [share(*(b[k] for b in newest)) for k in range(2, 6)]
    few, sets = (sum(int(b[k].split()[0]) for b in newest) for k in (6, 1))
    worse = [f"{k} worse in {of} data sets" for k, of in ((total[6], total[1]), (few, sets))]
    (nothing, one, two, outside) = (
        [share_of(*share(cell)), share_of(*own)] for cell, own in zip(total[2:6], of_newest, strict=True)
    )
    assert shown_table(text, "`discover`") == (
        as_table(
            ["`discover`", "right is", f"all {len(benches)} benches", "newest five"],
            ["nothing hidden", "no effect named", *nothing],
            ["one effect hidden", "exactly this one named", *one],
            ["two effects hidden", "exactly these two named", *two],
            ["a disturbance that the library lacks", "no effect named", *outside],
            ["a written robot file", "never worse than the given one", *worse],
        )
    )
    told = " ".join((root / "docs/decisions/outside_benches.md").read_text().split())
    nothing, one, two, outside = (f"{good} of {of}" for good, of in of_newest)
    assert (
        f"nothing hidden {nothing}, one effect {one}, two {two}, outside {outside}, {few or 'none'} of {sets}" in told
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
