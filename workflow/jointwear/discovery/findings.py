"""From estimates to the entries of the verdict: named effects, wrong parameters, what is left, what cannot be told."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from jointwear.discovery.estimates.effect_estimates import Estimate
from jointwear.discovery.estimates.outcome import Outcome, Refusal, Unexplained
from jointwear.discovery.held_out import HeldOut, held_out
from jointwear.discovery.model.final_model import Final
from jointwear.discovery.model.link_masses import moving_bodies
from jointwear.discovery.model.retuned import ended_on_bounds, retuned_parameters, stands_in
from jointwear.discovery.model.shared_friction import shared_friction, undecided_friction
from jointwear.discovery.model.told_fallbacks import told_fallbacks
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate
from jointwear.discovery.problem.identifiability import Visible
from jointwear.discovery.problem.restrictions import beyond_the_temperature, beyond_the_time
from jointwear.discovery.verdict import (
    EFFECTS,
    NONE,
    RETUNED,
    UNKNOWN,
    BuildsUp,
    Lost,
    MissedGate,
    NamedEffect,
    NotIdentifiable,
    NotTried,
    PeakTorque,
    Quantity,
    Regime,
    Retuned,
    Structure,
    Suspect,
    Verdict,
)
from jointwear.effects import State, get_effect, library
from jointwear.files.json_values import six_digits
from jointwear.files.wording import count

#: Entries of lists that a reader looks through: unexplained structure, candidates that came close.
LONGEST_LIST = 12
#: Joints, and share of those that can be judged, that answer late from which it may be the clock of the log.
FEWEST_ALIKE, MOST_ALIKE = 3, 2 / 3


def make_verdict(
    name: str,
    final: Final,
    seen: list[Visible],
    torques: Mapping[str, np.ndarray],
    restrictions: list[str],
) -> Verdict:
    """Put names, parameters, what is left and what cannot be told into one verdict.

    Its word is that of the training trajectories (:func:`in_training`), unless the test trajectories contradict it.

    Parameters
    ----------
    seen : what the motion can show. torques : (m, n) [N m] of the nominal, retuned and augmented model.
    """
    outcome, problem = final.outcome, final.outcome.problem
    held = held_out(final, torques)
    effects = sorted(
        (_named_effect(final, e) for e in (*final.estimates, *final.unwritten)), key=lambda e: -e.evidence_nats
    )
    retuned = _retuned(final)
    untold = tuple(sorted({*(axis + 1 for axis in problem.too_coarse), *held.unsure, *held.ringing}))
    return Verdict(
        dataset=name,
        verdict=UNKNOWN if held.contradicts else in_training(final),
        effects=tuple(effects),
        retuned=tuple(retuned),
        unexplained=tuple(map(_structure, listed(outcome.unexplained))),
        suspects=tuple(_suspects(final)),
        gap=held.gap,
        to_the_noise=not untold and held.to_the_noise,
        lost=tuple(lost_candidates(outcome)),
        not_tried=tuple(_not_tried(outcome)),
        not_identifiable=tuple(_not_identifiable(effects, seen, problem.settings.visible)),
        fallbacks=told_fallbacks(final, held.gap),
        misfits=(*final.misfits, *ended_on_bounds(retuned)),
        restrictions=(*restrictions, *held.in_words(), *_in_words(final, retuned, held)),
        above_the_noise=held.above,
        noise_untold=untold,
        rings=tuple(held.ringing),
        bodies=moving_bodies(retuned, problem.settings),
        builds_up=tuple(BuildsUp(a + 1, way.form, six_digits(way.speed)) for a, way in problem.building_up.items()),
        filter_cutoff_hz=tuple(six_digits(c) if np.isfinite(c) else None for c in problem.measured.cutoff),
    )


def in_training(final: Final) -> str:
    """Return the word of a verdict as the training trajectories alone have it: none, retuned, effects or unknown."""
    if final.outcome.unexplained or final.outcome.problem.too_coarse:
        return UNKNOWN
    if final.estimates or final.unwritten:
        return EFFECTS
    return RETUNED if _retuned(final) else NONE


def _retuned(final: Final) -> list[Retuned]:
    return [] if final.outcome.white is None else retuned_parameters(final)


def _in_words(final: Final, retuned: list[Retuned], held: HeldOut) -> Iterable[str]:
    """Yield what else a reader has to know of the log, and of what stands in for something else."""
    problem, written = final.outcome.problem, [e.named.candidate for e in final.estimates]
    left = {u.axis for u in final.outcome.unexplained}
    yield from _alike_in_time(final)
    yield from beyond_the_time(problem, written)
    yield from beyond_the_temperature(problem, written)
    yield from shared_friction(final)
    yield from undecided_friction(final, retuned)
    yield from stands_in(retuned, left | {axis - 1 for axis in held.ringing})


def _structure(u: Unexplained) -> Structure:
    return Structure(
        axis=u.axis + 1,
        argument=u.argument,
        range=(six_digits(u.low), six_digits(u.high)),
        unit=u.unit,
        p_value=six_digits(u.p_value),
        share_of_range=round(u.share, 3),
    )


def listed(unexplained: list[Unexplained]) -> list[Unexplained]:
    """Return the strongest structure, that of every axis in it: what a list leaves out reads as if there were none."""
    first: dict[int, Unexplained] = {}
    for u in unexplained:
        first.setdefault(u.axis, u)
    others = [u for u in unexplained if u is not first[u.axis]]
    chosen = [*first.values(), *others][: max(LONGEST_LIST, len(first))]
    return sorted(chosen, key=lambda u: -u.nats)


def _alike_in_time(final: Final) -> Iterable[str]:
    """Yield in words that the torques of most joints are told at another time: a clock of the log does that."""
    found = [e.named.candidate for e in final.estimates]
    late = {c.axis for c in found if c.axis is not None and get_effect(c.effect).shifts(c.nonlinear)}
    if len(late) >= max(FEWEST_ALIKE, MOST_ALIKE * len(final.outcome.problem.judged)):
        yield (
            f"the torques of {count(len(late), 'joint')} belong to another time than the motion: one clock of the log, "
            "that of positions or of torques, does that as well as a delay of every drive"
        )


def _rounded(value: float | None) -> float | None:
    return None if value is None else six_digits(value)


def _places(candidate: Candidate) -> dict[str, int | None]:
    return {
        "axis": None if candidate.axis is None else candidate.axis + 1,
        "source_axis": None if candidate.source is None else candidate.source + 1,
    }


def lost_candidates(outcome: Outcome) -> Iterable[Lost]:
    """Yield the candidates that were refused, with the gates of their last refusals, strongest evidence first."""
    named = {n.candidate.key for n in outcome.named}
    gates: dict[tuple, dict[str, Refusal]] = {}
    for r in outcome.refusals:
        if r.candidate.effect != LINK_MASS and r.candidate.key not in named:
            gates.setdefault(r.candidate.key, {})[r.gate] = r
    found = sorted((list(missed.values()) for missed in gates.values()), key=lambda missed: -missed[0].evidence)
    for missed in found[:LONGEST_LIST]:
        listed = tuple(MissedGate(r.gate, six_digits(r.reached), six_digits(r.needed)) for r in missed)
        first = missed[0]
        yield Lost(
            first.candidate.effect,
            **_places(first.candidate),
            evidence_nats=six_digits(first.evidence),
            gate=listed[0].gate,
            reached=listed[0].reached,
            needed=listed[0].needed,
            gates=listed,
        )


def _suspects(final: Final) -> Iterable[Suspect]:
    for one, reason in final.suspects:
        yield Suspect(
            one.candidate.effect, **_places(one.candidate), evidence_nats=six_digits(one.evidence), reason=reason
        )


def _not_tried(outcome: Outcome) -> Iterable[NotTried]:
    """Yield what could not be tested, once where the reason is the same on every axis."""
    axes: dict[tuple[str, str], list[int | None]] = {}
    for (effect, axis), reason in outcome.not_tried.items():
        axes.setdefault((effect, reason), []).append(axis)
    for (effect, reason), found in axes.items():
        everywhere = set(outcome.problem.judged) <= set(found)
        for axis in [None] if everywhere or found == [None] else found:
            yield NotTried(effect, None if axis is None else axis + 1, reason)


def _named_effect(final: Final, e: Estimate) -> NamedEffect:
    candidate, named = e.named.candidate, e.named
    effect = get_effect(candidate.effect)
    units = {p.name: p.unit for p in effect.parameters}
    ties = [candidate.effect]
    for other in named.ties:
        if other.effect != LINK_MASS and other.effect not in ties:
            ties.append(other.effect)
    return NamedEffect(
        effect=candidate.effect,
        **_places(candidate),
        tie_set=tuple(ties),
        parameters={
            name: Quantity(six_digits(value), six_digits(e.std[name]) if name in e.std else None, units[name])
            for name, value in e.parameters.items()
        },
        regime=_regime(final, e),
        peak_torque=PeakTorque(
            six_digits(e.peak.value), six_digits(e.peak.low), six_digits(e.peak.high), _rounded(e.peak.beyond)
        ),
        evidence_nats=six_digits(named.evidence),
        probability=six_digits(named.probability),
        log_odds=six_digits(named.log_odds),
        cross_validated_gain=six_digits(named.cross_validated),
        lowers_error=six_digits(named.lowers_error),
        gain_share=six_digits(named.gain_share),
        structure_left=named.structure_left,
        repeated=_rounded(named.repeated),
        derived={
            d.name: Quantity(six_digits(value), None, d.unit)
            for d in effect.derived
            if (value := d.value(e.parameters)) is not None
        },
    )


def _argument(words: str, candidate: Candidate) -> str:
    return words if candidate.source is None else words.replace("the other axis", f"joint {candidate.source + 1}")


def argument_of(candidate: Candidate, state: State, axis: int) -> tuple[np.ndarray, str]:
    """Return what the torque of a candidate on `axis` depends on at every sample of a state (m,), and its unit."""
    return get_effect(candidate.effect).argument_of(state, axis, candidate.source, candidate.nonlinear)


def _regime(final: Final, e: Estimate) -> Regime:
    """Return the range of the effect's argument over the training samples that could be judged.

    That of an effect of the whole arm is told of the judged axis that travels farthest.
    """
    problem, candidate = final.outcome.problem, e.named.candidate
    state, axis = problem.train_state, candidate.axis
    if axis is None:
        axis = max(problem.judged, key=lambda j: np.ptp(state.position[problem.usable[:, j], j]))
    values, unit = argument_of(candidate, state, axis)
    values = values[problem.usable[:, axis]]
    return Regime(
        _argument(get_effect(candidate.effect).argument_in_words, candidate),
        (six_digits(values.min()), six_digits(values.max())),
        unit,
    )


def _not_identifiable(effects: list[NamedEffect], seen: list[Visible], needed: float) -> Iterable[NotIdentifiable]:
    for e in effects:
        for other in e.tie_set[1:]:
            yield NotIdentifiable(
                (e.effect, other), e.axis, "the data explain both equally well: this motion does not tell them apart"
            )
    best: dict[tuple, Visible] = {}
    for v in seen:
        key = (v.effect, v.axis)
        if key not in best or v.energy > best[key].energy:
            best[key] = v
    for (effect, place), v in best.items():
        axis = None if place is None else place + 1
        if v.energy < needed:
            yield NotIdentifiable(
                (effect,),
                axis,
                f"at {v.at} it would leave {v.energy:.3g} times the noise variance, less than {needed:.0f}",
            )
        elif v.left < needed:
            yield NotIdentifiable(
                (effect, v.rival),
                axis,
                f"once {get_effect(v.rival).phrase} is fitted, {v.left:.3g} noise variances are left of it, "
                f"less than {needed:.0f}",
            )
    for effect in library().values():
        if not effect.identifiable:
            yield NotIdentifiable((effect.identifier,), None, effect.reason)
