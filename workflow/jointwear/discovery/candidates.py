"""Every (effect, axis, source, nonlinear parameters) that may explain a discrepancy, as whitened columns."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import logsumexp

from jointwear.discovery.linear import Fit, Term, gain
from jointwear.discovery.problem import White, link_mass_blocks
from jointwear.discovery.reversals import TIMING, resolved_motion
from jointwear.discovery.structure import hats, knots_of
from jointwear.effects import Effect, State, get_effect, library
from jointwear.effects.order import second_derivative
from jointwear.robots.inertia import mass_direction

LINK_MASS = "link_mass"
#: A link mass that would have to be wrong by more than this share is not a wrong number but a missing body.
WRONGEST_MASS = 0.6


@dataclass(frozen=True)
class Candidate:
    """One point of the search: an effect of the library, or the mass of one link (``effect == LINK_MASS``).

    `axis` and `source` are 0-based; axis is None for the whole arm and the link for a link mass.
    """

    effect: str
    axis: int | None
    source: int | None
    nonlinear: dict[str, Any] = field(default_factory=dict)

    @property
    def key(self) -> tuple:
        """What a verdict tells apart: the effect, its axis and its source."""
        return (self.effect, self.axis, self.source)


@dataclass
class Dictionary:
    """Whitened columns of all single-axis candidates, one matrix an axis, and of those on the whole arm."""

    matrix: dict[int, np.ndarray]
    entries: dict[int, list[tuple[Candidate, slice, np.ndarray]]]
    whole: list[tuple[Candidate, dict[int, np.ndarray], np.ndarray]]


def raw_columns(white: White, candidate: Candidate) -> np.ndarray:
    """Return the columns (N_train, k) of a single-axis candidate before whitening."""
    effect = get_effect(candidate.effect)
    return effect.columns(white.problem.train_state, candidate.axis, candidate.source, candidate.nonlinear)


def raw_blocks(white: White, candidate: Candidate) -> dict[int, np.ndarray]:
    """Return the unwhitened columns of any candidate on the rows of the whitened ones."""
    problem = white.problem
    if candidate.effect == LINK_MASS:
        torque = problem.regressor[problem.train] @ mass_direction(problem.robot, candidate.axis)
        return {a: white.raw(a, torque[:, [a]]) for a in problem.judged if np.any(torque[:, a])}
    if candidate.axis is None:
        columns = get_effect(candidate.effect).columns(problem.train_state, 0, None, candidate.nonlinear)
        return {a: white.raw(a, columns[:, a]) for a in problem.judged}
    return {candidate.axis: white.raw(candidate.axis, raw_columns(white, candidate))}


def prior_std(white: White, axis: int, columns: np.ndarray) -> np.ndarray:
    """Return prior standard deviations (k,) at which each column is worth 30 % of the friction of the axis."""
    used = white.problem.usable[:, axis]
    size = np.sqrt(np.mean(columns[used] ** 2, axis=0))
    return 0.3 * white.problem.scale[axis] / np.maximum(size, 1e-12)


def resolved(white: White, axis: int, order: float) -> bool:
    """Return whether a line of `order` over the motor angle lies in the band of the torque for half of the samples."""
    problem = white.problem
    speed = np.median(np.abs(problem.train_state.velocity[problem.usable[:, axis], axis]))
    return bool(order * abs(problem.robot.gear_ratio[axis]) * speed / (2 * np.pi) < problem.measured.band)


def sources_of(axis: int, joints: int) -> list[int]:
    """Return the axes whose drive may act on `axis`: its neighbours up to two joints away."""
    return [k for k in range(max(0, axis - 2), min(joints, axis + 3)) if k != axis]


def build_dictionary(white: White) -> Dictionary:
    """Evaluate every effect of the library on every judged axis."""
    problem = white.problem
    state, n = problem.train_state, problem.robot.joints
    matrix, entries, whole = {}, {}, []
    for axis in problem.judged:
        rows, found, start = [], [], 0
        for effect in library().values():
            if not effect.identifiable or effect.whole_arm:
                continue
            if effect.identifier in TIMING and not resolved_motion(problem.measured):
                continue
            for source in sources_of(axis, n) if effect.needs_source else [None]:
                if source is not None and np.ptp(state.position[:, source]) < 1e-4:
                    continue
                for nonlinear in effect.grid(state, axis):
                    candidate = Candidate(effect.identifier, axis, source, dict(nonlinear))
                    if effect.argument == "motor angle" and not resolved(white, axis, nonlinear["order"]):
                        continue
                    columns = raw_columns(white, candidate)
                    if not np.any(columns[problem.usable[:, axis]]):
                        continue
                    found.append((candidate, slice(start, start + columns.shape[1]), prior_std(white, axis, columns)))
                    rows.append(columns)
                    start += columns.shape[1]
        matrix[axis] = white.columns(axis, np.concatenate(rows, axis=1))
        entries[axis] = found
    for effect in library().values():
        if effect.whole_arm and effect.identifiable:
            for nonlinear in effect.grid(state, 0):
                columns = effect.columns(state, 0, None, nonlinear)
                blocks = {axis: white.columns(axis, columns[:, axis]) for axis in problem.judged}
                whole.append((Candidate(effect.identifier, None, None, dict(nonlinear)), blocks, _payload_std(white)))
    for link in range(n):
        blocks = link_mass_blocks(white, link)
        if blocks:
            whole.append((Candidate(LINK_MASS, link, None), blocks, np.array([0.25])))
    return Dictionary(matrix, entries, whole)


def _shrunk(b: np.ndarray, gram: np.ndarray, std: np.ndarray) -> np.ndarray:
    """Posterior mean of coefficients under their prior."""
    if len(b) == 1:
        return b / (gram[0] + 1 / std**2)
    return np.linalg.solve(gram + np.diag(1 / std**2), b)


def _payload_std(white: White) -> np.ndarray:
    from jointwear.robots.inertia import bodies

    mass = 0.05 * sum(b[0] for b in bodies(white.problem.robot))
    lever = 0.15
    return np.array([mass, *[mass * lever] * 3, *[mass * lever**2] * 6])


@dataclass(frozen=True)
class Scored:
    """The best point of one family (effect, axis, source) and the evidence [nats] of the family."""

    candidate: Candidate
    evidence: float
    blocks: dict[int, np.ndarray]
    std: np.ndarray


def scan(white: White, dictionary: Dictionary, fit: Fit, keys: set | None = None) -> list[Scored]:
    """Score every family given the terms of `fit`; the families, best first.

    The evidence of a family is averaged over its grid and pays for the number of families searched. `keys`
    restricts the families.
    """
    families: dict[tuple, list[tuple[float, Candidate, dict, np.ndarray]]] = {}
    for axis, matrix in dictionary.matrix.items():
        b, cross = fit.projected({axis: matrix})
        chol = np.linalg.cholesky(fit.covariance + 0.0)
        turned = cross @ chol
        for candidate, where, std in dictionary.entries[axis]:
            if keys is not None and candidate.key not in keys:
                continue
            x = matrix[:, where]
            gram = x.T @ x - turned[where] @ turned[where].T
            effect = get_effect(candidate.effect)
            if len(std) == 1 or effect.needs_source:
                size = _shrunk(b[where], gram, std)
                if not possible(effect, candidate.nonlinear, size):
                    continue
            families.setdefault(candidate.key, []).append((gain(b[where], gram, std), candidate, {axis: x}, std))
    for candidate, blocks, std in dictionary.whole:
        if keys is not None and candidate.key not in keys:
            continue
        b, gram = fit.gram(blocks)
        value = gain(b, gram, std)
        if candidate.effect == LINK_MASS and abs(b[0]) > WRONGEST_MASS * (gram[0, 0] + 1 / std[0] ** 2):
            value = -np.inf
        families.setdefault(candidate.key, []).append((value, candidate, blocks, std))
    price = np.log(max(len(families), 1))
    found = []
    for points in families.values():
        values = np.array([p[0] for p in points])
        best = points[int(np.argmax(values))]
        evidence = float(logsumexp(values) - np.log(len(values))) - (price if keys is None else 0.0)
        found.append(Scored(best[1], evidence, best[2], best[3]))
    return sorted(found, key=lambda s: -s.evidence)


@dataclass(frozen=True)
class Form:
    """Tolerance of the form of one effect: flexible columns over its own argument.

    `knots` (k,) of a piecewise-linear table over the argument, or None where the columns are variants of the effect.
    """

    candidate: Candidate
    knots: np.ndarray | None

    def columns(self, state: State) -> np.ndarray:
        """Return the columns (N, k) on any ordered state."""
        candidate, axis = self.candidate, self.candidate.axis
        effect, nonlinear = get_effect(candidate.effect), candidate.nonlinear

        def like(**changes):
            return effect.columns(state, axis, candidate.source, {**nonlinear, **changes})

        if effect.argument == "motor angle":
            return np.concatenate([like(order=k * nonlinear["order"]) for k in (2, 3)], axis=1)
        if candidate.effect == "presliding_hysteresis":
            return np.concatenate([like(distance=f * nonlinear["distance"]) for f in (0.3, 0.6, 1.7, 3.5)], axis=1)
        if candidate.effect in ("actuation_delay", "joint_flexibility"):
            delay = get_effect("actuation_delay")
            steps = [delay.columns(state, axis, None, {"delay": d}) for d in (0.006, 0.018, -0.006)]
            seconds = [second_derivative(state, x[:, axis])[:, None] for x in (state.torque, state.load)]
            return np.concatenate([*steps, *seconds], axis=1)
        if effect.needs_source:
            speed = _drive_speed(state, candidate)
            return np.sign(speed)[:, None] * hats(np.abs(speed), self.knots)
        carrier, argument = effect.shape(state, axis, nonlinear)
        return carrier[:, None] * hats(argument, self.knots)


def _drive_speed(state: State, candidate: Candidate) -> np.ndarray:
    own, other = candidate.nonlinear["own"], candidate.nonlinear["other"]
    return own * state.velocity[:, candidate.axis] + other * state.velocity[:, candidate.source]


def form_of(white: White, candidate: Candidate) -> Form | None:
    """Return the tolerance of the form of a candidate, None where its form is exact (a gain, a payload, a mass)."""
    if candidate.effect == LINK_MASS or candidate.axis is None:
        return None
    problem, axis = white.problem, candidate.axis
    effect, state = get_effect(candidate.effect), problem.train_state
    used = problem.usable[:, axis]
    if effect.argument == "motor angle" or effect.sequential:
        return Form(candidate, None)
    if effect.needs_source:
        return Form(candidate, knots_of(np.abs(_drive_speed(state, candidate))[used], 5))
    if effect.shape is None:
        return None
    _, argument = effect.shape(state, axis, candidate.nonlinear)
    count = {"temperature": 4, "time": 6, "time x direction": 5, "position": 6}.get(effect.argument, 8)
    if "order" in candidate.nonlinear:
        # Enough for the second harmonic and a slow change of amplitude.
        span = float(np.ptp(argument[used]))
        count = int(np.clip(round(span * candidate.nonlinear["order"] * 8 / (2 * np.pi)), 6, 40))
    knots = knots_of(argument[used], count)
    return Form(candidate, knots) if len(knots) > 1 else None


def possible(effect: Effect, nonlinear: dict[str, Any], coefficients: np.ndarray) -> bool:
    """Return whether the parameters lie within their bounds: no friction that drives, no delay of a quarter second."""
    found = effect.parameters_of(nonlinear, coefficients)
    return all(p.lower <= found.get(p.name, p.default) <= p.upper for p in effect.parameters)


def companion(white: White, form: Form, size: float) -> Term:
    """Return the whitened columns of a form with their prior.

    Parameters
    ----------
    size : RMS torque of the effect [N m]; the columns may each be worth 30 % of it.
    """
    axis = form.candidate.axis
    columns = form.columns(white.problem.train_state)
    used = white.problem.usable[:, axis]
    # Hats are narrow: their height, not their RMS, is bounded by the size of the effect.
    scale = np.sqrt(np.mean(columns[used] ** 2, axis=0))
    height = np.sqrt(np.mean(columns[used] ** 4, axis=0) / np.maximum(scale**2, 1e-300))
    std = np.where(scale > 1e-12, 0.3 * size / np.maximum(height, 1e-12), 1e-9)
    return Term(
        f"form of {form.candidate.effect}",
        {axis: white.columns(axis, columns)},
        np.maximum(std, 1e-9),
        {axis: white.raw(axis, columns)},
    )
