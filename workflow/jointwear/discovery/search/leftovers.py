"""Structure that the named effects leave, and what it means for those on the same axis."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
from scipy.stats import median_abs_deviation

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Named, Outcome, Unexplained
from jointwear.discovery.linear import Fit, Term, chance, chi_square, least_squares
from jointwear.discovery.problem.candidates import LINK_MASS, Seen, of_bases, raw_columns, resolved_bases
from jointwear.discovery.problem.instruments import torque_noise
from jointwear.discovery.problem.unresolved_steps import at_unresolved_steps
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.acceptance import of_timing, predictive
from jointwear.discovery.search.changing_size import changing
from jointwear.discovery.search.crossval import CrossValidated
from jointwear.discovery.search.drives_at_rest import at_rest
from jointwear.discovery.search.early_torque import EARLY, early
from jointwear.discovery.search.encoder_wave import encoder_wave
from jointwear.discovery.search.explained import explained, explained_elsewhere
from jointwear.discovery.search.in_its_place import better_in_its_place
from jointwear.discovery.search.least_torque import least_square, rms
from jointwear.discovery.search.residual_lines import Line, chance_of, strongest_line, where_strongest
from jointwear.discovery.search.rocking import swing_beside, swing_terms, swings
from jointwear.discovery.search.tolerance import with_tolerances
from jointwear.discovery.search.windings import stiffens, wound_up_further_in
from jointwear.discovery.structure import Basis
from jointwear.effects import get_effect
from jointwear.effects.state import record_slices
from jointwear.files.wording import digits_apart, numbered, significant

#: Share of the squared error beyond the noise from which an effect is more of what an axis lacks than all else
#: together: half, by what the word means.
MOST = 0.5
#: Argument of structure that is a wave or a linear chirp.
LINE = "line over time"
#: Constant speeds of one joint that are left out, one after the other, each with a wave of its own.
SPEEDS = 4
#: Shares of the largest from which a column of a basis, and a sample by its columns, tells where structure sits.
STRONG, NEAR = 0.7, 0.5


def unexplained(
    outcome: Outcome, robust: bool = False, asked: Collection[tuple[int, str]] | None = None
) -> tuple[list[Unexplained], list[Unexplained]]:
    """Test every axis for structure over every argument.

    Parameters
    ----------
    robust : let no sample lie further than `Settings.noise_sigmas` from the model, none at steps of acceleration that
        the sampling does not resolve or where a shared drive that has a name is at rest, and no `assumed.BLOCK` of
        splines decide.
    asked : 0-based axes with the arguments that are tested there; default all.

    Returns
    -------
    the structure that is significant and large enough to matter, and the full profile (one entry per basis).
    """
    problem, white = outcome.problem, outcome.white
    # What a form that is a little off leaves behind is no structure of its own.
    fit = white.fit([*with_tolerances(white, outcome.named), *white.attenuation])
    if robust:
        unknown = {axis: at_unresolved_steps(white, axis) | at_rest(outcome, axis) for axis in problem.judged}
        fit = _without_outliers(fit, problem.settings.noise_sigmas, unknown)
    settings = problem.settings
    found, profile = [], []
    for axis in problem.judged if asked is None else sorted({axis for axis, _ in asked}):
        least = least_square(outcome, axis)
        bases = [x for x in resolved_bases(white, axis) if asked is None or (axis, x.argument) in asked]
        for basis, seen in of_bases(white, fit, axis, bases):
            b, gram = seen.b, seen.gram
            statistic, freedom = chi_square(b, gram, seen.full)
            if not freedom:
                continue
            p, nats = chance(statistic, freedom, len(white.targets[axis]))
            rows = white.whiteners[axis].rows
            low, high = _where(basis, seen, rows)
            share = (high - low) / max(float(np.ptp(basis.values[rows])), 1e-300)
            entry = Unexplained(axis, basis.argument, basis.unit, low, high, max(p, 1e-300), nats, share)
            profile.append(entry)
            if p < settings.unexplained_p and nats > settings.accept:
                theta = least_squares(b, gram, seen.full)
                if robust and not _elsewhere(white, fit, axis, seen.columns, theta):
                    continue
                torque = _beside(fit, axis, seen.columns, white.raw(axis, basis.columns[:, seen.good]), theta)
                if (1.0 - freedom / statistic) * float(np.mean(torque**2)) > least:
                    found.append(entry)
        if asked is not None and (axis, LINE) not in asked:
            continue
        line = _line(white, fit, axis)
        if line is not None:
            p, end = max(line.p_value, 1e-300), line.frequency + abs(line.rate)
            entry = Unexplained(axis, LINE, "Hz", line.frequency, end, p, line.power)
            profile.append(entry)
            if _line_matters(white, axis, line, least):
                found.append(entry)
    found.sort(key=lambda u: -u.nats)
    return found, profile


def _line_matters(white: White, axis: int, line: Line, least: float) -> bool:
    """Return whether a line over time is significant, no error of the motion, and of more than `least` [(N m)^2]."""
    settings, rate = white.problem.settings, white.problem.measured.rate
    density = float(white.whiteners[axis].density(np.array([line.frequency]), rate)[0])
    return (
        line.p_value < settings.unexplained_p
        and line.power > settings.accept
        and line.power / len(white.whiteners[axis].rows) * density * rate > least
        and _shown_as_motion(white, axis, line, density) > settings.accept
    )


def _line(white: White, fit: Fit, axis: int) -> Line | None:
    """Return the strongest line over time that is left on an axis, at more than one speed of it.

    A controller that reads its positions in steps answers with a torque of their period, whatever digits the log keeps.
    At a constant speed that is a line over time, folded into the band of the log, as is every wave over the position.
    What shakes an arm from outside does so at any speed.
    """
    problem, settings = white.problem, white.problem.settings
    rows, residual = white.whiteners[axis].rows, fit.residual[axis]
    state, rate, same = problem.train_state, problem.measured.rate, problem.measured.speed_floor[axis]
    speed, sure = np.abs(state.velocity[rows, axis]), np.exp(-settings.accept)
    line = strongest_line(residual, rows, state, rate)
    for _ in range(SPEEDS):
        if line is None or line.p_value >= settings.unexplained_p:
            break
        # What does not stand out of what is around it is slow structure, which has bases of its own.
        if chance_of(line, residual, rows, state, rate) > sure:
            return None
        at = float(np.median(speed[where_strongest(line, residual, rows, state, rate)]))
        away = np.abs(speed - at) > same
        if chance_of(line, residual[away], rows[away], state, rate) < sure:
            break
        others = strongest_line(residual[away], rows[away], state, rate)
        if others is None:
            break
        line, residual, rows, speed = others, residual[away], rows[away], speed[away]
    return line


def _shown_as_motion(white: White, axis: int, line: Line, density: float) -> float:
    """Return what the motion that holds a line would be worth in the positions [nats], infinite where it is measured.

    A controller that rings at 50 Hz moves its arm by less than a step of the encoder. Derived accelerations hold
    nothing of that motion, and the torque that it takes is no structure.

    Parameters
    ----------
    density : of the noise of the axis at the line [(N m)^2/Hz].
    """
    problem = white.problem
    noise = problem.measured.noise
    if noise is None:
        return np.inf
    everywhere = replace(noise, band=np.full_like(noise.band, np.inf))
    as_torque = float(torque_noise(everywhere, problem.mass_squares, np.array([line.frequency]))[axis, 0])
    return line.power * density / as_torque if as_torque > 0 else np.inf


def _elsewhere(white: White, fit: Fit, axis: int, columns: np.ndarray, theta: np.ndarray) -> bool:
    """Return whether structure on one axis is half as sure without the time, a block long, that gains most from it.

    Where the acceleration jumps, that of splines is wrong for a few samples. At the largest torque of a log those are
    alone over that torque, and would be structure. Without splines an instant may be all that is seen of a cause.
    """
    if not white.problem.measured.fitted:
        return True
    settings, torque, residual = white.problem.settings, columns @ theta, fit.residual[axis]
    state, rows = white.problem.train_state, white.whiteners[axis].rows
    # No block holds samples of two records, whose clocks may begin anew.
    passed = np.where(np.diff(np.asarray(state.record)[rows]) != 0, assumed.BLOCK, np.diff(state.time[rows]))
    time = np.concatenate([[0.0], np.cumsum(passed)])
    end = np.searchsorted(time, time + assumed.BLOCK)
    gained = np.concatenate([[0.0], np.cumsum(torque * residual - 0.5 * torque**2)])
    first = np.argmax(gained[end] - gained[:-1])
    most = slice(first, end[first])
    gone, rest = np.zeros_like(residual), columns.copy()
    gone[most], rest[most] = residual[most], 0.0
    # What the terms had said of that time they give back elsewhere.
    back = fit.design[axis] @ fit.mimicked({axis: gone[:, None]}, np.ones(1))[fit.columns[axis]]
    b, gram = fit.gram({axis: rest})
    statistic, freedom = chi_square(b + rest.T @ back, gram, rest.T @ rest)
    if not freedom:
        return False
    p, nats = chance(statistic, freedom, len(white.targets[axis]))
    return p < np.sqrt(settings.unexplained_p) and nats > 0.5 * settings.accept


def _beside(fit: Fit, axis: int, columns: np.ndarray, raw: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Return the torque (m,) [N m] of columns on one axis, whitened and `raw`, less what the terms could say of it."""
    torque, instead = raw @ theta, fit.mimicked({axis: columns}, theta)
    for term, where in zip(fit.terms, fit.slices, strict=True):
        if axis in term.raw:
            torque -= term.raw[axis] @ instead[where]
    return torque


