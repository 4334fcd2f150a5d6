"""How a model predicts records left out in turn, against the robot that was given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.linalg import block_diag, cho_factor, cho_solve
from scipy.special import ndtri

from jointwear.discovery import assumed
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.whitening import INERTIAL, Folds, White
from jointwear.discovery.settings import Settings

#: Share of its prior variance that is left of a coefficient that the data do not tell of: half of it, most.
UNTOLD = 0.5


@dataclass(frozen=True)
class LeftOut:
    """How a model predicts records left out in turn, every axis (n,) against the given robot.

    Attributes
    ----------
    ratio : RMS error [N m] over that of the given robot, as :func:`left_out_ratio` says.
    surely : the same, where a record alone counts only if it is worse beyond what its blocks of time scatter.
    gained : share of what is gained in all that the model changes of the squared errors of blocks of time: 1 where no
        block is worse, 0.5 where the model gains nothing.
    steady : margin by which a record to come is expected to keep `not_worse`, as :func:`margin` says; infinite for one.
    told_alone : one fold alone tells of an effect.
    """

    ratio: np.ndarray
    surely: np.ndarray
    gained: np.ndarray
    steady: np.ndarray
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
    return (_EveryFold(white, terms, white.parts, each) if parts else Asked(white, terms, each))(terms).ratio


class Asked:
    """A model, and what is left of it when parts are given up, on records left out in turn.

    Sums of products of all its terms are formed once for each fold and axis: a part of the model has a part of them.

    Parameters
    ----------
    terms : of the whole model. each : say something of blocks of time too.
    """

    def __init__(self, white: White, terms: list[Term], each: bool = True) -> None:
        self._white, self._terms, self._each = white, list(terms), each
        self._records = _EveryFold(white, self._terms, white.folds, each)

    @cached_property
    def _of_halves(self) -> _EveryFold:
        return _EveryFold(self._white, self._terms, self._white.halves, self._each)

    def __call__(self, kept: list[Term]) -> LeftOut:
        """Return how `kept` of the terms predict records left out in turn, or halves; see :func:`left_out_ratio`."""
        found = self._records(kept)
        return replace(self._of_halves(kept), steady=found.steady) if found.told_alone else found

    def drives(self, kept: list[Term]) -> dict[int, np.ndarray]:
        """Return for every axis (0-based) that can be judged what its drive is worth on each record left out, (r, 4).

        They are sums of squares [(N m)^2]: the torque of the corrections of its drive times what all others leave, that
        torque squared, what the others leave squared, and what the given robot leaves squared.
        """
        records = self._of_halves if self._records.without_each(kept)[1] else self._records
        return records.drives(kept)


@dataclass(frozen=True)
class _Rows:
    """What one axis shows in one fold.

    Attributes
    ----------
    places : (k,) places of the coefficients that act on the axis. gram, right : (k, k) and (k,) sums of products of
        whitened columns, and with the whitened targets.
    raw, target : (m, k) and (m,) columns and what the given robot leaves [N m]. blocks : (m,) block of time.
    """

    places: np.ndarray
    gram: np.ndarray
    right: np.ndarray
    raw: np.ndarray
    target: np.ndarray
    blocks: np.ndarray


class _EveryFold:
    """Sums of products of the terms of a model in some folds, left out in turn; arguments as of :class:`Asked`."""

    def __init__(self, white: White, terms: list[Term], folds: Folds, each: bool) -> None:
        self._white, self._each, self._terms = white, each, terms
        edges = np.concatenate([[0], np.cumsum([len(t.std) for t in terms])]).astype(int)
        self._places = [np.arange(*edge) for edge in pairwise(edges)]
        self._total = int(edges[-1])
        self._rows: dict[int, dict[int, _Rows]] = {}
        #: Sums over all axes of all terms in a fold: those of a part of them are a part of these.
        self._whole: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        targets = white.raw_targets
        for axis, y in enumerate(white.targets):
            if not len(y):
                continue
            active = [i for i, t in enumerate(terms) if axis in t.raw]
            places = np.concatenate([self._places[i] for i in active] or [np.zeros(0, int)])
            nothing = np.zeros((len(y), 0))
            raw = np.concatenate([nothing, *(terms[i].raw[axis] for i in active)], axis=1)
            # What an axis says nothing of may still act on it.
            said = (terms[i].blocks.get(axis, np.zeros((len(y), len(terms[i].std)))) for i in active)
            design = np.concatenate([nothing, *said], axis=1)
            label, blocks = folds(axis), white.blocks(axis)
            for fold in np.unique(label):
                rows = label == fold
                x = design[rows]
                self._rows.setdefault(int(fold), {})[axis] = _Rows(
                    places, x.T @ x, x.T @ y[rows], raw[rows], targets[axis][rows], blocks[rows]
                )

    def __call__(self, kept: list[Term]) -> LeftOut:
        """Return how `kept` of the terms, corrections of the links with less or no freedom, predict each fold."""
        found: dict[int, list[_Record]] = {}
        thetas, told_alone = self.without_each(kept)
        for fold, theta in thetas.items():
            for axis, rows in self._rows[fold].items():
                found.setdefault(axis, []).append(self._record(rows, rows.target - rows.raw @ theta[rows.places]))
        count = len(self._white.targets)
        ratio, surely, gained, steady = np.zeros(count), np.zeros(count), np.ones(count), np.full(count, np.inf)
        for axis, records in found.items():
            ratio[axis], surely[axis], gained[axis] = _of_records(records)
            steady[axis] = margin(np.array([r.squares for r in records]), self._white.problem.settings)
        return LeftOut(ratio, surely, gained, steady, told_alone)

    def drives(self, kept: list[Term]) -> dict[int, np.ndarray]:
        """Return what the corrections of each drive are worth in each fold, (r, 4) an axis; as :meth:`Asked.drives`."""
        of_drive = np.full(self._total, -1)
        for term, places in zip(self._terms, self._places, strict=True):
            of_drive[places] = term.drive[0] if term.drive else -1
        found: dict[int, list[tuple[float, ...]]] = {}
        for fold, theta in self.without_each(kept)[0].items():
            for axis, rows in self._rows[fold].items():
                own = of_drive[rows.places] == axis
                drive = rows.raw[:, own] @ theta[rows.places[own]]
                left = rows.target - rows.raw[:, ~own] @ theta[rows.places[~own]]
                pairs = ((drive, left), (drive, drive), (left, left), (rows.target, rows.target))
                found.setdefault(axis, []).append(tuple(float(x @ y) for x, y in pairs))
        return {axis: np.array(worth) for axis, worth in found.items()}

    def without_each(self, kept: list[Term]) -> tuple[dict[int, np.ndarray], bool]:
        """Return the coefficients (p,) of all terms fitted without each fold, and whether one alone tells of an effect.

        Those of what is not kept are 0.
        """
        of_term = [self._place(t) for t in kept]
        chosen = np.concatenate([self._places[i] for i in of_term] or [np.zeros(0, int)])
        precision = np.concatenate([1.0 / t.std**2 for t in kept] or [np.zeros(0)])
        of_effect = np.repeat([t.effect for t in kept], [len(t.std) for t in kept]).astype(bool)
        turn = self._turn(kept, of_term)
        sums = {fold: self._sums(fold, kept, of_term, chosen, turn) for fold in self._rows}
        total_gram, total_right = sum(g for g, _ in sums.values()), sum(r for _, r in sums.values())
        known = of_effect
        if of_effect.any():
            known = of_effect & (_left_open(cho_factor(total_gram + np.diag(precision)), precision) < UNTOLD)
        thetas, told_alone = {}, False
        for fold, (gram, right) in sums.items():
            theta = np.zeros(self._total)
            if len(chosen):
                factor = cho_factor(total_gram - gram + np.diag(precision))
                theta[chosen] = cho_solve(factor, total_right - right)
                theta[chosen] = theta[chosen] if turn is None else turn @ theta[chosen]
                told_alone |= known.any() and bool(np.any(known & (_left_open(factor, precision) > UNTOLD)))
            thetas[fold] = theta
        return thetas, bool(told_alone)

    def _place(self, term: Term) -> int:
        """Return which of the terms one is, or is of with less freedom."""
        links = term.label == INERTIAL
        return next(i for i, t in enumerate(self._terms) if (t.label == INERTIAL if links else t is term))

    def _turn(self, kept: list[Term], of_term: list[int]) -> np.ndarray | None:
        """Return what turns the coefficients (k, k) of `kept` to those of the terms, None where they are the same."""
        if all(t.turn is self._terms[i].turn for t, i in zip(kept, of_term, strict=True)):
            return None
        parts = [np.eye(len(t.std)) for t in kept]
        for k, (term, i) in enumerate(zip(kept, of_term, strict=True)):
            before = self._terms[i].turn
            if term.turn is not before:
                own = parts[k] if term.turn is None else term.turn
                parts[k] = own if before is None else before.T @ own
        return block_diag(*parts)

    def _sums(
        self, fold: int, kept: list[Term], of_term: list[int], chosen: np.ndarray, turn: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return sums of products (k, k) and with the targets (k,) of the terms that are kept, over all axes."""
        if all(t.blocks.keys() == self._terms[i].blocks.keys() for t, i in zip(kept, of_term, strict=True)):
            if fold not in self._whole:
                self._whole[fold] = self._over_axes(fold, self._terms, range(len(self._terms)))
            gram, right = self._whole[fold]
        else:
            gram, right = self._over_axes(fold, kept, of_term)
        gram, right = gram[np.ix_(chosen, chosen)], right[chosen]
        return (gram, right) if turn is None else (turn.T @ gram @ turn, turn.T @ right)

    def _over_axes(self, fold: int, terms: Sequence[Term], of_term: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """Return :meth:`_sums` of some terms at the places (p,) of all of them, 0 elsewhere."""
        gram, right = np.zeros((self._total, self._total)), np.zeros(self._total)
        for axis, rows in self._rows[fold].items():
            says = np.zeros(self._total, bool)
            for term, i in zip(terms, of_term, strict=True):
                says[self._places[i]] = axis in term.blocks
            own = says[rows.places]
            places = rows.places[own]
            gram[np.ix_(places, places)] += rows.gram[np.ix_(own, own)]
            right[places] += rows.right[own]
        return gram, right

    def _record(self, rows: _Rows, left: np.ndarray) -> _Record:
        """Return the errors of one axis on one fold of which the model leaves torque (m,) [N m]."""
        squares = float(left @ left), float(rows.target @ rows.target)
        if not self._each:
            return _Record(squares)
        problem = self._white.problem
        times = mean_squares(rows.blocks, left, rows.target)
        alone = bool(len(left) >= asked_alone(problem.settings) * problem.measured.rate)
        return _Record(squares, times, alone, alone and surely_worse(*times, problem.settings))


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


def asked_alone(settings: Settings) -> float:
    """Return the time in motion [s] from which a record is asked by itself.

    It holds as many blocks as would all have to be worse to be as sure as `certainty`: 3.3 s.
    """
    return assumed.BLOCK * float(-np.log2(1.0 - settings.certainty))


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
    return bool(lost.sum() > ndtri(settings.certainty) * np.sqrt(len(lost)) * np.std(lost))


def margin(squares: np.ndarray, settings: Settings) -> float:
    """Return the logarithm by which the expected error of a record to come stays below `not_worse`; negative if not.

    The records are taken for draws of one log-normal ratio of errors: one more scatters about their mean as they do,
    and by what their mean is not known. What counts is the mean square of that ratio: a record that gains far more than
    the others widens the scatter, and is no sign that one will lose.

    Parameters
    ----------
    squares : (r, 2) sums of squares [(N m)^2] of what is left and of what the given robot leaves in each record.
    """
    if len(squares) < 2:
        return np.inf
    logs = 0.5 * np.diff(np.log(np.maximum(squares, 1e-300)), axis=1)[:, 0]
    scatter = np.std(logs, ddof=1) * np.sqrt(1.0 + 1.0 / len(logs))
    return float(np.log(settings.not_worse) + np.mean(logs) - scatter**2)


def _left_open(factor: tuple[np.ndarray, bool], precision: np.ndarray) -> np.ndarray:
    """Return the variance of each coefficient (k,) after the data, of a Cholesky `factor`, over that before them."""
    return np.diag(cho_solve(factor, np.eye(len(precision)))) * precision


def mean_squares(label: np.ndarray, *errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mean squares (e, b) of each of `errors` (m,) over each block, and the samples (b,) of the blocks.

    Parameters
    ----------
    label : (m,) integers, one for each block.
    """
    place = label - label.min(initial=0)
    count = np.bincount(place)
    held = count > 0
    return np.stack([np.bincount(place, e**2)[held] / count[held] for e in errors]), count[held]
