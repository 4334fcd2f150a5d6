"""Put a model back, axis by axis, where it predicts records left out worse than the robot that was given.

A fit may buy a better likelihood with parameters that make slow torque worse, or that hold for the records it has
seen. A robot file is used for motion to come: on no axis may it be worse than the one it replaces.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.stats import norm

from jointwear.discovery.linear import Term
from jointwear.discovery.settings import Settings
from jointwear.discovery.verdict import FallBack
from jointwear.discovery.whitening import INERTIAL, Folds, White

#: Words of the step that gives up what was fitted to the drive of a joint.
DRIVE = "friction and motor inertia as given"
#: Words of the step that gives up all of a joint.
EVERYTHING = "everything of this joint as given"
#: Words of the steps that take corrections of the links back, in part and all of them.
CLOSER, LINKS = "inertia of the links closer to that given", "inertia of the links as given"
#: Standard deviations, over that of their prior, that are left to corrections of the links before they are given up.
HALVINGS = (0.5, 0.25, 0.125, 0.0625, 0.03125)
#: Time in motion [s] from which a record is asked by itself.
ASKED_ALONE = 5.0
#: Share of its prior variance that is left of a coefficient that the data tell of, and of one that they do not.
TOLD, UNTOLD = 0.1, 0.5


@dataclass(frozen=True)
class Step:
    """Something that can be given up for the sake of an axis.

    Attributes
    ----------
    words, terms : what it is in words, and the terms that go.
    links : largest standard deviation, over that of their prior, that corrections of the links keep; at 0 they are
        given up. All axes share the links: for the sake of one they are given up as little as it needs.
    deaf : 0-based axis that says nothing of the links from here on, though they act on it: without parameters of its
        own, what it lacks would bend them.
    of_drive : it gives up what was fitted to the drive of a joint, and nothing else.
    """

    words: str
    terms: tuple[Term, ...] = ()
    links: float = np.inf
    deaf: int | None = None
    of_drive: bool = False

    def taken_off(self, terms: list[Term]) -> list[Term]:
        """Return `terms` without what this step gives up."""
        left = [t for t in terms if not any(t is own for own in self.terms)]
        return [self._of_links(t) if t.label == INERTIAL else t for t in left if t.label != INERTIAL or self.links > 0]

    def touches(self, terms: list[Term]) -> bool:
        """Return whether this step gives up anything of `terms`."""
        return any(
            any(t is own for own in self.terms) or (t.label == INERTIAL and np.any(t.std > self.links)) for t in terms
        )

    def _of_links(self, links: Term) -> Term:
        if np.any(links.std > self.links):
            links = replace(links, std=np.minimum(links.std, self.links))
        if self.deaf in links.blocks:
            silent = {self.deaf: np.zeros_like(links.blocks[self.deaf])}
            links = replace(links, blocks=links.blocks | silent)
        return links


#: What can be given up of the links, the least first.
OF_LINKS = (*(Step(CLOSER, links=width) for width in HALVINGS), Step(LINKS, links=0.0))


@dataclass(frozen=True)
class LeftOut:
    """How a model predicts records left out in turn, every axis (n,) against the given robot.

    Attributes
    ----------
    ratio : RMS error [N m] over that of the given robot, as :func:`left_out_ratio` says.
    surely : the same, where a record alone counts only if it is worse beyond what its blocks of time scatter.
    gained : share of what is gained in all that the model changes of the squared errors of blocks of time: 1 where no
        block is worse, 0.5 where the model gains nothing.
    told_alone : one fold alone tells of an effect.
    """

    ratio: np.ndarray
    surely: np.ndarray
    gained: np.ndarray
    told_alone: bool


@dataclass(frozen=True)
class _Record:
    """Errors of one axis on one record left out, of the model and then of the given robot.

    `squares` are their sums of squares [(N m)^2], `times` what :func:`mean_squares` says of the blocks of time, if
    asked. `alone` says that the record is long enough to be asked by itself, `surely` that it is surely worse.
    """

    squares: tuple[float, float]
    times: tuple[np.ndarray, np.ndarray] | None = None
    alone: bool = False
    surely: bool = False


def left_out_ratio(white: White, terms: list[Term], each: bool = True, parts: bool = False) -> np.ndarray:
    """Return the RMS error [N m] of a model on records left out in turn over that of the given robot, (n,).

    It is that over all records, that of the worst record or that of the block of time in the middle, whichever is
    largest: what helps in most records and harms in one is not a better robot, nor what helps while a wall is touched
    and harms at all other times. Records of a few seconds are too short to be asked one by one. Where one record alone
    tells of an effect nothing can be said of that record without it: halves of records are left out instead. Axes that
    cannot be judged get 0.

    Parameters
    ----------
    each : ask for the worst record and the middle block too, not only for all of them together.
    parts : leave out the parts that a name has to predict: fewer than four records are cut into blocks.
    """
    return _of_folds(white, terms, white.parts, each).ratio if parts else left_out(white, terms, each).ratio


def left_out(white: White, terms: list[Term], each: bool = True) -> LeftOut:
    """Return how a model predicts records left out in turn, or halves of them; see :func:`left_out_ratio`."""
    found = _of_folds(white, terms, white.folds, each)
    return _of_folds(white, terms, white.halves, each) if found.told_alone else found


def _of_folds(white: White, terms: list[Term], folds: Folds, each: bool) -> LeftOut:
    """Return how a model predicts some folds left out in turn; without `each` nothing is said of blocks of time."""
    sizes = [len(t.std) for t in terms]
    edges = np.concatenate([[0], np.cumsum(sizes)]).astype(int)
    total = int(edges[-1])
    precision = np.concatenate([1.0 / t.std**2 for t in terms]) if terms else np.zeros(0)
    parts: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    raw: dict[int, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
    targets = white.raw_targets()
    for axis, y in enumerate(white.targets):
        if not len(y):
            continue
        active = [i for i, t in enumerate(terms) if axis in t.blocks]
        where = np.concatenate([np.arange(edges[i], edges[i + 1]) for i in active] or [np.zeros(0, int)])
        design = np.concatenate([terms[i].blocks[axis] for i in active] or [np.zeros((len(y), 0))], axis=1)
        seen = np.concatenate([terms[i].raw[axis] for i in active] or [np.zeros((len(y), 0))], axis=1)
        label = folds(axis)
        raw[axis] = (seen, where, label)
        for record in np.unique(label):
            rows = label == record
            gram, right = parts.setdefault(int(record), (np.zeros((total, total)), np.zeros(total)))
            gram[np.ix_(where, where)] += design[rows].T @ design[rows]
            right[where] += design[rows].T @ y[rows]
    total_gram, total_right = sum(g for g, _ in parts.values()), sum(r for _, r in parts.values())
    found: dict[int, list[_Record]] = {axis: [] for axis in raw}
    blocks = {axis: white.blocks(axis) for axis in raw} if each else {}
    told_alone = False
    of_effect = np.repeat([t.effect for t in terms], sizes) if terms else np.zeros(0, bool)
    known = of_effect
    if of_effect.any():
        known = of_effect & (_left_open(cho_factor(total_gram + np.diag(precision)), precision) < TOLD)
    for record, (gram, right) in parts.items():
        theta = right
        if total:
            factor = cho_factor(total_gram - gram + np.diag(precision))
            theta = cho_solve(factor, total_right - right)
            told_alone |= known.any() and bool(np.any(known & (_left_open(factor, precision) > UNTOLD)))
        for axis, (seen, where, label) in raw.items():
            rows = label == record
            given = targets[axis][rows]
            left = given - seen[rows] @ theta[where]
            one = _Record((float(left @ left), float(given @ given)))
            if each:
                times = mean_squares(blocks[axis][rows], left, given)
                alone = bool(rows.sum() >= ASKED_ALONE * white.problem.measured.rate)
                one = _Record(one.squares, times, alone, alone and surely_worse(*times, white.problem.settings))
            found[axis].append(one)
    ratio, surely, gained = np.zeros(len(white.targets)), np.zeros(len(white.targets)), np.ones(len(white.targets))
    for axis, records in found.items():
        if records:
            ratio[axis], surely[axis], gained[axis] = _of_records(records)
    return LeftOut(ratio, surely, gained, bool(told_alone))


def _of_records(records: list[_Record]) -> tuple[float, float, float]:
    """Return `ratio`, `surely` and `gained` of one axis, as :class:`LeftOut` has them."""
    together, gained = [tuple(np.sum([r.squares for r in records], axis=0))], 1.0
    times = [r.times for r in records if r.times is not None]
    if times:
        means, count = (np.concatenate(parts, axis=-1) for parts in zip(*times, strict=True))
        together.append(tuple(np.median(means, axis=1)))
        drop = (means[1] - means[0]) * count
        gained = np.sum(np.maximum(drop, 0.0)) / np.sum(np.abs(drop)) if drop.any() else 1.0

    def worst(asked: list[tuple[float, float]]) -> float:
        return max(np.sqrt(left / max(given, 1e-300)) for left, given in together + asked)

    alone, surely = [r.squares for r in records if r.alone], [r.squares for r in records if r.surely]
    return worst(alone), worst(surely), gained


def surely_worse(means: np.ndarray, count: np.ndarray, settings: Settings) -> bool:
    """Return whether a record is predicted worse than by the given robot beyond what its blocks of time scatter.

    What is given up for the sake of a record that comes out 1.04 times as bad by chance is lost to all others, and of
    the links to all axes.

    Parameters
    ----------
    means : (2, b) mean square [(N m)^2] of what is left and of what the given robot leaves in each block of time.
    count : (b,) samples of each block.
    """
    squares = means * count
    lost = squares[0] - settings.not_worse**2 * squares[1]
    return bool(lost.sum() > norm.ppf(settings.certainty) * np.sqrt(len(lost)) * np.std(lost))


def _left_open(factor: tuple[np.ndarray, bool], precision: np.ndarray) -> np.ndarray:
    """Return the variance of each coefficient (k,) after the data, of a Cholesky `factor`, over that before them."""
    return np.diag(cho_solve(factor, np.eye(len(precision)))) * precision


def mean_squares(label: np.ndarray, *errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mean squares (e, b) of each of `errors` (m,) over each block, and the samples (b,) of the blocks.

    Parameters
    ----------
    label : (m,) integers, one for each block.
    """
    _, place = np.unique(label, return_inverse=True)
    count = np.bincount(place)
    return np.stack([np.bincount(place, e**2) / count for e in errors]), count