def lasting(outcome: Outcome) -> list[Unexplained]:
    """Return the unexplained structure that is left when no single sample may decide.

    Names are held against all structure: a few samples that do not fit a name speak against it. That a joint lacks
    something that nobody can name is said only of what many samples show.
    """
    if not outcome.unexplained:
        return []
    asked = {(u.axis, u.argument) for u in outcome.unexplained}
    firm = {(u.axis, u.argument) for u in unexplained(outcome, robust=True, asked=asked)[0]}
    return [u for u in outcome.unexplained if (u.axis, u.argument) in firm]


def _without_outliers(fit: Fit, sigmas: float, unknown: Mapping[int, np.ndarray] | None = None) -> Fit:
    """Return the fit to targets in which no sample lies further off than noise does (winsorised, one step).

    Where half of the samples lie further off than that, they are no outliers: the scale is that of the residual itself.
    Samples `unknown`, by axis, are not off at all.
    """
    scales = [max(1.0, median_abs_deviation(r, scale="normal")) if len(r) else 1.0 for r in fit.residual]
    limits = [np.full(len(r), sigmas * scale) for r, scale in zip(fit.residual, scales, strict=True)]
    for axis, samples in (unknown or {}).items():
        limits[axis][samples] = 0.0
    excess = [r - np.clip(r, -limit, limit) for r, limit in zip(fit.residual, limits, strict=True)]
    if not any(e.any() for e in excess):
        return fit
    return Fit([y - e for y, e in zip(fit.targets, excess, strict=True)], fit.terms)


