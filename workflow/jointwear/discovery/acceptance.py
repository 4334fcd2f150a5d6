"""Whether an effect that the evidence favours is believed: it predicts, it does not merely cancel, it does not jump."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.candidates import LINK_MASS, Candidate, possible, prior_std, raw_columns
from jointwear.discovery.crossval import CrossValidated, cross_validate
from jointwear.discovery.linear import Fit, Term, gain
from jointwear.discovery.outcome import Named
from jointwear.discovery.problem import White
from jointwear.discovery.refine import SCALED
from jointwear.effects import get_effect

#: Squared error [N m] in records left out, with an effect over without it, above which the effect is not believed:
#: whitened noise can favour an effect that makes slow torque worse.
WORST_RAW = 1.005
#: An effect may cost no record that is left out more than this [nats]: it belongs to the robot, not to one recording.
WORST_RECORD = -4.0
#: The same as a share of what it gains in all, and the ratio where it explains most of what can be explained.
WORST_SHARE, WORST_RAW_IF_STRONG = 0.02, 1.2
#: Gain [nats] in records left out that is enough for an effect of any evidence.
ENOUGH = 100.0
#: Arguments over which a robot file cannot bend the form of an effect: it holds a table, harmonics or several
#: hysteresis loops.
UNBENDING = ("rate of torque", "second derivative of the load")
#: Steps tried within each record [s apart], and how much better than a drift one has to be [nats].
STEP_EVERY, STEP_BETTER = 0.5, 5.0

#: The torque of an effect whose one parameter is in its columns has the coefficient one. Where the best parameter
#: still needs one this far off, the torque has another shape.
OFF_SCALE = 1.5


def follows_time(candidate: Candidate) -> bool:
    """Return whether an effect changes with time."""
    return candidate.effect != LINK_MASS and get_effect(candidate.effect).argument.startswith("time")


def _cancels(white: White, trial: Named) -> bool:
    """Return whether an effect, fitted, is twice the discrepancy of its axis: then it only cancels other terms.

    What friction and motor inertia could take over of it does not count.
    """
    problem, axis = white.problem, trial.candidate.axis
    used = problem.usable[:, axis]
    fit = white.fit()
    b, gram = fit.gram(trial.term.blocks)
    coefficients = np.linalg.solve(gram + np.diag(1 / trial.term.std**2), b)
    torque = (raw_columns(white, trial.candidate) @ coefficients)[used]
    friction = problem.friction_columns(problem.train_state, axis)[used]
    torque = torque - friction @ np.linalg.lstsq(friction, torque, rcond=None)[0]
    discrepancy = problem.discrepancy[problem.train, axis][used]
    return bool(np.mean(torque**2) > 4.0 * np.mean(discrepancy**2))


def holds(white: White, named: list[Named], trial: Named) -> bool:
    """Return whether an effect predicts records left out in turn, and survives a wider inertial prior."""
    before = [t for n in named for t in n.terms]
    found = cross_validate(white, before, [trial.term])
    if not predicts(found, trial.evidence):
        if trial.form is None or follows_time(trial.candidate):
            return False
        # The textbook form may fail where the effect itself does not.
        found = cross_validate(white, before, trial.terms)
        if not predicts(found, trial.evidence):
            return False
    if trial.candidate.axis is not None and trial.candidate.effect != LINK_MASS:
        # What changes with time is wanted for the time to come.
        if follows_time(trial.candidate) and (found.last < -1.0 or _jumps(white, before, trial)):
            return False
        if _cancels(white, trial) or not within_bounds(white, before, trial):
            return False
    wide = [replace(t, std=3.0 * t.std) if t.label == "inertial" else t for t in white.base]
    fit = Fit(white.targets, [*wide, *before])
    b, gram = fit.gram(trial.term.blocks)
    need = 0.5 * white.problem.settings.accept
    return trial.candidate.effect == LINK_MASS or gain(b, gram, trial.term.std) > need


def _jumps(white: White, before: list[Term], trial: Named) -> bool:
    """Return whether a step within one record does better than an effect that follows time: then it is no drift."""
    problem, candidate = white.problem, trial.candidate
    effect, state = get_effect(candidate.effect), problem.train_state
    if effect.shape is None:
        return False
    carrier, time = effect.shape(state, candidate.axis, candidate.nonlinear)
    label = np.asarray(state.record)
    steps = []
    for one in np.unique(label):
        inside = time[label == one]
        steps.extend(np.arange(inside.min() + 1.0, inside.max() - 1.0, STEP_EVERY))
    if not steps:
        return False
    columns = carrier[:, None] * (time[:, None] > np.array(steps))
    std = prior_std(white, candidate.axis, columns)
    fit = white.fit(before)
    b, cross = fit.projected({candidate.axis: (x := white.columns(candidate.axis, columns))})
    left = np.sum(x**2, axis=0) - np.sum((cross @ fit.covariance) * cross, axis=1)
    scaled = 1.0 + std**2 * np.maximum(left, 0.0)
    gains = 0.5 * (std * b) ** 2 / scaled - 0.5 * np.log(scaled)
    b, gram = fit.gram(trial.term.blocks)
    smooth = gain(b, gram, trial.term.std)
    return bool(np.max(gains) - np.log(len(steps)) > smooth + STEP_BETTER)


def within_bounds(white: White, before: list[Term], trial: Named) -> bool:
    """Return whether the parameters of an effect of one unknown, fitted, are those of such an effect."""
    if len(trial.term.std) > 1 or trial.candidate.effect == LINK_MASS:
        return True
    b, gram = white.fit(before).gram(trial.term.blocks)
    size = b / (gram[0] + 1 / trial.term.std**2)
    if trial.candidate.effect in SCALED and not 1 / OFF_SCALE < size[0] < OFF_SCALE:
        return False
    return possible(get_effect(trial.candidate.effect), trial.candidate.nonlinear, size)


def predicts(found: CrossValidated, evidence: float) -> bool:
    """Return whether terms predict records left out: in all, in every one, and in N m."""
    worst = min(WORST_RECORD, -WORST_SHARE * found.nats)
    raw = found.raw <= WORST_RAW or (found.share > 0.5 and found.raw <= WORST_RAW_IF_STRONG)
    # Where the base could take an effect over at the price of unlikely numbers, that price is in the evidence but not
    # in the prediction of one more record: from some strength on the share is no longer asked for.
    gains = found.nats >= max(2.0, min(0.15 * evidence, ENOUGH)) and found.share > 0.0
    return gains and found.worst >= worst and raw


def predicts_most(found: CrossValidated) -> bool:
    """Return whether terms predict records left out, and in N m most of them.

    One record that gains much may make up in N m for all others that lose: then the effect is one of that record.
    """
    return predicts(found, 0.0) and (found.middle <= WORST_RAW or found.share > 0.5)


def stiff(candidate: Candidate) -> bool:
    """Return whether a robot file cannot bend the form of an effect: what is written is the textbook form."""
    if candidate.effect == LINK_MASS:
        return False
    effect = get_effect(candidate.effect)
    return effect.needs_source or effect.argument in UNBENDING
