"""Names that would not stand on their own: something that has none, or another cause, could stand for them as well."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome, Unexplained
from jointwear.discovery.linear import Term, chi_square
from jointwear.discovery.problem.candidates import LINK_MASS, raw_columns
from jointwear.discovery.search.acceptance import of_timing, predictive
from jointwear.discovery.search.changing_size import changing
from jointwear.discovery.search.crossval import CrossValidated
from jointwear.discovery.search.early_torque import EARLY, early
from jointwear.discovery.search.encoder_wave import encoder_wave
from jointwear.discovery.search.explained import explained, explained_elsewhere
from jointwear.discovery.search.in_its_place import better_in_its_place
from jointwear.discovery.search.least_torque import rms
from jointwear.discovery.search.leftovers import LINE, fit_again, without_outliers
from jointwear.discovery.search.rocking import Swing, swing_beside, swing_terms, swings
from jointwear.discovery.search.steeper_wave import steeper_wave
from jointwear.discovery.search.windings import stiffens, wound_up_further_in
from jointwear.effects import get_effect
from jointwear.effects.state import record_slices
from jointwear.files.wording import digits_apart, numbered, significant

#: Share of the squared error beyond the noise from which an effect is more of what an axis lacks than all else
#: together: half, by what the word means.
MOST = 0.5
#: By how many nats a wave that grows with the square of something is ahead of one whose height does not, of what it is
#: the square, and what makes it.
_STEEPER_WAVES = (
    (encoder_wave, "speed", "an encoder that is off by a wave makes of a controller that follows it"),
    (steeper_wave, "torque", "an inductance that changes with the angle makes of a current"),
)


def settle(outcome: Outcome) -> None:
    """Fit the named effects again and test what they leave; names that do not stand beside it become suspects."""
    fit_again(outcome)
    if outcome.named:
        stand_alone(outcome)


def stand_alone(outcome: Outcome) -> None:
    """Turn names that something else could stand for as well into suspects.

    An effect of the whole arm is asked of structure where half of the axes that it moves stay unexplained. Changes
    `outcome`.
    """
    swing = swing_beside(outcome) if any(swings(n) for n in outcome.named) else None
    doubts = (
        _acts_on_two,
        _unsteady,
        _of_no_constant,
        _in_its_place,
        partial(_swings_along, swing),
        _wound_up,
        _early,
        shaken_alike,
        _beside_structure,
    )
    if _fallen(outcome, doubts):
        doubt_early_torque(outcome)


def doubt_early_torque(outcome: Outcome) -> None:
    """Turn torques that would have to be early into suspects where structure is left: a name that fell beside them had
    explained it. Changes `outcome`."""
    while _fallen(outcome, (_early,)):
        pass


def _fallen(outcome: Outcome, doubts: Sequence[Callable[[Outcome, Named], str | None]]) -> bool:
    """Turn the names that one of some doubts speaks against into suspects, and return whether there are any."""
    kept: list[Named] = []
    for one in outcome.named:
        reason = next((words for doubt in doubts if (words := doubt(outcome, one)) is not None), None)
        if reason is None:
            kept.append(one)
        else:
            outcome.suspects.append((one, reason))
    if len(kept) == len(outcome.named):
        return False
    outcome.named = kept
    fit_again(outcome)
    return True


def _early(outcome: Outcome, one: Named) -> str | None:
    """Say of a torque that is early (:func:`.early_torque.early`) that it stands beside no structure."""
    return EARLY if left_open(outcome, one) and early(outcome, one) else None


def _acts_on_two(outcome: Outcome, one: Named) -> str | None:
    """Say that another joint lacks what an effect says of its own (:func:`acts_elsewhere`)."""
    elsewhere = acts_elsewhere(outcome, one)
    return None if elsewhere is None else f"joint {elsewhere + 1} lacks the same torque, and this effect acts on one"


def _unsteady(outcome: Outcome, one: Named) -> str | None:
    """Say of an effect that is not the same at all times, or speeds, that it is not; `outcome` notes it."""
    steeper = [(nats, of, cause) for ask, of, cause in _STEEPER_WAVES if (nats := ask(outcome, one)) is not None]
    spread = None if steeper else changing(outcome, one)
    if not steeper and spread is None:
        return None
    outcome.unsteady.add(one.candidate.key)
    if steeper:
        nats, of, cause = max(steeper)
        return f"it grows with the square of the {of}, which explains {nats:.0f} nats more: so does what {cause}"
    return f"its size is not the same throughout the recordings, it varies by {100 * spread:.0f} % of its mean"


def _of_no_constant(outcome: Outcome, one: Named) -> str | None:
    """Say of a factor of all torque of an axis that it is none: what is left there goes with that torque.

    Other effects have forms that may be off; a constant has one. A reading that saturates is no constant.
    """
    axis, effect = one.candidate.axis, one.candidate.effect
    if effect == LINK_MASS or not get_effect(effect).of_drive:
        return None
    if not any(u.axis == axis and u.argument == get_effect(effect).argument for u in outcome.unexplained):
        return None
    return "it is not the same at all torques, over which structure is left"


def _in_its_place(outcome: Outcome, one: Named) -> str | None:
    """Say that structure without a name explains more in the place of an effect, on any axis."""
    instead = better_in_its_place(outcome, one)
    if instead is None:
        return None
    basis, axis, lead = instead
    return f"structure over {basis.argument} of joint {axis + 1} explains {lead:.0f} nats more in its place"


def _swings_along(swing: Swing | None, outcome: Outcome, one: Named) -> str | None:
    """Say that an elastic gear predicts nothing beside a base that swings."""
    if swing is None or not swings(one):
        return None
    if not predictive(outcome.white, [*outcome.terms_beside(one), *swing_terms(outcome.white, swing)], one)[1]:
        return None
    return f"a base that swings with the motion, at {swing.frequency:.2g} Hz, could stand for it as well"


def _wound_up(outcome: Outcome, one: Named) -> str | None:
    """Say that the stiffness of a gear changes, or that the wind-up of a joint further in could be a spring or gear."""
    change = stiffens(outcome, one)
    if change is not None:
        return f"its stiffness is not the same at all loads, it changes by {100 * change:.0f} % of itself"
    inner = wound_up_further_in(outcome, one)
    if inner is not None:
        return f"joint {inner + 1} stays unexplained further in, and its wind-up could stand for it as well"
    return None


def shaken_alike(outcome: Outcome, one: Named) -> str | None:
    """Say of an effect of timing that waves over time, which shake other joints, explain most of it.

    A spindle that is out of balance shakes all joints at its own pace, many of them by less than a line that shows.
    What a gear or a delay does of its own depends on no such waves.
    """
    lines = [u for u in outcome.unexplained if u.argument == LINE and u.axis != one.candidate.axis]
    if len(lines) < 2 or one.candidate.axis is None or not _shaken(one):
        return None
    white, others = outcome.white, outcome.terms_beside(one)
    waves = [t for axis in sorted(one.term.blocks) for t in _waves(outcome, axis, lines)]
    before, beside = (white.evidence_of(one.terms, terms) for terms in (others, [*others, *waves]))
    if beside > MOST * before:
        return None
    where = numbered("joint", sorted(u.axis + 1 for u in lines))
    return f"waves over time, as shake {where}, explain {100 * (1 - max(beside, 0.0) / before):.0f} % of it"


def _beside_structure(outcome: Outcome, one: Named) -> str | None:
    """Say of an effect on axes that stay unexplained why it does not stand on its own there.

    It does where it is worth more than any structure that is left, and is nearly all of what its axes lacked
    (:func:`nearly_all`), or still passes the gates of prediction with all the unexplained structure of its axes in the
    model; one of timing has to be most of it too.
    """
    axes = left_open(outcome, one)
    if not axes:
        return None
    where = numbered("joint", [a + 1 for a in axes])
    most = max((u for u in outcome.unexplained if u.axis in axes), key=lambda u: u.nats)
    if most.nats > one.evidence:
        return f"{most.nats:.0f} nats over {most.argument} are left on {where}, more than it explains"
    others = outcome.terms_beside(one)
    found, failed = predictive(outcome.white, others, one)
    if failed:
        gate, reached, needed = failed[0].gate, failed[0].reached, failed[0].needed
        digits = digits_apart(reached, needed)
        return f"{gate}: {significant(reached, digits)}, needed {significant(needed, digits)}"
    share = _share(outcome, others, one, found)
    if share <= MOST and _shaken(one):
        # The bases of structure hold no rates of torque: beside them it would pass whatever it stands for.
        return f"explains {100 * share:.0f} % of what {where} lacks, and structure is left there"
    if not _shaken(one) and nearly_all(outcome, others, one, share, most.nats):
        return None
    if predictive(outcome.white, [*others, *_structures(outcome, one, axes)], one)[1]:
        return f"the structure that is left on {where} could stand for it as well"
    return None


def _share(outcome: Outcome, others: list[Term], one: Named, found: CrossValidated) -> float:
    """Return the share of what its axes lack that an effect explains, of which `found` says what it predicts.

    A torque that is recorded late turns late too: beside reversals samples are left out by when the joint turns, not
    by when the log says so, and the few that lie between must not decide.
    """
    white = outcome.white
    if one.candidate.effect != LINK_MASS and get_effect(one.candidate.effect).late:
        white = replace(white, targets=without_outliers(outcome.fit, outcome.problem.settings.noise_sigmas).targets)
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
    if not _shaken(one):
        return terms
    lines = [u for u in outcome.unexplained if u.argument == LINE]
    return terms + [t for a in axes for t in _waves(outcome, a, [u for u in lines if u.axis == a])]


def _waves(outcome: Outcome, axis: int, lines: Sequence[Unexplained]) -> list[Term]:
    """Return terms for lines over time on one axis: waves of each record as close as it can tell apart."""
    problem, white = outcome.problem, outcome.white
    state = problem.train_state
    columns = []
    # Lines of several joints at one frequency are the same waves.
    for line in {(u.low, u.high): u for u in lines}.values():
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