def _where(basis: Basis, seen: Seen, rows: np.ndarray) -> tuple[float, float]:
    """Return the range of the argument that the strongest columns of a basis cover, of those that hold anything."""
    size = np.abs(seen.b) / np.sqrt(np.maximum(np.diag(seen.gram), 1e-12))
    strong = np.flatnonzero(seen.good)[size > STRONG * size.max()]
    height = np.abs(basis.columns.T[strong].take(rows, axis=1))
    chosen = height.max(axis=0) > NEAR * height.max()
    values = basis.values[rows][chosen]
    return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)


def stand_alone(outcome: Outcome) -> None:
    """Turn names on axes that stay unexplained into suspects, but for those that would stand on their own.

    A name in whose place structure without a name explains more is a suspect on any axis, and so is one whose size
    changes over time (:func:`.changing_size.changing`), one that is the wave of an encoder
    (:func:`.encoder_wave.encoder_wave`), and an elastic gear that says nothing beside a swinging base, or whose
    stiffness changes; a spring or gear that says nothing beside the wind-up of a joint further in is one too.
    An effect stands on its own where it is worth more than any structure that is left, and is nearly all of what its
    axes lacked (:func:`nearly_all`), or still passes the gates of prediction with all the unexplained structure of its
    axes in the model, and no other joint lacks the same; one of timing has to be most of it too, and a torque that is
    early (:func:`.early_torque.early`) stands beside no structure.
    An effect of the whole arm is asked where half of the axes that it moves stay unexplained. Changes `outcome`.
    """
    kept: list[Named] = []
    swing = swing_beside(outcome) if any(swings(n) for n in outcome.named) else None
    for one in outcome.named:
        elsewhere = acts_elsewhere(outcome, one)
        if elsewhere is not None:
            outcome.suspects.append((one, f"joint {elsewhere + 1} lacks the same torque, and this effect acts on one"))
            continue
        ahead = encoder_wave(outcome, one)
        if ahead is not None:
            reason = (
                f"it grows with the square of the speed, which explains {ahead:.0f} nats more: so does what an encoder "
                "that is off by a wave makes of a controller that follows it"
            )
            outcome.suspects.append((one, reason))
            outcome.unsteady.add(one.candidate.key)
            continue
        spread = changing(outcome, one)
        if spread is not None:
            words = f"its size is not the same throughout the recordings, it varies by {100 * spread:.0f} % of its mean"
            outcome.suspects.append((one, words))
            outcome.unsteady.add(one.candidate.key)
            continue
        instead = better_in_its_place(outcome, one)
        if instead is not None:
            basis, axis, lead = instead
            reason = f"structure over {basis.argument} of joint {axis + 1} explains {lead:.0f} nats more in its place"
            outcome.suspects.append((one, reason))
            continue
        if swing is not None and swings(one):
            others = [t for n in outcome.named if n is not one for t in n.terms]
            if predictive(outcome.white, [*others, *swing_terms(outcome.white, swing)], one)[1]:
                words = f"a base that swings with the motion, at {swing.frequency:.2g} Hz, could stand for it as well"
                outcome.suspects.append((one, words))
                continue
        change = stiffens(outcome, one)
        if change is not None:
            words = f"its stiffness is not the same at all loads, it changes by {100 * change:.0f} % of itself"
            outcome.suspects.append((one, words))
            continue
        inner = wound_up_further_in(outcome, one)
        if inner is not None:
            words = f"joint {inner + 1} stays unexplained further in, and its wind-up could stand for it as well"
            outcome.suspects.append((one, words))
            continue
        axes = left_open(outcome, one)
        if not axes:
            kept.append(one)
            continue
        if early(outcome, one):
            outcome.suspects.append((one, EARLY))
            continue
        where = numbered("joint", [a + 1 for a in axes])
        most = max((u for u in outcome.unexplained if u.axis in axes), key=lambda u: u.nats)
        if most.nats > one.evidence:
            reason = f"{most.nats:.0f} nats over {most.argument} are left on {where}, more than it explains"
            outcome.suspects.append((one, reason))
            continue
        others = [t for n in outcome.named if n is not one for t in n.terms]
        found, failed = predictive(outcome.white, others, one)
        share = found.share if failed else _share(outcome, others, one, found)
        if failed:
            gate, reached, needed = failed[0].gate, failed[0].reached, failed[0].needed
            digits = digits_apart(reached, needed)
            reason = f"{gate}: {significant(reached, digits)}, needed {significant(needed, digits)}"
        elif share <= MOST and _shaken(one):
            # The bases of structure hold no rates of torque: beside them it would pass whatever it stands for.
            reason = f"explains {100 * share:.0f} % of what {where} lacks, and structure is left there"
        elif (not _shaken(one) and nearly_all(outcome, others, one, share, most.nats)) or not predictive(
            outcome.white, [*others, *_structures(outcome, one, axes)], one
        )[1]:
            kept.append(one)
            continue
        else:
            reason = f"the structure that is left on {where} could stand for it as well"
        outcome.suspects.append((one, reason))
    if len(kept) != len(outcome.named):
        outcome.named = kept
        outcome.fit = outcome.white.fit([t for n in kept for t in n.terms])
        outcome.unexplained, outcome.profile = unexplained(outcome)


