"""The scoring of the hidden-effect test, on verdicts made by hand."""

import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.discovery.settings import Settings
from jointwear.files.errors import InputError
from jointwear.measurement.recording import Recording, elapsed_time
from jointwear.statistics.intervals import wilson_interval
from jointwear.studies.challenge import solve
from jointwear.studies.challenge.judge import accepted_names, error_norm, judge
from jointwear.studies.challenge.peer_scores import best_settings, judged_answers, write_peer_scores
from jointwear.studies.challenge.peer_terms import AxisProblem
from jointwear.studies.challenge.peers import effects_of, least_squares
from jointwear.studies.challenge.plan import part_batches
from jointwear.studies.challenge.scores import (
    calibration,
    confusion,
    detection_limits,
    reached,
    score_tier,
)
from jointwear.studies.challenge.scoring import peak_covered, summarise
from jointwear.studies.challenge.solve import at_samples
from jointwear.studies.challenge.tiers import DRAWINGS, EFFECTS, TARGETS, TIERS
from jointwear.studies.hidden_effect_page.page import calibration_points, confusion_table, write_page
from jointwear.studies.hidden_effect_page.stored import write_stored, write_stored_page


def effect(name="stribeck_friction", axis=2, energy=1000.0, **more):
    return {
        "effect": name,
        "axis": axis,
        "also": [],
        "form": "rational",
        "size": 0.2,
        "energy": energy,
        "peak": [0, 1.0, 0, 0, 0, 0],
        "rivals": {},
        **more,
    }


def facts(kind="single", effects=(), **more):
    return {
        "case": "c1",
        "tier": "clean",
        "kind": kind,
        "subject": effects[0]["effect"] if effects else None,
        "closed_loop": False,
        "noise": [0.1] * 6,
        "wrong_parameter": None,
        "effects": list(effects),
        **more,
    }


def entry(name="stribeck_friction", axis=2, ties=None, evidence=50.0, **more):
    said = {"effect": name, "axis": axis, "tie_set": ties or [name], "evidence_nats": evidence, "parameters": {}}
    return {**said, **more}


def verdict(*effects, word=None, retuned=()):
    return {"verdict": word or ("effects" if effects else "none"), "effects": list(effects), "retuned": list(retuned)}


def test_a_right_answer_is_right():
    row = judge(facts(effects=[effect()]), verdict(entry()), None, 1.0)
    assert row["identifiable"]
    assert row["name_first"]
    assert row["axis_right"]
    assert row["exact_set"]
    assert row["tie_holds"]
    assert row["tie_size"] == 1


@pytest.mark.parametrize(
    ("named", "wrong"),
    [
        ([], {"name_first", "axis_right", "exact_set"}),
        ([entry(axis=3)], {"axis_right", "exact_set"}),
        ([entry("wear_drift")], {"name_first", "exact_set"}),
        ([entry(), entry("wear_drift", 4)], {"exact_set"}),
        ([entry(), entry(axis=5)], {"exact_set"}),
        ([entry("wear_drift"), entry()], {"name_first", "exact_set"}),
    ],
)
def test_each_kind_of_mistake_costs_its_own_score(named, wrong):
    row = judge(facts(effects=[effect()]), verdict(*named), None, 1.0)
    assert {k for k in ("name_first", "axis_right", "exact_set") if not row[k]} == wrong


def test_names_that_the_motion_cannot_separate_count_as_one_but_not_in_the_strict_score():
    hidden = effect(rivals={"wear_drift": 5.0, "payload": 500.0})
    assert accepted_names(hidden) == {"stribeck_friction", "wear_drift"}
    row = judge(facts(effects=[hidden]), verdict(entry("wear_drift")), None, 1.0)
    assert row["name_first"]
    assert row["exact_set"]
    assert not row["name_first_strict"]
    assert not row["exact_set_strict"]


def test_a_coupling_may_be_named_on_both_its_axes():
    hidden = effect("drive_coupling", 5, also=[6])
    both = verdict(entry("drive_coupling", 5), entry("drive_coupling", 6))
    assert judge(facts(effects=[hidden]), both, None, 1.0)["exact_set"]


def test_a_payload_has_no_axis():
    hidden = effect("payload", None)
    assert judge(facts(effects=[hidden]), verdict(entry("payload", None)), None, 1.0)["axis_right"]
    assert not judge(facts(effects=[hidden]), verdict(entry("joint_spring", 2)), None, 1.0)["axis_right"]