def put_back(
    white: White, terms: list[Term], steps: dict[int, list[Step]], model: str, open_axes: Collection[int] = ()
) -> tuple[list[Term], tuple[FallBack, ...]]:
    """Give up parts of a model until no axis is predicted worse than by the given robot.

    Parameters
    ----------
    steps : 0-based axis -> what can be given up for its sake, the least loss first.
    model : name of the model in the verdict.
    open_axes : 0-based axes on which structure is left that nothing explains: what acts on such an axis alone is kept
        only where it gains clearly.

    Returns
    -------
    the terms that are kept, and what was given up and why.
    """
    limit = white.problem.settings.not_worse
    kept, given_up = list(terms), []
    asked = left_out(white, kept)
    while True:
        ratio = asked.surely
        bad = [j for j in np.argsort(-ratio) if ratio[j] > limit]
        chosen = next(((int(j), s) for j in bad if (s := _best_step(white, kept, steps, int(j), ratio[j]))), None)
        chosen = chosen or _little_gained(white, kept, steps, open_axes, asked)
        if chosen is None:
            return kept, tuple(given_up)
        axis, step = chosen
        if ratio[axis] > limit or axis in open_axes:
            # Elsewhere the parameters follow noise alone: that they stay as given is no loss to tell of.
            given_up.append(FallBack(model, axis + 1, float(f"{ratio[axis]:.4g}"), step.words))
        kept = step.taken_off(kept)
        asked = left_out(white, kept)


