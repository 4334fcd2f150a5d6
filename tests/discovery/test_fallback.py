"""What a model gives up for the sake of an axis that it would make worse."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.linear import Term
from jointwear.discovery.model.fallback import DRIVE, EVERYTHING, HALVINGS, HELD, OF_LINKS, PutBack, Step, best_step
from jointwear.discovery.model.steps_back import given_up_of_effects
from jointwear.discovery.model.told_fallbacks import told_fallbacks
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.problem.whitening import INERTIAL
from jointwear.discovery.verdict import Gap


def test_links_are_given_up_by_halves_and_never_widened():
    links = Term(INERTIAL, {0: np.ones((4, 2)), 1: np.ones((3, 2))}, np.array([1.0, 0.1]))
    kept, own = [links], Term("friction 0", {0: np.ones((4, 1))}, np.ones(1), drive=(0, 0))
    widths = []
    for step in OF_LINKS:
        assert step.touches(kept)
        assert not step.touches([own])
        kept = step.taken_off(kept)
        assert not step.touches(kept)
        widths.append([t.std.tolist() for t in kept])
    assert widths[0] == [[0.5, 0.1]]
    assert widths[-2] == [[HALVINGS[-1]] * 2]
    assert widths[-1] == []


def test_an_axis_that_is_held_says_nothing_of_the_links_and_feels_no_change_of_them():
    rng = np.random.default_rng(1)
    raw = {0: rng.normal(size=(9, 3)), 1: np.outer(np.ones(5), [1.0, 2.0, 0.0])}
    links, own = Term(INERTIAL, raw, np.ones(3), raw), Term("friction 1", {1: np.ones((5, 1))}, np.ones(1))
    step = Step(HELD, (own,), deaf=1, hold=1e8 * raw[1].T @ raw[1])
    assert step.touches([links])
    (held,) = step.taken_off([links, own])
    assert not step.touches([held])
    assert set(held.blocks) == {0}
    prior = held.turn @ np.diag(held.std**2) @ held.turn.T
    # The other axis keeps what this one does not feel: two directions of three, as wide as before.
    assert np.linalg.eigvalsh(prior) == pytest.approx([0.0, 1.0, 1.0], abs=1e-6)
    assert raw[1] @ prior == pytest.approx(np.zeros((5, 3)), abs=1e-6)
    assert held.blocks[0] == pytest.approx(raw[0] @ held.turn)
    (narrow,) = OF_LINKS[0].taken_off([held])
    (twice,) = replace(step, deaf=0, hold=1e8 * raw[0].T @ raw[0]).taken_off([narrow])
    assert narrow.std.max() == HALVINGS[0]
    assert twice.std.max() < 1e-3


def term(label):
    return Term(label, {0: np.ones((3, 1))}, np.ones(1))


@pytest.mark.parametrize(
    ("ratio", "after", "given_up"),
    [
        (1.2, {"a": (1.1, 0.5), "b": (1.02, 0.4)}, "b"),  # the first that mends
        (1.2, {"a": (1.0, 1.7), "b": (1.1, 0.4)}, "b"),  # better by a little and no harm than mended at a price
        (1.2, {"a": (1.0, 1.7), "b": (1.3, 0.5), "ab": (1.0, 1.0)}, None),  # what mends costs the other axis more
        (1.2, {"a": (1.0, 1.1), "b": (1.3, 1.0), "ab": (1.0, 1.0)}, "a"),  # at a price that is worth it
        (1.04, {"a": (1.0, 1.7), "b": (1.04, 0.4), "ab": (1.0, 1.7)}, None),  # no way out but one that costs more
        (1.2, {"a": (1.3, 0.5), "b": (1.25, 0.5), "ab": (1.0, 0.4)}, EVERYTHING),
    ],
)
def test_what_mends_one_axis_and_harms_another_comes_last(ratio, after, given_up):
    terms = [term("a"), term("b"), term("c")]
    steps = [Step(t.label, (t,)) for t in terms[:2]]
    before = np.array([ratio, 1.05 if given_up == "a" else 0.4])

    def ask(kept):
        gone = sorted({"a", "b", "c"} - {t.label for t in kept})
        return SimpleNamespace(surely=np.array(after["".join(gone)]))

    step = best_step(ask, terms, steps, 0, before, 1.03)
    assert (step.words if step else None) == given_up


def test_an_effect_of_the_whole_arm_is_not_given_up_for_one_axis_where_others_gain_by_it():
    """As on a heavy arm with a load: one axis at 1.29, and five from a tenth to a half that would be above one."""
    body = Term("payload", {j: np.ones((3, 1)) for j in range(6)}, np.ones(1))
    own = Term("own", {1: np.ones((3, 1))}, np.ones(1))
    steps = [Step("friction", (own,)), Step("without payload", (body,))]
    before = np.array([0.11, 1.29, 0.3, 0.52, 0.2, 0.4])
    with_it, without = before.copy(), np.array([1.0, 1.0, 1.01, 1.0, 1.02, 1.0])
    with_it[1] = 1.2

    def ask(kept):
        return SimpleNamespace(surely=with_it if any(t is body for t in kept) else without)

    step = best_step(ask, [body, own], steps, 1, before, 1.03)
    assert step.words == "friction"
    assert best_step(ask, [body], steps, 1, with_it, 1.03) is None


def test_an_effect_of_the_whole_arm_that_is_not_written_is_told():
    body = SimpleNamespace(axis=None, effect="payload")
    step = PutBack("augmented", 2, 1.29, EVERYTHING)
    assert [f.step for f in given_up_of_effects((step,), [body])] == ["without payload"]


def test_an_axis_without_anything_to_give_up_is_left():
    assert best_step(None, [term("c")], [Step("a", (term("a"),))], 0, np.array([1.2]), 1.03) is None


def test_steps_of_one_model_and_axis_are_one_entry_in_their_order_with_what_is_kept():
    zeros, fitted = np.zeros((3, 4)), np.array([[0.1, 0.0, 0.0, 0.0], [0.0] * 4, [0.0] * 4])
    spring = SimpleNamespace(named=SimpleNamespace(candidate=Candidate("joint_spring", 0, None)))
    final = SimpleNamespace(
        fallbacks=(
            PutBack("retuned", 1, 1.3, "any words", held=True),
            PutBack("retuned", 2, 1.2, DRIVE),
            PutBack("augmented", 2, 1.2, DRIVE),
            PutBack("augmented", 1, 1.1, OF_LINKS[0].words),
            PutBack("augmented", 2, 1.6, OF_LINKS[0].words),
            PutBack("augmented", 2, 1.3, OF_LINKS[0].words),
            PutBack("augmented", 3, 1.0, DRIVE),
            PutBack("augmented", 3, 1.0, OF_LINKS[-1].words),
            PutBack("retuned", 3, 1.0, EVERYTHING),
        ),
        estimates=(spring,),
        delta_friction=fitted,
        retuned_friction=zeros,
        delta_inertial=np.zeros(30),
        retuned_inertial=np.ones(30),
    )
    gap = Gap((2.0, None, 1.0), (1.5, None, 1.0), (1.0, None, 1.0), (0.5, None, 1.0))
    # Nothing is told of parameters of the third joint that changed nothing; of effects it is.
    one, two, held, other, third = told_fallbacks(final, gap)
    assert (one.model, one.axis, one.held_out) == ("augmented", 1, 0.5)
    assert one.kept == "friction and motor inertia as fitted, inertia of the links as given, joint_spring"
    assert (two.axis, two.ratio, two.held_out) == (2, 1.2, None)
    assert [s.ratio for s in two.steps] == [1.2, 1.6, 1.3]
    assert two.step == f"{DRIVE}, then {OF_LINKS[0].words}"
    assert held.kept == (
        "friction and motor inertia as given, inertia of the links as fitted, but for what this joint feels"
    )
    assert (other.model, other.kept) == (
        "retuned",
        "friction and motor inertia as given, inertia of the links as fitted",
    )
    assert (third.model, third.axis, third.step) == ("retuned", 3, EVERYTHING)
