"""How discovery decides: gates in N m, groups of recordings, models put back, what a failed search leaves."""

import json
from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery import Settings, discover, pipeline
from jointwear.discovery.estimates.outcome import Named, Refusal
from jointwear.discovery.estimates.scan import scan
from jointwear.discovery.linear import Term
from jointwear.discovery.model.left_out import left_out_ratio
from jointwear.discovery.presentation.page import (
    lead,
    write_page,
)
from jointwear.discovery.problem.candidates import Candidate, build_dictionary, raw_blocks, term_of
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.search import acceptance, decide, forward_search, leftovers, named_effects
from jointwear.discovery.search.acceptance import missed, predictive
from jointwear.discovery.search.crossval import CrossValidated, cross_validate
from jointwear.discovery.search.explained import explained
from jointwear.discovery.search.leftovers import LINE, lasting, unexplained
from jointwear.discovery.settings import settings_of
from jointwear.discovery.stages import discover_dataset
from jointwear.effects import get_effect
from jointwear.files.errors import InputError
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import write_recording


def test_a_name_says_how_sure_it_is(found):
    (effect,) = found.effects
    assert (effect["effect"], effect["axis"]) == ("position_dependent_friction", 3)
    assert effect["lowers_error"] > 0.99
    assert effect["gain_share"] > 1.0
    assert 0.5 < effect["probability"] <= 1.0
    # Monday and Tuesday each show it alone.
    assert effect["repeated"] == 1.0
    assert found.data["to_the_noise"]
    assert "nothing beyond the noise is left" in " ".join(lead(found.data))


def test_a_form_that_says_more_than_was_seen_gives_way_to_a_plainer_one(found, monkeypatch):
    white, dictionary = found.final.outcome.white, found.final.outcome.dictionary
    drift = next(s for s in scan(white, dictionary, white.fit()) if s.candidate.key == ("torque_offset_drift", 2, None))
    (other,) = drift.others
    assert {"period", "time_constant"} == set(drift.candidate.nonlinear) ^ set(other.candidate.nonlinear)
    assert other.evidence <= drift.evidence
    drift = replace(drift, others=(replace(other, evidence=50.0),))
    asked = []

    def only_the_plain(white, named, trial):
        asked.append(trial)
        return ["refused"] if set(trial.candidate.nonlinear) == set(drift.candidate.nonlinear) else []

    monkeypatch.setattr(forward_search, "refusals", only_the_plain)
    trial, failed = forward_search.best_form(white, white.fit(), [], drift)
    assert failed == []
    assert set(trial.candidate.nonlinear) == set(other.candidate.nonlinear)
    assert len(asked) == 2
    # With too little evidence of its own the other form is not asked.
    weak = replace(drift, others=(replace(other, evidence=5.0),))
    assert forward_search.best_form(white, white.fit(), [], weak)[1] == ["refused"]


@pytest.mark.parametrize(("share", "plainer"), [(0.9, True), (0.3, False)])
def test_a_form_competes_by_what_it_predicts_where_it_explains_nearly_as_much(found, monkeypatch, share, plainer):
    """Beside a payload without a name a gear on one axis had predicted better than the true one on all of them."""
    white, dictionary = found.final.outcome.white, found.final.outcome.dictionary
    drift = next(s for s in scan(white, dictionary, white.fit()) if s.candidate.key == ("torque_offset_drift", 2, None))
    (other,) = drift.others
    drift = replace(drift, others=(replace(other, evidence=share * drift.evidence),))

    def better_the_plainer(white, before, trial):
        plain = set(trial.candidate.nonlinear) == set(other.candidate.nonlinear)
        return CrossValidated(nats=60.0, share=0.25, worst=3.0, gain_share=2.0 if plain else 1.0), None

    monkeypatch.setattr(forward_search, "refusals", lambda *_: [])
    monkeypatch.setattr(forward_search, "predictive", better_the_plainer)
    trial, _ = forward_search.best_form(white, white.fit(), [], drift)
    assert (set(trial.candidate.nonlinear) == set(other.candidate.nonlinear)) is plainer


