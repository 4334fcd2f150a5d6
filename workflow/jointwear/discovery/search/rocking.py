"""A base that swings with the motion: structure that a noise model takes for noise and that no basis holds.

A pedestal or a column that gives way rocks at a frequency of its own each time the arm starts or stops, and so do, much
alike, a load on a rope and a link. At the joints those are bursts that die away. Over time they make no line, for each
start has a phase of its own, and an autoregressive model of what is left calls them coloured noise. Noise does not know
how the arm moves. So the base is let swing, driven by the moment that the arm along its nominal motion asks of it, at
each of many frequencies: where the torques that follow say what is left, in records that had no part in choosing
frequency and size too, that is no noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome, Unexplained
from jointwear.discovery.linear import Fit, Term, chance, least_nats
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.least_torque import least_square
from jointwear.discovery.search.tolerance import fit_beside_forms
from jointwear.effects import get_effect
from jointwear.effects.swing import drag_of, wind_up
from jointwear.robots.rocking_base import WAYS, RockingBase
from jointwear.statistics.runs import runs

#: Argument of structure that swings with the motion.
SWING = "swing of the base"
#: Frequencies [Hz] at which a base is let swing: from slow columns to stiff pedestals, in steps of a twentieth.
FREQUENCIES = tuple(float(f) for f in np.geomspace(1.5, 20.0, 53))
#: Dampings of these swings, over that at which they end, and those with which hardly anything swings: a base of steel
#: or concrete has less, what rates of torque feign has no frequency.
DAMPINGS, DULL = (0.03, 0.1), (0.3, 0.7)
#: Every so many of the frequencies are looked at first, with the largest damping, whose peaks are as wide as that; and
#: the share of what a swing needs, not to be one that noise feigns, that one of them has to say, or none is looked for:
#: the rest costs four times that.
COARSE, HINT = 2, 0.5
#: Swings of which the best is told.
_SEARCHED = len(FREQUENCIES) * len(DAMPINGS)


@dataclass(frozen=True)
class Swing:
    """A swing of the base, with its `torque` (m, n) [N m] at the joints and what it is worth [nats]: `lead` more than
    one that is dull or at an end of the frequencies, `left_out` in records that had no part in choosing it."""

    frequency: float
    torque: np.ndarray
    nats: float
    freedom: int
    lead: float
    left_out: float


class Rocking:
    """The swings of the base that whitened data may hold, by frequency and damping."""

    def __init__(self, white: White) -> None:
        self.white = white

    @cached_property
    def _driven(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Moments (m, 2) on the base, and what it does to base and joints by acceleration and angle (m, 2, 2 + n)."""
        problem = self.white.problem
        base, state = RockingBase(problem.dynamics), problem.train_state
        return base.moments(state.position, state.velocity, state.acceleration), *base.pulls(state.position)

    @cached_property
    def _folds(self) -> dict[int, list[tuple[int, slice]]]:
        """Axis -> the runs of whitened rows that are in one fold, with that fold."""
        folds = {axis: self.white.folds(axis) for axis in self.white.problem.judged}
        return {axis: [(int(fold[rows.start]), rows) for rows in runs(fold)] for axis, fold in folds.items()}

    def torques(self, frequency: float, damping: float) -> np.ndarray:
        """Return the torques (m, n, 2) [N m] of the joints where the base swings about each of its directions."""
        moments, by_acceleration, by_angle = self._driven
        state, result = self.white.problem.train_state, []
        for way in range(WAYS):
            inertia = by_acceleration[:, way, way]
            mean = float(np.mean(inertia))
            stiffness = mean * (2.0 * np.pi * frequency) ** 2
            drag = drag_of(stiffness, mean, damping)
            twist = wind_up(state, -moments[:, way], inertia, stiffness, drag)
            torque = by_acceleration[:, way] * twist.acceleration[:, None] + by_angle[:, way] * twist.angle[:, None]
            result.append(torque[:, WAYS:])
        return np.stack(result, axis=-1)

    def found(self, fit: Fit, needed: float) -> Swing | None:
        """Return the swing that says most of what a fit leaves, None where it is no swing.

        Sizes are those of a base that gives way: positive. Of a swing there is a best frequency, within those searched:
        at their ends it says less, unlike what lies beyond them.

        Parameters
        ----------
        needed : nats below which no swing is told.
        """
        coarse = [self._sums(fit, f, max(DAMPINGS)) for f in FREQUENCIES[::COARSE]]
        if max(_said(b.sum(axis=0), gram.sum(axis=0))[0] for b, gram in coarse) < HINT * needed:
            return None
        swings = [(f, d) for d in DAMPINGS for f in FREQUENCIES]
        sums = [self._sums(fit, *one) for one in swings]
        every = [_said(b.sum(axis=0), gram.sum(axis=0)) for b, gram in sums]
        best = int(np.argmax([nats for nats, *_ in every]))
        nats, size, freedom = every[best]
        frequency, damping = swings[best]
        if not freedom:
            return None
        # Hardly any frequency is left in what is dull.
        dull = [self._sums(fit, f, d) for d in DULL for f in FREQUENCIES[:: len(DAMPINGS) + 1]]
        rivals = [_said(b.sum(axis=0), gram.sum(axis=0))[0] for b, gram in dull]
        rivals += [every[k][0] for k, (f, _) in enumerate(swings) if f in (FREQUENCIES[0], FREQUENCIES[-1])]
        lead = nats - max(rivals)
        torque = self.torques(frequency, damping) @ size
        return Swing(frequency, torque, nats, freedom, lead, _left_out(sums))

    def _sums(self, fit: Fit, frequency: float, damping: float) -> tuple[np.ndarray, np.ndarray]:
        """Return b (folds, 2) and H (folds, 2, 2) of the torques of a swing, less what the terms of a fit can say."""
        problem = self.white.problem
        torques = self.torques(frequency, damping)
        blocks = {axis: self.white.columns(axis, torques[:, axis]) for axis in problem.judged}
        instead = fit.mimicked(blocks, np.eye(WAYS))
        folds = int(problem.fold_of_sample.max()) + 1
        b, gram = np.zeros((folds, WAYS)), np.zeros((folds, WAYS, WAYS))
        for axis, columns in blocks.items():
            own = columns - fit.design[axis] @ instead[fit.columns[axis]]
            for one, rows in self._folds[axis]:
                b[one] += own[rows].T @ fit.residual[axis][rows]
                gram[one] += own[rows].T @ own[rows]
        return b, gram