def test_two_effects():
    hidden = [effect(), effect("wear_drift", 4)]
    assert judge(facts("two", hidden), verdict(entry("wear_drift", 4), entry()), None, 1.0)["two_exact"]
    row = judge(facts("two", hidden), verdict(entry("wear_drift", 4), entry(), entry("payload", None)), None, 1.0)
    assert row["both_found"]
    assert not row["two_exact"]
    assert not judge(facts("two", hidden), verdict(entry()), None, 1.0)["both_found"]
    weak = judge(facts("two", [effect(), effect("wear_drift", 4, energy=10)]), verdict(entry()), None, 1.0)
    assert not weak["identifiable"]


def test_abstention_retuning_and_the_unknown():
    assert judge(facts("nothing"), verdict(entry()), None, 1.0)["false_name"]
    assert not judge(facts("nothing"), verdict(word="retuned"), None, 1.0)["false_name"]
    wrong = {"parameter": "coulomb_friction", "axis": 3, "share": 0.2, "energy": 500.0}
    listed = [{"parameter": "coulomb_positive", "axis": 3}]
    row = judge(facts("retuned", wrong_parameter=wrong), verdict(word="retuned", retuned=listed), None, 1.0)
    assert row["retuned"]
    assert row["right_parameter"]
    named = judge(facts("retuned", wrong_parameter=wrong), verdict(entry(), word="effects", retuned=listed), None, 1.0)
    assert not named["retuned"]
    assert judge(facts("outside", [effect("beat")]), verdict(word="unknown"), None, 1.0)["unknown"]
    assert not judge(facts("outside", [effect("beat")]), verdict(entry()), None, 1.0)["unknown"]


def test_a_refusal_is_no_answer():
    row = judge(facts(effects=[effect()]), {"refused": "degrees"}, None, 1.0)
    assert row["verdict"] == "refused"
    assert not row["name_first"]


def test_error_norm_leaves_out_rest():
    truth = np.array([[1.0, np.nan], [2.0, 5.0], [3.0, np.nan]])
    predicted = truth + np.array([[1.0, 9.0], [1.0, 2.0], [1.0, 9.0]])
    assert error_norm(predicted, truth) == pytest.approx(np.hypot(1, 2))
    assert error_norm(truth, np.where(np.arange(2), np.nan, truth)) == 0


def test_gap_and_not_worse():
    errors = {"nominal": 2.0, "retuned": 1.0, "augmented": 0.2}
    row = judge(facts(effects=[effect()]), verdict(entry()), errors, 1.0)
    assert row["gap_closed"] == pytest.approx(0.9)
    assert row["not_worse"]
    assert not judge(facts(effects=[effect()]), verdict(entry()), {**errors, "augmented": 1.1}, 1.0)["not_worse"]


def test_peak_interval():
    assert peak_covered(effect(), entry(peak_torque={"value": 0.9, "low": 0.8, "high": 1.05}))
    assert not peak_covered(effect(), entry(peak_torque={"value": 0.9, "low": 0.85, "high": 0.95}))
    assert peak_covered(effect(), entry()) is None
    assert peak_covered(effect("payload", None), entry("payload", None, peak_torque={"low": 0.9, "high": 1.1}))


@settings(deadline=None)
@given(st.integers(0, 60), st.integers(0, 60))
def test_wilson_holds_the_share(a, b):
    right, count = min(a, b), max(a, b, 1)
    low, high = wilson_interval(right, count)
    assert 0 <= low <= right / count <= high <= 1


def rows_of_a_tier():
    rows = []
    for k in range(40):
        hidden = effect(size=0.02 * 1.08**k, energy=20.0 + 10 * k)
        said = verdict(entry(evidence=10.0 + 10 * k)) if k > 15 else verdict()
        rows.append(judge(facts(effects=[hidden]), said, {"nominal": 1.0, "retuned": 0.9, "augmented": 0.1}, 1.0))
    rows += [judge(facts("nothing"), verdict(), None, 1.0) for _ in range(9)]
    rows.append(judge(facts("nothing"), verdict(entry(evidence=12.0)), None, 1.0))
    return rows