def test_families_are_ranked_off_their_grids(found):
    """A bend makes up for a step of the grid too: a coarse grid would lose against a fine one."""
    white, dictionary = found.final.outcome.white, found.final.outcome.dictionary
    speed = white.problem.train_state.velocity[:, [1]]
    lacking = 4.0 * white.whiteners[1].marginal * np.sign(speed) / np.cosh(speed / 0.12)
    targets = list(white.targets)
    targets[1] = targets[1] + white.columns(1, lacking)[:, 0]
    trial = replace(white, targets=targets)
    fit = trial.fit()
    scored = next(s for s in scan(trial, dictionary, fit) if s.candidate.key == ("stribeck_friction", 1, None))
    moved = named_effects.off_grid(trial, fit, scored)
    assert moved.candidate.key == scored.candidate.key
    assert moved.candidate.nonlinear["speed"] != scored.candidate.nonlinear["speed"]
    assert moved.evidence > scored.evidence + 1.0
    for key in (("torque_constant_error", 1, None), ("actuation_delay", 1, None)):
        same = next((s for s in scan(trial, dictionary, fit) if s.candidate.key == key), None)
        assert same is None or named_effects.off_grid(trial, fit, same) is same


def test_a_load_is_not_refused_for_what_one_joint_lacks(found):
    outcome = found.final.outcome
    problem, coefficients = outcome.problem, np.zeros(10)
    load = get_effect("payload")
    columns = load.columns(problem.train_state, 0, None, {})
    coefficients[:4] = 0.5, 0.0, 0.0, 0.02
    torque = columns @ coefficients[: columns.shape[-1]]
    # In the last record something of another kind acts on joint 2, many times as large and against the load.
    last = problem.part_of_sample == problem.part_of_sample.max()
    wrong = torque.copy()
    wrong[last, 1] -= 6.0 * torque[last, 1]
    discrepancy = problem.discrepancy.copy()
    discrepancy[problem.train] += wrong
    white = whiten(replace(problem, discrepancy=discrepancy), outcome.white.whiteners)
    candidate, blocks, std = next(x for x in build_dictionary(white).whole if x[0].effect == "payload")
    term = Term("payload", blocks, std, raw_blocks(white, candidate))
    before = [t for n in outcome.named for t in n.terms]
    trial = Named(candidate, term, None, 1000.0)
    plain = missed(cross_validate(white, before, [term]), 1000.0, problem.settings)
    assert any("gains least" in gate for gate, _, _ in plain)
    assert not any("gains least" in r.gate for r in predictive(white, before, trial)[1])


@pytest.mark.parametrize(("mass", "may_be"), [(0.5, True), (-0.9, False)])
def test_a_robot_cannot_lose_more_than_it_has(found, mass, may_be):
    """A hose that lifts the flange looks like a load of negative mass; the last link of a PUMA weighs 0.09 kg."""
    outcome = found.final.outcome
    problem = outcome.problem
    columns = get_effect("payload").columns(problem.train_state, 0, None, {})
    coefficients = np.zeros(columns.shape[-1])
    coefficients[[0, 3]] = mass, 0.05 * mass
    discrepancy = problem.discrepancy.copy()
    discrepancy[problem.train] += columns @ coefficients
    white = whiten(replace(problem, discrepancy=discrepancy), outcome.white.whiteners)
    candidate, blocks, std = next(x for x in build_dictionary(white).whole if x[0].effect == "payload")
    trial = Named(candidate, Term("payload", blocks, std, raw_blocks(white, candidate)), None, 1000.0)
    assert (acceptance.bound_missed(white, white.fit(), trial) is None) == may_be


