"""What is written is never worse than what was given, and says how sure it is."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings, discover
from jointwear.discovery.estimates.base import likely_base
from jointwear.discovery.estimates.misfit import divided, misfit_of, tempered
from jointwear.discovery.estimates.outcome import Unexplained
from jointwear.discovery.estimates.refined_model import RefinedEffect, RefinedModel
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.model import sound_files
from jointwear.discovery.model.estimation import doubts, finalise
from jointwear.discovery.model.fallback import AS_FITTED, DRIVE, FELT, HELD, HELD_WITHOUT, OF_LINKS, OWN, Step, put_back
from jointwear.discovery.model.final_model import Weighing, named_all_the_same
from jointwear.discovery.model.left_out import Asked, left_out_ratio
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.problem.whitening import INERTIAL
from jointwear.discovery.search.crossval import cross_validate


@pytest.fixture(scope="module")
def found(robot):
    """Friction of joint 3 that grows with the root of the speed in place of the viscous friction of the robot file."""

    def root(q, v, *_):
        full = np.zeros_like(q)
        full[:, 2] = 4.0 * np.sqrt(np.abs(v[:, 2])) * np.sign(v[:, 2]) - robot.viscous[2] * v[:, 2]
        return full

    return discover(make_case(robot, 22, root), robot, Settings())


def _that_lacks(white, told):
    """`white` with nothing left on any axis but what `told` {axis: (m,)} says, over the noise."""
    odd = replace(white.problem, discrepancy=white.problem.discrepancy.copy())
    targets = [np.zeros_like(y) for y in white.targets]
    for axis, y in told.items():
        whitener = white.whiteners[axis]
        odd.discrepancy[np.flatnonzero(white.problem.train)[whitener.rows], axis] = whitener.marginal * y
        targets[axis] = y
    return replace(white, problem=odd, targets=targets)


def test_a_parameter_may_go_to_zero_where_an_effect_takes_its_place(found, robot):
    assert [(e["effect"], e["axis"]) for e in found.effects] == [("nonlinear_viscous_friction", 3)]
    assert found.augmented_robot["joints"][2]["viscous"] < 0.25 * robot.viscous[2] / robot.gear_ratio[2] ** 2
    held = found.problem.measured.usable[:, 2] & found.problem.test
    rms = {k: np.sqrt(np.mean((found.problem.measured.torque - t)[held, 2] ** 2)) for k, t in found.torques.items()}
    assert rms["augmented"] < 0.5 * rms["retuned"] <= 0.5 * rms["nominal"]


def test_a_misfit_divides_what_an_axis_says(found):
    white = found.final.outcome.white
    right = white.fit(found.final.outcome.named[0].terms)
    misfit = misfit_of(white, right)
    assert np.all((misfit >= 1.0) & (misfit < 1.5))
    # Something in every fourth block that no term describes.
    odd = [y.copy() for y in white.targets]
    odd[2] += 6.0 * (white.blocks(2) % 4 == 0)
    wrong = misfit_of(white, Fit(odd, right.terms))
    assert wrong[2] > 20.0
    assert np.delete(wrong, 2) == pytest.approx(np.delete(misfit, 2), abs=0.02)
    assert tempered(white, np.ones(6)) is white
    weak = tempered(white, np.full(6, 1e2))
    assert weak.targets[2] == pytest.approx(white.targets[2] / 10.0)
    term = divided(right.terms[0], np.full(6, 1e2))
    assert all(x == pytest.approx(right.terms[0].blocks[axis] / 10.0) for axis, x in term.blocks.items())
    columns = found.problem.train_state.velocity[:, [2]]
    assert weak.columns(2, columns) == pytest.approx(white.columns(2, columns) / 10.0)
    assert weak.raw_targets[2] == pytest.approx(white.raw_targets[2])


def test_what_helps_while_a_wall_is_touched_only_is_no_better_robot(found):
    white = found.final.outcome.white
    axis, label = 1, white.blocks(1)
    touched = label % 4 == 0
    wall = 50.0 * touched * white.whiteners[axis].sigma
    column = touched + 0.3
    odd = replace(white.problem, discrepancy=white.problem.discrepancy.copy())
    rows = np.flatnonzero(white.problem.train)[white.whiteners[axis].rows]
    odd.discrepancy[rows, axis] += wall
    term = replace(
        white.base[0],
        label="wall",
        blocks={axis: column[:, None] * 1.0},
        raw={axis: column[:, None] * white.whiteners[axis].sigma},
        std=np.array([1e3]),
        drive=(),
    )
    targets = [y.copy() for y in white.targets]
    targets[axis] += 50.0 * touched
    trial = replace(white, problem=odd, targets=targets)
    assert left_out_ratio(trial, [term], each=False)[axis] < 0.7
    assert left_out_ratio(trial, [term])[axis] > 1.5
    assert Asked(trial, [term])([term]).surely[axis] > 1.5


def test_of_three_records_two_need_not_tell_of_the_third(found):
    """A torque that only the last of three records shows is predicted from its other half, not from other records."""
    white, axis = found.final.outcome.white, 1
    problem = replace(white.problem, discrepancy=np.zeros_like(white.problem.discrepancy))
    order = np.arange(problem.train.sum())
    fold, half = order * 3 // len(order), order * 6 // len(order)
    problem.__dict__.update(fold_of_sample=fold, part_of_sample=half)
    column = (fold == 2)[:, None].astype(float)
    problem.discrepancy[np.flatnonzero(problem.train), axis] = 2.0 * column[:, 0]
    trial = replace(white, problem=problem, targets=[np.zeros_like(y) for y in white.targets])
    trial.targets[axis] += trial.columns(axis, 2.0 * column)[:, 0]
    term = Term("late", {axis: trial.columns(axis, column)}, np.array([10.0]), {axis: trial.raw(axis, column)})
    assert left_out_ratio(trial, [term], each=False)[axis] == pytest.approx(1.0)
    assert left_out_ratio(trial, [term], each=False, parts=True)[axis] < 0.1


def test_an_axis_that_lacks_what_nothing_explains_keeps_its_parameters_as_given(found):
    outcome = found.final.outcome
    white = outcome.white
    # Friction of joint 1 that comes and goes with every eighth block: fitted, it helps little and lasts no longer.
    axis = 0
    odd = replace(outcome.problem, discrepancy=outcome.problem.discrepancy.copy())
    label = outcome.problem.block_of_sample
    gripped = 4.0 * np.sign(outcome.problem.train_state.velocity[:, axis]) * (label % 8 == 0)
    odd.discrepancy[outcome.problem.train, axis] += gripped
    targets = [y.copy() for y in white.targets]
    targets[axis] += white.whiteners[axis](gripped)
    trial = replace(white, problem=odd, targets=targets)
    left = Unexplained(axis, "time", "s", 0.0, 1.0, 1e-20, 500.0)
    fit = trial.fit([t for n in outcome.named for t in n.terms])
    lacking = replace(outcome, problem=odd, white=trial, fit=fit, unexplained=[left])
    doubt = doubts(lacking)
    assert doubt[axis] > 5.0
    assert np.all(np.delete(doubt, axis) == 1.0)
    final = finalise(lacking)
    assert np.all(final.delta_friction[axis] == 0.0)
    assert {(f.model, f.axis) for f in final.fallbacks} >= {("augmented", 1), ("retuned", 1)}
    assert [e.named.candidate.key for e in final.estimates] == [("nonlinear_viscous_friction", 2, None)]
    # An axis with a name, and one without structure, count as they are.
    assert np.all(doubts(replace(lacking, unexplained=[replace(left, axis=2)])) == 1.0)
    assert np.all(doubts(replace(lacking, unexplained=[])) == 1.0)


def test_an_effect_that_one_record_alone_tells_of_is_asked_by_halves_of_records(found):
    white = found.final.outcome.white
    axis, record = 1, white.folds(1)
    last = (record == record[-1]).astype(float)
    sigma = white.whiteners[axis].sigma
    odd = replace(white.problem, discrepancy=white.problem.discrepancy.copy())
    odd.discrepancy[np.flatnonzero(white.problem.train)[white.whiteners[axis].rows], axis] += 30.0 * sigma * last
    targets = [y.copy() for y in white.targets]
    targets[axis] += 30.0 * last
    trial = replace(white, problem=odd, targets=targets)
    term = Term("step", {axis: last[:, None]}, np.array([100.0]), {axis: sigma * last[:, None]})
    # As a parameter of the model it has to extrapolate to a record that it knows nothing of.
    assert left_out_ratio(trial, [term], each=False)[axis] > 0.95
    assert left_out_ratio(trial, [replace(term, effect=True)], each=False)[axis] < 0.5
    everywhere = replace(term, blocks={axis: np.ones((len(last), 1))}, raw={axis: sigma * np.ones((len(last), 1))})
    asked = [left_out_ratio(trial, [replace(everywhere, effect=effect)])[axis] for effect in (True, False)]
    assert asked[0] == asked[1]


def test_evidence_is_asked_without_the_block_of_time_that_gives_most_of_it(found):
    white = found.final.outcome.white
    axis, block = 1, white.blocks(1)
    column = np.random.default_rng(4).standard_normal(len(block))
    raw = {axis: (white.whiteners[axis].sigma * column)[:, None]}
    term = Term("made up", {axis: column[:, None]}, np.array([1.0]), raw)
    once = block == block[len(block) // 3]
    for shown, everywhere in ((once, False), (np.ones(len(block), bool), True)):
        targets = [y.copy() for y in white.targets]
        targets[axis] += (0.4 if everywhere else 2.0) * column * shown
        held = cross_validate(replace(white, targets=targets), [], [term])
        assert (held.elsewhere > 0.8 * held.nats > 20.0) if everywhere else (held.elsewhere < 4.5)


@pytest.mark.parametrize("dragging", [0.5, 1.0])
def test_friction_of_half_of_the_time_is_no_drive_parameter(found, dragging):
    """What a brake adds now and then is a mean of two states, right in neither: its next share of the time is open."""
    white = found.final.outcome.white
    axis = 0
    label, sign = white.blocks(axis) // 8, np.sign(white.problem.train_state.velocity[white.whiteners[axis].rows, axis])
    drags = label % 2 < 2 * dragging
    sigma = white.whiteners[axis].marginal
    trial = _that_lacks(white, {axis: 20.0 * sign * drags})
    blocks, raw = {axis: sign[:, None] * 1.0}, {axis: sigma * sign[:, None]}
    term = Term("friction", blocks, np.array([1e3]), raw, (axis, 0))
    step = Step(DRIVE, (term,), of_drive=True)
    asked = Asked(trial, [term])([term])
    assert (asked.gained[axis] > 0.99) == (dragging == 1.0)
    assert asked.ratio[axis] < 0.9
    for open_axes in ([], [axis]):
        kept, given_up = put_back(trial, [term], {axis: [step]}, "augmented", open_axes)
        assert len(kept) == int(dragging == 1.0)
        # It is told where structure is left.
        assert [f.step for f in given_up] == ([] if kept or not open_axes else [DRIVE])


def test_a_part_of_a_model_is_asked_as_if_it_were_the_whole(found):
    final = found.final
    white = final.outcome.white
    links = next(t for t in white.base if t.label == INERTIAL)
    terms = [*(t for t in final.fit.terms if t.label != INERTIAL), links]
    ask = Asked(white, terms)
    own = next(t for t in terms if t.drive == (2, 0))
    held = Step("", (own,), deaf=2, hold=1e3 * links.raw[2].T @ links.raw[2])
    for step in (Step("", (own,)), *OF_LINKS, Step("", tuple(t for t in terms if t.effect)), held):
        kept = step.taken_off(terms)
        part, alone = ask(kept), Asked(white, kept)(kept)
        for name in ("ratio", "surely", "gained"):
            assert getattr(part, name) == pytest.approx(getattr(alone, name), rel=1e-9)


@pytest.mark.parametrize("has_effect", [False, True])
def test_a_joint_that_links_make_worse_is_held_and_the_others_keep_what_it_does_not_feel(found, has_effect):
    """One joint asks for links that another contradicts: as given they would be lost to both.

    An effect of that joint alone that helps and does not mend it goes too.
    """
    white = found.final.outcome.white
    lacks, right = 0, 2
    rows = {axis: white.whiteners[axis].rows for axis in (lacks, right)}
    sigma = {axis: white.whiteners[axis].marginal for axis in rows}
    velocity = white.problem.train_state.velocity
    own = np.sign(velocity[rows[lacks], lacks])
    both = np.stack([own, np.cos(np.arange(len(own)))], axis=1)
    felt = np.stack([np.sign(velocity[rows[right], right]), np.zeros(len(rows[right]))], axis=1)
    rng = np.random.default_rng(1)
    idle = np.cos(3.0 * np.arange(len(felt)))[:, None]
    told = {lacks: both @ [1.0, 4.0], right: rng.normal(size=len(felt)) + 0.15 * has_effect * idle[:, 0]}
    told[lacks] += 3.0 * has_effect * rng.normal(size=len(own))
    trial = _that_lacks(white, told)
    blocks = {lacks: both, right: felt}
    links = Term(INERTIAL, blocks, np.full(2, 1e3), {axis: sigma[axis] * x for axis, x in blocks.items()})
    effect = Term("effect", {right: idle}, np.ones(1), {right: sigma[right] * idle}, effect=True)
    effects, steps = ([effect], [Step("without it", (effect,))]) if has_effect else ([], list(OF_LINKS))
    kept, given_up = put_back(trial, [links, *effects], {right: steps}, "augmented")
    assert [(f.axis, f.step, f.held) for f in given_up] == [(right + 1, HELD_WITHOUT if has_effect else HELD, True)]
    ratio = Asked(trial, kept)(kept).ratio
    assert ratio[right] <= white.problem.settings.not_worse
    assert ratio[lacks] < 0.8
    (held,) = kept
    theta = held.turn @ Fit(trial.targets, kept).theta
    assert theta == pytest.approx([0.0, 4.0], abs=0.3)


@pytest.mark.parametrize("is_open", [True, False])
def test_a_joint_with_structure_that_gains_nothing_by_links_alone_feels_none_of_them(found, is_open):
    """What is told by other joints may be right there; where nothing explains what a joint lacks it is no better."""
    white = found.final.outcome.white
    tells, lacks = 0, 2
    rows = {axis: white.whiteners[axis].rows for axis in (tells, lacks)}
    sigma = {axis: white.whiteners[axis].marginal for axis in rows}
    rng = np.random.default_rng(2)
    felt = {axis: rng.choice([-1.0, 1.0], size=(len(rows[axis]), 1)) for axis in rows}
    told = {tells: 4.0 * felt[tells][:, 0], lacks: 20.0 * rng.normal(size=len(felt[lacks]))}
    trial = _that_lacks(white, told)
    blocks = {tells: np.hstack([felt[tells]] * 2), lacks: felt[lacks] * np.array([[1.0, 0.0]])}
    links = Term(INERTIAL, blocks, np.full(2, 1e2), {axis: sigma[axis] * x for axis, x in blocks.items()})
    kept, given_up = put_back(trial, [links], {}, "augmented", [lacks] if is_open else [])
    assert [(f.axis, f.step) for f in given_up] == ([(lacks + 1, FELT)] if is_open else [])
    (own,) = kept
    fitted = Fit(trial.targets, kept).theta
    theta = fitted if own.turn is None else own.turn @ fitted
    assert theta.sum() == pytest.approx(4.0, abs=0.1)
    assert (abs(theta[0]) < 0.2) == is_open


@pytest.mark.parametrize("last", [0.6, 0.99])
def test_friction_that_gains_in_every_record_is_written_where_structure_is_left_too(found, last):
    """All records together gain, no one is worse: that one gains less is no sign that a further one will lose."""
    white = found.final.outcome.white
    axis = 0
    record, sign = white.folds(axis), np.sign(white.problem.train_state.velocity[white.whiteners[axis].rows, axis])
    sigma = white.whiteners[axis].marginal
    trial = _that_lacks(white, {axis: 20.0 * sign * np.where(record == record.max(), last, 1.0)})
    term = Term("friction", {axis: sign[:, None]}, np.array([1e3]), {axis: sigma * sign[:, None]}, (axis, 0))
    asked = Asked(trial, [term])([term])
    assert asked.ratio[axis] < 0.8
    assert asked.gained[axis] > 0.99
    for open_axes in ([], [axis]):
        step = Step(DRIVE, (term,), of_drive=True)
        kept, _ = put_back(trial, [term], {axis: [step]}, "augmented", open_axes)
        assert kept


def test_an_axis_counts_as_without_a_name_by_the_effects_that_a_model_has(found, monkeypatch):
    asked = []

    def gives_up_effects(white, terms, steps, model, open_axes=()):
        asked.append((model, list(open_axes)))
        return [t for t in terms if not t.effect], ()

    monkeypatch.setattr("jointwear.discovery.model.estimation.put_back", gives_up_effects)
    left = Unexplained(2, "position", "rad", 0.0, 1.0, 1e-12, 50.0)
    assert [n.candidate.axis for n in found.final.outcome.named] == [2]
    finalise(replace(found.final.outcome, unexplained=[left]))
    assert asked == [("augmented", []), ("augmented", [2]), ("retuned", [2])]


def test_a_name_that_the_file_does_without_is_a_suspect_where_structure_is_left_on_its_axis(found, monkeypatch):
    monkeypatch.setattr(
        "jointwear.discovery.model.estimation.put_back",
        lambda _, terms, *more: ([t for t in terms if not t.effect], ()),
    )
    for axis, suspected in ((2, True), (1, False)):
        left = Unexplained(axis, "position", "rad", 0.0, 1.0, 1e-12, 50.0)
        outcome = replace(found.final.outcome, unexplained=[left], suspects=[])
        final = finalise(outcome)
        assert [e.named.candidate.axis for e in final.unwritten] == ([] if suspected else [2])
        assert bool(final.suspects) == suspected


@pytest.mark.parametrize("leans", [True, False])
def test_links_on_which_no_axis_leans_are_as_given(found, leans):
    """One coefficient moves two axes. Both lack something that comes and goes, or the second lacks it at all times."""
    white = found.final.outcome.white
    lacking, blocks, raw = {}, {}, {}
    for axis in (0, 1):
        told = np.where(white.folds(axis) == white.folds(axis).max(), -0.2, 0.2)
        if leans and axis == 1:
            told = 0.2
        lacking[axis] = 20.0 * (told + 0.6 * np.sign(white.blocks(axis) % 2 - 0.5) * (axis == 0))
        blocks[axis] = np.ones((len(lacking[axis]), 1))
        raw[axis] = white.whiteners[axis].marginal * blocks[axis]
    trial = _that_lacks(white, lacking)
    links = Term(INERTIAL, blocks, np.array([1e3]), raw)
    given, asked = Asked(trial, [links])([]).ratio, Asked(trial, [links])([links]).ratio
    assert (asked[1] < given[1]) == leans
    kept, _ = put_back(trial, [links], {}, "augmented")
    assert [t.label for t in kept] == ([INERTIAL] if leans else [])


def test_a_bad_file_of_one_kind_leaves_the_other_alone(found, monkeypatch):
    problem, bad = found.problem, found.torques["retuned"]
    monkeypatch.setattr(sound_files, "_worse", lambda _, torque: {0: 1.2} if np.allclose(torque, bad) else {})
    final, files, torques = sound_files.sound_files(problem, found.final.outcome)
    assert np.array_equal(torques["augmented"], found.torques["augmented"])
    assert files["augmented"].data == found.files["augmented"].data
    assert not np.allclose(torques["retuned"], bad)
    assert [e.named.candidate.key for e in final.estimates] == [e.named.candidate.key for e in found.final.estimates]


def test_links_of_a_bad_file_are_closer_to_those_given_before_they_are_as_given(found, monkeypatch):
    """For one joint that links of a quarter of their freedom mend, links as given would take from all others."""
    whole, asked = found.final, []
    told = replace(whole, delta_inertial=whole.delta_inertial.copy(), retuned_inertial=whole.retuned_inertial.copy())
    mass = 10 * (found.problem.robot.joints - 1)
    for inertial in (told.delta_inertial, told.retuned_inertial):
        inertial[mass] += 0.4

    def of(_, links=AS_FITTED):
        asked.append(links.links)
        width = min(links.links, 1.0)
        return replace(told, delta_inertial=width * told.delta_inertial, retuned_inertial=width * told.retuned_inertial)

    def torque(width):
        return sound_files.write_files(found.problem, of(None, Step("", links=width)))[2]["augmented"]

    nominal = sound_files.write_files(found.problem, of(None, OF_LINKS[-1]))[2]["augmented"]
    most = 1.1 * np.max(np.abs(torque(0.25) - nominal))
    monkeypatch.setattr(sound_files, "finalise", of)
    monkeypatch.setattr(sound_files, "_worse", lambda _, t: {1: 1.5} if np.max(np.abs(t - nominal)) > most else {})
    asked.clear()
    final, _, torques = sound_files.sound_files(found.problem, found.final.outcome)
    # Each width is fitted once for both files.
    assert asked == [np.inf, 0.0, 0.5, 0.25]
    assert final.delta_inertial == pytest.approx(0.25 * told.delta_inertial)
    assert torques["augmented"] == pytest.approx(torque(0.25))
    # Where links as given do not mend a file, no other width is asked.
    given = found.torques["nominal"]
    monkeypatch.setattr(sound_files, "_worse", lambda _, t: {} if np.allclose(t, given) else {1: 1.5})
    asked.clear()
    sound_files.sound_files(found.problem, found.final.outcome)
    assert asked == [np.inf, 0.0]


def test_where_every_file_is_worse_the_robot_is_written_as_given_and_the_name_stays(found, monkeypatch):
    nominal = found.torques["nominal"]
    monkeypatch.setattr(sound_files, "_worse", lambda _, torque: {} if np.allclose(torque, nominal) else {1: 1.5})
    final, _, torques = sound_files.sound_files(found.problem, found.final.outcome)
    assert torques["augmented"] == pytest.approx(nominal, abs=1e-6)
    assert not final.estimates
    assert [e.named.candidate.effect for e in final.unwritten] == ["nonlinear_viscous_friction"]
    assert {f.model for f in final.fallbacks if f.step.startswith("everything as given")} == {"augmented", "retuned"}
    told = next(f.step for f in final.fallbacks if f.model == "augmented" and f.step.startswith("everything"))
    assert "named but not written: nonlinear_viscous_friction" in told


def test_for_one_joint_only_what_acts_on_it_alone_is_as_given(found, monkeypatch):
    nominal, axis = found.torques["nominal"], 2
    own = nominal[:, axis]
    monkeypatch.setattr(sound_files, "_worse", lambda _, t: {} if np.allclose(t[:, axis], own) else {axis: 1.5})
    final, _, torques = sound_files.sound_files(found.problem, found.final.outcome)
    assert torques["augmented"][:, axis] == pytest.approx(own, abs=1e-6)
    assert np.all(final.delta_friction[axis] == 0.0)
    assert [e.named.candidate.effect for e in final.unwritten] == ["nonlinear_viscous_friction"]
    told = [f.step for f in final.fallbacks if f.step.startswith(OWN)]
    assert told == [f"{OWN}", f"{OWN}; named but not written: nonlinear_viscous_friction"]


def test_a_bend_of_a_form_is_given_up_before_the_effect(found, monkeypatch):
    """Where the effect itself is nothing its bend still follows noise."""
    asked = []

    def first_bend(white, terms, steps, model, open_axes=()):
        asked.append([s.words for s in steps[2]])
        bend = next((s for s in steps[2] if s.words.startswith("the plain form of")), None)
        return (terms if bend is None else bend.taken_off(terms)), ()

    monkeypatch.setattr("jointwear.discovery.model.estimation.put_back", first_bend)
    white = found.final.outcome.white
    column = np.sin(np.arange(len(white.targets[2])))[:, None]
    raw = {2: white.whiteners[2].sigma * column}
    bend = Term("form of nonlinear_viscous_friction", {2: column}, np.array([1.0]), raw)
    monkeypatch.setattr("jointwear.discovery.model.estimation._bend_if_kept", lambda *_: (None, bend))
    final = finalise(found.final.outcome)
    assert asked[0][-2:] == [f"{w} nonlinear_viscous_friction" for w in ("the plain form of", "without")]
    assert [e.named.candidate.key for e in final.estimates] == [("nonlinear_viscous_friction", 2, None)]
    assert not any(t is bend for t in final.fit.terms)


def test_a_plain_form_takes_the_place_of_one_that_says_more_than_the_records(found):
    """A bend through all records swings where one is left out; a line does not."""
    white, axis = found.final.outcome.white, 1
    record = white.folds(axis) - np.mean(np.unique(white.folds(axis)))
    sigma = white.whiteners[axis].marginal
    trial = _that_lacks(white, {axis: 30.0 * record + 3.0 * (record == record.max())})

    def of(columns):
        return Term("drift", {axis: columns}, np.full(columns.shape[1], 1e3), {axis: sigma * columns}, effect=True)

    line = of(record[:, None])
    bend = of(np.stack([np.cos(3.0 * record), np.sin(3.0 * record), record**3], axis=1))
    assert Asked(trial, [bend])([bend]).surely[axis] > 1.03
    steps = [Step("the plain form of drift", (bend,), instead=(line,)), Step("without drift", (bend, line))]
    kept, given_up = put_back(trial, [bend], {axis: steps}, "augmented")
    assert [f.step for f in given_up] == ["the plain form of drift"]
    assert len(kept) == 1
    assert kept[0] is line
    assert not steps[0].touches(kept)


def test_an_effect_has_its_plain_forms_and_no_more_of_them_than_it_is():
    drift = Candidate("torque_offset_drift", 1, None, {"start": 0.0, "period": 9.0})
    terms = [Term(x, {1: np.ones((3, 1))}, np.ones(1), effect=True) for x in "abc"]
    plain = [(replace(drift, nonlinear={}), terms[1])]
    bend = (None, Term("bend", {1: np.ones((3, 1))}, np.ones(1), effect=True))
    model = RefinedModel((RefinedEffect(None, drift, terms[0], bend),), ())

    def kept(*left):
        found = model.plain_where_kept([plain], {id(t) for t in left})
        return (*found.effects, len(found.lost({id(t) for t in left})))

    assert kept(terms[0], bend[1]) == (model.effects[0], 0)
    assert kept(terms[0]) == (RefinedEffect(None, drift, terms[0]), 0)
    assert kept(terms[1]) == (RefinedEffect(None, *plain[0]), 0)
    assert kept(terms[2]) == (model.effects[0], 1)


@pytest.mark.parametrize(("ratio", "named"), [(1.9, True), (2.1, False)])
def test_an_effect_that_adds_more_than_the_robot_lacks_is_a_suspect(found, monkeypatch, ratio, named):
    """Records that are predicted far worse with it speak against it, those that are a little worse do not."""
    white = found.final.outcome.white
    one = found.final.outcome.named[0]
    effect = RefinedEffect(one, one.candidate, one.term)
    weighing = Weighing(found.final.outcome, white, np.ones(6), np.ones(6))
    base = likely_base(white, [effect.term])[0]
    told = replace(Asked(white, base)(base), surely=np.full(6, ratio))
    monkeypatch.setattr("jointwear.discovery.model.final_model.Asked", lambda *_: lambda _: told)
    model = RefinedModel((effect,), ())
    still, suspects = named_all_the_same(weighing, base, model, [effect])
    assert (len(still), len(suspects)) == ((1, 0) if named else (0, 1))


@pytest.mark.parametrize("left", [True, False])
def test_an_effect_that_the_file_does_without_is_a_suspect_beside_structure(found, monkeypatch, left):
    """What nobody can name may be all that it has found; where nothing is left it keeps its name."""
    harmful = found.torques["augmented"]
    monkeypatch.setattr(sound_files, "_worse", lambda _, torque: {2: 3.0} if np.allclose(torque, harmful) else {})
    monkeypatch.setattr(sound_files, "finalise", lambda outcome, *_: replace(found.final, outcome=outcome))
    unexplained = [Unexplained(2, "time", "s", 0.0, 1.0, 1e-20, 40.0)] if left else []
    outcome = replace(found.final.outcome, unexplained=unexplained, suspects=[])
    final, _, _ = sound_files.sound_files(found.problem, outcome)
    assert not final.estimates
    name = "nonlinear_viscous_friction"
    assert [e.named.candidate.effect for e in final.unwritten] == ([] if left else [name])
    assert [one.candidate.effect for one, _ in final.suspects] == ([name] if left else [])
    assert final.fallbacks[-1].step == (f"without {name}" if left else f"{name} named but not written")


def test_a_file_that_a_few_samples_speak_for_is_worse(found):
    """Friction that turns at ten samples outweighs a column that is noise everywhere else."""
    problem, axis, rng = found.problem, 1, np.random.default_rng(3)
    used = np.flatnonzero(problem.train)[problem.usable[:, axis]]
    lacking = np.zeros_like(problem.discrepancy)
    lacking[used, axis] = 0.1 * rng.standard_normal(len(used))
    lacking[used[:10], axis] = 100.0
    odd, useful = replace(problem, discrepancy=lacking), problem.measured.torque - lacking
    useful[used[:10], axis] += 60.0
    noisy = useful.copy()
    noisy[used[10:], axis] += 0.3 * rng.standard_normal(len(used) - 10)
    assert not sound_files._worse(odd, useful)
    assert sound_files._worse(odd, noisy)[axis] == pytest.approx(np.sqrt(10.0), rel=0.1)
    assert np.sum((problem.measured.torque - noisy)[used, axis] ** 2) < 0.5 * np.sum(lacking[used, axis] ** 2)