def test_scores_count_identifiable_cases_and_all_cases():
    rows = rows_of_a_tier()
    scores, everything = score_tier(rows), score_tier(rows, identifiable=False)
    assert scores["identifiable_share"]["value"] == pytest.approx(35 / 40)
    assert scores["name_first"]["value"] == pytest.approx(24 / 35)
    assert everything["name_first"]["value"] == pytest.approx(24 / 40)
    assert (scores["false_names"]["value"], scores["false_names"]["count"]) == (0.1, 10)
    assert scores["gap_median"]["value"] == pytest.approx(0.9)
    assert scores["retuned"]["value"] is None
    assert set(TARGETS) <= set(scores)


def test_targets():
    assert reached("name_first", "clean", {"value": 0.97, "count": 9}) is True
    assert reached("name_first", "clean", {"value": 0.94, "count": 9}) is False
    assert reached("false_names", "clean", {"value": 0.01, "count": 350}) is True
    assert reached("false_names", "clean", {"value": 0.05, "count": 20}) is False
    assert reached("worse", "factory", {"value": 0.01, "count": 200}) is False
    assert reached("tie_size", "factory", {"value": 1.31, "count": 9}) is False
    assert reached("coverage", "dirty", {"value": 0.99, "count": 9}) is False
    assert reached("unknown", "dirty", {"value": None, "count": 0}) is None


def test_detection_limit_lies_where_the_answers_turn():
    (limit,) = detection_limits(rows_of_a_tier())
    assert limit["effect"] == "stribeck_friction"
    assert limit["half"] == pytest.approx(0.02 * 1.08**15.5, rel=0.1)
    assert limit["ninety"] > limit["half"]
    assert limit["grows_with_size"]


def test_confusion_and_calibration_count_the_same_cases():
    rows = rows_of_a_tier()
    table = confusion(rows)
    assert table["stribeck_friction"] == {"none": 11, "stribeck_friction": 24}
    assert table["nothing"] == {"none": 9, "stribeck_friction": 1}
    drawn = confusion_table(table)
    assert sum(c["count"] for c in drawn["rows"][0]["cells"]) == 35
    right = {r["truth"]: sum(c["count"] for c in r["cells"] if c["right"]) for r in drawn["rows"]}
    assert (right["stribeck_friction"], right["nothing"]) == (24, 9)
    retuned = confusion_table({"nothing": {"none": 1, "retuned": 8, "unknown": 1}}, wrong_file=True)
    assert [c["answer"] for c in retuned["rows"][0]["cells"] if c["right"]] == ["none", "retuned"]
    bins = calibration(rows)
    assert sum(b["names"] for b in bins) == 25
    assert sum(b["right"] for b in bins) == 24
    assert len(calibration_points(bins)) == sum(b["names"] > 0 for b in bins)


def test_page_says_what_was_missed(tmp_path, root):
    scores = tmp_path / "scores.json"
    scores.write_text(json.dumps(summarise(rows_of_a_tier())))
    write_page(str(scores), None, str(tmp_path / "page.html"), "sample", 1)
    page = (tmp_path / "page.html").read_text()
    assert re.search(r"<li><b>clean</b>: [^<]*right name first", page)
    assert "src=" not in page
    assert all(link.startswith(("#", "data:")) for link in re.findall(r'href="([^"]*)"', page))


def two_axes():
    rng = np.random.default_rng(0)
    terms = rng.normal(size=(400, 4))
    names = ("stribeck_friction", "stribeck_friction", "wear_drift", "payload")
    target = terms @ [1.0, 0.5, 0.0, 0.0] + 0.1 * rng.normal(size=400)
    return [AxisProblem(target, terms, names), AxisProblem(0.1 * rng.normal(size=400), terms, names)]


def test_a_part_holds_the_first_batches_of_every_tier():
    seed_set, numbers = part_batches("report_first_5")
    assert (seed_set, set(numbers.values())) == ("report", {5})
    _, all_of_them = part_batches("report")
    assert min(all_of_them.values()) > 5
    assert part_batches("sample_first_999") == part_batches("sample")


def test_a_curve_over_sizes_needs_cases_on_both_sides(tmp_path, root):
    scores, page = tmp_path / "scores.json", tmp_path / "page.html"
    scores.write_text(json.dumps(summarise(rows_of_a_tier())))
    write_page(str(scores), None, str(page), "sample", 1)
    assert page.read_text().count('<td class="left">larger</td>') == 1
    scores.write_text(json.dumps(summarise(rows_of_a_tier()[14:24])))
    write_page(str(scores), None, str(page), "sample", 1)
    assert '<td class="left">larger</td>' not in page.read_text()


