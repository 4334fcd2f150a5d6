"""Whether a name is found again when one day, session or other group of recordings is left out."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.outcome import Outcome, Refusal
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.setting_up import FEWEST_SAMPLES
from jointwear.discovery.search.carried import search_beside
from jointwear.discovery.search.leftovers import fit_again
from jointwear.discovery.search.searches import search, whitened
from jointwear.discovery.search.slow_noise import beside_slow_noise
from jointwear.files.errors import InputError, nearest
from jointwear.measurement.recording import Recording


def check_groups(recording: Recording, groups: tuple[tuple[str, tuple[int, ...]], ...]) -> None:
    """Check that groups name trajectories of the recording, each once.

    Raises
    ------
    InputError : naming the group and the label.
    """
    seen: dict[int, str] = {}
    for name, labels in groups:
        for label in labels:
            where = f"data set '{recording.name}': 'group.{name}'"
            if label not in recording.labels:
                known = [str(x) for x in recording.labels]
                raise InputError(
                    f"{where} holds trajectory {label}, which is not in the data (allowed: {', '.join(known)})"
                    f"{nearest(str(label), known)}"
                )
            if label in seen:
                raise InputError(f"{where} holds trajectory {label}, which is in '{seen[label]}' too")
            seen[label] = name


def repeat(outcome: Outcome, problem: Problem | None = None) -> Outcome:
    """Run the search again without each group and note how often every name comes back.

    A weak name that does not come back without one of the groups rests on that group alone: it is not given.

    Parameters
    ----------
    problem : what the search began with, where a body that was found has since been added to the load: each run has to
        find the body, and what stands beside it, by itself. Default that of `outcome`.
    """
    problem = problem or outcome.problem
    settings = problem.settings
    parts = [p for _, labels in settings.groups if (p := _without(problem, labels)) is not None]
    if not parts or not outcome.named:
        return outcome
    count = Counter(n.candidate.key for p in parts for n in _searched(p).named)
    kept = []
    for one in outcome.named:
        share = count[one.candidate.key] / len(parts)
        if share < 1.0 and one.evidence < settings.weak_nats:
            gate = "share of the runs without one group of recordings that name it"
            outcome.refusals.append(Refusal(one.candidate, one.evidence, gate, share, 1.0))
        else:
            kept.append(replace(one, repeated=share))
    changed = len(kept) < len(outcome.named)
    outcome.named = kept
    if changed:
        fit_again(outcome)
    return outcome


def _searched(problem: Problem) -> Outcome:
    """Return what the whole search finds: names that stand only beside a body that is carried, too."""
    return search_beside(beside_slow_noise(whitened(problem), search))


def _without(problem: Problem, labels: tuple[int, ...]) -> Problem | None:
    """Return the problem without the training samples of a group, None where none or nothing is left."""
    train = problem.train & ~np.isin(problem.measured.trajectory, labels)
    if not train.any() or train.sum() == problem.train.sum():
        return None
    counts = np.sum(problem.measured.usable[train], axis=0)
    judged = tuple(j for j in problem.judged if counts[j] >= FEWEST_SAMPLES)
    return replace(problem, train=train, judged=judged) if judged else None
