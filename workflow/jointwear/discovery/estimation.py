"""From the effects that were found to estimates: refined parameters, uncertainties, torques on held-out motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from jointwear.discovery.acceptance import stiff
from jointwear.discovery.base import doubted_links, likely_base
from jointwear.discovery.between_axes import of_scales
from jointwear.discovery.beyond_band import beyond_band, with_gears
from jointwear.discovery.candidates import (
    LINK_MASS,
    Candidate,
    fitted_torque,
)
from jointwear.discovery.crossval import cross_validate
from jointwear.discovery.drive_shares import drive_shares, told_shares
from jointwear.discovery.effect_estimates import Estimate, estimate_effect, misfits
from jointwear.discovery.fallback import PutBack, put_back
from jointwear.discovery.forms import Form, companion, form_of
from jointwear.discovery.left_out import left_out_ratio
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.misfit import divided, misfit_of, tempered
from jointwear.discovery.outcome import Named, Outcome, Suspected
from jointwear.discovery.references import effect_term, reference_of, with_references
from jointwear.discovery.refine import refine, simplest
from jointwear.discovery.sound_fit import make_links_sound, make_sound
from jointwear.discovery.steps_back import as_kept, given_up_of_effects, plainer_forms, steps_of
from jointwear.discovery.whitening import INERTIAL, White
from jointwear.robots.inertia import mass_direction

#: How often effects are refined at most, each time beside what the last elastic gears do above their band.
REFINEMENTS = 3


@dataclass(frozen=True)
class Final:
    """The retuned and the augmented model.

    `delta_friction` (n, 4) and `delta_inertial` (10 n,) are added to the nominal parameters of the augmented model;
    `retuned_friction`, `retuned_inertial` those of retuning alone. `unwritten` are effects that are named and that the
    augmented model does without, `suspects` those of the search and what this model does without and does not name,
    with the reason. `white` is the problem with the weight of each axis divided by its `misfit` (n,).
    """

    outcome: Outcome
    white: White
    misfit: np.ndarray
    fit: Fit
    estimates: tuple[Estimate, ...]
    delta_friction: np.ndarray
    std_friction: np.ndarray
    delta_inertial: np.ndarray
    retuned_friction: np.ndarray
    retuned_inertial: np.ndarray
    unwritten: tuple[Estimate, ...] = ()
    suspects: tuple[Suspected, ...] = ()
    fallbacks: tuple[PutBack, ...] = ()
    misfits: tuple[str, ...] = ()


def finalise(outcome: Outcome, without: frozenset[str] = frozenset()) -> Final:
    """Refine the parameters of the named effects, fit everything together and predict all samples.

    Parameters
    ----------
    without : labels of base terms that are left as the robot file has them.
    """
    doubt = doubts(outcome)
    plain = tempered(outcome.white, doubt)
    named = [_doubted(n, doubt) for n in outcome.named]
    effects = [n for n in named if n.candidate.effect != LINK_MASS]
    masses = [n for n in named if n.candidate.effect == LINK_MASS]
    mass_terms = [t for n in masses for t in n.terms]
    white, refined = _refined(plain, effects, mass_terms)
    forms: list[tuple[Form, Term] | None] = []
    for i, (_, candidate, term) in enumerate(refined):
        others = [t for k, (_, _, t) in enumerate(refined) if k != i] + mass_terms
        forms.append(_form_if_kept(white, candidate, term, others))
    found = [t for _, _, t in refined] + [f[1] for f in forms if f is not None]
    misfit = misfit_of(white, white.fit([*found, *mass_terms]))
    unwritten: tuple[Estimate, ...] = ()
    suspects: tuple[Suspected, ...] = tuple(outcome.suspects)
    fallbacks: tuple[PutBack, ...] = ()
    while True:
        base, refined = _whole_model(white, refined, forms, mass_terms)
        terms = [t for _, _, t in refined] + mass_terms + [f[1] for f in forms if f is not None]
        base = [t for t in base if t.label not in without]
        nameless = open_axes(outcome, [c.axis for _, c, _ in refined] + [n.candidate.axis for n in masses])
        plainer = [plainer_forms(white, c, t) for _, c, t in refined]
        steps = steps_of(white, base, refined, forms, masses, plainer)
        kept, given_up = put_back(white, base + terms, steps, "augmented", nameless)
        left = {id(t) for t in kept}
        refined = [as_kept(r, other, left) for r, other in zip(refined, plainer, strict=True)]
        # A bend goes alone, or with the form that it bends.
        forms = [
            f if f is None or id(f[1]) in left or id(t) not in left else None
            for f, (_, _, t) in zip(forms, refined, strict=True)
        ]
        everything = all(id(t) in left for _, _, t in refined)
        if not everything:
            still_named, doubtful = _named_all_the_same(
                outcome, white, doubt, misfit, base, refined, forms, masses, left
            )
            unwritten, suspects = unwritten + still_named, suspects + doubtful
            # Parameters of the drives were held where the effect made corrections needless: they are asked again.
            given_up = given_up_of_effects(given_up, [c for _, c, t in refined if id(t) not in left])
        fallbacks += given_up
        masses = [n for n in masses if id(n.term) in left]
        mass_terms = [t for n in masses for t in n.terms]
        forms = [f for f, (_, _, t) in zip(forms, refined, strict=True) if id(t) in left]
        refined = [r for r in refined if id(r[2]) in left]
        if everything:
            break
        white = _in_band(plain, [c for _, c, _ in refined])
    ours = {id(t) for t in [*terms, *(t for _, _, t in refined)]}
    base = [t for t in kept if id(t) not in ours]
    final = _fitted(outcome, white, doubt, misfit, base, refined, forms, masses)
    shares = drive_shares(white, kept, nameless)
    delta_friction = _in_part(final.delta_friction, shares)
    fallbacks += told_shares(shares, "augmented")
    friction, inertial, retuned_given_up = _retuned(
        outcome, plain, [n for n in named if n.candidate.effect == LINK_MASS], without
    )
    return replace(
        final,
        delta_friction=delta_friction,
        retuned_friction=friction,
        retuned_inertial=inertial,
        fallbacks=fallbacks + retuned_given_up,
        unwritten=unwritten,
        suspects=suspects,
        misfits=tuple(words for e in (*final.estimates, *unwritten) for words in misfits(e)),
    )


def _retuned(
    outcome: Outcome, plain: White, masses: list[Named], without: frozenset[str]
) -> tuple[np.ndarray, np.ndarray, tuple[PutBack, ...]]:
    """Return what retuning alone corrects of drives (n, 4) and links (10 n,), and what of it was put back.

    Parameters
    ----------
    masses : masses of links that have a name; `without` as of :func:`finalise`.
    """
    mass_terms = [t for n in masses for t in n.terms]
    alone = [t for t in likely_base(plain, mass_terms)[0] if t.label not in without]
    nameless, steps = open_axes(outcome, [n.candidate.axis for n in masses]), steps_of(plain, alone, [], [], masses, [])
    alone, given_up = put_back(plain, [*alone, *mass_terms], steps, "retuned", nameless)
    fit = Fit(plain.targets, alone)
    beside = make_links_sound(plain, fit, masses)
    friction, _, inertial = _base_of(plain, fit, masses)
    shares = drive_shares(plain, alone, nameless)
    return _in_part(friction, shares), inertial + beside, given_up + told_shares(shares, "retuned")


def _in_part(friction: np.ndarray, shares: dict[int, tuple[float, float]]) -> np.ndarray:
    """Return corrections of the drives (n, 4) of which some are written in part."""
    part = friction.copy()
    for axis, (share, _) in shares.items():
        part[axis] *= share
    return part


def _in_band(plain: White, candidates: list[Candidate]) -> White:
    """Return the problem with what elastic gears do above the band of their columns, and a load that knows them."""
    white = with_gears(plain, candidates)
    beside = beyond_band(white, candidates)
    return replace(white, base=[*white.base, *beside]) if beside else white


def _refined(
    plain: White, effects: list[Named], mass_terms: list[Term]
) -> tuple[White, list[tuple[Named, Candidate, Term]]]:
    """Return the problem beside the effects and these with their nonlinear parameters at the largest evidence.

    The load of which the columns of an elastic gear are made depends on the gear: it is refined once more with that.
    """
    candidates = [n.candidate for n in effects]
    for _ in range(REFINEMENTS):
        white = _in_band(plain, candidates)
        refined: list[tuple[Named, Candidate, Term]] = []
        for i, one in enumerate(effects):
            others = [t for _, _, t in refined] + [t for n in effects[i + 1 :] for t in n.terms] + mass_terms
            fit = white.fit(others)
            candidate = simplest(white, fit, refine(white, fit, candidates[i]))
            refined.append((one, candidate, effect_term(white, candidate, one.term)))
        if white is plain:
            break
        before, candidates = candidates, [c for _, c, _ in refined]
        white = _in_band(plain, candidates)
        refined = [(one, c, effect_term(white, c, one.term)) for one, c, _ in refined]
        if all(_alike(a, b, plain.problem.settings.parameter_error) for a, b in zip(before, candidates, strict=True)):
            break
    return white, refined


def _alike(one: Candidate, other: Candidate, share: float) -> bool:
    """Return whether no parameter of two candidates of one effect differs by more than a share of itself."""
    return one.nonlinear.keys() == other.nonlinear.keys() and all(
        np.isclose(float(value), float(other.nonlinear[name]), rtol=share, atol=0.0)
        for name, value in one.nonlinear.items()
    )


def open_axes(outcome: Outcome, named: Iterable[int | None]) -> list[int]:
    """Return the 0-based axes on which structure is left and no effect of a model acts; it has effects on `named`."""
    return sorted({u.axis for u in outcome.unexplained} - set(named))


def doubts(outcome: Outcome) -> np.ndarray:
    """Return by how much the noise of every axis (n,) is taken too small where nothing that was fitted helps much.

    Of an axis without a name and with structure that is left, on which a model in which the axis counts by its misfit
    gains little on records left out, the model says nothing. It would bend the inertia of the links, which all axes
    share, to what the axis lacks. Elsewhere it is 1.
    """
    doubt = np.ones(outcome.problem.robot.joints)
    where = open_axes(outcome, [n.candidate.axis for n in outcome.named])
    if where:
        doubt[where] = misfit_of(outcome.white, outcome.fit)[where]
        white = tempered(outcome.white, doubt)
        terms = [divided(t, doubt) for n in outcome.named for t in n.terms]
        gained = left_out_ratio(white, likely_base(white, terms)[0] + terms) <= outcome.problem.settings.nearly_all
        doubt[gained] = 1.0
    return doubt


def _doubted(one: Named, doubt: np.ndarray) -> Named:
    form = None if one.form is None else divided(one.form, doubt)
    return replace(one, term=divided(one.term, doubt), form=form)


def _named_all_the_same(
    outcome: Outcome, white: White, doubt: np.ndarray, misfit: np.ndarray, base, refined, forms, masses, left
) -> tuple[tuple[Estimate, ...], tuple[Suspected, ...]]:
    """Return the effects that are there although the written model does without them, and those that are suspected.

    A model falls back where one record left out is predicted worse, as when the others have to extrapolate to it. That
    does not speak against an effect with which all records together are predicted better than by the given robot.
    Where no structure is left the parts that a name has to predict are asked instead: out of three records two would
    have to extrapolate to the third. Beside structure on its own axis it does: what nobody can name may be all that
    such an effect has found. The others are suspects.
    """
    lost = [i for i, (_, _, term) in enumerate(refined) if id(term) not in left]
    if not lost:
        return (), ()
    whole = _fitted(outcome, white, doubt, misfit, base, refined, forms, masses)
    ratio = cache(lambda parts: left_out_ratio(white, whole.fit.terms, each=False, parts=parts))
    still = {u.axis for u in outcome.unexplained}
    named, suspects = [], []
    for i in lost:
        one, candidate, _ = refined[i]
        axes = white.problem.judged if candidate.axis is None else (candidate.axis,)
        fine = max(ratio(not still.intersection(axes))[j] for j in axes) <= 1.0
        if fine and candidate.axis not in still:
            named.append(whole.estimates[i])
        else:
            suspects.append((one, "with it the model predicts records left out worse than the given robot"))
    return tuple(named), tuple(suspects)


def _whole_model(white, refined, forms, mass_terms):
    """Return the base with its likely errors, and the effects with their references placed."""
    terms = [t for _, _, t in refined] + mass_terms + [f[1] for f in forms if f is not None]
    base, error = likely_base(white, terms)
    settings = white.problem.settings
    if error <= settings.mass_sigmas * settings.parameter_error and any(
        f is None and reference_of(r[1]) for f, r in zip(forms, refined, strict=True)
    ):
        others = mass_terms + [f[1] for f in forms if f is not None]
        refined = with_references(white, base, refined, forms, others, error)
        base, error = likely_base(white, [t for _, _, t in refined] + others)
    return base, refined


def _fitted(
    outcome: Outcome,
    white: White,
    doubt: np.ndarray,
    misfit: np.ndarray,
    base: list[Term],
    refined,
    forms,
    masses: list[Named],
) -> Final:
    """Fit a model as it will be written, and give every effect its estimate.

    What is known of them is said by the axes for as much as their `misfit` leaves, beside the `doubt` by which those of
    `white` have been divided already.
    """
    mass_terms = [t for n in masses for t in n.terms]
    terms = [t for _, _, t in refined] + mass_terms + [f[1] for f in forms if f is not None]
    fit = Fit(white.targets, [*base, *terms])
    places = {id(t): where for t, where in zip(fit.terms, fit.slices, strict=True)}
    beside = make_links_sound(white, fit, masses)
    for _, candidate, term in refined:
        make_sound(fit, candidate, places[id(term)])
    weak, less = tempered(white, misfit), {id(t): divided(t, misfit) for t in fit.terms}
    known = Fit(weak.targets, [less[id(t)] for t in fit.terms])
    known.covariance = doubted_links(weak, known)
    known.theta = fit.theta
    for one, _, term in refined:
        if one.candidate.axis is None:
            known.covariance = known.covariance + of_scales(weak, known, less[id(term)])
    weak_base = [less[id(t)] for t in base]
    rng = np.random.default_rng(np.random.SeedSequence([4, len(terms)]))
    estimates = []
    for i, (one, candidate, term) in enumerate(refined):
        form = forms[i]
        where = [places[id(term)]] + ([places[id(form[1])]] if form is not None else [])
        own = {id(term)} | ({id(form[1])} if form is not None else set())
        others = [less[id(t)] for t in terms if id(t) not in own]
        bent = form[0] if form is not None else None
        estimates.append(estimate_effect(weak, known, weak_base, one, candidate, bent, where, rng, others))
    friction, _, inertial = _base_of(white, fit, masses)
    inertial += beside
    std = _base_of(weak, known, [])[1]
    return Final(
        outcome=outcome,
        white=weak,
        misfit=doubt * misfit,
        fit=fit,
        estimates=tuple(estimates),
        delta_friction=friction,
        std_friction=std,
        delta_inertial=inertial,
        retuned_friction=friction,
        retuned_inertial=inertial,
    )


def _base_of(white: White, fit: Fit, masses: list[Named]):
    """Return corrections of friction (n, 4) with their standard deviations and of inertia (10 n,)."""
    problem = white.problem
    mass_terms = [t for n in masses for t in n.terms]
    n = problem.robot.joints
    friction, std = np.zeros((n, 4)), np.zeros((n, 4))
    inertial = np.zeros(10 * n)
    for term, where in zip(fit.terms, fit.slices, strict=True):
        if term.drive:
            axis, k = term.drive
            friction[axis, k] = fit.theta[where][0]
            std[axis, k] = np.sqrt(np.diag(fit.covariance)[where][0])
        elif term.label == INERTIAL:
            inertial += problem.factor @ (white.directions_of(term) @ fit.theta[where])
        for one, own in zip(masses, mass_terms, strict=True):
            if term is own:
                inertial += mass_direction(problem.robot, one.candidate.axis) * fit.theta[where][0]
    return friction, std, inertial


def _form_if_kept(white, candidate, term, others) -> tuple[Form, Term] | None:
    form = form_of(white, candidate)
    if form is None or stiff(candidate):
        return None
    torque = fitted_torque(white, white.fit(others), candidate, term.blocks, term.std)
    flexible = companion(white, form, float(np.sqrt(np.mean(torque**2))))
    found = cross_validate(white, [*others, term], [flexible])
    return (form, flexible) if found.nats > 0.5 * white.problem.settings.accept and found.gain_share > 0 else None
