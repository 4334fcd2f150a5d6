"""Effects and forms of theirs that a written model does without, and what becomes of their names."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import that_lacks

from jointwear.discovery.estimates.base import likely_base
from jointwear.discovery.estimates.outcome import Unexplained
from jointwear.discovery.estimates.refined_model import RefinedEffect, RefinedModel
from jointwear.discovery.linear import Term
from jointwear.discovery.model.estimation import finalise
from jointwear.discovery.model.fallback import Step, put_back
from jointwear.discovery.model.final_model import Weighing, fit_model, generator_of, named_all_the_same
from jointwear.discovery.model.left_out import Asked
from jointwear.discovery.problem.candidates import Candidate, term_of


def test_an_axis_counts_as_without_a_name_by_the_effects_that_a_model_has(rooted, monkeypatch):
    asked = []

    def gives_up_effects(white, terms, steps, model, open_axes=()):
        asked.append((model, list(open_axes)))
        return [t for t in terms if not t.effect], ()

    monkeypatch.setattr("jointwear.discovery.model.estimation.put_back", gives_up_effects)
    left = Unexplained(2, "position", "rad", 0.0, 1.0, 1e-12, 50.0)
    assert [n.candidate.axis for n in rooted.final.outcome.named] == [2]
    finalise(replace(rooted.final.outcome, unexplained=[left]))
    assert asked == [("augmented", []), ("augmented", [2]), ("retuned", [2])]


def test_a_name_that_the_file_does_without_is_a_suspect_where_structure_is_left_on_its_axis(rooted, monkeypatch):
    monkeypatch.setattr(
        "jointwear.discovery.model.estimation.put_back",
        lambda _, terms, *more: ([t for t in terms if not t.effect], ()),
    )
    for axis, suspected in ((2, True), (1, False)):
        left = Unexplained(axis, "position", "rad", 0.0, 1.0, 1e-12, 50.0)
        outcome = replace(rooted.final.outcome, unexplained=[left], suspects=[])
        final = finalise(outcome)
        assert [e.named.candidate.axis for e in final.unwritten] == ([] if suspected else [2])
        assert bool(final.suspects) == suspected


@pytest.mark.parametrize(
    ("ratio", "beside", "named"), [(1.9, 0.9, True), (2.1, 0.9, False), (2.1, 0.46, False), (2.1, 0.44, True)]
)
def test_an_effect_that_adds_more_than_the_robot_lacks_is_a_suspect(rooted, monkeypatch, ratio, beside, named):
    """Records that are predicted far worse with it speak against it, those that are a little worse do not.

    Nor does one to which the others have to be carried on, if it is nearly all of what parts of records lack.
    """
    white = rooted.final.outcome.white
    one = rooted.final.outcome.named[0]
    effect = RefinedEffect(one, one.candidate, one.term)
    weighing = Weighing(rooted.final.outcome, white, np.ones(6), np.ones(6))
    base = likely_base(white, [effect.term])[0]
    told = replace(Asked(white, base)(base), surely=np.full(6, ratio))
    monkeypatch.setattr("jointwear.discovery.model.final_model.Asked", lambda *_: lambda _: told)

    def left_out(_, terms, each, parts):
        return np.full(6, beside if any(t is effect.term for t in terms) else 1.0)

    monkeypatch.setattr("jointwear.discovery.model.final_model.left_out_ratio", left_out)
    model = RefinedModel((effect,), ())
    still, suspects = named_all_the_same(weighing, base, model, [effect])
    assert (len(still), len(suspects)) == ((1, 0) if named else (0, 1))


def test_a_bend_of_a_form_is_given_up_before_the_effect(rooted, monkeypatch):
    """Where the effect itself is nothing its bend still follows noise."""
    asked = []

    def first_bend(white, terms, steps, model, open_axes=()):
        asked.append([s.words for s in steps[2]])
        bend = next((s for s in steps[2] if s.words.startswith("the plain form of")), None)
        return (terms if bend is None else bend.taken_off(terms)), ()

    monkeypatch.setattr("jointwear.discovery.model.estimation.put_back", first_bend)
    white = rooted.final.outcome.white
    column = np.sin(np.arange(len(white.targets[2])))[:, None]
    raw = {2: white.whiteners[2].sigma * column}
    bend = Term("form of nonlinear_viscous_friction", {2: column}, np.array([1.0]), raw)
    monkeypatch.setattr("jointwear.discovery.model.estimation._bend_if_kept", lambda *_: (None, bend))
    final = finalise(rooted.final.outcome)
    assert asked[0][-2:] == [f"{w} nonlinear_viscous_friction" for w in ("the plain form of", "without")]
    assert [e.named.candidate.key for e in final.estimates] == [("nonlinear_viscous_friction", 2, None)]
    assert not any(t is bend for t in final.fit.terms)


def test_a_plain_form_takes_the_place_of_one_that_says_more_than_the_records(rooted):
    """A bend through all records swings where one is left out; a line does not."""
    white, axis = rooted.final.outcome.white, 1
    record = white.folds(axis) - np.mean(np.unique(white.folds(axis)))
    sigma = white.whiteners[axis].marginal
    trial = that_lacks(white, {axis: 30.0 * record + 3.0 * (record == record.max())})

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


def test_the_interval_of_an_effect_does_not_depend_on_the_order_of_the_names(rooted, monkeypatch):
    white, one = rooted.final.outcome.white, rooted.final.outcome.named[0]
    beside = Candidate("stribeck_friction", 1, None, {"speed": 0.1, "exponent": 1.0})
    other = replace(one, candidate=beside, term=term_of(white, beside), form=None)
    effects = [RefinedEffect(n, n.candidate, n.term) for n in (one, other)]
    base = likely_base(white, [e.term for e in effects])[0]
    weighing = Weighing(rooted.final.outcome, white, np.ones(6), np.ones(6))
    peaks = [
        {e.named.candidate.key: e.peak for e in fit_model(weighing, base, RefinedModel(tuple(order), ())).estimates}
        for order in (effects, effects[::-1])
    ]
    assert len(peaks[0]) == 2
    for key, peak in peaks[0].items():
        assert (peaks[1][key].low, peaks[1][key].high) == pytest.approx((peak.low, peak.high), rel=1e-6)


def test_each_effect_axis_and_source_draws_its_own_numbers():
    places = [("joint_spring", 1, None), ("joint_spring", 2, None), ("joint_spring", None, None)]
    places += [("stribeck_friction", 1, None), ("stribeck_friction", 1, 0), ("stribeck_friction", 1, 1)]
    drawn = [generator_of(Candidate(*place)).standard_normal() for place in places]
    assert len(set(drawn)) == len(places)
    assert drawn == [generator_of(Candidate(*place, {"other": 1.0})).standard_normal() for place in places]
