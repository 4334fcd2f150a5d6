"""From the effects that were found to the model that is written: refined parameters, and what is put back."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.base import likely_base
from jointwear.discovery.estimates.beyond_band import beyond_band, with_gears
from jointwear.discovery.estimates.curvature import moved_together
from jointwear.discovery.estimates.effect_estimates import Estimate, misfits
from jointwear.discovery.estimates.forms import Form, companion, form_of
from jointwear.discovery.estimates.misfit import divided, misfit_of, tempered
from jointwear.discovery.estimates.outcome import Named, Outcome, Suspected
from jointwear.discovery.estimates.references import effect_term, reference_of, with_references
from jointwear.discovery.estimates.refine import refine, simplest
from jointwear.discovery.estimates.refined_model import RefinedEffect, RefinedModel
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.model.drive_shares import drive_shares, surely_impossible, told_shares
from jointwear.discovery.model.fallback import AS_FITTED, PutBack, Step, put_back
from jointwear.discovery.model.final_model import Final, Weighing, base_of, fit_model, named_all_the_same
from jointwear.discovery.model.left_out import Asked, left_out_ratio
from jointwear.discovery.model.sound_fit import make_links_sound
from jointwear.discovery.model.steps_back import given_up_of_effects, plainer_forms, steps_of
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, fitted_torque
from jointwear.discovery.problem.problem import SENSE
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.acceptance import stiff
from jointwear.discovery.search.crossval import cross_validate

#: How often effects are refined at most, each time beside what the last elastic gears do above their band.
REFINEMENTS = 3


def finalise(outcome: Outcome, links: Step = AS_FITTED) -> Final:
    """Return the retuned and the augmented model, without what predicts records left out worse than the given robot.

    The parameters of named effects are refined, and everything is fitted together, until nothing more is put back.

    Parameters
    ----------
    links : how much of the corrections of the links is given up from the start.
    """
    doubt = doubts(outcome)
    plain = tempered(outcome.white, doubt)
    white, model = _refined(plain, [_doubted(n, doubt) for n in outcome.named])
    named_masses = model.masses
    misfit = misfit_of(white, white.fit(model.effect_terms + model.bend_terms + model.mass_terms))
    weighing = Weighing(outcome, white, doubt, misfit)
    unwritten: tuple[Estimate, ...] = ()
    suspects: tuple[Suspected, ...] = tuple(outcome.suspects)
    fallbacks: tuple[PutBack, ...] = ()
    while True:
        base, model = _whole_model(white, model)
        base, asked = links.taken_off(base), model.terms
        nameless = open_axes(outcome, model.axes)
        plainer = [plainer_forms(white, e.candidate, e.term) for e in model.effects]
        steps = steps_of(white, base, model, plainer)
        kept, given_up = put_back(white, base + asked, steps, "augmented", nameless)
        left = {id(t) for t in kept}
        model = model.plain_where_kept(plainer, left)
        lost = model.lost(left)
        if lost:
            still_named, doubtful = named_all_the_same(weighing, base, model, lost)
            unwritten, suspects = unwritten + still_named, suspects + doubtful
            # Parameters of the drives were held where the effect made corrections needless: they are asked again.
            given_up = given_up_of_effects(given_up, [e.candidate for e in lost])
        fallbacks += given_up
        model = model.only(left)
        if not lost:
            break
        white = _in_band(plain, model.candidates)
        weighing = replace(weighing, white=white)
    ours = {id(t) for t in [*asked, *model.effect_terms]}
    final = fit_model(weighing, [t for t in kept if id(t) not in ours], model)
    shares = _shares(white, kept, nameless, final.delta_friction, final.std_friction)
    friction, inertial, retuned_given_up = _retuned(outcome, plain, named_masses, links)
    return replace(
        final,
        delta_friction=_in_part(final.delta_friction, shares),
        retuned_friction=friction,
        retuned_inertial=inertial,
        fallbacks=fallbacks + told_shares(shares, "augmented") + retuned_given_up,
        unwritten=unwritten,
        suspects=suspects,
        misfits=tuple(words for e in (*final.estimates, *unwritten) for words in misfits(e)),
    )


def _retuned(
    outcome: Outcome, plain: White, masses: tuple[Named, ...], links: Step
) -> tuple[np.ndarray, np.ndarray, tuple[PutBack, ...]]:
    """Return what retuning alone corrects of drives (n, 4) and links (10 n,), and what of it was put back.

    Parameters
    ----------
    masses : masses of links that have a name; `links` as of :func:`finalise`.
    """
    model = RefinedModel((), masses)
    alone = links.taken_off(likely_base(plain, model.terms)[0])
    nameless, steps = open_axes(outcome, model.axes), steps_of(plain, alone, model, [])
    alone, given_up = put_back(plain, [*alone, *model.terms], steps, "retuned", nameless)
    fit = Fit(plain.targets, alone)
    beside = make_links_sound(plain, fit, masses)
    friction, std, inertial = base_of(plain, fit, masses)
    shares = _shares(plain, alone, nameless, friction, std)
    return _in_part(friction, shares), inertial + beside, given_up + told_shares(shares, "retuned")


def _shares(
    white: White, kept: list[Term], open_axes: list[int], friction: np.ndarray, std: np.ndarray
) -> dict[int, tuple[float, float]]:
    """Return :func:`drive_shares`, nothing of a drive whose correction (n, 4) no motor can have: `std` (n, 4) of it."""
    problem, shares = white.problem, drive_shares(white, kept, open_axes)
    for axis in surely_impossible(problem.drive_parameters, friction * SENSE, std, open_axes, problem.settings):
        ratio = shares[axis][1] if axis in shares else float(Asked(white, kept)(kept).surely[axis])
        shares[axis] = (0.0, ratio)
    return shares


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


def _refined(plain: White, named: list[Named]) -> tuple[White, RefinedModel]:
    """Return the problem beside named effects, and these with their nonlinear parameters at the largest evidence.

    The load of which the columns of an elastic gear are made depends on the gear: it is refined once more with that.
    """
    effects = [n for n in named if n.candidate.effect != LINK_MASS]
    masses = tuple(n for n in named if n.candidate.effect == LINK_MASS)
    mass_terms = RefinedModel((), masses).terms
    candidates = [n.candidate for n in effects]
    for _ in range(REFINEMENTS):
        white = _in_band(plain, candidates)
        refined: list[RefinedEffect] = []
        for i, one in enumerate(effects):
            others = [e.term for e in refined] + [t for n in effects[i + 1 :] for t in n.terms] + mass_terms
            fit = white.fit(others)
            candidate = simplest(white, fit, moved_together(white, fit, refine(white, fit, candidates[i])))
            refined.append(RefinedEffect(one, candidate, effect_term(white, candidate, one.term)))
        if white is plain:
            break
        before, candidates = candidates, [e.candidate for e in refined]
        white = _in_band(plain, candidates)
        refined = [replace(e, term=effect_term(white, e.candidate, e.named.term)) for e in refined]
        if all(_alike(a, b, plain.problem.settings.parameter_error) for a, b in zip(before, candidates, strict=True)):
            break
    bent = []
    for i, effect in enumerate(refined):
        others = [e.term for k, e in enumerate(refined) if k != i] + mass_terms
        bent.append(replace(effect, bend=_bend_if_kept(white, effect, others)))
    return white, RefinedModel(tuple(bent), masses)


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
    where = open_axes(outcome, [axis for n in outcome.named for axis in n.candidate.axes])
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


def _whole_model(white: White, model: RefinedModel) -> tuple[list[Term], RefinedModel]:
    """Return the base with its likely errors, and the model with its references placed."""
    base, error = likely_base(white, model.terms)
    settings = white.problem.settings
    if error <= settings.mass_sigmas * settings.parameter_error and any(
        e.bend is None and reference_of(e.candidate) for e in model.effects
    ):
        model = with_references(white, base, model, error)
        base, error = likely_base(white, model.terms)
    return base, model


def _bend_if_kept(white: White, effect: RefinedEffect, others: list[Term]) -> tuple[Form, Term] | None:
    """Return the correction of the form of an effect, and its term, where records left out are predicted better."""
    candidate, term = effect.candidate, effect.term
    form = form_of(white, candidate)
    if form is None or stiff(candidate):
        return None
    torque = fitted_torque(white, white.fit(others), candidate, term.blocks, term.std)
    flexible = companion(white, form, float(np.sqrt(np.mean(torque**2))))
    found = cross_validate(white, [*others, term], [flexible])
    return (form, flexible) if found.nats > 0.5 * white.problem.settings.accept and found.gain_share > 0 else None
