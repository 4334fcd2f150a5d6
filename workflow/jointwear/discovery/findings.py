"""From estimates to the entries of the verdict: named effects, wrong parameters, what is left, what cannot be told."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.effect_estimates import Estimate
from jointwear.discovery.estimates.outcome import Outcome, Refusal, Unexplained
from jointwear.discovery.model.final_model import Final
from jointwear.discovery.model.link_masses import moving_bodies
from jointwear.discovery.model.noise_floor import floor_with_names
from jointwear.discovery.model.retuned import ended_on_bounds, retuned_parameters, stands_in
from jointwear.discovery.model.told_fallbacks import told_fallbacks
from jointwear.discovery.noise.bursts import rings
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate
from jointwear.discovery.problem.identifiability import Visible
from jointwear.discovery.problem.problem import Problem
from jointwear.discovery.problem.restrictions import beyond_the_temperature, beyond_the_time
from jointwear.discovery.verdict import (
    NONE,
    AboveNoise,
    BuildsUp,
    Gap,
    Lost,
    MissedGate,
    NamedEffect,
    NotIdentifiable,
    NotTried,
    PeakTorque,
    Quantity,
    Regime,
    Structure,
    Suspect,
    Verdict,
)
from jointwear.effects import State, get_effect, library
from jointwear.files.json_values import six_digits
from jointwear.files.wording import count, numbered

#: Entries of lists that a reader looks through: unexplained structure, candidates that came close.
LONGEST_LIST = 12
#: Times the held-out error of the augmented model above which an estimate of noise holds what the model lacked: between
#: two records noise of a sensor does not differ as much.
ABOVE_ALL = 2.0
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

    Parameters
    ----------
    seen : what the motion can show. torques : (m, n) [N m] of the nominal, retuned and augmented model.
    """
    outcome, problem = final.outcome, final.outcome.problem
    effects = sorted(
        (_named_effect(final, e) for e in (*final.estimates, *final.unwritten)), key=lambda e: -e.evidence_nats
    )
    retuned = [] if outcome.white is None else retuned_parameters(final)
    left = listed(outcome.unexplained)
    if left:
        word = "unknown"
    elif effects:
        word = "effects"
    else:
        word = "retuned" if retuned else NONE
    gap, unsure = _with_told_floor(measure_gap(problem, torques, floor_with_names(final)), problem.too_coarse)
    gap, in_bursts = _without_bursts(problem, torques["augmented"], gap, {u.axis for u in left})
    untold = tuple(sorted({*(axis + 1 for axis in problem.too_coarse), *unsure, *in_bursts}))
    above = _above_the_noise(gap, problem.settings.near_the_floor)
    apart = _only_held_out(problem, above, gap) if word in (NONE, "retuned") else []
    open_still = _suspected(final, above) if not left else []
    word = "unknown" if apart or open_still or in_bursts or problem.too_coarse else word
    written = [e.named.candidate for e in final.estimates]
    return Verdict(
        dataset=name,
        verdict=word,
        effects=tuple(effects),
        retuned=tuple(retuned),
        unexplained=tuple(
            Structure(
                axis=u.axis + 1,
                argument=u.argument,
                range=(six_digits(u.low), six_digits(u.high)),
                unit=u.unit,
                p_value=six_digits(u.p_value),
                share_of_range=round(u.share, 3),
            )
            for u in left
        ),
        suspects=tuple(_suspects(final)),
        gap=gap,
        to_the_noise=not untold and _to_the_noise(gap, problem.settings.near_the_floor),
        lost=tuple(_lost(outcome)),
        not_tried=tuple(_not_tried(outcome)),
        not_identifiable=tuple(_not_identifiable(effects, seen, problem.settings.visible)),
        fallbacks=told_fallbacks(final, gap),
        misfits=(*final.misfits, *ended_on_bounds(retuned)),
        restrictions=(
            *restrictions,
            *_noise_too_high(gap, unsure),
            *_noise_in_bursts(in_bursts),
            *_held_out_alone(apart, above),
            *_without_a_name(open_still, above),
            *_alike_in_time(final),
            *beyond_the_time(problem, written),
            *beyond_the_temperature(problem, written),
            *stands_in(retuned, {*(u.axis for u in left), *(axis - 1 for axis in in_bursts)}),
        ),
        above_the_noise=above,
        noise_untold=untold,
        rings=tuple(in_bursts),
        bodies=moving_bodies(retuned, problem.settings),
        builds_up=tuple(BuildsUp(a + 1, way.form, six_digits(way.speed)) for a, way in problem.building_up.items()),
        filter_cutoff_hz=tuple(six_digits(c) if np.isfinite(c) else None for c in problem.measured.cutoff),
    )


