"""Nonlinear parameters of an effect, moved from the grid to the largest evidence."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from jointwear.discovery.estimates.harmless_band import where_noise_is_harmless
from jointwear.discovery.estimates.scan import gain_about_one, possible
from jointwear.discovery.linear import Fit, gain, gain_of_one, posterior_mean
from jointwear.discovery.problem.candidates import Candidate, on_all_axes, prior_std, raw_torques, whitened
from jointwear.discovery.problem.whitening import White
from jointwear.effects import Parameter, get_effect

#: How many values of the one parameter in which a torque is nearly linear the search may start from.
STARTS = 16
#: First step of the logarithm of a parameter, by how much one that finds nothing shortens, and rounds.
FIRST_STEP, SHORTER, ROUNDS = 0.25, 0.45, 7


def free_parameters(candidate: Candidate) -> list[Parameter]:
    """The nonlinear parameters of a candidate that may be refined."""
    return [] if candidate.axis is None else get_effect(candidate.effect).searched(candidate.nonlinear)


def evidence_at(white: White, fit: Fit, candidate: Candidate, any_size: bool = False) -> float:
    """Return the evidence [nats] that a candidate on one axis adds to a fit.

    Parameters
    ----------
    any_size : a torque that misses the size which its one parameter gives it counts too.
    """
    torques = raw_torques(white, candidate)
    if not all(np.isfinite(columns).all() for columns in torques.values()):
        return -np.inf
    b, gram = fit.gram(whitened(white, torques))
    if on_all_axes(candidate):
        return gain_about_one(white, b, gram, np.inf if any_size else white.problem.settings.off_scale)
    if get_effect(candidate.effect).scaled:
        # Its size is in the columns: the coefficient is one.
        return gain_of_one(b, gram)
    return gain(b, gram, prior_std(white, candidate, torques[candidate.axis]))


def best_start(white: White, fit: Fit, candidate: Candidate) -> Candidate:
    """Return the best of a row of values of the one parameter of an effect whose coefficient is one.

    Friction turns at another sample with each value: the evidence has many small peaks, and a search from one of them
    stays there.
    """
    effect = get_effect(candidate.effect)
    name = effect.scaled
    if not name or on_all_axes(candidate):
        # The grid of what acts on all axes was made for it.
        return candidate
    grid = [float(p[name]) for p in effect.grid(white.problem.train_state, candidate.axis)]
    sign = np.sign(candidate.nonlinear[name])
    sizes = [abs(x) for x in grid if np.sign(x) == sign]
    values = sign * np.geomspace(0.5 * min(sizes), max(sizes), STARTS)
    trials = [candidate, *(replace(candidate, nonlinear={**candidate.nonlinear, name: float(x)}) for x in values)]
    return max(trials, key=lambda c: evidence_at(white, fit, c))


def refine(white: White, fit: Fit, candidate: Candidate, other_form: bool = False) -> Candidate:
    """Move the nonlinear parameters of a candidate to the largest evidence, one after the other, twice.

    Parameters keep their sign and are searched on a logarithmic scale, with steps that shrink. Where the effect names
    alternatives, or states in which records may begin, these are tried too; `other_form` says that this has been seen
    to.
    """
    free = free_parameters(candidate)
    if not free:
        return candidate
    effect = get_effect(candidate.effect)
    forms = [candidate.nonlinear, *effect.alternatives(candidate.nonlinear)]
    others = [] if other_form else [*forms[1:], *(p for form in forms for p in effect.begins(form))]
    if others:
        found = [refine(white, fit, c, other_form=True) for c in (candidate, *_others(candidate, others))]
        return _likeliest(white, fit, found)
    candidate = best_start(white, fit, candidate)
    best, value = candidate, evidence_at(white, fit, candidate)
    step = {p.name: FIRST_STEP for p in free}
    bounds = limits(white, candidate)
    for _ in range(ROUNDS):
        for p in free:
            for sign in (1.0, -1.0):
                trial_value = float(best.nonlinear[p.name]) * np.exp(sign * step[p.name])
                trial_value = float(np.clip(trial_value, *bounds[p.name]))
                trial = replace(best, nonlinear={**best.nonlinear, p.name: trial_value})
                got = evidence_at(white, fit, trial)
                if got > value:
                    best, value = trial, got
                    break
            else:
                step[p.name] *= SHORTER
    return best


def limits(white: White, candidate: Candidate) -> dict[str, tuple[float, float]]:
    """Return between which values every nonlinear parameter of a candidate is searched."""
    effect = get_effect(candidate.effect)
    bounds = {p.name: (p.lower, p.upper) for p in free_parameters(candidate)}
    if on_all_axes(candidate):
        # A swing outside the range of the grid is none that these data could show.
        grid = effect.grid(white.problem.train_state, candidate.axis)
        sizes = [g[effect.scaled] for g in grid if set(g) == set(candidate.nonlinear)]
        bounds[effect.scaled] = (min(sizes), max(sizes))
    return bounds


def _likeliest(white: White, fit: Fit, found: list[Candidate]) -> Candidate:
    """Return the form of most evidence out of those of an effect, refined.

    Of late torque only the turn is compared above the cut-off of rates of torque, and a lag turns less than it takes
    off: which of its forms it is, is told below, unless they are as good there.
    """
    if get_effect(found[0].effect).late:
        nats = [where_noise_is_harmless(white, fit, c)[0] for c in found]
        undecided = 0.5 * white.problem.settings.accept
        found = [c for c, n in zip(found, nats, strict=True) if n >= max(nats) - undecided]
    return max(found, key=lambda c: evidence_at(white, fit, c))


def simplest(white: White, fit: Fit, candidate: Candidate) -> Candidate:
    """Return the candidate with the simplest form that the data do not contradict.

    A form that the data leave open says more than they do where there are none: between recordings, or beyond the
    travel. Where an effect has courses over time the one in the middle of all is taken, else its plain form if it has
    one, of waves over time the slowest, of friction that builds up that which does not relax, of forms that look alike
    that of the smallest coefficients.
    """
    if candidate.axis is None:
        return candidate
    effect, state = get_effect(candidate.effect), white.problem.train_state
    searched = bool(free_parameters(candidate))
    courses = _others(candidate, effect.courses(state, candidate.axis)) if searched else []
    if courses:
        return central(white, fit, candidate, courses)
    plain = _others(candidate, effect.plain(state, candidate.axis))
    if not plain and not searched:
        return candidate
    best = evidence_at(white, fit, candidate)
    undecided = 0.5 * white.problem.settings.accept
    for trial in plain:
        # Turned round a form says as much, with friction that drives.
        if evidence_at(white, fit, trial) > best - undecided and _may_exist(white, fit, trial):
            return trial
    if not searched:
        return candidate
    slower = _others(candidate, effect.slower(state, candidate.axis, candidate.nonlinear))
    if slower:
        trials = [refine(white, fit, t, other_form=True) for t in slower]
        told = [(evidence_at(white, fit, t), t) for t in trials] + [(best, candidate)]
        most = max(value for value, _ in told)
        return next(t for value, t in told if value > most - undecided)
    alike = _others(candidate, effect.alike(candidate.nonlinear))
    return _smallest(white, fit, [candidate, *alike], undecided) if alike else candidate


def _others(candidate: Candidate, forms: Iterable[Mapping[str, Any]]) -> list[Candidate]:
    """Return the same candidate with other nonlinear parameters."""
    return [replace(candidate, nonlinear=dict(p)) for p in forms]


def _smallest(white: White, fit: Fit, forms: list[Candidate], undecided: float) -> Candidate:
    """Return the form of the smallest coefficients of those that are behind the likeliest by less than `undecided`
    nats."""
    found = []
    for form in forms:
        torques = raw_torques(white, form)
        b, gram = fit.gram(whitened(white, torques))
        std = prior_std(white, form, torques[form.axis])
        size = float(np.linalg.norm(posterior_mean(b, gram, std)))
        found.append((gain(b, gram, std), size, form))
    best = max(value for value, _, _ in found)
    return min((f for f in found if f[0] > best - undecided), key=lambda f: f[1])[2]


def _may_exist(white: White, fit: Fit, candidate: Candidate) -> bool:
    """Return whether the parameters of an effect, as they would be fitted, lie within their bounds."""
    torques = raw_torques(white, candidate)
    b, gram = fit.gram(whitened(white, torques))
    size = posterior_mean(b, gram, prior_std(white, candidate, torques[candidate.axis]))
    return possible(get_effect(candidate.effect), candidate.nonlinear, size)


def central(white: White, fit: Fit, candidate: Candidate, others: list[Candidate]) -> Candidate:
    """Return the form over time that is nearest to the average of all, each weighed by how likely it is.

    Many forms go through the few points in time that recordings show. Between them the likeliest may lie far from all
    others that are as good. No form is exact, so that evidence is weighed against what `form_error` costs.
    """
    settings, state = white.problem.settings, white.problem.train_state
    effect, axis, forms = get_effect(candidate.effect), candidate.axis, [candidate, *others]
    # The same motion at times spread evenly: those between the recordings too.
    spread = replace(state, time=np.linspace(np.min(state.time), np.max(state.time), len(state.time)))
    used = white.problem.usable[:, axis]
    nats, courses = [], []
    for form in forms:
        torques = raw_torques(white, form)
        b, gram = fit.gram(whitened(white, torques))
        std = prior_std(white, form, torques[axis])
        size = posterior_mean(b, gram, std)
        nats.append(gain(b, gram, std))
        carrier, _ = effect.shape(state, axis, form.nonlinear)
        # A constant is a correction of what is beside it.
        level = carrier[used] @ torques[axis][used] @ size / max(carrier[used] @ carrier[used], 1e-300)
        courses.append(effect.columns(spread, axis, form.source, form.nonlinear) @ size - level * carrier)
    behind = np.max(nats) - np.array(nats)
    unsure = max(1.0, settings.form_error**2 * float(np.max(nats)))
    off = np.mean((courses - np.average(courses, axis=0, weights=np.exp(-behind / unsure))) ** 2, axis=1)
    undecided = 0.5 * settings.accept
    near = forms[int(np.argmin(np.where(behind < undecided * unsure, off, np.inf)))]
    moved = refine(white, fit, near, other_form=True)
    return moved if evidence_at(white, fit, moved) > evidence_at(white, fit, near) + undecided else near
