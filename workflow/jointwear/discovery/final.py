"""From the effects that were found to numbers: refined parameters, uncertainties, torques on held-out motion."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jointwear.discovery.candidates import (
    LINK_MASS,
    Candidate,
    Form,
    companion,
    form_of,
    prior_std,
    raw_columns,
)
from jointwear.discovery.crossval import cross_validate
from jointwear.discovery.decide import Named, Outcome
from jointwear.discovery.inertia import mass_direction
from jointwear.discovery.linear import Fit, Term, gain
from jointwear.discovery.problem import White
from jointwear.effects import State, get_effect

#: Bends of a form are kept where records left out gain at least this much from them [nats].
KEEP_FORM = 3.0
DRAWS = 400
#: Arguments over which a robot file cannot bend the form of an effect.
UNBENDING = ("rate of torque", "second derivative of the load")


@dataclass(frozen=True)
class Estimate:
    """One named effect with numbers.

    Attributes
    ----------
    parameters : value of every parameter; std : standard deviation of those that were estimated.
    coefficients : of the columns (and, behind them, of the form if it is kept).
    peak : largest torque [N m] on the held-out motion, peak_low and peak_high its 95 % interval.
    """

    named: Named
    parameters: dict[str, float]
    std: dict[str, float]
    coefficients: np.ndarray
    form: Form | None
    peak: float
    peak_low: float
    peak_high: float


@dataclass(frozen=True)
class Final:
    """The retuned and the augmented model.

    `delta_friction` (n, 4) and `delta_inertial` (10 n,) are added to the nominal numbers of the augmented model;
    `retuned_friction`, `retuned_inertial` those of retuning alone.
    """

    outcome: Outcome
    fit: Fit
    estimates: tuple[Estimate, ...]
    delta_friction: np.ndarray
    std_friction: np.ndarray
    delta_inertial: np.ndarray
    retuned_friction: np.ndarray
    retuned_inertial: np.ndarray


def finalise(outcome: Outcome) -> Final:
    """Refine the parameters of the named effects, fit everything together and predict all samples."""
    white, problem = outcome.white, outcome.problem
    effects = [n for n in outcome.named if n.candidate.effect != LINK_MASS]
    masses = [n for n in outcome.named if n.candidate.effect == LINK_MASS]
    mass_terms = [t for n in masses for t in n.terms]
    refined: list[tuple[Named, Candidate, Term]] = []
    for i, one in enumerate(effects):
        others = [t for _, _, t in refined] + [t for n in effects[i + 1 :] for t in n.terms] + mass_terms
        candidate = _refine(white, white.fit(others), one.candidate)
        refined.append((one, candidate, _term(white, candidate, one.term)))
    forms: list[tuple[Form, Term] | None] = []
    for i, (one, candidate, term) in enumerate(refined):
        others = [t for k, (_, _, t) in enumerate(refined) if k != i] + mass_terms
        forms.append(_form_if_kept(white, one, candidate, term, others))
    terms = [t for _, _, t in refined] + mass_terms + [f[1] for f in forms if f is not None]
    base = sparse_base(white, terms)
    fit = Fit(white.targets, [*base, *terms])
    rng = np.random.default_rng(np.random.SeedSequence([4, len(terms)]))
    estimates = []
    offset = len(base)
    next_form = offset + len(refined) + len(mass_terms)
    for i, (one, candidate, _) in enumerate(refined):
        where = [fit.slices[offset + i]]
        form = None
        if forms[i] is not None:
            form = forms[i][0]
            where.append(fit.slices[next_form])
            next_form += 1
        estimates.append(_estimate(problem, white, fit, one, candidate, form, where, rng, refined, i))
    friction, std, inertial = _base_of(white, fit, mass_terms, masses)
    alone = Fit(white.targets, [*sparse_base(white, mass_terms), *mass_terms])
    base_friction, _, base_inertial = _base_of(white, alone, mass_terms, masses)
    return Final(outcome, fit, tuple(estimates), friction, std, inertial, base_friction, base_inertial)


#: Relative error that a nominal number of the drive typically has.
TYPICAL_ERROR = 0.15
#: Evidence [nats] for a correction before it is made: of two dozen numbers one would else move by chance.
NEEDED_NATS = 2.5


def sparse_base(white: White, extra: list[Term]) -> list[Term]:
    """Return the base terms that the data call for: a number that is right is left as it is.

    Every correction of friction and motor inertia is weighed against none (Savage-Dickey ratio, the correction
    being of :data:`TYPICAL_ERROR` before the data), the inertial parameters all together.
    """
    robot = white.problem.robot
    nominal = np.stack([robot.coulomb_positive, -robot.coulomb_negative, robot.viscous, robot.armature], axis=1)
    base: list[Term] = []
    slab: dict[str, float] = {}
    for term in white.base:
        if not term.label.startswith("friction "):
            base.append(term)
            continue
        axis = int(term.label.split()[1])
        for k in range(4):
            label = f"{term.label} {k}"
            base.append(Term(label, {axis: term.blocks[axis][:, [k]]}, term.std[[k]], {axis: term.raw[axis][:, [k]]}))
            typical = TYPICAL_ERROR * nominal[axis, k]
            slab[label] = min(term.std[k], typical) if typical > 0 else float(term.std[k])
    fit = Fit(white.targets, [*base, *extra])
    inertial = next((t for t in base if t.label == "inertial"), None)
    if inertial is not None:
        without = Fit(white.targets, [*(t for t in base if t is not inertial), *extra])
        if without.evidence > fit.evidence:
            base, fit = [t for t in base if t is not inertial], without
    for _ in range(8):
        for_removal = {}
        for term, where in zip(fit.terms, fit.slices, strict=True):
            if term.label in slab:
                variance, value = fit.covariance[where, where][0, 0], fit.theta[where][0]
                ratio = 0.5 * np.log(slab[term.label] ** 2 / variance) - 0.5 * value**2 / variance
                if ratio > -NEEDED_NATS:
                    for_removal[term.label] = ratio
        if not for_removal:
            break
        # Numbers that stand in for each other must not go together: the upper half first.
        bar = float(np.median(list(for_removal.values())))
        gone = {label for label, ratio in for_removal.items() if ratio >= bar}
        base = [t for t in base if t.label not in gone]
        fit = Fit(white.targets, [*base, *extra])
    # A number that would have to be negative is not what is wrong: it stays as it is.
    for _ in range(4):
        values = {t.label: fit.theta[w][0] for t, w in zip(fit.terms, fit.slices, strict=True) if t.label in slab}
        gone = set()
        for label, value in values.items():
            axis, k = map(int, label.split()[1:])
            if nominal[axis, k] + (value if k != 1 else -value) < 0:
                gone.add(label)
        if not gone:
            break
        base = [t for t in base if t.label not in gone]
        fit = Fit(white.targets, [*base, *extra])
    return base


def effect_on(state: State, estimate: Estimate) -> np.ndarray:
    """Return the torque of one estimated effect on any ordered state, (m, n)."""
    return np.asarray(_columns_on(state, estimate) @ estimate.coefficients)


def _columns_on(state: State, estimate: Estimate) -> np.ndarray:
    """Columns (m, n, k) of an effect and its form."""
    return _all_columns(state, estimate.named.candidate, estimate.form)


def _all_columns(state: State, candidate: Candidate, form: Form | None) -> np.ndarray:
    effect = get_effect(candidate.effect)
    if effect.whole_arm:
        return effect.columns(state, 0, None, candidate.nonlinear)
    own = effect.columns(state, candidate.axis, candidate.source, candidate.nonlinear)
    if form is not None:
        own = np.concatenate([own, form.columns(state)], axis=1)
    full = np.zeros((len(own), state.position.shape[1], own.shape[1]))
    full[:, candidate.axis] = own
    return full


def _base_of(white: White, fit: Fit, mass_terms: list[Term], masses: list[Named]):
    problem = white.problem
    n = problem.robot.joints
    friction, std = np.zeros((n, 4)), np.zeros((n, 4))
    inertial = np.zeros(10 * n)
    for term, where in zip(fit.terms, fit.slices, strict=True):
        if term.label.startswith("friction "):
            axis, k = map(int, term.label.split()[1:])
            friction[axis, k] = fit.theta[where][0]
            std[axis, k] = np.sqrt(np.diag(fit.covariance)[where][0])
        elif term.label == "inertial":
            inertial += problem.factor @ (white.directions @ fit.theta[where])
        for one, own in zip(masses, mass_terms, strict=True):
            if term is own:
                inertial += mass_direction(problem.robot, one.candidate.axis) * fit.theta[where][0]
    return friction, std, inertial


def _term(white: White, candidate: Candidate, old: Term) -> Term:
    if candidate.axis is None:
        return old
    columns = raw_columns(white, candidate)
    return Term(
        f"{candidate.effect} {candidate.axis}",
        {candidate.axis: white.columns(candidate.axis, columns)},
        prior_std(white, candidate.axis, columns),
        {candidate.axis: white.raw(candidate.axis, columns)},
    )


def _free(candidate: Candidate) -> list:
    """The nonlinear parameters of a candidate that may be refined."""
    if candidate.axis is None or get_effect(candidate.effect).needs_source:
        return []
    known = {p.name: p for p in get_effect(candidate.effect).parameters}
    return [known[k] for k in candidate.nonlinear if not known[k].fixed and k != "order"] + [
        known[k] for k in candidate.nonlinear if k == "order" and get_effect(candidate.effect).argument != "motor angle"
    ]


def _value(white: White, fit: Fit, candidate: Candidate) -> float:
    columns = raw_columns(white, candidate)
    if not np.isfinite(columns).all():
        return -np.inf
    b, gram = fit.gram({candidate.axis: white.columns(candidate.axis, columns)})
    return gain(b, gram, prior_std(white, candidate.axis, columns))


def _refine(white: White, fit: Fit, candidate: Candidate) -> Candidate:
    """Move the nonlinear parameters of a candidate to the largest evidence, one after the other, twice.

    Parameters that are positive are searched on a logarithmic scale, with steps that shrink.
    """
    free = _free(candidate)
    if not free:
        return candidate
    best, value = candidate, _value(white, fit, candidate)
    step = {p.name: 0.25 for p in free}
    for _ in range(7):
        for p in free:
            for sign in (1.0, -1.0):
                trial_value = float(best.nonlinear[p.name]) * np.exp(sign * step[p.name])
                trial_value = float(np.clip(trial_value, p.lower, p.upper))
                trial = replace(best, nonlinear={**best.nonlinear, p.name: trial_value})
                got = _value(white, fit, trial)
                if got > value:
                    best, value = trial, got
                    break
            else:
                step[p.name] *= 0.45
    return best


def _form_if_kept(white, one: Named, candidate, term, others) -> tuple[Form, Term] | None:
    form = form_of(white, candidate)
    effect = get_effect(candidate.effect)
    # A robot file can hold a table, harmonics or several hysteresis loops, not other bends.
    if form is None or effect.needs_source or effect.argument in UNBENDING:
        return None
    fit = white.fit(others)
    b, gram = fit.gram(term.blocks)
    coefficients = np.linalg.solve(gram + np.diag(1 / term.std**2), b)
    used = white.problem.usable[:, candidate.axis]
    size = float(np.sqrt(np.mean((raw_columns(white, candidate) @ coefficients)[used] ** 2)))
    flexible = companion(white, form, size)
    found = cross_validate(white, [*others, term], [flexible])
    return (form, flexible) if found.nats > KEEP_FORM and found.raw < 1.0 else None


def _estimate(problem, white, fit, one, candidate, form, where, rng, refined, index) -> Estimate:
    """Numbers of one effect: parameters by the delta method, the peak torque by drawing from the posterior."""
    named = replace(one, candidate=candidate)
    effect = get_effect(candidate.effect)
    places = np.concatenate([np.arange(w.start, w.stop) for w in where])
    coefficients = fit.theta[places]
    own = where[0].stop - where[0].start
    covariance = fit.covariance[np.ix_(places, places)]
    parameters = effect.parameters_of(candidate.nonlinear, coefficients[:own])
    std: dict[str, float] = {}
    jacobian = {name: np.zeros(own) for name in parameters}
    for k in range(own):
        step = 1e-4 * max(abs(coefficients[k]), float(np.sqrt(covariance[k, k])), 1e-12)
        moved = coefficients[:own].copy()
        moved[k] += step
        after = effect.parameters_of(candidate.nonlinear, moved)
        for name in parameters:
            jacobian[name][k] = (after[name] - parameters[name]) / step
    linear = {p.name for p in effect.parameters if not p.fixed} - set(candidate.nonlinear)
    if candidate.effect == "actuation_delay":
        linear = {"delay"}
    for name in linear & set(parameters):
        std[name] = float(np.sqrt(max(jacobian[name] @ covariance[:own, :own] @ jacobian[name], 0.0)))
    others = [t for k, (_, _, t) in enumerate(refined) if k != index]
    rest = white.fit(others)
    directions = []
    for p in _free(candidate):
        if p.name == "delay":
            continue
        spread = _spread(white, rest, candidate, p)
        std[p.name] = spread * abs(float(candidate.nonlinear[p.name]))
        directions.append(_profile_change(problem, white, rest, candidate, p.name, spread))
    if "reference" in candidate.nonlinear:
        directions.append(_reference_change(problem, candidate, coefficients[:own]))
    test = problem.state.part(problem.test)
    columns = _all_columns(test, candidate, form)
    moving = problem.measured.usable[problem.test]
    torque = np.where(moving, columns @ coefficients, 0.0)
    peak = float(np.max(np.abs(torque), initial=0.0))
    root = np.linalg.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance) + 1e-300))
    draws = coefficients[:, None] + root @ rng.standard_normal((len(coefficients), DRAWS))
    if candidate.axis is None:
        # Ten columns on every axis: thinned, the largest torque is a slow function of the pose.
        keep = slice(None, None, max(1, len(columns) // 300))
        sampled = np.abs(np.einsum("mnk,kd->mnd", columns[keep], draws) * moving[keep][:, :, None]).max(axis=(0, 1))
    else:
        sampled = columns[:, candidate.axis] @ draws
        for change in directions:
            sampled = sampled + change[:, candidate.axis][:, None] * rng.standard_normal(DRAWS)
        sampled = np.abs(sampled * moving[:, candidate.axis][:, None]).max(axis=0)
    # The form is a further source of error: the peak is where a textbook curve fits worst.
    sampled = sampled * (1 + FORM_ERROR * rng.standard_normal(DRAWS)) if len(sampled) else sampled
    low, high = np.quantile(sampled, [0.025, 0.975])
    return Estimate(named, parameters, std, coefficients, form, peak, float(min(low, peak)), float(max(high, peak)))


def _profile_change(problem, white, rest: Fit, candidate: Candidate, name: str, spread: float) -> np.ndarray:
    """Return how the torque on the held-out motion changes with one standard deviation of a nonlinear parameter.

    The coefficients follow, as they would in a fit.
    """
    test = problem.state.part(problem.test)

    def torque(shift: float) -> np.ndarray:
        value = float(candidate.nonlinear[name]) * np.exp(shift)
        moved = replace(candidate, nonlinear={**candidate.nonlinear, name: value})
        raw = raw_columns(white, moved)
        b, gram = rest.gram({candidate.axis: white.columns(candidate.axis, raw)})
        std = prior_std(white, candidate.axis, raw)
        return _all_columns(test, moved, None) @ np.linalg.solve(gram + np.diag(1 / std**2), b)

    step = min(spread, 0.3)
    return (torque(step) - torque(-step)) / (2 * step) * spread


def _reference_change(problem, candidate: Candidate, coefficients: np.ndarray) -> np.ndarray:
    """Return how the torque on the held-out motion changes with the reference temperature.

    Where the nominal numbers hold is known to an eighth of the range of temperatures at best.
    """
    test = problem.state.part(problem.test)
    warm = problem.train_state.temperature[:, candidate.axis]
    shift = 0.125 * float(np.nanmax(warm) - np.nanmin(warm))
    moved = replace(candidate, nonlinear={**candidate.nonlinear, "reference": candidate.nonlinear["reference"] + shift})
    return (_all_columns(test, moved, None) - _all_columns(test, candidate, None)) @ coefficients


#: Relative standard deviation of the form of an effect in the interval of its peak torque.
FORM_ERROR = 0.1


def _spread(white: White, fit: Fit, candidate: Candidate, parameter) -> float:
    """Return the standard deviation of the logarithm of a nonlinear parameter from the curvature of the evidence."""
    h = 0.05

    def at(shift):
        value = float(candidate.nonlinear[parameter.name]) * np.exp(shift)
        return _value(white, fit, replace(candidate, nonlinear={**candidate.nonlinear, parameter.name: value}))

    curvature = -(at(h) - 2 * at(0.0) + at(-h)) / h**2
    return float(np.clip(1 / np.sqrt(max(curvature, 1e-9)), 1e-4, 1.0))