def _little_gained(
    white: White, kept: list[Term], steps: dict[int, list[Step]], open_axes: Collection[int], asked: LeftOut
) -> tuple[int, Step] | None:
    """Return an axis on which the model gains little or not nearly always, and what acts on it alone; None if none.

    A parameter of a drive is the same at all times. One that is better in some stretches and worse in others is a mean
    over what comes and goes, or follows noise: the next recording may hold more of the others.
    """
    settings = white.problem.settings
    nearly_all = settings.nearly_all
    for axis in white.problem.judged:
        is_open = axis in open_axes
        if asked.gained[axis] >= nearly_all and not (is_open and asked.ratio[axis] > nearly_all):
            continue
        own = [s for s in steps.get(axis, []) if s.terms and all(set(t.blocks) == {axis} for t in s.terms)]
        own = [s for s in own if (is_open or s.of_drive) and s.touches(kept)]
        if not own:
            continue
        together = Step(", ".join(s.words for s in own), tuple(t for s in own for t in s.terms))
        for step in [together, replace(together, deaf=axis)] if is_open else [together]:
            # An axis that is above the limit by one slow record alone speaks against no step of another.
            if np.all(left_out_ratio(white, step.taken_off(kept)) <= np.maximum(settings.not_worse, asked.ratio)):
                return axis, step
    return None


def _best_step(white: White, kept: list[Term], steps: dict[int, list[Step]], axis: int, ratio: float) -> Step | None:
    """Return the first step that mends an axis, else the one that helps most, else all at once; None if none is left.

    Parameters
    ----------
    ratio : error of the model as it is over that of the given robot.
    """
    every = steps.get(axis, [])
    best: tuple[float, Step] | None = None
    for step in every:
        if not step.touches(kept):
            continue
        after = float(left_out(white, step.taken_off(kept)).surely[axis])
        if after <= white.problem.settings.not_worse:
            return step
        if best is None or after < best[0]:
            best = (after, step)
    if best is None:
        return None
    if best[0] < ratio:
        return best[1]
    return Step(EVERYTHING, tuple(t for s in every for t in s.terms), min(s.links for s in every))
