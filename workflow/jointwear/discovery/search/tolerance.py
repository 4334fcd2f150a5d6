"""How wrong the form of a named effect may be, as terms of the model.

No form is known exactly: the torque of an effect may be a few percent off, differently in each record and over
position, speed and direction. What that leaves must not be taken for a further effect nor for structure without a
name, however strong the effect is; what is more than that must.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.candidates import LINK_MASS, on_all_axes, raw_columns, raw_torques
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect
from jointwear.effects.state import record_slices


def with_tolerances(white: White, named: list[Named]) -> list[Term]:
    """Return the terms of named effects and of the tolerance of their forms."""
    terms = [t for n in named for t in n.terms]
    fit = white.fit(terms)
    places = {id(t): where for t, where in zip(fit.terms, fit.slices, strict=True)}
    return terms + [x for n in named for x in _tolerance(white, n, fit, fit.theta[places[id(n.term)]])]


def fit_beside_forms(white: White, named: list[Named]) -> Fit:
    """Return the fit of named effects in which neither the tolerance of their forms nor what noise takes off fitted
    inertias is left: what it leaves is of something else."""
    return white.fit([*with_tolerances(white, named), *white.attenuation])


def _tolerance(white: White, one: Named, fit: Fit, coefficients: np.ndarray) -> list[Term]:
    """Return one term per axis: the torque of the effect over its records, position, speed and direction."""
    problem = white.problem
    state, error = problem.train_state, problem.settings.form_error
    result = []
    for axis, raw in one.term.raw.items():
        rows = white.whiteners[axis].rows
        torque = np.zeros(len(state.velocity))
        torque[rows] = raw @ coefficients
        # Whitening looks back over samples that are no rows themselves.
        torque = _filled(torque, rows)
        record = problem.fold_of_sample
        speed = np.abs(state.velocity[:, axis])
        ways = [(record == k).astype(float) for k in np.unique(record)]
        ways += [state.direction[:, axis], _unit(state.position[:, axis]), _unit(speed)]
        columns = torque[:, None] * np.stack(ways, axis=1)
        std = np.full(columns.shape[1], error)
        more = (
            _beyond_its_band(white, one, coefficients, axis),
            _of_corrections(white, one, fit, coefficients, axis),
            _begun_otherwise(white, one, coefficients),
        )
        columns = np.concatenate([columns, *more], axis=1)
        std = np.append(std, np.ones(columns.shape[1] - len(std)))
        result.append(
            Term(f"tolerance of {one.term.label}", {axis: white.columns(axis, columns)}, std, {axis: columns[rows]})
        )
    return result


def _beyond_its_band(white: White, one: Named, coefficients: np.ndarray, axis: int) -> np.ndarray:
    """Return the torque (N_train, k) on one axis of an effect of timing above the band that its columns end at.

    There the columns would feed on the noise of derived accelerations, but the effect goes on: what it does there is
    no structure without a name.
    """
    candidate = one.candidate
    state = white.problem.train_state
    if candidate.effect == LINK_MASS or candidate.axis is None or not get_effect(candidate.effect).timing:
        return np.zeros((len(state.velocity), 0))
    effect = get_effect(candidate.effect)
    if on_all_axes(candidate):
        whole = effect.spread(state, candidate.axis, candidate.source, candidate.nonlinear)[:, axis]
        within = raw_torques(white, candidate)[axis][:, 0]
        return ((whole - within) * coefficients[0])[:, None]
    bands = (white.state_of(effect, candidate.axis, candidate.nonlinear), white.axis_state(candidate.axis), state)
    torques = [effect.columns(s, candidate.axis, candidate.source, candidate.nonlinear) @ coefficients for s in bands]
    steps = np.diff(np.stack(torques, axis=1), axis=1)
    return steps[:, np.any(steps != 0.0, axis=0)]


def _of_corrections(white: White, one: Named, fit: Fit, coefficients: np.ndarray, axis: int) -> np.ndarray:
    """Return what an effect that is in proportion to all torque makes of the torque that a fit adds, (N_train, k).

    Its columns are those of the given friction and links: a gain that follows the temperature, of viscous friction that
    is 20 % off, looks like viscous friction that does.
    """
    state, candidate = white.problem.train_state, one.candidate
    if candidate.effect == LINK_MASS or not get_effect(candidate.effect).of_torque:
        return np.zeros((len(state.velocity), 0))
    rows = white.whiteners[axis].rows
    added = np.zeros(len(state.velocity))
    for term, where in zip(fit.terms, fit.slices, strict=True):
        if not term.effect and axis in term.raw:
            added[rows] += term.raw[axis] @ fit.theta[where]
    torque = np.array(state.torque)
    torque[:, axis] = _filled(added, rows)
    columns = get_effect(candidate.effect).columns(
        replace(state, torque=torque), axis, candidate.source, candidate.nonlinear
    )
    return (columns @ coefficients)[:, None]


def _begun_otherwise(white: White, one: Named, coefficients: np.ndarray) -> np.ndarray:
    """Return what another state at its start adds to an effect, record by record, (N_train, k).

    A name has one such state for all records. How a joint came to where a record begins differs from one to the next,
    and what that leaves until the joint has moved far enough is no structure without a name.
    """
    state, candidate = white.problem.train_state, one.candidate
    none = np.zeros((len(state.velocity), 0))
    if candidate.effect == LINK_MASS or candidate.axis is None or state.record is None:
        return none
    own = {"start": 1, **candidate.nonlinear}
    # Other forms of the effect are no other start.
    others = [p for p in get_effect(candidate.effect).begins(own) if {**p, "start": own["start"]} == own]
    if not others:
        return none
    farthest = max(others, key=lambda p: abs(p["start"] - own["start"]))
    there = raw_columns(white, replace(candidate, nonlinear=farthest)) @ coefficients
    added = there - raw_columns(white, candidate) @ coefficients
    parts = [part for part in record_slices(state) if np.any(added[part])]
    columns = np.zeros((len(added), len(parts)))
    for k, part in enumerate(parts):
        columns[part, k] = added[part]
    return columns


def _filled(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return values (m,) with those beside `rows` taken from the next row."""
    after = np.minimum(np.searchsorted(rows, np.arange(len(values))), len(rows) - 1)
    return values[rows[after]]


def _unit(x: np.ndarray) -> np.ndarray:
    half = 0.5 * float(np.ptp(x))
    return (x - 0.5 * float(x.max() + x.min())) / (half if half > 0 else 1.0)
