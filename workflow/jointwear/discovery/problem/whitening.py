"""The problem after whitening: targets, base regression and instruments of every axis."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.noise.noise import Whitener
from jointwear.discovery.problem.fused_load import end_of_columns, fused_load
from jointwear.discovery.problem.instruments import (
    Cutoffs,
    axis_cutoffs,
    clock_of,
    ended,
    held_at_ends,
    limited_inertial,
    limited_state,
    nominal_noise,
    swing_cutoff,
    velocities,
)
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.structure import Basis, axis_bases
from jointwear.effects import Effect, State
from jointwear.measurement.derived.filtering import limit
from jointwear.statistics.runs import runs

#: Label of the term of the corrections of the links, which all axes share.
INERTIAL = "inertial"
#: What the data tell of a direction of the links, over what its prior does, from which it is a coefficient.
TOLD = 1e-2
#: Axis -> fold (m,) of each whitened row.
Folds = Callable[[int], np.ndarray]


@dataclass(frozen=True)
class White:
    """The problem after whitening: targets and base terms, for the training samples.

    `cutoffs` are those of the instruments of each axis, `gears` axis -> Jm G^2/K [s2] of the elastic gears that have
    their name, as far as a load is made of the measured torque too.
    """

    problem: Problem
    whiteners: list[Whitener | None]
    targets: list[np.ndarray]
    base: list[Term]
    directions: np.ndarray
    cutoffs: list[Cutoffs]
    gears: Mapping[int, float] = field(default_factory=dict)
    # What was made of these fields: another problem begins with none.
    _states: dict[tuple, Any] = field(init=False, default_factory=dict, repr=False)

    def state_of(
        self,
        effect: Effect,
        axis: int | None,
        nonlinear: Mapping[str, Any] | None = None,
        band: float = 1.0,
        wide: bool = False,
    ) -> State:
        """Return the training samples that the columns of an effect on one axis are made from: its instruments.

        Parameters
        ----------
        nonlinear : of the effect; None for a bend of its form, which is of rates of torque whatever the effect is.
        band : times the cut-off of an effect of timing at which its columns end.
        wide : whether columns of an elastic gear behind the encoder go on, of the load of the model, to where noise of
            derived accelerations is half of the residual.
        """
        if axis is None:
            return self.problem.train_state
        cutoffs = self.cutoffs[axis]
        if self.fuses_load(effect, axis):
            share = abs(float((nonlinear or {}).get(effect.scaled, 0.0)))
            end = self._end_of_gear(axis, self.gears.get(axis, share))
            return self._fused_state(axis, band * end, band * cutoffs.judged if wide else 0.0)
        if nonlinear is not None and effect.shifts(nonlinear):
            return self._limited_state(axis, cutoffs.late)
        if nonlinear is not None and effect.late:
            return self._turned_state(axis)
        return self._limited_state(axis, band * cutoffs.timing) if effect.timing else self.axis_state(axis)

    def _turned_state(self, axis: int) -> State:
        """Return the training samples that a lag turns above the cut-off of rates of torque, where it would take noise
        off, and filters below."""
        slow, late = (self._limited_state(axis, end) for end in (self.cutoffs[axis].timing, self.cutoffs[axis].late))
        if late is slow:
            return slow
        if (axis, "turned") not in self._states:
            self._states[axis, "turned"] = replace(slow, above=late.torque - slow.torque)
        return self._states[axis, "turned"]

    def axis_state(self, axis: int) -> State:
        """Return the training samples without the noise of derived accelerations on one axis."""
        cutoffs = self.cutoffs[axis]
        limited = self._limited_state(axis, cutoffs.torque)
        if not self.problem.shaken[axis]:
            return limited
        if (axis, "shaken") not in self._states:
            self._states[axis, "shaken"] = replace(limited, velocity=velocities(self.problem, axis, cutoffs))
        return self._states[axis, "shaken"]

    def timing_state(self, axis: int) -> State:
        """Return the training samples of which rates of change on one axis are made, without the noise of these."""
        return self._limited_state(axis, self.cutoffs[axis].timing)

    def bases(self, axis: int) -> list[Basis]:
        """Return the bases over which structure on one axis is looked for."""
        speeds = velocities(self.problem, axis, self.cutoffs[axis])
        return axis_bases(self.structure_state(axis), axis, self.problem.usable[:, axis], velocity=speeds)

    def structure_state(self, axis: int) -> State:
        """Return the training samples over which structure on one axis is looked for.

        A flexible basis can follow the noise of an acceleration alone, where hardly anything moves.
        """
        return self._limited_state(axis, self.cutoffs[axis].structure)

    def _limited_state(self, axis: int, cutoff: float) -> State:
        return limited_state(self.problem, axis, cutoff)

    def beside_gears(self, gears: Mapping[int, float]) -> White:
        """Return the same problem once it is known that the residual of some axes holds an elastic gear."""
        return replace(self, gears=dict(gears)) if gears else self

    def fuses_load(self, effect: Effect, axis: int) -> bool:
        """Return whether the columns of an effect on one axis are of a load that is told by the measured torque too."""
        # Where positions may be those of the motor, a link that swings shakes all joints: that is no noise.
        of_link = self.problem.state.encoder_side == "link"
        return bool(effect.of_load and of_link and np.isfinite(self.cutoffs[axis].timing))

    def _end_of_gear(self, axis: int, share: float) -> float:
        cutoffs = self.cutoffs[axis]
        return end_of_columns(self.problem, axis, self.whiteners[axis], share, cutoffs.timing, cutoffs.swing)

    def _fused_state(self, axis: int, end: float, wide: float = 0.0) -> State:
        """Return the training samples with a load that is fused up to `end` [Hz], and as of the model up to `wide`."""
        key = axis, "fused", end, wide
        if key not in self._states:
            record, rate = np.asarray(self.problem.train_state.record), self.problem.measured.rate
            state = self._limited_state(axis, self.cutoffs[axis].timing)
            load = state.load.copy()
            load[:, axis] = limit(self._fused_load(axis)[:, None], record, end, rate)[:, 0]
            if wide > end:
                model = self.problem.train_state.load[:, [axis]]
                load[:, axis] += (limit(model, record, wide, rate) - limit(model, record, end, rate))[:, 0]
            self._states[key] = replace(state, load=load)
        return self._states[key]

    def _fused_load(self, axis: int) -> np.ndarray:
        if (axis, "load") not in self._states:
            problem = self.problem
            residual = bridged(self._residual(axis), problem.usable[:, axis], np.asarray(problem.train_state.record))
            share = self.gears.get(axis, 0.0)
            self._states[axis, "load"] = fused_load(problem, axis, self.whiteners[axis], residual, share)
        return self._states[axis, "load"]

    @cached_property
    def _base_fit(self) -> Fit:
        return Fit(self.targets, self.base)

    def _residual(self, axis: int) -> np.ndarray:
        """Return the discrepancy (N_train,) [N m] of one axis less drives and inertial parameters as fitted."""
        problem, fit = self.problem, self._base_fit
        left = np.array(problem.discrepancy[problem.train, axis])
        friction, inertial = base_columns(problem, axis, self.cutoffs[axis])
        for term, where in zip(fit.terms, fit.slices, strict=True):
            if term.drive == (axis,):
                left -= friction @ fit.theta[where]
            elif term.label == INERTIAL:
                left -= inertial @ (self.directions @ fit.theta[where])
        return left

    def directions_of(self, links: Term) -> np.ndarray:
        """Return the directions (r, k) of the inertial prior of the coefficients of a term of the links."""
        return self.directions if links.turn is None else self.directions @ links.turn

    def limited(self, axis: int, columns: np.ndarray) -> np.ndarray:
        """Return columns (N_train, k) of torque on one axis, without the noise of derived accelerations."""
        return _limited(self.problem, self.cutoffs[axis], columns)

    @cached_property
    def attenuation(self) -> list[Term]:
        """Terms for what the noise of derived accelerations takes off the fitted inertias.

        Columns with noise are fitted with coefficients that are too small; what is missing follows the motion itself.
        """
        problem, terms = self.problem, []
        for axis in problem.judged:
            if not np.isfinite(self.cutoffs[axis].structure):
                continue
            state = self.structure_state(axis)
            motion = np.column_stack([state.load[:, axis], state.acceleration])
            size = np.sqrt(np.mean(motion[problem.usable[:, axis]] ** 2, axis=0))
            std = problem.scale[axis] / np.maximum(size, 1e-12)
            blocks, raw = {axis: self.columns(axis, motion)}, {axis: self.raw(axis, motion)}
            terms.append(Term(f"attenuation {axis}", blocks, std, raw))
        return terms

    def fit(self, extra: list[Term] = ()) -> Fit:
        """Return the posterior of the base regression with `extra` terms."""
        return Fit(self.targets, [*self.base, *extra], self._base_fit) if extra else self._base_fit

    def evidence_of(self, terms: Sequence[Term], beside: Sequence[Term]) -> float:
        """Return the log evidence that `terms` add to the base regression with the terms `beside`."""
        return self.fit([*beside, *terms]).evidence - self.fit(list(beside)).evidence

    def columns(self, axis: int, columns: np.ndarray) -> np.ndarray:
        """Whiten columns (N_train, k) of one axis."""
        return self.whiteners[axis](columns)

    def of_swing(self, axis: int, column: np.ndarray, period: float, damping: float) -> np.ndarray:
        """Return the column (N_train, 1) on one axis of a link that swings, ended where noise would feign it."""
        problem, whitener = self.problem, self.whiteners[axis]
        record, rate = np.asarray(problem.train_state.record), problem.measured.rate
        timing = self.cutoffs[axis].timing
        if problem.measured.noise is None or not np.isfinite(timing):
            return column
        if (axis, "noise") not in self._states:
            self._states[axis, "noise"] = nominal_noise(problem, axis, whitener)
        frequency, density = self._states[axis, "noise"]
        column = held_at_ends(column, record, problem.measured.vague_ends)
        # What is motion in a column is seen where noise alone could do no harm.
        energy = float(np.mean(whitener(limit(column, record, timing, rate)) ** 2))
        cutoff = swing_cutoff(whitener, density, frequency, rate, period, damping, energy)
        # Above what is judged most of a column is noise, which takes a part off its size.
        return limit(column, record, min(cutoff, max(self.cutoffs[axis].judged, timing)), rate)

    def raw(self, axis: int, columns: np.ndarray) -> np.ndarray:
        """Return columns (N_train, k) [N m] on the rows of the whitened ones, below what is noise of derivatives."""
        return _raw(self.problem, axis, self.cutoffs[axis], self.whiteners[axis], columns)

    @cached_property
    def raw_targets(self) -> list[np.ndarray]:
        """Discrepancy (m,) [N m] of every axis on the rows of its targets, below what is noise of derivatives."""
        train = self.problem.discrepancy[self.problem.train]
        return [np.zeros(0) if w is None else self.raw(axis, train[:, axis]) for axis, w in enumerate(self.whiteners)]

    def folds(self, axis: int) -> np.ndarray:
        """Return the fold (m,) of cross-validation of each whitened row of `axis`, in order of time.

        A fold is a record; fewer than three records are cut into contiguous blocks.
        """
        return self.problem.fold_of_sample[self.whiteners[axis].rows]

    def parts(self, axis: int) -> np.ndarray:
        """Return the part (m,), out of at least four, that a name has to predict, of each whitened row of `axis`."""
        return self.problem.part_of_sample[self.whiteners[axis].rows]

    def halves(self, axis: int) -> np.ndarray:
        """Return the half (m,) of its record that each whitened row of `axis` is in, numbered over all records."""
        return self.problem.half_of_sample[self.whiteners[axis].rows]

    def blocks(self, axis: int) -> np.ndarray:
        """Return the block of time (m,), within its record, of each whitened row of `axis`."""
        return self.problem.block_of_sample[self.whiteners[axis].rows]


def clock_label(axis: int) -> str:
    """Return the label of the term for what the torque of an axis (0-based) changes within the accuracy of its time."""
    return f"clock {axis}"


def whiten(problem: Problem, whiteners: list[Whitener | None]) -> White:
    """Whiten targets and base regression; inertial directions that the data cannot see are dropped."""
    cutoffs = [Cutoffs() if w is None else axis_cutoffs(problem, axis, w) for axis, w in enumerate(whiteners)]
    targets, base, inertial, raw_inertial = [], [], {}, {}
    for axis in range(problem.robot.joints):
        white = whiteners[axis]
        if white is None:
            targets.append(np.zeros(0))
            continue
        targets.append(white(problem.discrepancy[problem.train, axis]))
        friction, columns = base_columns(problem, axis, cutoffs[axis])
        raw = _raw(problem, axis, cutoffs[axis], white, friction)
        base.append(
            Term(f"friction {axis}", {axis: white(friction)}, problem.friction_prior(axis), {axis: raw}, (axis,))
        )
        # It takes the noise of derivatives off the residual too: here as where the noise is estimated.
        smear = problem.rounding(axis)
        if np.any(smear):
            # What the filter does is no part of the robot: a prediction in N m has to do without it.
            nothing = np.zeros((len(white.rows), smear.shape[1]))
            base.append(Term(f"filter {axis}", {axis: white(smear)}, np.ones(smear.shape[1]), {axis: nothing}))
        clock = clock_of(problem, axis, cutoffs[axis])
        base.append(Term(clock_label(axis), {axis: white(clock)}, np.ones(1), {axis: np.zeros((len(white.rows), 1))}))
        raw_inertial[axis], inertial[axis] = _raw(problem, axis, cutoffs[axis], white, columns), white(columns)
    rank = problem.factor.shape[1]
    gram = sum((x.T @ x for x in inertial.values()), np.zeros((rank, rank)))
    values, vectors = np.linalg.eigh(gram)
    directions = vectors[:, values > TOLD]
    if directions.shape[1]:
        blocks = {axis: x @ directions for axis, x in inertial.items()}
        raw = {axis: x @ directions for axis, x in raw_inertial.items()}
        base.append(Term(INERTIAL, blocks, np.ones(directions.shape[1]), raw))
    return White(problem, whiteners, targets, base, directions, cutoffs)


def base_columns(problem: Problem, axis: int, cutoffs: Cutoffs) -> tuple[np.ndarray, np.ndarray]:
    """Return the columns of the drive (N_train, 4) and of the inertial directions (N_train, r) of one axis."""
    friction = problem.friction_columns(problem.train_state, axis, velocities(problem, axis, cutoffs))
    friction[:, 3:] = _limited(problem, cutoffs, friction[:, 3:])
    return friction, limited_inertial(problem, axis, cutoffs.torque)


def _limited(problem: Problem, cutoffs: Cutoffs, columns: np.ndarray) -> np.ndarray:
    return ended(problem, columns, cutoffs.torque) if np.isfinite(cutoffs.torque) else columns


def _raw(problem: Problem, axis: int, cutoffs: Cutoffs, white: Whitener, columns: np.ndarray) -> np.ndarray:
    if not np.isfinite(cutoffs.judged):
        return columns[white.rows]
    record, rate = np.asarray(problem.train_state.record), problem.measured.rate
    return limit(bridged(columns, problem.usable[:, axis], record), record, cutoffs.judged, rate)[white.rows]


def bridged(columns: np.ndarray, usable: np.ndarray, record: np.ndarray) -> np.ndarray:
    """Return columns (N,) or (N, k) with straight lines, within each record, over samples that are not `usable`.

    What stands there cannot be judged, a step of friction at a reversal above all: a filter would carry it to its
    neighbours.
    """
    result = np.array(columns, dtype=float)
    for piece in runs(record):
        known = np.flatnonzero(usable[piece])
        if 0 < len(known) < piece.stop - piece.start:
            values = result[piece][known]
            place = np.interp(np.arange(piece.stop - piece.start), known, np.arange(len(known)))
            before = place.astype(int)
            after = np.minimum(before + 1, len(known) - 1)
            share = (place - before).reshape(-1, *[1] * (columns.ndim - 1))
            result[piece] = (1 - share) * values[before] + share * values[after]
    return result


def link_mass_blocks(white: White, link: int) -> dict[int, np.ndarray]:
    """Return axis -> whitened column (m, 1) for the mass and inertia of `link` growing by 100 %."""
    problem = white.problem
    torque = problem.link_mass_torque(link)
    return {
        axis: white.columns(axis, white.limited(axis, torque[:, [axis]]))
        for axis in problem.judged
        if np.any(torque[:, axis])
    }