@pytest.mark.parametrize(
    ("times", "most"), [(2.0, "at most"), (0.3, "at least"), (1.0, None)], ids=["larger", "smaller", "as it says"]
)
def test_a_bound_that_is_missed_is_told_with_its_parameter(found, times, most):
    """Reached 0, needed 1 said neither which parameter nor which bound."""
    white = found.final.outcome.white
    candidate = Candidate("actuation_delay", 1, None, {"delay": 0.01, "lag": 0})
    term = term_of(white, candidate)
    targets = [y + times * term.blocks[a][:, 0] if a == 1 else y for a, y in enumerate(white.targets)]
    told = acceptance.bound_missed(white, replace(white, targets=targets).fit(), Named(candidate, term, None, 99.0))
    if most is None:
        assert told is None
        return
    gate, reached, needed = told
    assert gate == f"torque that fits over that of its delay, {most}"
    assert reached == pytest.approx(times, abs=0.2)
    assert needed == pytest.approx(white.problem.settings.off_scale ** (1 if times > 1 else -1))
    spring = get_effect("joint_flexibility")
    assert spring.beyond({"damping": 1.2}) == ("its damping [1], at most", 1.2, 1.0)
    assert spring.beyond({"damping": float("nan")})[0] == "its damping [1], at least"
    assert spring.beyond({"damping": 0.015}) is None


def delay_with_form(found):
    """Return the problem and a delay of joint 3, with a term that stands for its bend."""
    white, (one,) = found.final.outcome.white, found.final.outcome.named
    late = Candidate("actuation_delay", 2, None, {"delay": 0.004, "lag": 0})
    return white, replace(one, candidate=late, form=replace(one.term, label="form"))


@pytest.mark.parametrize("worst", ["bent", "plain"])
def test_one_record_may_ask_for_the_bend_that_no_robot_file_holds(found, monkeypatch, worst):
    """All records together are asked of the textbook form: that is what is written."""
    white, trial = delay_with_form(found)
    plain = CrossValidated(nats=110.0, share=0.4, worst=-50.0, last=30.0)
    bent = CrossValidated(nats=350.0, share=0.8, worst=35.0, last=120.0)
    if worst == "plain":
        plain = replace(plain, nats=10.0)
    monkeypatch.setattr(acceptance, "cross_validate", lambda w, b, terms, p: plain if len(terms) == 1 else bent)
    result, failed = predictive(white, [], trial)
    assert result is plain
    assert bool(failed) == (worst == "plain")


def test_what_a_bend_takes_up_is_the_effects_own(found, monkeypatch):
    """A drift has to predict in its textbook form, and yet explains what its bend explains; a bend may lose too."""
    white, (one,) = found.final.outcome.white, found.final.outcome.named
    drift = replace(one, candidate=Candidate("torque_offset_drift", 2, None), form=one.term)
    plain = CrossValidated(nats=3000.0, share=0.6)
    for share in (0.88, 0.3):
        monkeypatch.setattr(
            "jointwear.discovery.search.explained.cross_validate", lambda *_, s=share: replace(plain, share=s)
        )
        assert explained(white, [], drift, plain) == max(share, 0.6)
    late = delay_with_form(found)[1]
    assert explained(white, [], late, plain) == 0.6


def test_the_augmented_robot_is_better_on_records_left_out(found):
    final = found.final
    ratio = left_out_ratio(final.outcome.white, final.fit.terms)
    assert np.all(ratio <= found.problem.settings.not_worse)
    assert ratio[2] < 0.5
    assert left_out_ratio(final.outcome.white, []) == pytest.approx(1.0)


def test_groups_name_trajectories_of_the_data(case, robot):
    with pytest.raises(InputError, match=r"'group\.b' holds trajectory 9"):
        discover(case, robot, settings_of({"group": {"a": [0], "b": [9]}}))
    with pytest.raises(InputError, match="which is in 'a' too"):
        discover(case, robot, settings_of({"group": {"a": [0], "b": [0]}}))


