"""What the wind-up of an elastic gear says against a name: a stiffness that changes, and a cause further in.

The name of an elastic gear is that of one with one stiffness. A gear that stiffens as it is wound up is fitted by a
stiffness in between, and by a damping that no gear has. Behind the encoder of its motor the link lags by the wind-up:
gravity and inertia pull at the joints further out as if those stood elsewhere, which over their own positions looks
like a spring, and over the rates of their torques like a gear.
"""

from __future__ import annotations

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import Term, chi_square, least_squares
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.discovery.search.acceptance import predictive
from jointwear.discovery.search.least_torque import rms
from jointwear.discovery.search.rocking import swings
from jointwear.discovery.search.tolerance import fit_beside_forms
from jointwear.effects import get_effect
from jointwear.effects.order import second_derivative
from jointwear.effects.swing import drag_of, torque_of, wind_up

#: Share by which the stiffness is moved to learn what that changes.
STEP = 0.2
#: Part of the largest that rounding leaves of what is zero.
ROUNDING = 1e-9


def stiffens(outcome: Outcome, one: Named) -> float | None:
    """Return the share of its stiffness by which that of an elastic gear changes with its load, None where it may not.

    The stiffness is let change with the square of the load about its mean, on all joints that the link shakes. Forms
    are off by `form_error`: the change has to be larger than that, and to say more than that share of the evidence of
    the name.
    """
    regressor = outcome.problem.train_state.wind_up_regressor
    if not swings(one) or regressor is None:
        return None
    white, problem, settings = outcome.white, outcome.problem, outcome.problem.settings
    axis, p, state = one.candidate.axis, one.candidate.nonlinear, outcome.problem.train_state
    slopes = by_acceleration, _, by_angle = regressor(axis)
    load, inertia = state.load[:, axis], by_acceleration[:, axis]
    stiffness = p["inertia"] / p["inertia_over_stiffness"]
    drag = drag_of(stiffness, p["inertia"], p["damping"])

    def lag(more: np.ndarray) -> np.ndarray:
        twist = wind_up(state, load, inertia, stiffness, drag, by_angle[:, axis] + more)
        return -torque_of(twist, slopes, axis)

    mean = max(rms(load, problem.usable[:, axis]) ** 2, np.finfo(float).tiny)
    change = (lag(STEP * stiffness * (load**2 / mean - 1.0)) - lag(np.zeros(len(load)))) / STEP
    blocks = {
        a: white.columns(a, white.of_swing(a, change[:, [a]], p["inertia_over_stiffness"], p["damping"]))
        for a in problem.judged
    }
    fit = fit_beside_forms(white, outcome.named)
    full = sum(x.T @ x for x in blocks.values())
    b, gram = fit.gram(blocks)
    statistic, freedom = chi_square(b, gram, full)
    if not freedom or 0.5 * (statistic - freedom) <= max(settings.accept, settings.form_error * one.evidence):
        return None
    share = abs(float(least_squares(b, gram, full)[0]))
    return share if share > settings.form_error else None


def wound_up_further_in(outcome: Outcome, one: Named) -> int | None:
    """Return an unexplained 0-based axis further in whose wind-up leaves a name nothing to say, None for none."""
    candidate, state = one.candidate, outcome.problem.train_state
    if candidate.effect == LINK_MASS or not get_effect(candidate.effect).as_wound or state.wind_up_regressor is None:
        return None
    others = outcome.terms_beside(one)
    lacking = {u.axis for u in outcome.unexplained} | {n.candidate.axis for n, _ in outcome.suspects if swings(n)}
    for inner in sorted(a for a in lacking if a is not None and a < candidate.axis):
        wind_up = wind_up_of(outcome, inner, candidate.axis)
        if wind_up is not None and predictive(outcome.white, [*others, wind_up], one)[1]:
            return inner
    return None


def wind_up_of(outcome: Outcome, inner: int, axis: int) -> Term | None:
    """Return the term of what the wind-up of one joint, load over stiffness, changes of the torque of another; None
    where it changes nothing of it."""
    white, state = outcome.white, outcome.white.timing_state(inner)
    # About a vertical axis gravity changes by rounding alone.
    by_acceleration, _, by_angle = (
        np.where(np.abs(x).max(axis=0) > ROUNDING * np.abs(x).max(), x, 0.0)[:, axis]
        for x in outcome.problem.train_state.wind_up_regressor(inner)
    )
    load = state.load[:, inner]
    columns = np.stack([by_angle * load, by_acceleration * second_derivative(state, load)], axis=1)
    size = np.sqrt(np.mean(columns[outcome.problem.usable[:, axis]] ** 2, axis=0))
    columns, size = columns[:, size > 0], size[size > 0]
    if not len(size):
        return None
    std = outcome.problem.widest[axis] / size
    blocks, raw = {axis: white.columns(axis, columns)}, {axis: white.raw(axis, columns)}
    return Term(f"wind-up of joint {inner + 1}", blocks, std, raw)