def listed(unexplained: list[Unexplained]) -> list[Unexplained]:
    """Return the strongest structure, that of every axis in it: what a list leaves out reads as if there were none."""
    first: dict[int, Unexplained] = {}
    for u in unexplained:
        first.setdefault(u.axis, u)
    others = [u for u in unexplained if u is not first[u.axis]]
    chosen = [*first.values(), *others][: max(LONGEST_LIST, len(first))]
    return sorted(chosen, key=lambda u: -u.nats)


def measure_gap(problem: Problem, torques: Mapping[str, np.ndarray], floor: Iterable[float | None]) -> Gap:
    """Return the RMS error of every model over moving samples of the test trajectories, with the noise floor.

    Parameters
    ----------
    torques : model -> torque (m, n) [N m]. floor : RMS of the noise [N m] of each axis, None where it is not judged.
    """
    usable = problem.measured.usable & problem.test[:, None]

    def errors(kind: str) -> tuple[float | None, ...]:
        square = (problem.measured.torque - torques[kind]) ** 2
        return tuple(
            six_digits(np.sqrt(np.mean(square[usable[:, j], j]))) if usable[:, j].any() else None
            for j in range(square.shape[1])
        )

    return Gap(errors("nominal"), errors("retuned"), errors("augmented"), tuple(map(_rounded, floor)))


def _with_told_floor(gap: Gap, coarse: Collection[int]) -> tuple[Gap, dict[int, float]]:
    """Return the gap with a noise floor that is told, and of which axes, from 1, an estimate [N m] was too high.

    None is told of axes too coarse in time (`coarse`, 0-based). Noise is no more than what the augmented model leaves
    of motion that it has not seen.
    """
    floor, unsure = list(gap.noise_floor), {}
    for axis, (left, noise) in enumerate(zip(gap.augmented, gap.noise_floor, strict=True)):
        if axis in coarse:
            floor[axis] = None
        elif left is not None and noise is not None and noise > ABOVE_ALL * left:
            floor[axis], unsure[axis + 1] = left, noise
    return replace(gap, noise_floor=tuple(floor)), unsure


def _noise_too_high(gap: Gap, unsure: Mapping[int, float]) -> Iterable[str]:
    """Yield in words of which axes the noise was estimated higher than all that is left of the held-out motion."""
    for axis, noise in unsure.items():
        yield (
            f"joint {axis}: noise was estimated as {noise:.2g} N m, while the augmented model leaves "
            f"{gap.augmented[axis - 1]:.2g} N m of the held-out motion: the estimate holds what the model lacked, or "
            "noise of the training trajectories alone, and what is smaller may be missed; log at a higher rate"
        )


def _without_bursts(
    problem: Problem, model: np.ndarray, gap: Gap, explained: Collection[int]
) -> tuple[Gap, dict[int, float]]:
    """Return the gap with a floor that no joint rings above, and of which axes, from 1, the noise [N m] was ringing.

    Parameters
    ----------
    model : (m, n) [N m] torque of the augmented model. explained : axes, from 0, of which it is said already that more
        than noise is left.
    """
    measured, floor, ringing = problem.measured, list(gap.noise_floor), {}
    for axis, noise in enumerate(gap.noise_floor):
        if noise is None or axis in explained:
            continue
        torque, usable = measured.torque[:, axis], measured.usable[:, axis]
        if rings(noise, torque - model[:, axis], torque, usable, measured.trajectory):
            left = gap.augmented[axis]
            floor[axis], ringing[axis + 1] = noise if left is None else min(noise, left), noise
    return replace(gap, noise_floor=tuple(floor)), ringing


