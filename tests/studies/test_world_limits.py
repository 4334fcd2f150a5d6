"""What is said of the limits of discovery, and of the probability of its names."""

from dataclasses import asdict, fields, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Outcome, Refusal
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.search.calibration import FEATURES, calibrated
from jointwear.discovery.settings import REPORTED, USERS, Settings
from jointwear.studies.world import assumptions
from jointwear.studies.world.calibration import cross_fitted, fit, names_of, summary
from jointwear.studies.world.page import limits_context
from jointwear.studies.world.sensitivity import FACTORS, GATES, can_matter, lines, moves, table, variants


def test_fewer_than_twenty_limits_decide_and_each_has_its_meaning():
    deciding = [f.name for f in fields(Settings) if f.name not in (*USERS, *REPORTED)]
    assert len(deciding) < 20
    assert len(deciding) + len(assumptions.LIMITS) < 27
    for name in deciding:
        assert f"    {name} : " in Settings.__doc__ or f"`{name}`" in Settings.__doc__
    # None is a limit of a score.
    assert 60.0 not in asdict(Settings()).values()
    assert 0.02 not in asdict(Settings()).values()


def test_every_limit_moves_both_ways_and_alone():
    base = Settings()
    moved = variants(base)
    deciding = {f.name for f in fields(Settings)} - {*USERS, *REPORTED, *assumptions.WRITTEN}
    assert {name for name, _ in moved} == deciding
    for (name, factor), settings in moved.items():
        assert {k for k, v in asdict(settings).items() if v != getattr(base, k)} == {name}
        assert factor in FACTORS
        if name in ("certainty", "nearly_all"):
            assert 0.0 < getattr(settings, name) < 1.0


def rows_of(changed, right):
    keys = [f"{name} {factor:g}" for name, factor in variants(Settings())]
    plain = {"names": ["a"], "right": True}
    found = {key: {"names": ["b"], "right": right} if changed in key else plain for key in keys} | {" 1": plain}
    return [{"case": "x", "kind": "single", "identifiable": True, "found": found}]


def test_the_table_counts_what_a_limit_changes():
    entries = {
        (e["limit"], e["names_change"], e["right"]["single"])
        for e in table(rows_of("accept", False), moves(Settings()))
    }
    assert ("accept", 1, -1) in entries
    assert ("certainty", 0, 0) in entries
    stored = {
        "cases": 1,
        "judged": {"single": 1},
        "right": {"single": 1},
        "limits": table(rows_of("accept", False), moves(Settings())),
    }
    assert any("accept" in line and "single -1" in line for line in lines(stored))


def refused(gate):
    return Refusal(Candidate("payload", None, None), 30.0, gate, 0.0, 1.0)


def test_a_limit_is_moved_only_where_it_can_matter():
    base, empty = Settings(), Outcome(None, None, None, None)
    for name, (words, less) in GATES.items():
        more = next(factor for factor in FACTORS if factor != less)
        assert not can_matter(empty, name, less, base)
        assert not can_matter(empty, name, more, base)
        assert can_matter(replace(empty, refusals=[refused(words)]), name, less, base)
    assert all(can_matter(empty, "accept", factor, base) for factor in FACTORS)


def test_every_assumption_is_asked_of_the_case_as_it_is(monkeypatch):
    """The robot file of a case lies in a folder that has to be there at every answer."""
    facts = {"case": "x", "kind": "nothing", "effects": [], "wrong_parameter": None}
    asked = []

    def answer(world, settings):
        assert Path(world.folder).is_dir()
        asked.append(assumed.BESIDE)
        return {"kind": "nothing", "named": [("payload", None)] if assumed.BESIDE > 0.12 else [], "worse": [2]}

    monkeypatch.setattr(assumptions, "generate", lambda _, folder: SimpleNamespace(facts=facts, folder=folder))
    monkeypatch.setattr(assumptions, "answer", answer)
    monkeypatch.setattr(assumptions, "judge", lambda *_: {"identifiable": None})
    row = assumptions.answers(None, FACTORS)
    assert len(asked) == 1 + 2 * len([*assumptions.LIMITS, *assumptions.WRITTEN])
    (changed,) = [entry for entry in table([row], assumptions.moves(FACTORS)) if entry["names_change"]]
    assert (changed["limit"], changed["right"]["nothing"], changed["worse"]) == ("BESIDE", -1, 0)


def test_the_page_shows_the_table():
    stored = {"cases": 1, "judged": {"single": 1, "two": 0}, "right": {"single": 1, "two": 0}, "command": "x"}
    shown = limits_context({**stored, "limits": table(rows_of("accept", False), moves(Settings()))})
    assert shown["words"] == "1 of 1 single"
    assert {r["words"] for r in shown["table"]} == {"single -1", "the same"}
    worse = {**stored, "limits": [{**table(rows_of("accept", True), moves(Settings()))[0], "worse": 1}]}
    beside = limits_context({**stored, "limits": [], "assumed": worse})["assumed"]
    assert beside["table"][0]["words"] == "worse than given +1"


def world_rows(rng, count):
    """Return rows whose names are right as often as a known function of their features says."""
    rows = []
    for _ in range(count):
        log_odds, share, left = rng.exponential(50.0), rng.uniform(0.0, 1.0), rng.random() < 0.3
        right = rng.random() < 1 / (1 + np.exp(-(0.5 * np.arcsinh(log_odds) + share - left - 0.5)))
        rows.append({"names": [{"log_odds": log_odds, "share": share, "left": left, "right": right}]})
    return rows


def test_a_fit_is_calibrated_on_names_that_it_has_not_seen():
    rows = world_rows(np.random.default_rng(np.random.SeedSequence(3)), 600)
    error, count = cross_fitted(rows)
    assert count == 600
    assert error < 0.06
    stored = summary(rows, "drawn")
    assert stored["features"] == list(FEATURES)
    _, odds, share, left = stored["coefficients"]
    assert odds > 0
    assert share > 0
    assert left < 0


@given(wrong=st.integers(0, 3))
def test_few_names_do_not_make_a_fit_certain(wrong):
    rows = [{"names": [{"log_odds": 50.0, "share": 0.9, "left": False, "right": k >= wrong}]} for k in range(20)]
    features, right, _ = names_of(rows)
    probability = 1 / (1 + np.exp(-(features @ fit(features, right))))
    assert np.all(probability < 1.0)
    assert np.all(probability < 0.96)
    assert probability.mean() == pytest.approx(right.mean(), abs=0.05)


@given(log_odds=st.floats(-1e3, 1e6), share=st.floats(-1.0, 1.0))
def test_structure_that_is_left_makes_no_name_more_probable(log_odds, share):
    assert 0.0 <= calibrated(log_odds, share, True) <= calibrated(log_odds, share, False) <= 1.0
    assert calibrated(log_odds, share, False) <= calibrated(log_odds + 10.0, share, False) + 1e-12
    # Nothing else of the library is as likely: one half at least, unless structure says that something else is there.
    assert log_odds < 0.0 or calibrated(log_odds, share, False) >= 0.5


def test_a_name_of_little_share_beside_structure_is_no_name():
    assert calibrated(50.0, 0.2, True) < 0.5 < calibrated(50.0, 0.9, True)
