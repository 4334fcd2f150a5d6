"""The 95 % interval of the largest torque of an effect on the held-out motion: a posterior over everything open.

An effect is a coefficient times a form. The coefficient is confounded with drive parameters, the form is known by its
textbook curve only, and curves that the recordings do not tell apart differ on other motion. So the torque is drawn
from the posterior of a mixture: nonlinear parameters over the range that the data leave, each with the evidence that
it has; the bends of the form, where it may bend; the coefficients jointly with the parameters of the nominal model,
under the likely errors of those (:mod:`jointwear.discovery.estimates.base`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from jointwear.discovery.estimates.curvature import Spreads
from jointwear.discovery.estimates.forms import Form, companion, form_of
from jointwear.discovery.estimates.references import BEYOND
from jointwear.discovery.estimates.scan import possible
from jointwear.discovery.linear import Fit, Term, gain
from jointwear.discovery.problem.candidates import Candidate, prior_std
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.settings import Settings
from jointwear.effects import Effect, State, get_effect

DRAWS = 400
#: Steps [standard deviations] at which a nonlinear parameter is tried, for an effect with one of them and with more.
STEPS_OF_ONE, STEPS_OF_MANY = np.linspace(-2.5, 2.5, 11), np.linspace(-2.0, 2.0, 5)
#: How many places are tried at which an effect may vanish, where that may be anywhere.
ZEROS = 13
#: Share of the largest carrier of an effect below which a sample says nothing of its argument but rounding.
STILL = 0.01


@dataclass(frozen=True)
class Shape:
    """One possibility for the columns of an effect: a candidate, the zero of its argument, and whose motion it is.

    Attributes
    ----------
    zero : value of each column, over its carrier, where the effect vanishes, or None where its form says so.
    drive : of a drive that turns with two axes: "" for the columns of a robot file, in which what depends on the
        motion of the axis alone is a part of its own parameters; "other" for the whole friction and inertia of the
        drive of the other axis, which this axis drags along; "own" for what turning with the other axis changes in
        the friction of the drive of this axis.
    """

    candidate: Candidate
    zero: np.ndarray | None = None
    drive: str = ""

    def columns(self, state: State) -> np.ndarray:
        """Return the columns (m, k) on ordered samples."""
        candidate = self.candidate
        effect, nonlinear = get_effect(candidate.effect), candidate.nonlinear
        columns = effect.columns(state, candidate.axis, candidate.source, nonlinear)
        if self.zero is not None:
            carrier, _ = effect.shape(state, candidate.axis, nonlinear)
            return columns - carrier[:, None] * self.zero
        if self.drive == "other":
            share = nonlinear["own"] / nonlinear["other"]
            own = np.stack([state.velocity[:, candidate.axis], state.acceleration[:, candidate.axis]], axis=1)
            return np.concatenate([columns[:, :1], columns[:, 1:] + share * own], axis=1)
        if self.drive == "own":
            columns[:, 0] -= nonlinear["own"] * state.direction[:, candidate.axis]
        return columns


def zeros_of(state: State, candidate: Candidate, used: np.ndarray) -> list[np.ndarray | None]:
    """Return the columns over their carrier at each argument at which the effect may vanish.

    A torque over position, time or temperature is told from friction but for a constant, which is a correction of
    the friction (of one direction against the other for a spring): where the parameters of the nominal model hold is
    not known, but for lying within the data.
    """
    effect = get_effect(candidate.effect)
    if not effect.floats or effect.shape is None:
        return [None]
    carrier, argument = effect.shape(state, candidate.axis, candidate.nonlinear)
    columns = effect.columns(state, candidate.axis, candidate.source, candidate.nonlinear)
    chosen = np.flatnonzero(used & _telling(carrier, used))
    if not len(chosen):
        return [None]
    # Between recordings, as of one temperature and of another, and beyond them lie arguments that no sample has.
    places, first = np.unique(argument[chosen], return_index=True)
    if len(places) < 2:
        return [columns[chosen[0]] / carrier[chosen[0]]]
    values = columns[chosen[first]] / carrier[chosen[first], None]
    margin = BEYOND * (places[-1] - places[0])
    low, high = places[0] - margin, places[-1] + margin
    near = [places[0] + 0.5 * margin, places[-1] - 0.5 * margin]
    wanted = np.linspace(low, high, ZEROS)
    result = []
    for v in values.T:
        inner = np.interp(near, places, v)
        known = np.concatenate([[3 * v[0] - 2 * inner[0]], v, [3 * v[-1] - 2 * inner[1]]])
        result.append(np.interp(wanted, np.concatenate([[low], places, [high]]), known))
    return list(np.stack(result, axis=1))


def shapes(white: White, candidate: Candidate, spreads: Spreads) -> Iterator[Shape]:
    """Yield the possibilities that the data may leave for the columns of an effect."""
    problem, effect = white.problem, get_effect(candidate.effect)
    state = white.state_of(effect, candidate.axis, candidate.nonlinear)
    if effect.needs_source:
        for nonlinear in effect.grid(state, candidate.axis):
            one = replace(candidate, nonlinear=dict(nonlinear))
            for drive in ("", "other", "own") if nonlinear["own"] else ("",):
                yield Shape(one, drive=drive)
        return
    free = len(spreads.names)
    steps = STEPS_OF_ONE if free == 1 else STEPS_OF_MANY
    # At a bound several steps lead to the same place.
    places = {}
    for taken in product(steps, repeat=free):
        one = spreads.moved(candidate, np.array(taken))
        places.setdefault(tuple(float(one.nonlinear[name]) for name in spreads.names), one)
    for one in places.values():
        for zero in zeros_of(state, one, problem.usable[:, candidate.axis]):
            yield Shape(one, zero)


def _bends(white: White, form: Form, size: float) -> Term:
    """Return the columns of a form with a prior that holds where no sample was recorded too."""
    term = companion(white, form, size)
    if form.knots is None:
        return term
    # A piece of a table that few samples touch must not reach higher than others on motion that does touch it: the
    # pieces sum to the carrier.
    axis = form.candidate.axis
    carrier = form.columns(white.state_of(get_effect(form.candidate.effect), axis)).sum(axis=1)[
        white.problem.usable[:, axis]
    ]
    return replace(term, std=np.minimum(term.std, white.problem.settings.usual * size / height(carrier)))


def height(values: np.ndarray) -> float:
    """Return how high a series (m,) reaches where it is not small: more than its RMS if it is narrow."""
    return float(np.sqrt(np.mean(values**4) / max(float(np.mean(values**2)), 1e-300))) + 1e-300


def draw_form_errors(effect: Effect, settings: Settings, rng: np.random.Generator) -> np.ndarray:
    """Draw the factors (DRAWS,) by which the largest torque of an effect is off because of its form.

    An effect that acts after reversals is highest in the very samples beside them that cannot be judged, and sharper
    than what filters leave of it: its peak may be higher than what is seen, not lower. That of a timing effect may be
    either: rates of torque hold the noise of derived accelerations as well.
    """
    factors = 1.0 + settings.peak_error * rng.standard_normal(DRAWS)
    if effect.sequential:
        up = rng.standard_normal(DRAWS)
        factors = factors * np.exp(settings.reversal_error * (up if effect.timing else np.abs(up)))
    return factors


def draw_torque(
    white: White,
    base: list[Term],
    candidate: Candidate,
    spreads: Spreads,
    size: float,
    reach: float,
    test: State,
    rng: np.random.Generator,
) -> np.ndarray:
    """Draw the torque (m, DRAWS) [N m] of an effect on one axis on ordered samples from its posterior.

    Parameters
    ----------
    base : all terms but those of this effect.
    size : height of the torque of the effect [N m], of which each bend of its form may be worth the `usual` share.
    reach : largest torque of the effect on the training samples [N m].
    """
    axis, effect = candidate.axis, get_effect(candidate.effect)
    form = form_of(white, candidate)
    terms = list(base)
    if form is not None:
        terms.append(_bends(white, form, size))
    fit = Fit(white.targets, terms)
    bends = fit.slices[-1] if form is not None else slice(0, 0)
    points = []
    for one in shapes(white, candidate, spreads):
        columns = one.columns(white.state_of(effect, axis))
        if not np.isfinite(columns).all() or not np.any(columns):
            continue
        std = prior_of(white, one, columns)
        b, cross = fit.projected({axis: (x := white.columns(axis, columns))})
        gram = x.T @ x - cross @ fit.covariance @ cross.T
        points.append((gain(b, gram, std), one, b, gram, std, cross))
    # Rounding may leave next to nothing of a column, and no evidence.
    nats = np.maximum([p[0] for p in points], -1e6)
    weights = np.exp(nats - nats.max())
    counts = rng.multinomial(DRAWS, weights / weights.sum())
    bend_columns = form.columns(test) if form is not None else np.zeros((len(test.velocity), 0))
    root = np.linalg.cholesky(fit.covariance[bends, bends] + 1e-30 * np.eye(bends.stop - bends.start))
    drawn = []
    for (_, one, b, gram, std, cross), count in zip(points, counts, strict=True):
        if not count:
            continue
        # Over its prior, which may be 0.
        covariance = np.linalg.inv(std[:, None] * gram * std + np.eye(len(std)))
        mean = std * (covariance @ (std * b))
        noise = np.linalg.cholesky(covariance) @ rng.standard_normal((len(b), count))
        coefficients = mean[:, None] + std[:, None] * noise
        coefficients = _possible(effect, one.candidate, mean, coefficients)
        follow = fit.covariance[bends] @ cross.T
        bent = fit.theta[bends][:, None] - follow @ coefficients + root @ rng.standard_normal((len(root), count))
        drawn.append(one.columns(test) @ coefficients + bend_columns @ bent)
    return np.concatenate(drawn, axis=1) + draw_beyond(white, candidate, reach, test, rng)


def prior_of(white: White, shape: Shape, columns: np.ndarray) -> np.ndarray:
    """Return the prior standard deviations (k,) of the columns (N_train, k) of a possibility.

    What turning with another axis changes in the friction of a drive is no more than the friction of that drive. By its
    own columns, which are nothing where this axis turns faster in all of training, it would be without a bound on
    motion where the other does. A column that is nothing in training for another reason is left out: 0.
    """
    candidate, used = shape.candidate, white.problem.usable[:, shape.candidate.axis]
    std = prior_std(white, candidate, columns)
    told = columns
    if shape.drive == "own":
        told = replace(shape, drive="").columns(white.state_of(get_effect(candidate.effect), candidate.axis))
        std = np.minimum(std, prior_std(white, candidate, told))
    return np.where(np.any(told[used], axis=0), std, 0.0)


def draw_beyond(white: White, candidate: Candidate, reach: float, test: State, rng: np.random.Generator) -> np.ndarray:
    """Draw what the torque (m, DRAWS) [N m] of an effect may be more where its argument leaves the training samples.

    There the form goes on straight, or stays, and nothing says that the effect does. It may rise or fall as steeply as
    one that reaches its largest torque there, `reach` [N m], within half of the arguments that were seen.
    """
    effect = get_effect(candidate.effect)
    nothing = np.zeros((len(test.velocity), 1))
    if not effect.as_seen:
        return nothing
    axis = candidate.axis
    carrier, argument = effect.shape(white.state_of(effect, axis, candidate.nonlinear), axis, candidate.nonlinear)
    seen = white.problem.usable[:, axis] & _telling(carrier, white.problem.usable[:, axis])
    if not seen.any():
        return nothing
    low, high, tallest = argument[seen].min(), argument[seen].max(), np.abs(carrier[seen]).max()
    carrier, argument = effect.shape(test, axis, candidate.nonlinear)
    share = np.stack([np.maximum(low - argument, 0.0), np.maximum(argument - high, 0.0)], axis=1)
    share *= (carrier / tallest)[:, None] / max(0.5 * (high - low), 1e-300)
    return reach * share @ rng.standard_normal((2, DRAWS))


def _telling(carrier: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Return the mask (m,) of the samples in which an effect acts at all."""
    return np.abs(carrier) > STILL * np.abs(carrier[used]).max(initial=0.0)


def _possible(effect, candidate: Candidate, mean: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Return drawn coefficients (k, d), those that no such effect can have mirrored at the bound or set to the mean."""
    if len(mean) > 1:
        return coefficients
    good = np.array([possible(effect, candidate.nonlinear, c) for c in coefficients.T])
    if not possible(effect, candidate.nonlinear, mean):
        return coefficients
    return np.where(good, coefficients, np.abs(coefficients) * np.sign(mean[:, None]))