def _noise_in_bursts(ringing: Mapping[int, float]) -> Iterable[str]:
    """Yield in words of which axes what was taken for noise is ringing."""
    for axis, noise in ringing.items():
        yield (
            f"joint {axis}: what looks like noise there, {noise:.2g} N m, hides the torque and comes in bursts, which "
            "no sensor's noise does; lost motion in the gear behind the encoder of the motor rings like "
            "that, or a resonance that motion excites, or the torque signal is poor: what the model lacks there cannot "
            "be told; compare motor and link with a second encoder, or look at the raw torque"
        )


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


def _to_the_noise(gap: Gap, margin: float) -> bool:
    pairs = [(a, f) for a, f in zip(gap.augmented, gap.noise_floor, strict=True) if a is not None and f is not None]
    return bool(pairs) and not _above_the_noise(gap, margin)


def _above_the_noise(gap: Gap, margin: float) -> tuple[AboveNoise, ...]:
    """Return the axes on which the held-out error stays above the noise floor by more than `margin`, and the ratio."""
    return tuple(
        AboveNoise(axis, float(f"{a / max(f, 1e-300):.4g}"))
        for axis, (a, f) in enumerate(zip(gap.augmented, gap.noise_floor, strict=True), start=1)
        if a is not None and f is not None and a > (1 + margin) * f
    )


def _only_held_out(problem: Problem, above: Sequence[AboveNoise], gap: Gap) -> list[int]:
    """Return the axes, from 1, whose held-out error noise does not reach, though training shows nothing without a name.

    It matters to a simulation too: below `smallest_share` of the torque even exact models differ.
    """
    result = []
    for axis, ratio in ((a.axis, a.ratio) for a in above):
        size = np.sqrt(np.nanmean(problem.measured.torque[problem.test, axis - 1] ** 2))
        beyond = np.sqrt(gap.augmented[axis - 1] ** 2 - gap.noise_floor[axis - 1] ** 2)
        if ratio > problem.settings.noise_sigmas and beyond > problem.settings.smallest_share * size:
            result.append(axis)
    return result


def _held_out_alone(axes: Sequence[int], above: Sequence[AboveNoise]) -> list[str]:
    """Say which axes disagree with the model in the test trajectories alone, in one sentence or none."""
    if not axes:
        return []
    words = (
        f"{numbered('joint', axes)}: {_disagreement(axes, above)}, the training trajectories do not; look whether the "
        "records of the test trajectories are sound (torque and motion of one record, sign, unit, the same robot), or "
        "whether something acts there alone"
    )
    return [words]


def _suspected(final: Final, above: Sequence[AboveNoise]) -> list[int]:
    """Return the axes, from 1, on which an effect is suspected and the held-out error stays above the noise.

    What it stood for is there, in training and in the test trajectories, and has no name.
    """
    axes = {one.candidate.axis for one, _ in final.suspects}
    return [a.axis for a in above if None in axes or a.axis - 1 in axes]


def _without_a_name(axes: Sequence[int], above: Sequence[AboveNoise]) -> list[str]:
    """Say which axes lack something for which an effect is only suspected, in one sentence or none."""
    if not axes:
        return []
    words = (
        f"{numbered('joint', axes)}: what the model lacks is like a suspected effect, but none of the library describes"
        f" it; {_disagreement(axes, above)}"
    )
    return [words]


def _disagreement(axes: Sequence[int], above: Sequence[AboveNoise]) -> str:
    """Say by how much the test trajectories of some axes, from 1, disagree with the model."""
    largest = max(a.ratio for a in above if a.axis in axes)
    return f"the test trajectories disagree with the model by up to {largest:.2g} times the noise"


def _places(candidate: Candidate) -> dict[str, int | None]:
    return {
        "axis": None if candidate.axis is None else candidate.axis + 1,
        "source_axis": None if candidate.source is None else candidate.source + 1,
    }


def _lost(outcome: Outcome) -> Iterable[Lost]:
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
        form_corrected=e.form is not None,
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