def test_a_failed_search_leaves_a_verdict_and_a_page(case, tmp_path, monkeypatch):
    def fails(problem):
        raise np.linalg.LinAlgError("not positive definite")

    monkeypatch.setattr(pipeline, "search", fails)
    write_recording(split(case), tmp_path / "case.nc", {"dataset": "case"})
    entry = {"measured": str(tmp_path / "case.nc"), "robot": "config/robots/puma560.yaml"}
    discover_dataset("case", entry, entry["robot"], tmp_path, tmp_path / "log")
    written = json.loads((tmp_path / "verdict.json").read_text())
    assert written["verdict"] == "unknown"
    assert "not positive definite" in written["misfits"][0]
    assert "not positive definite" in (tmp_path / "log").read_text()
    assert written["gap"]["augmented"] == pytest.approx(written["gap"]["nominal"], rel=1e-4)
    pages = [tmp_path / name for name in ("verdict.json", "where.nc", "models.nc", "page.html")]
    write_page(*pages, tmp_path / "figures")
    assert "model, RMS error in N&nbsp;m" in pages[-1].read_text()
    assert '<ol class="wraps">' in pages[-1].read_text()
    assert "a calculation went wrong" in pages[-1].read_text().lower()
    assert "No effect of the library is needed" not in pages[-1].read_text()


def test_one_sample_that_jumps_is_no_structure(found):
    outcome = found.final.outcome
    white, axis = outcome.white, 4
    rows = white.whiteners[axis].rows
    before = unexplained(outcome)[0]
    targets = [y.copy() for y in white.targets]
    targets[axis][np.argmax(white.axis_state(axis).torque[rows, axis])] += 100.0
    jumped = replace(outcome, white=replace(white, targets=targets))
    jumped.unexplained = unexplained(jumped)[0]
    assert {u.axis for u in jumped.unexplained} == {axis} | {u.axis for u in before}
    assert [(u.axis, u.argument) for u in lasting(jumped)] == [(u.axis, u.argument) for u in before]


@pytest.mark.parametrize("instant", [True, False])
def test_one_instant_that_is_off_is_no_structure(found, instant):
    """Where the acceleration jumps, samples beside each other are off, each by little more than one may be."""
    outcome = found.final.outcome
    white, axis = outcome.white, 4
    before = [(u.axis, u.argument) for u in unexplained(outcome)[0]]
    state = white.axis_state(axis)
    torque, used = state.torque[:, axis], white.problem.usable[:, axis]
    largest = np.argmax(np.where(used, torque, -np.inf))
    if instant:
        block = white.problem.block_of_sample
        off = np.exp(-(((state.time - state.time[largest]) / 0.1) ** 2)) * (block == block[largest])
    else:
        off = np.cos(4.0 * torque / np.std(torque[used]))
    extra = white.columns(axis, off[:, None])[:, 0]
    targets = [y.copy() for y in white.targets]
    targets[axis] += extra * np.sqrt(2.0 * 400.0 / (extra @ extra))
    jumped = replace(outcome, white=replace(white, targets=targets))
    jumped.unexplained = unexplained(jumped)[0]
    assert (axis, "torque") in {(u.axis, u.argument) for u in jumped.unexplained}
    left = [(u.axis, u.argument) for u in lasting(jumped)]
    assert left == before if instant else (axis, "torque") in left


@pytest.mark.parametrize("shown", [True, False])
def test_a_line_counts_where_positions_show_its_motion(found, monkeypatch, shown):
    outcome = found.final.outcome
    white, axis = outcome.white, 4
    wave = white.columns(axis, np.sin(2.0 * np.pi * 20.0 * white.problem.train_state.time)[:, None])[:, 0]
    targets = [y.copy() for y in white.targets]
    targets[axis] += wave * np.sqrt(2.0 * 500.0 / (wave @ wave))
    rings = replace(outcome, white=replace(white, targets=targets))
    of_positions = leftovers.torque_noise
    monkeypatch.setattr(leftovers, "torque_noise", lambda *given: of_positions(*given) * (1e-9 if shown else 1e9))
    assert ((axis, LINE) in {(u.axis, u.argument) for u in unexplained(rings)[0]}) == shown