def _share(outcome: Outcome, others: list[Term], one: Named, found: CrossValidated) -> float:
    """Return the share of what its axes lack that an effect explains, of which `found` says what it predicts.

    A torque that is recorded late turns late too: beside reversals samples are left out by when the joint turns, not
    by when the log says so, and the few that lie between must not decide.
    """
    white = outcome.white
    if one.candidate.effect != LINK_MASS and get_effect(one.candidate.effect).late:
        white = replace(white, targets=_without_outliers(outcome.fit, outcome.problem.settings.noise_sigmas).targets)
        found, _ = predictive(white, others, one)
    return explained(white, others, one, found)


def nearly_all(outcome: Outcome, others: list[Term], one: Named, share: float, left: float) -> bool:
    """Return whether an effect explains nearly all of what its axes lack, a `share` of it in parts of the records.

    Whole records are asked too where the structure that is `left` there [nats] is more than what the form of the effect
    may be off by.
    """
    settings = outcome.problem.settings
    if share <= settings.nearly_all:
        return False
    of_its_form = left <= settings.form_error * one.evidence
    return of_its_form or explained_elsewhere(outcome.white, others, one) > settings.nearly_all


def _shaken(one: Named) -> bool:
    """Return whether an effect is of timing: what shakes a joint at its own pace moves its load in time with it.

    The noise model takes a part of that for noise, so that the share of what is left says nothing.
    """
    return of_timing(one.candidate)


