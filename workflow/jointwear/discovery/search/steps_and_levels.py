"""Whether steps in time, or another level in every record, say what an effect does."""

from __future__ import annotations

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Fit, Term, gain
from jointwear.discovery.problem.candidates import Candidate, prior_std
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect


def step_lead(white: White, beside: Fit, trial: Named) -> float:
    """Return the nats by which a step within one record does better than an effect that follows time."""
    time, label = white.problem.train_state.time, np.asarray(white.problem.train_state.record)
    steps = []
    for one in np.unique(label):
        inside = time[label == one]
        steps.extend(np.arange(inside.min() + 1.0, inside.max() - 1.0, assumed.BLOCK))
    return _best_step(white, beside, trial, time[:, None] > np.array(steps))


def step_between_lead(white: White, beside: Fit, trial: Named) -> float:
    """Return the nats by which a step between two records does better than an effect that follows time.

    A joint that was mounted anew, or other oil, is followed by a growth whose rate and exponent are free. Where the
    records cannot tell one from the other it is called growth.
    """
    label = np.asarray(white.problem.train_state.record)
    begins = np.flatnonzero(np.diff(label)) + 1
    return _best_step(white, beside, trial, np.arange(len(label))[:, None] >= begins)


def _best_step(white: White, beside: Fit, trial: Named, after: np.ndarray) -> float:
    """Return the nats by which the best of some steps does better than an effect that follows time.

    Parameters
    ----------
    after : (N_train, k) samples after each of the steps, one of which is chosen.
    """
    problem, candidate = white.problem, trial.candidate
    effect = get_effect(candidate.effect)
    if effect.shape is None or not after.shape[1]:
        return -np.inf
    carrier, _ = effect.shape(problem.train_state, candidate.axis, candidate.nonlinear)
    columns = carrier[:, None] * after
    std = prior_std(white, candidate, columns)
    b, left = beside.gram_each({candidate.axis: white.columns(candidate.axis, columns)})
    scaled = 1.0 + std**2 * np.maximum(left, 0.0)
    gains = 0.5 * (std * b) ** 2 / scaled - 0.5 * np.log(scaled)
    b, gram = beside.gram(trial.term.blocks)
    return float(np.max(gains) - np.log(after.shape[1]) - gain(b, gram, trial.term.std))


def levels_lead(white: White, beside: Fit, trial: Named) -> float:
    """Return the nats by which another level in every record does better than an effect that follows time.

    A zero that is set anew differs from record to record: a wave of free phase and period threads a few such levels,
    and says nothing of the record to come. Growth without a phase of its own cannot.
    """
    records = len(np.unique(np.asarray(white.problem.train_state.record)))
    if get_effect(trial.candidate.effect).shape is None or len(trial.term.std) < 2 or records < 3:
        return -np.inf
    levels = _levels(white, trial.candidate)
    found = gain(*beside.gram(levels.blocks), levels.std)
    return float(found - gain(*beside.gram(trial.term.blocks), trial.term.std))


def nats_beside_levels(white: White, before: list[Term], trial: Named) -> float:
    """Return the nats of a curve over the position beside another level in every record.

    Where each record keeps to a part of the travel of its own, a curve threads any levels of them: of friction that
    falls with the temperature, or of a zero that is set anew. Between those parts it would be made up.
    """
    fit = white.fit([*before, _levels(white, trial.candidate)])
    return float(gain(*fit.gram(trial.term.blocks), trial.term.std))


def _levels(white: White, candidate: Candidate) -> Term:
    """Return the term of an effect with a level of its own in every record, all over what it depends on."""
    state = white.problem.train_state
    carrier, _ = get_effect(candidate.effect).shape(state, candidate.axis, candidate.nonlinear)
    label = np.asarray(state.record)
    columns = carrier[:, None] * (label[:, None] == np.unique(label))
    blocks = {candidate.axis: white.columns(candidate.axis, columns)}
    return Term("levels", blocks, prior_std(white, candidate, columns))
