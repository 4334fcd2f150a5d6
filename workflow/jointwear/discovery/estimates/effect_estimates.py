"""Estimates for one named effect: parameters with standard deviations, its largest torque on held-out motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from jointwear.discovery.estimates.beyond_band import within_band
from jointwear.discovery.estimates.curvature import Spreads, spreads_of
from jointwear.discovery.estimates.fast_waves import lost_to_speed
from jointwear.discovery.estimates.forms import Form, companion
from jointwear.discovery.estimates.largest_torque import Fitted, Peak, all_columns, largest_torque
from jointwear.discovery.estimates.noisy_columns import noise_share
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.estimates.refine import evidence_at
from jointwear.discovery.estimates.refined_model import RefinedEffect
from jointwear.discovery.linear import Fit, Term, posterior_mean
from jointwear.discovery.problem.candidates import Candidate, on_all_axes, prior_std, raw_torques, whitened
from jointwear.discovery.problem.whitening import INERTIAL, White
from jointwear.effects import get_effect

#: Relative distance within which a parameter lies on a bound.
ON_BOUND = 1e-6
#: Factors on (period / 2 pi)^2 at which a swing that is damped less is looked for.
PERIODS = np.geomspace(0.5, 2.0, 21)
#: Times its load by which it is asked whether columns follow the load, and the relative step of a derivative.
MORE_LOAD, STEP = 1.01, 1e-4


@dataclass(frozen=True)
class Estimate:
    """One named effect with its estimates.

    Attributes
    ----------
    parameters : value of every parameter; std : standard deviation of those that were estimated.
    coefficients : of the columns (and, behind them, of the form if it is kept).
    peak : largest torque on the held-out motion, with its 95 % interval.
    """

    named: Named
    parameters: dict[str, float]
    std: dict[str, float]
    coefficients: np.ndarray
    form: Form | None
    peak: Peak


def misfits(estimate: Estimate) -> Iterator[str]:
    """Yield in words where the search for the parameters of an effect ended at its start or on a bound."""
    candidate = estimate.named.candidate
    if estimate.named.misfit:
        yield estimate.named.misfit
    if candidate.axis is None:
        return
    for p in get_effect(candidate.effect).parameters:
        value = estimate.parameters.get(p.name)
        if value is None or p.fixed or p.name not in estimate.std:
            continue
        for bound in (p.lower, p.upper):
            if np.isfinite(bound) and abs(value - bound) <= ON_BOUND * max(abs(bound), abs(value)):
                yield f"{p.name} of {candidate.effect} on joint {candidate.axis + 1} ended on its bound {bound:g}"


def links_error(white: White, fit: Fit, candidate: Candidate) -> float:
    """Return the relative error of the columns of an effect because they are made of the torque of the given links.

    It is the size of what the fit corrects of the links, over the load; 0 for columns that do not follow the load.

    Parameters
    ----------
    fit : of a model that may hold corrections of the links.
    """
    effect, problem = get_effect(candidate.effect), white.problem
    links = next((i for i, t in enumerate(fit.terms) if t.label == INERTIAL), None)
    if links is None:
        return 0.0
    state = problem.train_state
    axis = problem.judged if candidate.axis is None else candidate.axis
    if candidate.axis is not None:
        more = replace(state, load=MORE_LOAD * state.load, torque=MORE_LOAD * state.torque)
        columns = effect.columns(state, axis, candidate.source, candidate.nonlinear)
        if np.allclose(effect.columns(more, axis, candidate.source, candidate.nonlinear), columns, rtol=1e-6):
            return 0.0
    elif "gravity" not in effect.needs:
        return 0.0
    correction = problem.inertial[problem.train] @ (
        white.directions_of(fit.terms[links]) @ fit.theta[fit.slices[links]]
    )
    return float(np.sqrt(np.mean(correction[:, axis] ** 2) / max(float(np.mean(state.load[:, axis] ** 2)), 1e-300)))


def _form_std(
    white: White, fit: Fit, candidate: Candidate, parameters: dict[str, float], name: str, linear: set[str], lost: float
) -> float:
    """Return the standard deviation of a parameter beside that of the fit: no form and no filter is known exactly.

    Parameters of one unit are parts of one thing (a tilt about two lines, a moment), as large as all of them.
    """
    effect, problem = get_effect(candidate.effect), white.problem
    units = {p.name: p.unit for p in effect.parameters}
    size = np.sqrt(sum(parameters[other] ** 2 for other in linear if units[other] == units[name]))
    share = np.hypot(problem.settings.parameter_error, links_error(white, fit, candidate))
    if effect.left is not None:
        state = problem.train_state
        passed = effect.left(state, candidate.axis, candidate.nonlinear) * np.ones(len(state.time))
        passed = passed[problem.usable[:, candidate.axis]]
        share = np.hypot(share, problem.settings.filter_error * (1 - np.sqrt(np.mean(passed**2))))
    return float(np.hypot(share, lost) * size)


def _fitted(white: White, fit: Fit, candidate: Candidate) -> dict[str, float]:
    """Return the parameters of an effect that is added to a fit; the nonlinear ones stay as they are."""
    torques = raw_torques(white, candidate)
    b, gram = fit.gram(whitened(white, torques))
    mean = posterior_mean(b, gram, prior_std(white, candidate, torques[candidate.axis]))
    return get_effect(candidate.effect).parameters_of(candidate.nonlinear, mean)


def _followed(white: White, fit: Fit, candidate: Candidate, spreads: Spreads, names: set[str]) -> dict[str, float]:
    """Return the standard deviation of each linear parameter because the nonlinear ones are fitted too.

    A coefficient follows an exponent or a place on which the columns depend: what holds for the best values of these
    alone is too narrow.
    """
    square = dict.fromkeys(names, 0.0)
    for step in np.eye(len(spreads.names)):
        ends = [_fitted(white, fit, spreads.moved(candidate, sign * step)) for sign in (1, -1)]
        for name in names:
            square[name] += (0.5 * (ends[0][name] - ends[1][name])) ** 2
    return {name: float(np.sqrt(s)) for name, s in square.items()}


def _other_forms(
    white: White, fit: Fit, candidate: Candidate, parameters: dict[str, float], names: Iterable[str]
) -> dict[str, float]:
    """Return the standard deviation of each linear parameter because its effect may have another of its discrete forms.

    A log that is late is neither a dead time nor a lag of first order: each of them gives another delay for it.
    """
    effect = get_effect(candidate.effect)
    square = dict.fromkeys(names, 0.0)
    for nonlinear in effect.alternatives(candidate.nonlinear):
        found = effect.bounded(_fitted(white, fit, replace(candidate, nonlinear=nonlinear)))
        for name in square:
            square[name] += (found[name] - parameters[name]) ** 2
    return {name: float(np.sqrt(s)) for name, s in square.items()}


def _by_its_band(
    white: White,
    base: list[Term],
    others: list[Term],
    candidate: Candidate,
    parameters: dict[str, float],
    names: Iterable[str],
) -> dict[str, float]:
    """Return half of what each linear parameter of an effect of timing moves by what the effect does above its band.

    What is left to a term of its own there holds noise as well as the effect. Without it the parameter would be too
    large, with it that may be too small. Columns that go on where noise might feign a gear have their own size: half of
    what others ask for beside it is unknown too.
    """
    nothing, lean, effect = dict.fromkeys(names, 0.0), within_band(base), get_effect(candidate.effect)
    if len(lean) == len(base) or not effect.timing or candidate.axis is None:
        return nothing
    fit = Fit(white.targets, [*lean, *others])
    found = [_fitted(white, fit, candidate)]
    if candidate.wide:
        found.append(_fitted(white, fit, replace(candidate, wide=False)))
    return {name: 0.5 * max(abs(effect.bounded(f)[name] - parameters[name]) for f in found) for name in nothing}


def _by_its_noise(
    white: White, fit: Fit, candidate: Candidate, parameters: dict[str, float], names: Iterable[str]
) -> dict[str, float]:
    """Return what each linear parameter of a late torque may lack because its columns hold noise."""
    nothing = dict.fromkeys(names, 0.0)
    if candidate.axis is None or not get_effect(candidate.effect).late:
        return nothing
    share = noise_share(white, fit, candidate)
    return {name: share * abs(parameters[name]) for name in nothing}


def _by_its_damping(
    white: White, fit: Fit, candidate: Candidate, parameters: dict[str, float], names: Iterable[str]
) -> dict[str, float]:
    """Return by what the size of a swing moves if it is damped half as much.

    Noise of derived accelerations drives a swing in the model that is not there: one that ends sooner fits best, and
    that has its period elsewhere.
    """
    nothing, name = dict.fromkeys(names, 0.0), get_effect(candidate.effect).scaled
    if name not in nothing or not on_all_axes(candidate):
        return nothing
    own, best = {**candidate.nonlinear, "damping": 0.5 * candidate.nonlinear["damping"]}, parameters[name]
    trials = [replace(candidate, nonlinear={**own, name: best * factor}) for factor in PERIODS]
    lighter = max(trials, key=lambda c: evidence_at(white, fit, c))
    return nothing | {name: abs(lighter.nonlinear[name] - best)}


def out_of_step(candidate: Candidate, parameters: Mapping[str, float], std: Mapping[str, float]) -> dict[str, float]:
    """Return the standard deviation of the damping of a swing because its frequency is not known along the motion.

    Inertia of the model that is off by a share in one pose and not in another puts the swing out of step, and what is
    out of step by a share of its frequency looks damped, or rings on, by that share more.
    """
    scaled = get_effect(candidate.effect).scaled
    if not on_all_axes(candidate) or scaled not in std or "damping" not in std:
        return {}
    share = 0.5 * std[scaled] / parameters[scaled]
    return {"damping": float(np.hypot(std["damping"], share))}


def _in_the_bend(
    white: White,
    candidate: Candidate,
    form: Form | None,
    coefficients: np.ndarray,
    parameters: dict[str, float],
    names: Iterable[str],
) -> dict[str, float]:
    """Return how much of each linear parameter the bend of the form may hold: what its torque would give of it."""
    nothing = dict.fromkeys(names, 0.0)
    if form is None or candidate.axis is None:
        return nothing
    effect, problem = get_effect(candidate.effect), white.problem
    columns = all_columns(problem.train_state, candidate, form)[:, candidate.axis][problem.usable[:, candidate.axis]]
    own = columns.shape[1] - form.columns(problem.train_state).shape[1]
    bend = columns[:, own:] @ coefficients[own:]
    more = np.linalg.lstsq(columns[:, :own], bend, rcond=None)[0]
    whole = effect.bounded(effect.parameters_of(candidate.nonlinear, coefficients[:own] + more))
    return {name: abs(whole[name] - parameters[name]) for name in nothing}


def _where_the_form_bends(
    white: White,
    others: list[Term],
    candidate: Candidate,
    form: Form | None,
    coefficients: np.ndarray,
    spreads: Spreads,
) -> Spreads:
    """Return the spreads of the nonlinear parameters, no less than beside a form that may bend.

    The order of a wave with flat crests is that of the sine which comes nearest on the travel that was seen: known to a
    hundredth, and off by more. What the bend can make up for is not known of it.
    """
    if form is None or not spreads.names:
        return spreads
    torque = raw_torques(white, candidate)[candidate.axis]
    used = white.problem.usable[:, candidate.axis]
    size = float(np.sqrt(np.mean((torque @ coefficients[: torque.shape[1]])[used] ** 2)))
    bent = white.fit([*others, companion(white, form, size)])
    return spreads.at_least(spreads_of(white, bent, candidate))


def estimate_effect(
    white: White,
    fit: Fit,
    base: list[Term],
    refined: RefinedEffect,
    where: list[slice],
    others: list[Term],
    rng: np.random.Generator,
) -> Estimate:
    """Estimate one effect: parameters by the delta method, the peak torque by drawing from the posterior.

    Parameters
    ----------
    fit : of the whole model. base : terms of the parameters of the nominal model; others : those of the other effects.
    where : places of its coefficients in the fit, and of those of its bend.
    """
    candidate, form = refined.candidate, None if refined.bend is None else refined.bend[0]
    named = replace(refined.named, candidate=candidate)
    scaled = get_effect(candidate.effect).scaled
    places = np.concatenate([np.arange(w.start, w.stop) for w in where])
    coefficients, covariance = fit.theta[places], fit.covariance[np.ix_(places, places)]
    own = where[0].stop - where[0].start
    parameters, std = _by_delta_method(candidate, coefficients[:own], covariance[:own, :own])
    without = Fit(white.targets, [*base, *others])
    lost = lost_to_speed(white, without, candidate) if std else 0.0
    form_std = {name: _form_std(white, fit, candidate, parameters, name, set(std), lost) for name in std}
    std = {name: float(np.hypot(s, form_std[name])) for name, s in std.items()}
    rest = white.fit(others)
    spreads = spreads_of(white, rest, candidate)
    spreads = _where_the_form_bends(white, others, candidate, form, coefficients, spreads)
    if std:
        unknown = [
            _other_forms(white, without, candidate, parameters, std),
            _in_the_bend(white, candidate, form, coefficients, parameters, std),
            _by_its_band(white, base, others, candidate, parameters, std),
            _by_its_noise(white, without, candidate, parameters, std),
            _by_its_damping(white, without, candidate, parameters, std),
        ]
        if not scaled:
            unknown.append(_followed(white, without, candidate, spreads, set(std)))
        std = {name: float(np.sqrt(s**2 + sum(u[name] ** 2 for u in unknown))) for name, s in std.items()}
    std |= {name: s * abs(float(candidate.nonlinear[name])) for name, s in spreads.std.items() if name != scaled}
    std |= out_of_step(candidate, parameters, std)
    fitted = Fitted(
        candidate=candidate,
        form=form,
        coefficients=coefficients,
        covariance=covariance,
        own=own,
        parameters=parameters,
        std=std,
        spreads=spreads,
        lost=lost,
    )
    peak = largest_torque(white, [*base, *others], fitted, rng)
    return Estimate(named, parameters, std, coefficients, form, peak)


def _by_delta_method(
    candidate: Candidate, coefficients: np.ndarray, covariance: np.ndarray
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the parameters of an effect, within their bounds, and standard deviations of those that its coefficients
    (k,) tell, from their covariance (k, k)."""
    effect = get_effect(candidate.effect)
    parameters = effect.parameters_of(candidate.nonlinear, coefficients)
    jacobian = {name: np.zeros(len(coefficients)) for name in parameters}
    for k in range(len(coefficients)):
        step = STEP * max(abs(coefficients[k]), float(np.sqrt(covariance[k, k])), 1e-12)
        moved = coefficients.copy()
        moved[k] += step
        after = effect.parameters_of(candidate.nonlinear, moved)
        for name in parameters:
            jacobian[name][k] = (after[name] - parameters[name]) / step
    told = {p.name for p in effect.parameters if not p.fixed} - set(candidate.nonlinear)
    if effect.scaled:
        told = {effect.scaled}
    # A robot file takes no parameter beyond its bounds.
    parameters = effect.bounded(parameters)
    std = {
        name: float(np.sqrt(max(jacobian[name] @ covariance @ jacobian[name], 0.0))) for name in told & set(parameters)
    }
    return parameters, std
