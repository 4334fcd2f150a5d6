"""The gates that an effect passes before it is named: it predicts in nats and in N m, and it is one of the robot.

What is asked of a candidate is asked in full: every gate that it misses is a :class:`Refusal` that tells by how much.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.harmless_band import where_noise_is_harmless
from jointwear.discovery.estimates.misfit import divided, misfit_of, tempered
from jointwear.discovery.estimates.outcome import Named, Refusal
from jointwear.discovery.estimates.scan import gain_about_one, possible
from jointwear.discovery.linear import Fit, Term, gain, posterior_mean
from jointwear.discovery.problem.candidates import (
    LINK_MASS,
    Candidate,
    fitted_torque,
    on_all_axes,
    raw_torques,
)
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.whitening import INERTIAL, Folds, White, clock_label
from jointwear.discovery.search.body_or_links import impossible_nats, lead_over_links, nats_of_its_mass
from jointwear.discovery.search.crossval import CrossValidated, cross_validate
from jointwear.discovery.search.recorded_in_time import nats_of_time
from jointwear.discovery.search.steps_and_levels import levels_lead, nats_beside_levels, step_between_lead, step_lead
from jointwear.discovery.settings import Settings
from jointwear.effects import get_effect

#: The gate that asks every record alone.
ONE_RECORD = "nats gained on the record left out that gains least"
#: The gate of parameters that lie within their bounds each, but are not those of such an effect together.
BOUNDS = "its parameters within their bounds"


def follows_time(candidate: Candidate) -> bool:
    """Return whether an effect changes with time."""
    return candidate.effect != LINK_MASS and get_effect(candidate.effect).follows_time


def of_timing(candidate: Candidate) -> bool:
    """Return whether an effect is made of rates of torque."""
    return candidate.effect != LINK_MASS and get_effect(candidate.effect).timing


def of_late_torque(candidate: Candidate) -> bool:
    """Return whether an effect is torque at another time."""
    return candidate.effect != LINK_MASS and get_effect(candidate.effect).late


def without_clock(white: White, axis: int) -> White:
    """Return the problem in which position and torque of an axis (0-based) are recorded at the same instant."""
    label = clock_label(axis)
    return replace(white, base=[t for t in white.base if t.label != label])


def of_drive(candidate: Candidate) -> bool:
    """Return whether an effect is a share of all torque of its axis."""
    return candidate.effect != LINK_MASS and get_effect(candidate.effect).of_drive


def is_body(candidate: Candidate) -> bool:
    """Return whether an effect is a body, which wrong inertial parameters of the links may stand for."""
    return candidate.effect != LINK_MASS and get_effect(candidate.effect).sound is not None


def stiff(candidate: Candidate) -> bool:
    """Return whether a robot file cannot bend the form of an effect: what is written is the textbook form."""
    if candidate.effect == LINK_MASS:
        return False
    bend = get_effect(candidate.effect).bend
    return bend is not None and bend.written is None


def missed(found: CrossValidated, evidence: float, settings: Settings) -> list[tuple[str, float, float]]:
    """Return the gates of prediction that are missed: name, what was reached and what is needed of each.

    Parameters
    ----------
    evidence : nats of the effect, of which a small part must show in records left out; 0 asks for what any needs.
    """
    # Where the base could take an effect over at the price of unlikely parameters, that price is in the evidence but
    # not in the prediction of one more record: beyond twice what any effect needs the share is no longer asked for.
    nats = min(settings.form_error * max(evidence, settings.accept), 2.0 * settings.accept)
    # A form that is a little off in one record costs it that share of what the effect is worth.
    worst = min(-0.5 * settings.accept, -settings.form_error * found.nats)
    gates = (
        ("nats gained on records left out", found.nats, nats),
        (ONE_RECORD, found.worst, worst),
        ("nats without the block of time that gains most", found.elsewhere, 0.5 * settings.accept),
        ("probability of a smaller error on records left out", found.lowers_error, settings.certainty),
        ("drop of the squared error over the noise variance", found.gain_share, settings.smallest_share),
    )
    return [(gate, reached, needed) for gate, reached, needed in gates if not reached >= needed]


def _refused(trial: Named, gate: str, reached: float, needed: float) -> Refusal:
    return Refusal(trial.candidate, trial.evidence, gate, float(reached), float(needed))


def predictive(white: White, before: list[Term], trial: Named) -> tuple[CrossValidated, list[Refusal]]:
    """Return how an effect predicts records left out, with the gates that it misses.

    The textbook form may fail where the effect itself does not: then its form may bend. Where a robot file cannot hold
    the bend the textbook form has to predict all records together; what it costs one of them is asked of the bent
    form. What changes with time is wanted for the time to come: it has to predict either way. What acts on
    several axes may be there while one of them lacks something else: each counts by its misfit beside the effect.
    """
    settings = white.problem.settings
    if len(trial.term.blocks) > 1:
        white, before, trial = _by_misfit(white, before, trial)
    lasting, parts_of = follows_time(trial.candidate), left_out_of(white, trial.candidate)
    evidence = trial.evidence
    if of_late_torque(trial.candidate):
        white = without_clock(white, trial.candidate.axis)
    if is_body(trial.candidate):
        # Links that are wrong beyond what anyone would believe predict as well as a body does: the evidence tells them
        # apart. Records left out tell whether the robot as given predicts better with the body.
        white, evidence = replace(white, base=[t for t in white.base if t.label != INERTIAL]), 0.0
    found = cross_validate(white, before, [trial.term], parts_of)
    failed = missed(found, evidence, settings)
    if trial.form is not None and stiff(trial.candidate):
        if [gate for gate, *_ in failed] == [ONE_RECORD]:
            bent = cross_validate(white, before, trial.terms, parts_of)
            failed = missed(bent, evidence, settings) and failed
    elif trial.form is not None and lasting == (not failed):
        bent = cross_validate(white, before, trial.terms, parts_of)
        bent_failed = missed(bent, evidence, settings)
        if not lasting or bent_failed:
            found, failed = bent, bent_failed
    return found, [_refused(trial, *gate) for gate in failed]


def left_out_of(white: White, candidate: Candidate) -> Folds:
    """Return what is left out in turn to ask an effect.

    How much changed between two records is known of none that is left out: half of it tells of the other half.
    """
    return white.halves if follows_time(candidate) else white.parts


def _by_misfit(white: White, before: list[Term], trial: Named) -> tuple[White, list[Term], Named]:
    """Return problem, terms and trial in which every axis counts by what is left on it with the trial in the model."""
    misfit = misfit_of(white, white.fit([*before, *trial.terms]))
    if np.all(misfit <= 1.0):
        return white, before, trial
    form = None if trial.form is None else divided(trial.form, misfit)
    weighed = replace(trial, term=divided(trial.term, misfit), form=form)
    return tempered(white, misfit), [divided(t, misfit) for t in before], weighed


def refusals(white: White, named: list[Named], trial: Named) -> list[Refusal]:
    """Return the gates that keep an effect from being named beside `named`, none if it passes all of them."""
    settings = white.problem.settings
    before = [t for n in named for t in n.terms]
    found, failed = predictive(white, before, trial)
    if trial.candidate.effect == LINK_MASS:
        return failed + mass_refusals(white, before, trial)
    half = 0.5 * settings.accept
    beside = white.fit(before)
    beyond = bound_missed(white, beside, trial)
    gates = []
    if trial.candidate.axis is not None:
        if follows_time(trial.candidate):
            gates.append(("nats gained on the last record left out", found.last, -half))
            gates.append(("nats by which one step in time does better", -step_lead(white, beside, trial), -half))
            lead = step_between_lead(white, beside, trial)
            gates.append(("nats by which one step between two records does better", -lead, -half))
            lead = levels_lead(white, beside, trial)
            gates.append(("nats by which a level of its own in each record does better", -lead, -half))
        # Twice as large as what it has to explain: by the triangle inequality more is left with it than without.
        cancels = _cancels(white, before, trial)
        gates.append(("its RMS torque over that of the discrepancy of its axis", -cancels, -2.0))
        effect = get_effect(trial.candidate.effect)
        if effect.late:
            delay = float(trial.candidate.nonlinear[effect.scaled])
            on_time = without_clock(white, trial.candidate.axis).fit(before)
            nats = nats_of_time(white, on_time, trial.candidate.axis, delay)
            gates.append(("nats of the recorded torque put forward in time", nats, half))
            nats, share = where_noise_is_harmless(white, on_time, trial.candidate)
            gates.append(("nats in the band in which noise feigns no rate of torque", nats, half))
            gates.append(("share of what that band has of it at any size", share, settings.nearly_all))
        if effect.as_seen:
            nats = nats_beside_levels(white, before, trial)
            gates.append(("nats beside a level of its own in each record", nats, half))
        if effect.of_drive:
            sigmas = sigmas_off(white, before, beside, trial)
            gates.append(("standard deviations by which it is off", sigmas, settings.mass_sigmas))
        if effect.rubs:
            gates.append(("nats of its friction", _nats_of_friction(beside, trial, effect.rubs), half))
        if on_all_axes(trial.candidate):
            gates.append(("nats in the band that holds its swing", _nats_with_swing(white, beside, trial), half))
        coefficients = posterior_mean(*beside.gram(trial.term.blocks), trial.term.std)
        share = share_of_torque(white, trial.candidate, coefficients)
        gates.append(("its torque over that of its axis", share, settings.smallest_share))
    if is_body(trial.candidate):
        gates.append(("nats over links that are known less", lead_over_links(white, before, trial), 0.0))
        gates.append(("nats of its mass", nats_of_its_mass(white, beside, trial), 0.0))
        spare = max(settings.accept, settings.form_error * trial.evidence)
        gates.append(("nats that no body that may exist would have", -impossible_nats(white, beside, trial), -spare))
    else:
        nats = nats_without_witnesses(white, before, trial, (), settings.mass_sigmas)
        gates.append(("nats with inertial parameters known less", nats, half))
    bounds = [] if beyond is None else [_refused(trial, *beyond)]
    return failed + bounds + [_refused(trial, *gate) for gate in gates if not gate[1] >= gate[2]]


def nats_without_witnesses(
    white: White, before: list[Term], one: Named, witnesses: Collection[int], wider: float = 1.0
) -> float:
    """Return the nats of an effect where the axes `witnesses` (0-based) say nothing of the links.

    The torque of an axis alone does not tell a factor of it from links that are all as much heavier: what other axes
    say of the links does. An axis that lacks something bends the links to it, and then witnesses against all others.

    Parameters
    ----------
    wider : how many times as far as their prior says the links may be off.
    """
    base = [
        replace(t, blocks={a: x for a, x in t.blocks.items() if a not in witnesses}, std=wider * t.std)
        if t.label == INERTIAL
        else t
        for t in white.base
    ]
    b, gram = Fit(white.targets, [*base, *before]).gram(one.term.blocks)
    return gain(b, gram, one.term.std)


def mass_refusals(white: White, before: list[Term], trial: Named) -> list[Refusal]:
    """Refuse a link mass that stays within what the prior says of it: a wrong parameter, not one that stands out."""
    settings = white.problem.settings
    free = [t for t in white.base if t.label != INERTIAL]
    b, gram = Fit(white.targets, [*free, *before]).gram(trial.term.blocks)
    precision = float(gram[0, 0] + 1 / trial.term.std[0] ** 2)
    sigmas = abs(float(b[0])) / precision / settings.inertial_prior
    if sigmas < settings.mass_sigmas:
        gate = "standard deviations of the inertial prior by which the mass is off"
        return [_refused(trial, gate, sigmas, settings.mass_sigmas)]
    return []


def _cancels(white: White, before: list[Term], trial: Named) -> float:
    """Return the RMS torque of an effect, fitted, over that of the discrepancy of its axis.

    What friction and motor inertia could take over of it does not count. Above 2 the effect can only cancel other
    terms: whatever friction stands beside it, it leaves more of the discrepancy than there was. Terms of other axes
    stand beside it, because what those lack bends the links that all axes share; terms of its own it must not cancel.
    """
    problem, axis = white.problem, trial.candidate.axis
    used = problem.usable[:, axis]
    elsewhere = white.fit([t for t in before if axis not in t.blocks])
    torque = fitted_torque(white, elsewhere, trial.candidate, trial.term.blocks, trial.term.std)
    torque = without_drives(problem, axis, torque)
    discrepancy = problem.discrepancy[problem.train, axis][used]
    return float(np.sqrt(np.mean(torque**2) / max(float(np.mean(discrepancy**2)), 1e-300)))


def without_drives(problem: Problem, axis: int, torque: np.ndarray) -> np.ndarray:
    """Return torque (N_usable,) [N m] of one axis without what friction and motor inertia could take over of it."""
    friction = problem.friction_columns(problem.train_state, axis)[problem.usable[:, axis]]
    return torque - friction @ np.linalg.lstsq(friction, torque, rcond=None)[0]


def share_of_torque(white: White, candidate: Candidate, coefficients: np.ndarray) -> float:
    """Return the RMS torque of an effect with coefficients (k,) over that of its axis, or of the one it moves most.

    Timing changes nothing of a torque that stays: for effects of timing it counts about its mean in each record.
    Where an axis carries hardly any load its torque constant is a factor of friction and of motor inertia, and drives
    that are retuned say the same: of a torque constant only what they cannot take over counts.
    """
    problem = white.problem
    shares = []
    for axis, columns in raw_torques(white, candidate).items():
        used = problem.usable[:, axis]
        torque, whole = (columns @ coefficients)[used], problem.train_state.torque[used, axis]
        if get_effect(candidate.effect).timing:
            record = np.unique(np.asarray(problem.train_state.record)[used], return_inverse=True)[1]
            whole = whole - (np.bincount(record, whole) / np.bincount(record))[record]
        if get_effect(candidate.effect).of_drive:
            torque = without_drives(problem, axis, torque)
        shares.append(np.sqrt(np.mean(torque**2) / max(float(np.mean(whole**2)), 1e-300)))
    return float(max(shares))


def sigmas_off(white: White, before: list[Term], beside: Fit, trial: Named) -> float:
    """Return the most standard deviations by which a coefficient of an effect is off, by what is left on its axis.

    Nats count the noise alone: where the model misses more than that of an axis, they promise too much.
    """
    mean, spread = _fitted(beside, trial)
    worst = float(np.sqrt(misfit_of(white, white.fit([*before, *trial.terms]))[trial.candidate.axis]))
    return float(np.max(np.abs(mean) / (worst * spread)))


def _fitted(beside: Fit, trial: Named) -> tuple[np.ndarray, np.ndarray]:
    """Return the coefficients (k,) of an effect fitted beside others, and their standard deviations under the noise."""
    (b, gram), std = beside.gram(trial.term.blocks), trial.term.std
    return posterior_mean(b, gram, std), np.sqrt(np.diag(np.linalg.inv(gram + np.diag(1 / std**2))))


def _nats_of_friction(beside: Fit, trial: Named, rubs: int) -> float:
    """Return the nats by which an effect does better than what is left of it without its `rubs` first coefficients."""
    (b, gram), std = beside.gram(trial.term.blocks), trial.term.std
    return float(gain(b, gram, std) - gain(b[rubs:], gram[rubs:, rubs:], std[rubs:]))


def _nats_with_swing(white: White, beside: Fit, trial: Named) -> float:
    """Return the nats of a link that swings with its columns ended where noise feigns no swing, above its own.

    Columns that end below the swing are rates of torque, which filters and clocks feign too.
    """
    candidate, problem = trial.candidate, white.problem
    effect, own = get_effect(candidate.effect), candidate.nonlinear
    torque = effect.spread(problem.train_state, candidate.axis, candidate.source, own)
    period = 2 * np.pi * np.sqrt(own[effect.scaled])
    ended = {a: white.of_swing(a, torque[:, [a]], period, own["damping"]) for a in problem.judged}
    return gain_about_one(white, *beside.gram({a: white.columns(a, x) for a, x in ended.items()}))


def bound_missed(white: White, beside: Fit, trial: Named) -> tuple[str, float, float] | None:
    """Return the bound that a parameter of an effect, fitted beside a fit, lies beyond, in words, with the value of the
    parameter and of the bound; None if none does.

    Asked of effects of one unknown, and of what a robot cannot lose because it has no more of it.
    """
    if trial.candidate.effect == LINK_MASS:
        return None
    effect = get_effect(trial.candidate.effect)
    if effect.least is not None:
        return None if _above_least(white, beside, trial) else (BOUNDS, 0.0, 1.0)
    if len(trial.term.std) > 1:
        return None
    size = posterior_mean(*beside.gram(trial.term.blocks), trial.term.std)
    off, sized = white.problem.settings.off_scale, float(size[0])
    if effect.scaled and not 1 / off < sized < off:
        most, bound = ("at most", off) if sized > 1 else ("at least", 1 / off)
        return f"torque that fits over that of its {effect.scaled}, {most}", sized, bound
    nonlinear = trial.candidate.nonlinear
    if possible(effect, nonlinear, size):
        return None
    found = effect.beyond(effect.parameters_of(nonlinear, size))
    return found if found is not None and np.isfinite(found[1]) else (BOUNDS, 0.0, 1.0)


def _above_least(white: White, beside: Fit, trial: Named) -> bool:
    """Return whether no coefficient lies further below its lowest value than a link mass may be off by chance."""
    mean, spread = _fitted(beside, trial)
    least = get_effect(trial.candidate.effect).least(white.problem.robot)
    return bool(np.all(mean >= least - white.problem.settings.mass_sigmas * spread))
