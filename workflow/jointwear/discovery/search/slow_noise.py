"""Noise that is slower than the saturated fit can tell, asked anew beside what was found.

A fit with 240 columns leaves a fifth of the noise below 1 Hz, of records of 15 s a handful of waves: how dense slow
noise is beside white noise they do not tell. Where structure without a name or a weak name rests on that, the noise is
looked at beside a small fit: the base regression, what was named, and the basis that describes an axis best. If what is
left is denser below 2 Hz than the noise was taken to be, it is noise, up to what a sensor's may be, and the search is
run again. Where most joints have more than that, in a log whose rate is so low that any noise forgets within few
samples, it is the noise of that log. In others a wind has it on all joints too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Outcome, Unexplained
from jointwear.discovery.linear import Fit, least_nats
from jointwear.discovery.noise.noise import Whitener, highest_order, simulate, whitenable
from jointwear.discovery.noise.noise_spectrum import (
    CELLS,
    DRAWS,
    EDGES,
    POINTS,
    band_freedom,
    band_power,
    most_of_noise,
    of_density,
    quick_band,
    reddest_noise,
    slowest_pole,
    steadied,
)
from jointwear.discovery.problem.whitening import White, whiten
from jointwear.discovery.search.given_up import telling_names_given_up
from jointwear.discovery.search.leftovers import LINE
from jointwear.discovery.search.standing_alone import structure_terms
from jointwear.discovery.search.tolerance import with_tolerances

#: Gate that a name misses where slow noise stands for it.
GATE = "nats beside slow noise"
#: How often the search is run again at most: each time less is held beside the noise.
ROUNDS = 3
#: Price of an order of the noise model, none: slow noise beside white noise has a long tail of small coefficients,
#: which say little of the next sample and much of what is slow.
PRICE = 0.0
#: Samples within which noise forgets in a log of so low a rate that slow noise of most axes is the noise of the log.
FEW_SAMPLES = 16


def beside_slow_noise(white: White, ask: Callable[[White], Outcome]) -> Outcome:
    """Return what `ask` finds in whitened data, asked again for as long as slow noise may stand for some of it.

    Slow noise stands for structure and weak names: where a name of `weak_nats` would go with them it is no explanation.
    Nor is it where an effect whose size was seen to change would have a name: that size is no more constant beside it.
    """
    outcome = ask(white)
    weak_nats = white.problem.settings.weak_nats
    for _ in range(ROUNDS):
        slower = slower_noise(outcome)
        if slower is None:
            break
        again = ask(whiten(outcome.problem, slower))
        strong = {n.candidate.key for n in outcome.named if n.evidence >= weak_nats}
        named = {n.candidate.key for n in again.named}
        if not strong <= named or outcome.unsteady & named:
            break
        outcome = telling_names_given_up(outcome, again, GATE)
    return outcome


def slower_noise(outcome: Outcome) -> list[Whitener | None] | None:
    """Return the noise models with more slow noise on the axes where it may stand for what was found, or None for none.

    Asked are axes with structure and those of names of less than `weak_nats`. What swings at one frequency is no
    sensor's noise: an axis on which a line over time is nearly all of the structure is left as it is, but in a log
    whose noise is slow: what is slow swings at some frequency in every record.
    """
    white, settings = outcome.white, outcome.problem.settings
    weak = [n for n in outcome.named if n.evidence < settings.weak_nats]
    # Of the structure of an axis only the strongest is held: many bases together take slow noise off again.
    strongest = {u.axis: u for u in sorted(outcome.unexplained, key=lambda u: u.nats)}
    lines = [u for u in outcome.unexplained if u.argument == LINE]
    asked = strongest.keys() | {axis for n in weak for axis in n.term.blocks}
    # In a log of a higher rate what forgets so slowly may be a wind.
    told = white.problem.measured.rate * assumed.longest_memory() <= FEW_SAMPLES
    swings = {u.axis for u in lines if u.nats > settings.nearly_all * strongest[u.axis].nats}
    if not told:
        asked -= swings
    if not asked:
        return None
    beside = replace(outcome, unexplained=list(strongest.values()))
    terms = [*with_tolerances(white, outcome.named), *white.attenuation]
    fit = white.fit(terms + [t for axis in sorted(strongest) for t in structure_terms(beside, axis)])
    dense, of_log = _densities(white, fit, white.problem.judged if told else sorted(asked), told)
    if not of_log:
        asked -= swings
    whiteners = list(white.whiteners)
    for axis in sorted(asked):
        found, times = _slower(white, axis, dense[axis])
        # A chi-square of that much more noise is that much smaller. Before the price of complexity and search `accept`
        # asks for twice as many nats.
        own = [times_needed(white, u) for u in outcome.unexplained if u.axis == axis]
        stands = [max(own)] if own else []
        over = [n.evidence - settings.accept for n in weak if axis in n.term.blocks]
        stands += [1.0 + 0.5 * nats / settings.accept for nats in over]
        if min(stands) < times:
            whiteners[axis] = found
    return whiteners if any(a is not b for a, b in zip(whiteners, white.whiteners, strict=True)) else None


def times_needed(white: White, structure: Unexplained) -> float:
    """Return how many times as dense as it is taken to be the noise has to be for it to stand for structure."""
    sure = white.problem.settings.unexplained_p
    if not structure.freedom:
        # Of the power of one wave noise reaches more with a probability that falls exponentially.
        return float(np.log(structure.p_value) / np.log(sure))
    most = least_nats(sure, structure.freedom, len(white.targets[structure.axis]))
    return (2.0 * structure.nats + structure.freedom) / (2.0 * most + structure.freedom)


def _densities(white: White, fit: Fit, axes: Sequence[int], told: bool) -> tuple[dict[int, np.ndarray], bool]:
    """Return the density (k,) of the noise of axes with the slow noise that a fit leaves, up to a sensor's.

    And whether most of them have more of it than that, where that is `told` by a log. Then noise may forget as slowly
    as any, and as the axes have it in the middle each has it at least: beside the structure that is held on an axis
    little of it is left there.
    """
    rate = white.problem.measured.rate
    frequency = np.linspace(0.0, 0.5 * rate, POINTS + 1)
    models = {axis: white.whiteners[axis].density(frequency, rate) for axis in axes}
    dense = {axis: model * _louder(white, fit, axis) for axis, model in models.items()}
    most = {axis: most_of_noise(model, frequency) for axis, model in models.items()}
    if not told or 2 * sum(np.any(dense[axis] > most[axis]) for axis in models) <= len(models):
        return {axis: np.minimum(dense[axis], most[axis]) for axis in models}, False
    slow = frequency < quick_band()[0]
    reddest = {axis: reddest_noise(model, frequency, rate) for axis, model in models.items()}
    alike = np.median([dense[axis] / reddest[axis] for axis in models], axis=0)
    for axis, model in reddest.items():
        dense[axis][slow] = np.minimum(np.maximum(dense[axis], alike * model), model)[slow]
    return dense, True


def _louder(white: White, fit: Fit, axis: int) -> np.ndarray:
    """Return how many times as dense as in the noise model of one axis the slow noise is that a fit leaves (k,)."""
    problem, model = white.problem, white.whiteners[axis]
    rate, label, rows = problem.measured.rate, problem.measured.trajectory[problem.train], model.rows
    frequency = np.linspace(0.0, 0.5 * rate, POINTS + 1)
    rng = np.random.default_rng(np.random.SeedSequence([9, len(model.lags)]))
    drawn = model(simulate(model, label, DRAWS, rng))
    design, index = fit.design[axis], fit.columns[axis]
    left = drawn - design @ (fit.covariance[np.ix_(index, index)] @ (design.T @ drawn))
    whole, kept, seen = (band_power(x, rows, label) for x in (drawn, left, fit.residual[axis][:, None]))
    freedom = band_freedom(rows, label) * np.minimum(kept / whole, 1.0)
    known = (kept > assumed.NOISE_LEFT * whole) & (freedom > 0.0)
    if not known.any():
        return np.ones(len(frequency))
    centres, freedom = (0.5 * (EDGES[:-1] + EDGES[1:]) * 0.5 * rate / CELLS)[known], freedom[known]
    ratio = np.log(np.maximum(seen, 1e-9) / kept)[known]
    # Noise of one pole changes fourfold in an octave.
    ratio = steadied(ratio, 2.0 / freedom, np.log(4.0) ** 2 * np.diff(np.log2(centres)))
    # Above, the saturated fit leaves enough of the noise to tell.
    quick = quick_band()[0]
    slow = np.clip((quick - frequency) / (quick - assumed.slow()), 0.0, 1.0)
    return np.exp(slow * np.interp(frequency, centres, ratio))


def _slower(white: White, axis: int, dense: np.ndarray) -> tuple[Whitener, float]:
    """Return the noise model of one axis of a density (k,), and how many times as dense as before slow noise is."""
    problem, model = white.problem, white.whiteners[axis]
    rate, label = problem.measured.rate, problem.measured.trajectory[problem.train]
    frequency = np.linspace(0.0, 0.5 * rate, POINTS + 1)
    density = model.density(frequency, rate)
    radius = slowest_pole(rate)
    usable = problem.usable[:, axis]
    highest = highest_order(usable, label)
    found = of_density(np.maximum(density, dense), rate, highest, len(model.rows), radius, PRICE)
    times = float(np.max((found.density(frequency, rate) / density)[frequency < assumed.slow()]))
    rows = whitenable(usable, label, len(found.lags))
    return replace(model, rows=rows, lags=found.lags, sigma=found.sigma), times