def left_open(outcome: Outcome, one: Named) -> list[int]:
    """Return the unexplained axes of an effect; none for one of the whole arm that explains most axes that it moves."""
    still = {u.axis for u in outcome.unexplained}
    if one.candidate.effect == LINK_MASS:
        return []
    if one.candidate.axis is not None:
        return [one.candidate.axis] if one.candidate.axis in still else []
    size = outcome.fit.coefficients(one.term)
    energy = {axis: float(np.sum((columns @ size) ** 2)) for axis, columns in one.term.blocks.items()}
    moved = [axis for axis, e in energy.items() if e > outcome.problem.settings.visible]
    left = [axis for axis in moved if axis in still]
    return sorted(left) if 2 * len(left) >= len(moved) else []


def acts_elsewhere(outcome: Outcome, one: Named) -> int | None:
    """Return another axis that lacks, without a name, for the most part what an effect says of its own, or None.

    Friction, a spring or a drift of one joint acts on that joint alone. Where a neighbour follows the same argument,
    the cause lies between them, as a hose does: with a torque of the usual share of the effect's own at least. An
    elastic gear shakes the other joints, and a shared drive is two.
    """
    candidate, white = one.candidate, outcome.white
    if candidate.axis is None or candidate.effect == LINK_MASS:
        return None
    effect = get_effect(candidate.effect)
    if effect.timing or effect.needs_source:
        return None
    settings, fit = outcome.problem.settings, outcome.fit
    columns = raw_columns(white, candidate)
    own = rms(columns @ fit.coefficients(one.term), outcome.problem.usable[:, candidate.axis])
    for axis in sorted({u.axis for u in outcome.unexplained} - {candidate.axis}):
        x, residual = white.columns(axis, columns), fit.residual[axis]
        b, gram = fit.gram({axis: x})
        statistic, freedom = chi_square(b, gram, x.T @ x)
        lacking = float(residual @ residual) - len(residual)
        if 0.5 * (statistic - freedom) <= settings.accept or statistic <= MOST * max(lacking, 0.0):
            continue
        there = columns @ np.linalg.lstsq(gram, b, rcond=None)[0]
        if rms(there, outcome.problem.usable[:, axis]) > settings.usual * own:
            return axis
    return None


def _structures(outcome: Outcome, one: Named, axes: list[int]) -> list[Term]:
    """Return terms for the unexplained structure of some axes, beside which an effect is asked again."""
    terms = [t for a in axes for t in structure_terms(outcome, a)]
    return terms + [t for a in axes for t in _waves(outcome, a)] if _shaken(one) else terms


def _waves(outcome: Outcome, axis: int) -> list[Term]:
    """Return terms for unexplained lines over time of one axis: waves of each record as close as it can tell apart."""
    problem, white = outcome.problem, outcome.white
    state, found = problem.train_state, [u for u in outcome.unexplained if (u.axis, u.argument) == (axis, LINE)]
    columns = []
    for line in found:
        for piece in record_slices(state):
            if piece.stop - piece.start < 2:
                continue
            time = state.time[piece] - state.time[piece.start]
            apart = 1.0 / float(time[-1])
            reach = line.high - line.low + apart
            for frequency in np.arange(max(line.low - reach, 0.5 * apart), line.low + reach, apart):
                for wave in (np.sin, np.cos):
                    columns.append(np.zeros(len(state.time)))
                    columns[-1][piece] = wave(2 * np.pi * frequency * time)
    if not columns:
        return []
    every = np.column_stack(columns)
    std = np.full(every.shape[1], problem.widest[axis])
    return [Term(f"lines of {axis}", {axis: white.columns(axis, every)}, std, {axis: white.raw(axis, every)})]


def structure_terms(outcome: Outcome, axis: int) -> list[Term]:
    """Return terms for the unexplained structure of one axis."""
    problem, white = outcome.problem, outcome.white
    wanted = {u.argument for u in outcome.unexplained if u.axis == axis}
    terms = []
    for basis in white.bases(axis):
        if basis.argument not in wanted:
            continue
        columns = white.columns(axis, basis.columns)
        good = np.sum(columns**2, axis=0) > 1e-9
        std = np.full(int(good.sum()), problem.widest[axis])
        raw = white.raw(axis, basis.columns[:, good])
        terms.append(Term(f"structure over {basis.argument}", {axis: columns[:, good]}, std, {axis: raw}))
    return terms
