"""What the form of a named effect may be wrong by is no further effect."""

from dataclasses import replace

import numpy as np

from jointwear import effects
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.search.tolerance import with_tolerances


def test_a_gain_acts_on_the_friction_that_the_robot_has_and_not_on_that_of_its_file(white):
    """A ripple of 4 % of all torque, of viscous friction that is twice as large as given."""
    axis, size = 1, np.array([0.04, 0.0])
    ripple = Candidate("torque_constant_ripple", axis, None, {"order": 2.0})
    columns = raw_columns(white, ripple)
    term = Term(
        "ripple", {axis: white.columns(axis, columns)}, np.ones(2), {axis: white.raw(axis, columns)}, effect=True
    )
    state = white.problem.train_state
    more = np.zeros_like(state.torque)
    more[:, axis] = 2.0 * np.sqrt(np.mean(state.torque[:, axis] ** 2)) * state.velocity[:, axis]
    effect = effects.get_effect(ripple.effect)
    torque = (
        more[:, axis] + effect.columns(replace(state, torque=state.torque + more), axis, None, ripple.nonlinear) @ size
    )
    told = white.columns(axis, torque[:, None])[:, 0]
    asked = replace(white, targets=[told if a == axis else np.zeros_like(y) for a, y in enumerate(white.targets)])
    named = [Named(ripple, term, None, 100.0)]
    terms = with_tolerances(asked, named)
    assert len(terms) == 2

    def left(kept):
        return float(asked.fit(kept).residual[axis] @ asked.fit(kept).residual[axis])

    # 5 % of the form do not reach to it: what is missing is known.
    rest = terms[1]
    places = np.arange(len(rest.std) - 1)
    form = replace(
        rest,
        blocks={axis: rest.blocks[axis][:, places]},
        raw={axis: rest.raw[axis][:, places]},
        std=rest.std[places],
    )
    assert left(terms) < 0.2 * left([term, form])


def test_how_a_joint_came_to_where_its_records_begin_is_no_structure(white):
    """A hysteresis that begins settled in every other record and moved back in the rest, named as settled in all."""
    axis, level = 1, np.array([3.0])
    settled = Candidate("presliding_hysteresis", axis, None, {"distance": 0.1, "spring": 0, "start": 1})
    back = replace(settled, nonlinear={**settled.nonlinear, "start": -1})
    columns, other = raw_columns(white, settled), raw_columns(white, back)
    record = white.problem.train_state.record
    records = np.unique(record)
    torque = np.where(np.isin(record, records[::2])[:, None], columns, other) @ level
    told = white.columns(axis, torque[:, None])[:, 0]
    asked = replace(white, targets=[told if a == axis else np.zeros_like(y) for a, y in enumerate(white.targets)])
    term = Term(
        "hysteresis", {axis: white.columns(axis, columns)}, np.ones(1), {axis: white.raw(axis, columns)}, effect=True
    )
    terms = with_tolerances(asked, [Named(settled, term, None, 100.0)])

    rest = terms[1]
    form = slice(0, len(rest.std) - len(records))
    without = replace(
        rest, blocks={axis: rest.blocks[axis][:, form]}, raw={axis: rest.raw[axis][:, form]}, std=rest.std[form]
    )

    def left(kept):
        residual = asked.fit(kept).residual[axis]
        return float(residual @ residual)

    assert left(terms) < 0.1 * left([term, without])