def test_the_summary_is_small_and_says_how_much_was_run(tmp_path, root):
    scores = tmp_path / "scores.json"
    scores.write_text(json.dumps(summarise(rows_of_a_tier())))
    stored, page = tmp_path / "challenge.json", tmp_path / "page.html"
    write_stored(scores, stored, "report_first_2", 560, {"accept": 9.0})
    content = json.loads(stored.read_text())
    assert content["batches"] == dict.fromkeys(TIERS, 2)
    assert content["cases"] < content["cases_of_the_whole_set"] == 3180
    write_stored_page(stored, None, page)
    text = page.read_text()
    assert "the first 2 batches of every tier" in text
    assert f"(drawing {DRAWINGS['report']}: results on earlier ones had been seen" in text
    assert content["drawing"] == DRAWINGS["report"] > 1
    assert content["command"] in text


def test_peers_terms_are_counted_by_effect():
    problems = two_axes()
    coefficients = [least_squares(p, 6.0) for p in problems]
    (only,) = effects_of(problems, coefficients)
    assert only[:2] == ["stribeck_friction", 1]
    assert only[2] > 1000


def test_peers_are_scored_at_the_setting_that_did_best_elsewhere(tmp_path):
    truth, answers, own = tmp_path / "truth.json", tmp_path / "answers.json", tmp_path / "rows.json"
    cases = [facts(effects=[effect()]), facts("nothing", case="c2")]
    truth.write_text(json.dumps({"cases": cases}))
    right, extra = ["stribeck_friction", 2, 90.0], ["wear_drift", 1, 20.0]

    def said(*settings):
        return [{"method": "m", "setting": s, "named": n, "seconds": 0.1} for s, n in settings]

    answers.write_text(
        json.dumps(
            {
                "cases": [
                    {"case": "c1", "answers": said((1.0, [right, extra]), (2.0, [right]))},
                    {"case": "c2", "answers": said((1.0, [extra]), (2.0, []))},
                ]
            }
        )
    )
    own.write_text(json.dumps({"cases": [judge(c, verdict(), None, 1.0) for c in cases]}))
    files = [(str(truth), str(answers))]
    assert best_settings(judged_answers(files))["clean", "m"] == 2.0
    write_peer_scores(files, files, str(own), tmp_path / "peers.json")
    peer, shipped = json.loads((tmp_path / "peers.json").read_text())["tiers"]["clean"]
    assert (peer["setting"], peer["exact_set"], peer["false_cases"]) == (2.0, 1.0, 0)
    assert shipped["method"] == "jointwear discover"
    assert shipped["exact_set"] == 0.0


def test_every_effect_can_be_named():
    assert len(set(EFFECTS)) == len(EFFECTS)


def test_a_model_is_asked_at_the_instants_of_the_recording_though_discovery_used_others():
    # Two recordings at 1 kHz, each with a clock of its own; discovery takes every tenth sample from the fifth on.
    one = np.arange(1000) * 1e-3
    time, label = np.tile(one, 2), np.repeat([0, 1], 1000)
    nothing = np.zeros((2000, 1))
    recording = Recording(time, label, nothing, nothing)
    laid = elapsed_time(time, label)
    torque = np.sin(7.0 * laid)[:, None]
    used = np.concatenate([np.arange(5, 1000, 10), np.arange(1005, 2000, 10)])
    verdict = SimpleNamespace(sample_time=laid[used], sample_trajectory=label[used])
    wanted = np.arange(1000, 2000, 5)
    found = at_samples(verdict, torque[used], recording, wanted)
    inside = (wanted >= used[100]) & (wanted <= used[-1])
    assert found[inside] == pytest.approx(torque[wanted][inside], abs=1e-3)


def test_seconds_are_the_processor_time_that_passed(monkeypatch):
    """They were divided by the time of a loop in the interpreter, which varied more than they did."""

    def refused(*_):
        raise InputError("no")

    clock = iter([100.0, 102.5])
    monkeypatch.setattr(solve, "discover", refused)
    monkeypatch.setattr(solve.time, "process_time", lambda: next(clock))
    recording = SimpleNamespace(trajectory=np.array([1, 2]), test=(2,), joints=6)
    said, torque, seconds = solve.solve(recording, None, Settings())
    assert said == {"refused": "no"}
    assert np.isnan(torque).all()
    assert seconds == 2.5
