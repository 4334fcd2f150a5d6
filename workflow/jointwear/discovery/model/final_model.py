"""A model fitted as a whole: corrections of the robot, an estimate of every effect, and how well each is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from zlib import crc32

import numpy as np

from jointwear.discovery.estimates.base import doubted_links
from jointwear.discovery.estimates.effect_estimates import Estimate, estimate_effect
from jointwear.discovery.estimates.misfit import divided, tempered
from jointwear.discovery.estimates.outcome import Named, Outcome, Suspected
from jointwear.discovery.estimates.refined_model import RefinedEffect, RefinedModel
from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.model.between_axes import of_scales
from jointwear.discovery.model.fallback import PutBack
from jointwear.discovery.model.left_out import Asked, left_out_ratio
from jointwear.discovery.model.sound_fit import make_links_sound, make_sound
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.problem.whitening import INERTIAL, White
from jointwear.robots.inertia import mass_direction

#: Times the error of the given robot, on records left out, beyond which a model with an effect adds more than the robot
#: lacks: two, by the triangle inequality.
ADDS_MORE = 2.0


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


@dataclass(frozen=True)
class Weighing:
    """The problem in which models are fitted, and by how much less an axis counts than its noise says.

    Attributes
    ----------
    outcome : what the search found. white : the problem, its axes divided by `doubt`.
    doubt : (n,) by how much the noise of an axis is taken too small of which the model says nothing, elsewhere 1.
    misfit : (n,) the same of what the named effects leave, beside `doubt`.
    """

    outcome: Outcome
    white: White
    doubt: np.ndarray
    misfit: np.ndarray


def fit_model(weighing: Weighing, base: Sequence[Term], model: RefinedModel) -> Final:
    """Fit a model as it will be written, and give every effect its estimate.

    What is known of them is said by the axes for as much as their `misfit` leaves.
    """
    white, misfit, terms, masses = weighing.white, weighing.misfit, model.terms, model.masses
    fit = Fit(white.targets, [*base, *terms])
    places = {id(t): where for t, where in zip(fit.terms, fit.slices, strict=True)}
    beside = make_links_sound(white, fit, masses)
    for effect in model.effects:
        make_sound(fit, effect.candidate, places[id(effect.term)])
    weak, less = tempered(white, misfit), {id(t): divided(t, misfit) for t in fit.terms}
    known = Fit(weak.targets, [less[id(t)] for t in fit.terms])
    known.covariance = doubted_links(weak, known)
    known.theta = fit.theta
    for effect in model.effects:
        if effect.named.candidate.axis is None:
            known.covariance = known.covariance + of_scales(weak, known, less[id(effect.term)])
    weak_base = [less[id(t)] for t in base]
    estimates = []
    for effect in model.effects:
        others = [less[id(t)] for t in terms if not any(t is o for o in effect.terms)]
        where = [places[id(t)] for t in effect.terms]
        rng = generator_of(effect.candidate)
        estimates.append(estimate_effect(weak, known, weak_base, effect, where, others, rng))
    friction, _, inertial = base_of(white, fit, masses)
    inertial += beside
    std = base_of(weak, known, [])[1]
    return Final(
        outcome=weighing.outcome,
        white=weak,
        misfit=weighing.doubt * misfit,
        fit=fit,
        estimates=tuple(estimates),
        delta_friction=friction,
        std_friction=std,
        delta_inertial=inertial,
        retuned_friction=friction,
        retuned_inertial=inertial,
    )


def generator_of(candidate: Candidate) -> np.random.Generator:
    """Return the generator that the interval of an effect is drawn with: its own, whatever else is named beside it."""
    whose = (candidate.axis, candidate.source)
    key = (crc32(candidate.effect.encode()), *(0 if x is None else int(x) + 1 for x in whose))
    return np.random.default_rng(np.random.SeedSequence(4, spawn_key=key))


def named_all_the_same(
    weighing: Weighing, base: Sequence[Term], model: RefinedModel, lost: Sequence[RefinedEffect]
) -> tuple[tuple[Estimate, ...], tuple[Suspected, ...]]:
    """Return the effects that are there although the written model does without them, and those that are suspected.

    A model falls back where one record left out is predicted worse, as when the others have to extrapolate to it. That
    does not speak against an effect with which all records together are predicted better than by the given robot.
    Where no structure is left the parts that a name has to predict are asked instead: out of three records two would
    have to extrapolate to the third. A record with which it is far worse speaks against it, unless parts say that it is
    nearly all of what its axes lack. Beside structure on its own axis it does: what nobody can name may be all that
    such an effect has found. The others are suspects.
    """
    outcome, white = weighing.outcome, weighing.white
    whole = fit_model(weighing, base, model)
    terms = whole.fit.terms
    ratio = cache(lambda parts: left_out_ratio(white, terms, each=False, parts=parts))
    surely = Asked(white, terms)(terms).surely
    still = {u.axis for u in outcome.unexplained}
    named, suspects = [], []
    for effect, estimate in zip(model.effects, whole.estimates, strict=True):
        if not any(effect is e for e in lost):
            continue
        axis = effect.candidate.axis
        axes = white.problem.judged if axis is None else (axis,)
        fine = max(ratio(not still.intersection(axes))[j] for j in axes) <= 1.0
        little = max(surely[j] for j in axes) <= ADDS_MORE
        if fine and axis not in still and (little or _nearly_all_in_parts(white, terms, effect, axes, ratio(True))):
            named.append(estimate)
        else:
            suspects.append((effect.named, "with it the model predicts records left out worse than the given robot"))
    return tuple(named), tuple(suspects)


def _nearly_all_in_parts(
    white: White, terms: list[Term], effect: RefinedEffect, axes: Sequence[int], beside: np.ndarray
) -> bool:
    """Return whether an effect explains nearly all of what each axis lacks without it, in parts that are left out.

    Parameters
    ----------
    beside : (n,) error of all `terms` on the parts over that of the given robot.
    """
    without = [t for t in terms if not any(t is o for o in effect.terms)]
    before = left_out_ratio(white, without, each=False, parts=True)
    left = 1.0 - white.problem.settings.nearly_all
    return all(beside[j] ** 2 <= left * before[j] ** 2 for j in axes)


def base_of(white: White, fit: Fit, masses: Sequence[Named]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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