def test_samples_that_are_all_far_off_are_no_outliers(found):
    """Clipped at four times the noise a torque of hundreds of times the noise is too small to matter to the joint."""
    outcome = found.final.outcome
    white, axis = outcome.white, 4
    rows = white.whiteners[axis].rows
    position = white.problem.train_state.position[rows, 3]
    targets = [y.copy() for y in white.targets]
    targets[axis] += 300.0 * np.sin(3.0 * position) * np.sign(white.axis_state(axis).velocity[rows, axis])
    # Only what is worth twenty times the noise matters to this joint.
    torque = float(np.sqrt(np.mean(white.problem.train_state.torque[white.problem.usable[:, axis], axis] ** 2)))
    share = 20.0 * white.whiteners[axis].marginal / torque
    problem = replace(white.problem, settings=replace(white.problem.settings, smallest_share=share))
    off = replace(outcome, problem=problem, white=replace(white, problem=problem, targets=targets))
    off.unexplained = unexplained(off)[0]
    assert axis in {u.axis for u in lasting(off)}


def test_of_a_torque_constant_only_counts_what_drives_cannot_take_over(found):
    problem = found.final.outcome.white.problem
    used = problem.usable[:, 1]
    drives = problem.friction_columns(problem.train_state, 1)[used] @ [3.0, -3.0, 2.0, 0.5]
    load = problem.train_state.load[used, 1]
    left = acceptance.without_drives(problem, 1, drives)
    assert np.abs(left).max() < 1e-9 * np.abs(drives).max()
    assert np.std(acceptance.without_drives(problem, 1, load)) > 0.1 * np.std(load)


def test_of_two_that_are_as_likely_one_is_named(found, monkeypatch):
    outcome = replace(found.final.outcome, refusals=[])
    (one,) = outcome.named
    rival = next(c.candidate for c in scan(outcome.white, outcome.dictionary, outcome.white.fit()) if _rivals(c, one))
    beside = []

    def weighed(outcome, named, _):
        assert any(n is named for n in outcome.named)
        sure = named.candidate.key == rival.key or rival.key in {r.candidate.key for r in outcome.refusals}
        return replace(named, probability=0.9 if sure else 0.45, ties=(rival,))

    def gates(white, rest, trial):
        beside.append(rest)
        return answers[-1]

    monkeypatch.setattr(decide, "weigh", weighed)
    monkeypatch.setattr(decide, "refusals", gates)
    answers = [[]]
    assert decide.likelier(outcome, one).candidate.key == rival.key
    assert not outcome.refusals
    answers.append([Refusal(rival, 1.0, "gate", 0.0, 1.0)])
    again = decide.likelier(outcome, one)
    assert (again.candidate.key, again.probability) == (one.candidate.key, 0.9)
    assert [r.candidate.key for r in outcome.refusals] == [rival.key]
    # In the place of the effect, not beside it.
    assert beside == [[], []]


def _rivals(scored, one):
    return scored.candidate.axis == one.candidate.axis and scored.candidate.key != one.candidate.key


def test_what_a_record_may_cost_follows_what_an_effect_is_worth():
    settings = Settings()
    weak, strong = (CrossValidated(nats=n, share=0.5, worst=-0.04 * n) for n in (50.0, 5000.0))
    assert missed(weak, 60.0, settings) == missed(strong, 6000.0, settings) == []
    least = settings.form_error * settings.accept
    assert not missed(CrossValidated(nats=1.01 * least, share=0.5), 0.0, settings)
    assert missed(CrossValidated(nats=0.99 * least, share=0.5), 0.0, settings)[0][2] == pytest.approx(least)
