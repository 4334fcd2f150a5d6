"""Which effects a data set shows: forward search, cross-validation, elimination, exchange, unexplained structure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import gammaincc

from jointwear.discovery.acceptance import follows_time, holds, predicts_most, stiff, within_bounds
from jointwear.discovery.candidates import (
    LINK_MASS,
    Candidate,
    Dictionary,
    Scored,
    build_dictionary,
    companion,
    form_of,
    prior_std,
    raw_blocks,
    raw_columns,
    resolved,
    scan,
)
from jointwear.discovery.crossval import cross_validate
from jointwear.discovery.linear import Fit, Term, chi_square, gain
from jointwear.discovery.outcome import Named, Outcome, Unexplained
from jointwear.discovery.problem import Problem, White, estimate_noise, whiten
from jointwear.discovery.refine import refine
from jointwear.discovery.structure import Basis, axis_bases, strongest_line


def search(problem: Problem) -> Outcome:
    """Return the effects that the training samples of `problem` show.

    Steps: noise from a saturated fit; forward search by evidence, near ties re-ranked with the tolerance of their
    form; each acceptance must also predict records left out in turn and survive a three times wider inertial
    prior; elimination and exchange; then the tests for structure that is left.
    """
    settings = problem.settings
    white = whiten(problem, estimate_noise(problem))
    dictionary = build_dictionary(white)
    named: list[Named] = []
    refused: set = set()
    while sum(n.candidate.effect != LINK_MASS for n in named) < settings.most_effects:
        fit = white.fit([t for n in named for t in n.terms])
        best = _best(white, dictionary, fit, named, refused)
        if best is None:
            break
        trial = _named(white, fit, best)
        if not holds(white, named, trial):
            refused.add(best.candidate.key)
            if len(refused) > 12:
                break
            continue
        named.append(trial)
        named = _exchange(white, dictionary, named)
    named = _eliminate(white, named, settings.accept, settings.share)
    named = _predicting(white, named)
    fit = white.fit([t for n in named for t in n.terms])
    outcome = Outcome(problem, white, fit, dictionary, refused, named)
    outcome.unexplained, outcome.profile = unexplained(outcome)
    if outcome.unexplained:
        outcome = _survive(outcome)
    outcome.named = [_with_ties(outcome, n) for n in outcome.named]
    outcome.named.sort(key=lambda n: -n.evidence)
    return outcome


def _best(white: White, dictionary: Dictionary, fit: Fit, named: list[Named], refused: set) -> Scored | None:
    """Return the best family not named yet, near ties decided by evidence with the tolerance of the form."""
    settings = white.problem.settings
    taken = {n.candidate.key for n in named} | refused
    full = _full_axes(named, settings.most_on_axis)
    found = [s for s in scan(white, dictionary, fit) if s.candidate.key not in taken and s.candidate.axis not in full]
    found = [s for s in found if s.evidence > max(settings.accept, _bar(named, s.candidate, settings.share))]
    if not found:
        return None
    close = [s for s in found[:6] if s.evidence > 0.6 * found[0].evidence - 5.0]
    if len(close) == 1:
        return close[0]
    return max(close, key=lambda s: _with_form(white, fit, s))


def _full_axes(named: list[Named], most: int) -> set:
    """Return the axes on which no further effect may be named."""
    axes = [n.candidate.axis for n in named if n.candidate.axis is not None and n.candidate.effect != LINK_MASS]
    return {a for a in axes if axes.count(a) >= most}


def _bar(named: list[Named], candidate: Candidate, share: float) -> float:
    """Return the evidence that a further effect needs because the forms of those before are not known exactly."""
    same = [n.evidence for n in named if candidate.axis is None or n.candidate.axis in (None, candidate.axis)]
    near = [n.evidence for n in named]
    return max([share * e for e in same] + [0.1 * share * e for e in near], default=0.0)


def _form_of(white: White, fit: Fit, scored: Scored) -> Term | None:
    form = form_of(white, scored.candidate)
    if form is None:
        return None
    b, gram = fit.gram(scored.blocks)
    coefficients = np.linalg.solve(gram + np.diag(1 / scored.std**2), b)
    axis = scored.candidate.axis
    torque = raw_columns(white, scored.candidate) @ coefficients
    used = white.problem.usable[:, axis]
    return companion(white, form, float(np.sqrt(np.mean(torque[used] ** 2))))


def _with_form(white: White, fit: Fit, scored: Scored) -> float:
    """Return the evidence of a candidate when its form may bend, half the prior weight on either."""
    form = _form_of(white, fit, scored)
    if form is None:
        return scored.evidence
    axis = scored.candidate.axis
    joint = {axis: np.concatenate([scored.blocks[axis], form.blocks[axis]], axis=1)}
    b, gram = fit.gram(joint)
    k = len(scored.std)
    plain = gain(b[:k], gram[:k, :k], scored.std)
    bent = gain(b, gram, np.concatenate([scored.std, form.std]))
    return scored.evidence - plain + float(np.logaddexp(plain, bent) - np.log(2))


def _named(white: White, fit: Fit, scored: Scored) -> Named:
    if scored.candidate.axis is not None and scored.candidate.effect != LINK_MASS:
        candidate = refine(white, fit, scored.candidate)
        columns, axis = raw_columns(white, candidate), candidate.axis
        blocks, std = {axis: white.columns(axis, columns)}, prior_std(white, axis, columns)
        scored = Scored(candidate, scored.evidence, blocks, std)
    label = f"{scored.candidate.effect} {scored.candidate.axis}"
    term = Term(label, scored.blocks, scored.std, raw_blocks(white, scored.candidate))
    return Named(scored.candidate, term, _form_of(white, fit, scored), scored.evidence)


def _evidence_of(white: White, named: list[Named], index: int) -> float:
    """Return the evidence lost when one named effect, with its form, leaves the model."""
    others = [t for i, n in enumerate(named) if i != index for t in n.terms]
    all_terms = [t for n in named for t in n.terms]
    return white.fit(all_terms).evidence - white.fit(others).evidence


def _eliminate(white: White, named: list[Named], accept: float, share: float) -> list[Named]:
    """Drop effects that the others have made unnecessary, weakest first."""
    while named:
        named = [replace(n, evidence=_evidence_of(white, named, i)) for i, n in enumerate(named)]
        weakest = min(named, key=lambda n: n.evidence)
        rest = [n for n in named if n is not weakest]
        if weakest.evidence >= max(accept - 4.0, _bar(rest, weakest.candidate, 0.5 * share)):
            return named
        named = rest
    return named


def _exchange(white: White, dictionary: Dictionary, named: list[Named]) -> list[Named]:
    """Try, for every named effect, whether another family does better in its place now that all are there."""
    if len(named) < 2:
        return named
    result = list(named)
    for i in range(len(result) - 1):
        others = [t for k, n in enumerate(result) if k != i for t in n.terms]
        fit = white.fit(others)
        taken = {n.candidate.key for k, n in enumerate(result) if k != i}
        found = [s for s in scan(white, dictionary, fit) if s.candidate.key not in taken]
        close = [s for s in found[:6] if s.evidence > 0.6 * found[0].evidence - 5.0]
        best = max(close, key=lambda s: _with_form(white, fit, s))
        if best.candidate.key != result[i].candidate.key:
            result[i] = _named(white, fit, best)
    return result


def _predicting(white: White, named: list[Named]) -> list[Named]:
    """Drop effects that, beside all the others, do not predict records left out; the worst first.

    First go those that beside the others would need parameters beyond their bounds.
    """
    named = [
        one
        for i, one in enumerate(named)
        if within_bounds(white, [t for k, n in enumerate(named) if k != i for t in n.terms], one)
    ]
    while named:
        found = []
        for i, one in enumerate(named):
            others = [t for k, n in enumerate(named) if k != i for t in n.terms]
            result = cross_validate(white, others, [one.term])
            # What cannot be written into a robot file must not be what predicts.
            bendable = one.form is not None and not stiff(one.candidate)
            if bendable and (follows_time(one.candidate) or not predicts_most(result)):
                bent = cross_validate(white, others, one.terms)
                pick = min if follows_time(one.candidate) else max
                result = pick(result, bent, key=lambda r: r.nats)
            found.append(result)
        bad = [i for i, f in enumerate(found) if not predicts_most(f)]
        if not bad:
            return named
        worst = max(bad, key=lambda i: found[i].raw)
        named = [n for i, n in enumerate(named) if i != worst]
    return named


def _with_ties(outcome: Outcome, one: Named) -> Named:
    """Fill in evidence, cross-validated share and the families that explain the same within 1 % or 3 nats."""
    white, named = outcome.white, outcome.named
    index = next(i for i, n in enumerate(named) if n is one)
    others = [t for i, n in enumerate(named) if i != index for t in n.terms]
    fit = white.fit(others)
    taken = {n.candidate.key for i, n in enumerate(named) if i != index} | outcome.refused
    found = [s for s in scan(white, outcome.dictionary, fit) if s.candidate.key not in taken]
    close = [s for s in found[:8] if s.evidence > 0.6 * found[0].evidence - 5.0]
    scores = {s.candidate.key: _with_form(white, fit, s) for s in close}
    own = scores.get(one.candidate.key, one.evidence)
    margin = max(2.0, 0.01 * own)
    ties = [
        s.candidate for s in close if s.candidate.key != one.candidate.key and scores[s.candidate.key] > own - margin
    ]
    share = max(cross_validate(white, others, terms).share for terms in ([one.term], one.terms))
    return replace(one, ties=tuple(ties), cross_validated=share, evidence=_evidence_of(white, named, index))


def unexplained(outcome: Outcome) -> tuple[list[Unexplained], list[Unexplained]]:
    """Test every axis for structure over every argument.

    Returns
    -------
    the structure that is significant and large enough to matter, and the full profile (one entry a basis).
    """
    problem, white, fit = outcome.problem, outcome.white, outcome.fit
    settings = problem.settings
    state = problem.train_state
    found, profile = [], []
    for axis in problem.judged:
        used = problem.usable[:, axis]
        bar = _bar(outcome.named, Candidate("", axis, None), settings.share)
        for basis in axis_bases(state, axis, used):
            if basis.argument == "motor angle" and not resolved(white, axis, 6.0):
                continue
            columns = white.columns(axis, basis.columns)
            columns = columns[:, np.sum(columns**2, axis=0) > 1e-9]
            if not columns.shape[1]:
                continue
            b, gram = fit.gram({axis: columns})
            statistic, freedom = chi_square(b, gram, columns.T @ columns)
            if not freedom:
                continue
            # The colour of the noise is estimated too: 3 % is what that does to a chi-square.
            p = float(gammaincc(freedom / 2, statistic / 2 / 1.03))
            nats = 0.5 * (statistic - freedom)
            low, high = _where(basis, b, gram, white.whiteners[axis].rows)
            entry = Unexplained(axis, basis.argument, basis.unit, low, high, max(p, 1e-300), nats)
            profile.append(entry)
            if p < settings.unexplained_p and nats > max(settings.accept, bar):
                found.append(entry)
        line = strongest_line(fit.residual[axis], white.whiteners[axis].rows, state, problem.measured.rate)
        if line is not None:
            entry = Unexplained(
                axis,
                "line over time",
                "Hz",
                line.frequency,
                line.frequency + abs(line.rate),
                max(line.p_value, 1e-300),
                line.power,
            )
            profile.append(entry)
            if line.p_value < settings.unexplained_p and line.power > max(settings.accept, bar):
                found.append(entry)
    found.sort(key=lambda u: -u.nats)
    return found, profile


def _where(basis: Basis, b: np.ndarray, gram: np.ndarray, rows: np.ndarray) -> tuple[float, float]:
    """Return the range of the argument that the strongest columns of a basis cover."""
    size = np.abs(b) / np.sqrt(np.maximum(np.diag(gram), 1e-12))
    columns = basis.columns[rows]
    strong = np.flatnonzero(size > 0.7 * size.max())
    strong = strong[strong < columns.shape[1]]
    chosen = np.any(np.abs(columns[:, strong]) > 0.5 * np.abs(columns[:, strong]).max(), axis=1)
    values = basis.values[rows][chosen]
    return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)


def _survive(outcome: Outcome) -> Outcome:
    """Drop named effects that the unexplained structure on their axis makes unnecessary."""
    problem, white = outcome.problem, outcome.white
    state = problem.train_state
    kept = []
    for i, one in enumerate(outcome.named):
        axis = one.candidate.axis
        here = [u for u in outcome.unexplained if u.axis == axis and u.argument != "line over time"]
        if axis is None or one.candidate.effect == LINK_MASS or not here:
            kept.append(one)
            continue
        basis = next(b for b in axis_bases(state, axis, problem.usable[:, axis]) if b.argument == here[0].argument)
        size = 2.0 * problem.scale[axis]
        columns = white.columns(axis, basis.columns)
        good = np.sum(columns**2, axis=0) > 1e-9
        extra = Term("unexplained", {axis: columns[:, good]}, np.full(int(good.sum()), size))
        others = [t for k, n in enumerate(outcome.named) if k != i for t in n.terms]
        fit = white.fit([*others, extra])
        b, gram = fit.gram(one.term.blocks)
        if gain(b, gram, one.term.std) > problem.settings.accept:
            kept.append(one)
    if len(kept) != len(outcome.named):
        outcome.named = kept
        outcome.fit = white.fit([t for n in kept for t in n.terms])
        outcome.unexplained, outcome.profile = unexplained(outcome)
    return outcome