def rocking(outcome: Outcome) -> list[Unexplained]:
    """Return the structure of a base that swings beside all that was found, of each axis on which it matters.

    The form of an elastic gear that has its name may be off: then it leaves a swing that is worth no more than
    `form_error` of it.
    """
    swing = swing_beside(outcome)
    if swing is None:
        return []
    white, settings = outcome.white, outcome.problem.settings
    fit, p, found = fit_beside_forms(white, outcome.named), max(min(1.0, _chance(outcome, swing)), 1e-300), []
    for axis, columns in _blocks(white, swing).items():
        b, gram = fit.gram({axis: columns})
        nats = float(b[0] - 0.5 * gram[0, 0])
        size = float(np.mean(swing.torque[outcome.problem.usable[:, axis], axis] ** 2))
        if nats > settings.accept and size > least_square(outcome, axis):
            found.append(Unexplained(axis, SWING, "Hz", swing.frequency, swing.frequency, p, nats))
    return found


def swing_beside(outcome: Outcome) -> Swing | None:
    """Return the swing of a base that noise does not feign beside all that was found, or None.

    The form of an elastic gear that has its name may be off: then it leaves a swing that is worth no more than
    `form_error` of it.
    """
    if outcome.white is None:
        return None
    settings = outcome.problem.settings
    least = max([settings.accept, *(settings.form_error * n.evidence for n in outcome.named if swings(n))])
    fit = fit_beside_forms(outcome.white, outcome.named)
    swing = Rocking(outcome.white).found(fit, max(least, _least_sure(outcome)))
    return swing if swing is not None and _sure(outcome, swing, least) else None


