"""What is written is never worse than what was given, and says how sure it is."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import that_lacks

from jointwear.discovery.estimates.misfit import divided, misfit_of, tempered
from jointwear.discovery.estimates.outcome import Unexplained
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.model.estimation import doubts, finalise
from jointwear.discovery.model.fallback import DRIVE, FELT, HELD, HELD_WITHOUT, OF_LINKS, Step, put_back
from jointwear.discovery.model.left_out import Asked, left_out_ratio
from jointwear.discovery.problem.whitening import INERTIAL
from jointwear.discovery.search.crossval import cross_validate


def test_a_parameter_may_go_to_zero_where_an_effect_takes_its_place(rooted, robot):
    assert [(e["effect"], e["axis"]) for e in rooted.effects] == [("nonlinear_viscous_friction", 3)]
    assert rooted.augmented_robot["joints"][2]["viscous"] < 0.25 * robot.viscous[2] / robot.gear_ratio[2] ** 2
    held = rooted.problem.measured.usable[:, 2] & rooted.problem.test
    rms = {k: np.sqrt(np.mean((rooted.problem.measured.torque - t)[held, 2] ** 2)) for k, t in rooted.torques.items()}
    assert rms["augmented"] < 0.5 * rms["retuned"] <= 0.5 * rms["nominal"]


def test_a_misfit_divides_what_an_axis_says(rooted):
    white = rooted.final.outcome.white
    right = white.fit(rooted.final.outcome.named[0].terms)
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
    columns = rooted.problem.train_state.velocity[:, [2]]
    assert weak.columns(2, columns) == pytest.approx(white.columns(2, columns) / 10.0)
    assert weak.raw_targets[2] == pytest.approx(white.raw_targets[2])


def test_what_helps_while_a_wall_is_touched_only_is_no_better_robot(rooted):
    white = rooted.final.outcome.white
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


def test_of_three_records_two_need_not_tell_of_the_third(rooted):
    """A torque that only the last of three records shows is predicted from its other half, not from other records."""
    white, axis = rooted.final.outcome.white, 1
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


def test_an_axis_that_lacks_what_nothing_explains_keeps_its_parameters_as_given(rooted):
    outcome = rooted.final.outcome
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


def test_an_effect_that_one_record_alone_tells_of_is_asked_by_halves_of_records(rooted):
    white = rooted.final.outcome.white
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


def test_evidence_is_asked_without_the_block_of_time_that_gives_most_of_it(rooted):
    white = rooted.final.outcome.white
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
def test_friction_of_half_of_the_time_is_no_drive_parameter(rooted, dragging):
    """What a brake adds now and then is a mean of two states, right in neither: its next share of the time is open."""
    white = rooted.final.outcome.white
    axis = 0
    label, sign = white.blocks(axis) // 8, np.sign(white.problem.train_state.velocity[white.whiteners[axis].rows, axis])
    drags = label % 2 < 2 * dragging
    sigma = white.whiteners[axis].marginal
    trial = that_lacks(white, {axis: 20.0 * sign * drags})
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


def test_a_part_of_a_model_is_asked_as_if_it_were_the_whole(rooted):
    final = rooted.final
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
def test_a_joint_that_links_make_worse_is_held_and_the_others_keep_what_it_does_not_feel(rooted, has_effect):
    """One joint asks for links that another contradicts: as given they would be lost to both.

    An effect of that joint alone that helps and does not mend it goes too.
    """
    white = rooted.final.outcome.white
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
    trial = that_lacks(white, told)
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
def test_a_joint_with_structure_that_gains_nothing_by_links_alone_feels_none_of_them(rooted, is_open):
    """What is told by other joints may be right there; where nothing explains what a joint lacks it is no better."""
    white = rooted.final.outcome.white
    tells, lacks = 0, 2
    rows = {axis: white.whiteners[axis].rows for axis in (tells, lacks)}
    sigma = {axis: white.whiteners[axis].marginal for axis in rows}
    rng = np.random.default_rng(2)
    felt = {axis: rng.choice([-1.0, 1.0], size=(len(rows[axis]), 1)) for axis in rows}
    told = {tells: 4.0 * felt[tells][:, 0], lacks: 20.0 * rng.normal(size=len(felt[lacks]))}
    trial = that_lacks(white, told)
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
def test_friction_that_gains_in_every_record_is_written_where_structure_is_left_too(rooted, last):
    """All records together gain, no one is worse: that one gains less is no sign that a further one will lose."""
    white = rooted.final.outcome.white
    axis = 0
    record, sign = white.folds(axis), np.sign(white.problem.train_state.velocity[white.whiteners[axis].rows, axis])
    sigma = white.whiteners[axis].marginal
    trial = that_lacks(white, {axis: 20.0 * sign * np.where(record == record.max(), last, 1.0)})
    term = Term("friction", {axis: sign[:, None]}, np.array([1e3]), {axis: sigma * sign[:, None]}, (axis, 0))
    asked = Asked(trial, [term])([term])
    assert asked.ratio[axis] < 0.8
    assert asked.gained[axis] > 0.99
    for open_axes in ([], [axis]):
        step = Step(DRIVE, (term,), of_drive=True)
        kept, _ = put_back(trial, [term], {axis: [step]}, "augmented", open_axes)
        assert kept


@pytest.mark.parametrize("leans", [True, False])
def test_links_on_which_no_axis_leans_are_as_given(rooted, leans):
    """One coefficient moves two axes. Both lack something that comes and goes, or the second lacks it at all times."""
    white = rooted.final.outcome.white
    lacking, blocks, raw = {}, {}, {}
    for axis in (0, 1):
        told = np.where(white.folds(axis) == white.folds(axis).max(), -0.2, 0.2)
        if leans and axis == 1:
            told = 0.2
        lacking[axis] = 20.0 * (told + 0.6 * np.sign(white.blocks(axis) % 2 - 0.5) * (axis == 0))
        blocks[axis] = np.ones((len(lacking[axis]), 1))
        raw[axis] = white.whiteners[axis].marginal * blocks[axis]
    trial = that_lacks(white, lacking)
    links = Term(INERTIAL, blocks, np.array([1e3]), raw)
    given, asked = Asked(trial, [links])([]).ratio, Asked(trial, [links])([links]).ratio
    assert (asked[1] < given[1]) == leans
    kept, _ = put_back(trial, [links], {}, "augmented")
    assert [t.label for t in kept] == ([INERTIAL] if leans else [])
