"""Structure that the named effects leave: where it shows, whether it lasts, and whether it matters."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
from scipy.stats import median_abs_deviation

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Outcome, Unexplained
from jointwear.discovery.linear import Fit, chance, chi_square, least_squares
from jointwear.discovery.problem.candidates import Seen, of_bases, resolved_bases
from jointwear.discovery.problem.instruments import torque_noise
from jointwear.discovery.problem.unresolved_steps import at_unresolved_steps
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.drives_at_rest import at_rest
from jointwear.discovery.search.least_torque import least_square
from jointwear.discovery.search.residual_lines import Line, chance_of, strongest_line, where_strongest
from jointwear.discovery.search.tolerance import fit_beside_forms
from jointwear.discovery.structure import Basis

#: Argument of structure that is a wave or a linear chirp.
LINE = "line over time"
#: Constant speeds of one joint that are left out, one after the other, each with a wave of its own.
SPEEDS = 4
#: Least p-value that is told: below, a number is rounded to zero.
LEAST_P = 1e-300
#: Shares of the largest from which a column of a basis, and a sample by its columns, tells where structure sits.
STRONG, NEAR = 0.7, 0.5


def fit_again(outcome: Outcome) -> None:
    """Fit the effects that are named and test what they leave, after a change of the names. Changes `outcome`."""
    outcome.fit = outcome.white.fit([t for n in outcome.named for t in n.terms])
    outcome.unexplained, outcome.profile = unexplained(outcome)


def unexplained(
    outcome: Outcome,
    robust: bool = False,
    asked: Collection[tuple[int, str]] | None = None,
    apart: Collection[int] = (),
) -> tuple[list[Unexplained], list[Unexplained]]:
    """Test every axis for structure over every argument.

    Parameters
    ----------
    robust : let no sample lie further than `Settings.noise_sigmas` from the model, none at steps of acceleration that
        the sampling does not resolve or where a shared drive that has a name is at rest, and no `assumed.BLOCK` of
        splines decide.
    asked : 0-based axes with the arguments that are tested there; default all.
    apart : 0-based axes that say nothing of what all axes share.

    Returns
    -------
    the structure that is significant and large enough to matter, and the full profile (one entry per basis).
    """
    problem, white = outcome.problem, outcome.white
    # What a form that is a little off leaves behind is no structure of its own.
    fit = fit_beside_forms(white, outcome.named)
    if robust:
        unknown = {axis: at_unresolved_steps(white, axis) | at_rest(outcome, axis) for axis in problem.judged}
        fit = without_outliers(fit, problem.settings.noise_sigmas, unknown)
    if apart:
        fit = _without_axes(fit, apart)
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
            low, high = range_covered(basis, seen, rows)
            share = (high - low) / max(float(np.ptp(basis.values[rows])), 1e-300)
            entry = Unexplained(axis, basis.argument, basis.unit, low, high, max(p, LEAST_P), nats, share, freedom)
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
            p, end = max(line.p_value, LEAST_P), line.frequency + abs(line.rate)
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


def _without_axes(fit: Fit, apart: Collection[int]) -> Fit:
    """Return a fit to the targets of the other axes alone."""
    targets = [np.zeros(0) if axis in apart else y for axis, y in enumerate(fit.targets)]
    terms = [replace(t, blocks={a: x for a, x in t.blocks.items() if a not in apart}) for t in fit.terms]
    return Fit(targets, [t for t in terms if t.blocks])


def without_outliers(fit: Fit, sigmas: float, unknown: Mapping[int, np.ndarray] | None = None) -> Fit:
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


def range_covered(basis: Basis, seen: Seen, rows: np.ndarray) -> tuple[float, float]:
    """Return the range of the argument that the strongest columns of a basis cover, of those that hold anything."""
    size = np.abs(seen.b) / np.sqrt(np.maximum(np.diag(seen.gram), 1e-12))
    strong = np.flatnonzero(seen.good)[size > STRONG * size.max()]
    height = np.abs(basis.columns.T[strong].take(rows, axis=1))
    chosen = height.max(axis=0) > NEAR * height.max()
    values = basis.values[rows][chosen]
    return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)