def swing_terms(white: White, swing: Swing) -> list[Term]:
    """Return the term of a swing of the base, beside which an elastic gear is asked again."""
    raw = {axis: white.raw(axis, swing.torque[:, [axis]]) for axis in white.problem.judged}
    return [Term(SWING, _blocks(white, swing), np.ones(1), raw)]


def swings(one: Named) -> bool:
    """Return whether an effect is a link that swings behind its gear."""
    candidate = one.candidate
    return candidate.effect != LINK_MASS and get_effect(candidate.effect).spreads(candidate.nonlinear)


def swing_in_words(structure: Sequence[Unexplained]) -> list[str]:
    """Say at which frequency something swings with the motion, in one sentence or none."""
    found = [u for u in structure if u.argument == SWING]
    if not found:
        return []
    words = (
        f"something swings with the motion at {found[0].low:.2g} Hz, as a base that gives way does when the arm "
        "starts and stops: look at how firmly base, column and load are held, and at the gears"
    )
    return [words]


def _sure(outcome: Outcome, swing: Swing, least: float) -> bool:
    """Return whether noise, or a model that is off without swinging, does not feign a swing of so many nats."""
    settings = outcome.problem.settings
    return (
        _chance(outcome, swing) < settings.unexplained_p
        and swing.nats > least
        and swing.lead > settings.accept
        and swing.left_out > settings.accept
    )


def _chance(outcome: Outcome, swing: Swing) -> float:
    """Return how many swings as good as one noise is expected to hold, of all that are searched."""
    return _SEARCHED * chance(2.0 * swing.nats + swing.freedom, swing.freedom, _samples(outcome))[0]


def _least_sure(outcome: Outcome) -> float:
    """Return the nats without which noise may feign any swing, one of the base about one direction or about both."""
    once, samples = outcome.problem.settings.unexplained_p / _SEARCHED, _samples(outcome)
    return min(least_nats(once, freedom, samples) for freedom in range(1, WAYS + 1))


def _samples(outcome: Outcome) -> int:
    """Return how many whitened samples are searched."""
    return sum(len(y) for y in outcome.white.targets)


def _blocks(white: White, swing: Swing) -> dict[int, np.ndarray]:
    """Return axis -> whitened torque (m, 1) of a swing."""
    return {axis: white.columns(axis, swing.torque[:, [axis]]) for axis in white.problem.judged}


def _said(b: np.ndarray, gram: np.ndarray) -> tuple[float, np.ndarray, int]:
    """Return the nats of columns with b (2,) and H (2, 2) whose sizes (2,) are not negative, those, and how many."""
    best = (0.0, np.zeros(WAYS), 0)
    for chosen in ([0, 1], [0], [1]):
        part = gram[np.ix_(chosen, chosen)]
        if not np.all(np.linalg.eigvalsh(part) > 0):
            continue
        size = np.linalg.solve(part, b[chosen])
        nats = 0.5 * (float(size @ b[chosen]) - len(chosen))
        if np.all(size > 0) and nats > best[0]:
            full = np.zeros(WAYS)
            full[chosen] = size
            best = nats, full, len(chosen)
    return best


def _left_out(sums: Sequence[tuple[np.ndarray, np.ndarray]]) -> float:
    """Return the nats that swings chosen on all other folds gain in each one, in all."""
    b, gram = np.stack([x for x, _ in sums]), np.stack([x for _, x in sums])
    total = 0.0
    for fold in range(b.shape[1]):
        others = [_said(b[k].sum(axis=0) - b[k, fold], gram[k].sum(axis=0) - gram[k, fold]) for k in range(len(b))]
        best = int(np.argmax([nats for nats, *_ in others]))
        size = others[best][1]
        total += float(size @ b[best, fold] - 0.5 * size @ gram[best, fold] @ size)
    return total
