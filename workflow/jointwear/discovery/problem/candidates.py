"""Every (effect, axis, source, nonlinear parameters) that may explain a discrepancy, as whitened columns."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from jointwear.discovery.linear import Fit, Term, posterior_mean
from jointwear.discovery.problem.instruments import ended
from jointwear.discovery.problem.motor_lines import in_band
from jointwear.discovery.problem.products import Products
from jointwear.discovery.problem.whitening import White, link_mass_blocks
from jointwear.discovery.structure import ORDERS, Basis
from jointwear.effects import get_effect, library
from jointwear.files.errors import InputError

LINK_MASS = "link_mass"
#: A joint that moves less than this [rad] acts on no other.
STILL = 1e-4
#: Why nothing is tried on a joint of which noise is not told from what the model lacks.
TOO_COARSE = "too few samples between reversals to tell it from noise"


@dataclass(frozen=True)
class Candidate:
    """One point of the search: an effect of the library, or the mass of one link (``effect == LINK_MASS``).

    `axis` and `source` are 0-based; axis is None for the whole arm and the link for a link mass. `wide`: the columns of
    an elastic gear end as :meth:`White.state_of` says, not where its evidence is asked. `both`: a drive that two joints
    turn, with one coefficient on either.
    """

    effect: str
    axis: int | None
    source: int | None
    nonlinear: dict[str, Any] = field(default_factory=dict)
    wide: bool = False
    both: bool = False

    @property
    def other_half(self) -> Candidate:
        """What the other joint that turns a drive feels of it: by virtual work its friction acts on both."""
        return replace(self, axis=self.source, source=self.axis, both=False)

    @property
    def halves(self) -> tuple[Candidate, ...]:
        """The candidate on each axis that it is an effect of, the one that it is named on first."""
        return (replace(self, both=False), self.other_half) if self.both else (self,)

    @property
    def axes(self) -> tuple[int | None, ...]:
        """The axes that the candidate is an effect of, None for the whole arm."""
        return tuple(half.axis for half in self.halves)

    @property
    def key(self) -> tuple:
        """What a verdict tells apart: the effect, its axis and its source."""
        return (self.effect, self.axis, self.source)


@dataclass(frozen=True)
class Group:
    """Candidates on one axis that have k columns each.

    `members` (n,) are their places among the candidates of the axis, `places` (n, k) those of their columns. `std`
    (n, k) is the prior of their coefficients, `squares` (n, k, k) the sums of products of their own columns.
    """

    members: np.ndarray
    places: np.ndarray
    std: np.ndarray
    squares: np.ndarray

    def of(self, chosen: np.ndarray) -> Group:
        """Return those of the candidates that are `chosen`, a mask (c,) over all of the axis."""
        kept = chosen[self.members]
        return Group(self.members[kept], self.places[kept], self.std[kept], self.squares[kept])


@dataclass(frozen=True)
class Seen:
    """The whitened columns (m, k) of a basis of structure, those that hold anything, beside a fit.

    `good` (K,) says which of its columns they are; `b` (k,) and `gram` (k, k) are of :meth:`Fit.gram`, `full` (k, k)
    the sums of products of the columns themselves.
    """

    columns: np.ndarray
    good: np.ndarray
    b: np.ndarray
    gram: np.ndarray
    full: np.ndarray


def _grouped(matrix: np.ndarray, entries: list[tuple[Candidate, slice, np.ndarray]]) -> list[Group]:
    widths = np.array([len(std) for _, _, std in entries], dtype=int)
    found = []
    for width in np.unique(widths):
        members = np.flatnonzero(widths == width)
        own = [entries[i] for i in members]
        places = np.array([np.arange(where.start, where.stop) for _, where, _ in own])
        squares = np.array([(x := matrix[:, where]).T @ x for _, where, _ in own])
        found.append(Group(members, places, np.array([std for *_, std in own]), squares))
    return found


@dataclass
class Dictionary:
    """Whitened columns of all single-axis candidates, one matrix an axis, and of those on the whole arm.

    `spreading` holds candidates on one axis that act on all, family by family: axis -> a matrix, one column for each.
    `not_tried` holds effect, 0-based axis (None: whole arm) and reason of what these data do not allow.
    """

    matrix: dict[int, np.ndarray]
    entries: dict[int, list[tuple[Candidate, slice, np.ndarray]]]
    whole: list[tuple[Candidate, dict[int, np.ndarray], np.ndarray]]
    not_tried: list[tuple[str, int | None, str]] = field(default_factory=list)
    spreading: list[tuple[list[Candidate], dict[int, np.ndarray]]] = field(default_factory=list)

    _products: dict[int, Products] = field(default_factory=dict, repr=False)
    _groups: dict[int, list[Group]] = field(default_factory=dict, repr=False)

    def products(self, axis: int, columns: np.ndarray) -> Products:
        """Return the sums of products of a matrix (m, k) of this dictionary, on one axis."""
        return self._products.setdefault(id(columns), Products(axis, columns))

    def groups(self, axis: int) -> list[Group]:
        """Return the candidates on one axis in groups of as many columns."""
        if axis not in self._groups:
            self._groups[axis] = _grouped(self.matrix[axis], self.entries[axis])
        return self._groups[axis]

    def of_axes(self, axes: Collection[int | None]) -> Dictionary:
        """Return the candidates on some axes, and all of those on the whole arm."""
        matrix = {axis: matrix for axis, matrix in self.matrix.items() if axis in axes}
        entries = {axis: self.entries[axis] for axis in matrix}
        spreading = [one for one in self.spreading if one[0][0].axis in axes]
        return replace(self, matrix=matrix, entries=entries, spreading=spreading)


def raw_columns(white: White, candidate: Candidate, band: float = 1.0) -> np.ndarray:
    """Return the columns (N_train, k) of a single-axis candidate before whitening; `band` as of White.state_of.

    Raises
    ------
    InputError : if the file of the effect gives columns of another shape.
    """
    effect = get_effect(candidate.effect)
    state = white.state_of(effect, candidate.axis, candidate.nonlinear, band, candidate.wide)
    columns = effect.columns(state, candidate.axis, candidate.source, candidate.nonlinear)
    wanted = np.shape(state.position) if effect.whole_arm else np.shape(state.position)[:1]
    if np.shape(columns)[:-1] != wanted:
        asked = ", ".join(map(str, wanted))
        raise InputError(
            f"effect '{candidate.effect}': 'columns' gives shape {np.shape(columns)} (allowed: ({asked}, k), one row a "
            "sample and one column a coefficient)"
        )
    return columns


def on_all_axes(candidate: Candidate) -> bool:
    """Return whether a candidate on one axis acts on the others too."""
    if candidate.effect == LINK_MASS or candidate.axis is None:
        return False
    return get_effect(candidate.effect).spreads(candidate.nonlinear)


def on_its_axis_alone(candidate: Candidate) -> bool:
    """Return whether a candidate is an effect on one axis that acts on no other."""
    return candidate.effect != LINK_MASS and candidate.axis is not None and not on_all_axes(candidate)


def wider(white: White, candidate: Candidate) -> Candidate | None:
    """Return an elastic gear behind the encoder with columns that go on as far as its torque can be judged.

    None where they end no further up than those in which noise feigns nothing.
    """
    if not on_its_axis_alone(candidate) or not white.fuses_load(get_effect(candidate.effect), candidate.axis):
        return None
    cutoffs = white.cutoffs[candidate.axis]
    return replace(candidate, wide=True) if cutoffs.swing < cutoffs.judged < np.inf else None


def raw_torques(white: White, candidate: Candidate) -> dict[int, np.ndarray]:
    """Return the columns (N_train, k) before whitening, on every axis that it acts on, of a candidate on one axis."""
    if candidate.both:
        return {half.axis: raw_columns(white, half) for half in candidate.halves}
    if not on_all_axes(candidate):
        return {candidate.axis: raw_columns(white, candidate)}
    problem, effect = white.problem, get_effect(candidate.effect)
    torque = effect.spread(problem.train_state, candidate.axis, candidate.source, candidate.nonlinear)
    return {a: _ended(white, a, torque[:, [a]]) for a in problem.judged}


def _ended(white: White, axis: int, columns: np.ndarray) -> np.ndarray:
    """Return columns (N_train, k) on one axis of effects that spread, ended where those of a swing end."""
    return ended(white.problem, columns, white.cutoffs[axis].swing)


def whitened(white: White, torques: dict[int, np.ndarray]) -> dict[int, np.ndarray]:
    """Return columns (N_train, k) on some axes, as of :func:`raw_torques`, whitened."""
    return {a: white.columns(a, columns) for a, columns in torques.items()}


def term_of(white: White, candidate: Candidate) -> Term:
    """Return the term of the model that a candidate on one axis is."""
    torques = raw_torques(white, candidate)
    std = prior_std(white, candidate, torques[candidate.axis])
    raw = {a: white.raw(a, columns) for a, columns in torques.items()}
    return Term(f"{candidate.effect} {candidate.axis}", whitened(white, torques), std, raw, effect=True)


def fitted_torque(white: White, fit: Fit, candidate: Candidate, blocks: dict, std: np.ndarray) -> np.ndarray:
    """Return the torque [N m] of a candidate, fitted beside a fit, on the samples of its axis that can be used.

    Parameters
    ----------
    blocks : whitened columns of the candidate by axis. std : (k,) prior standard deviations of their coefficients.
    """
    b, gram = fit.gram(blocks)
    torque = raw_columns(white, candidate) @ posterior_mean(b, gram, std)
    return torque[white.problem.usable[:, candidate.axis]]


def raw_blocks(white: White, candidate: Candidate) -> dict[int, np.ndarray]:
    """Return axis -> unwhitened columns (m, k) [N m] of any candidate, on the rows of the whitened ones."""
    problem = white.problem
    if candidate.effect == LINK_MASS:
        torque = problem.link_mass_torque(candidate.axis)
        return {a: white.raw(a, white.limited(a, torque[:, [a]])) for a in problem.judged if np.any(torque[:, a])}
    if candidate.axis is None:
        columns = get_effect(candidate.effect).columns(problem.train_state, 0, None, candidate.nonlinear)
        return {a: white.raw(a, white.limited(a, columns[:, a])) for a in problem.judged}
    return {a: white.raw(a, columns) for a, columns in raw_torques(white, candidate).items()}


def prior_std(white: White, candidate: Candidate, columns: np.ndarray) -> np.ndarray:
    """Return prior standard deviations (k,): each column is worth the `usual` share of the friction of its axis.

    An effect may say that some of its coefficients are usually larger.
    """
    if on_all_axes(candidate):
        # Its size is in its parameters.
        return np.ones(columns.shape[1])
    return _std_of_size(white, candidate, _rms(white, candidate.axis, columns))


def _rms(white: White, axis: int, columns: np.ndarray) -> np.ndarray:
    """Return the RMS (k,) of columns (N_train, k) over the samples of an axis that can be judged."""
    rows = white.problem.rows_used[axis]
    return np.sqrt(np.array([(used := series.take(rows)) @ used for series in columns.T]) / max(len(rows), 1))


def _std_of_size(white: White, candidate: Candidate, size: np.ndarray) -> np.ndarray:
    """Return :func:`prior_std` of columns of RMS `size` (k,)."""
    widths = get_effect(candidate.effect).widths
    std = white.problem.settings.usual * white.problem.scale[candidate.axis] / np.maximum(size, 1e-12)
    return std * np.array(widths) if len(widths) == len(std) else std


def resolved(white: White, axis: int, order: float) -> bool:
    """Return whether a line of `order` over the motor angle lies in the band of the torque for half of the samples."""
    return in_band(white.problem, axis, order * abs(white.problem.robot.gear_ratio[axis]))


def resolved_bases(white: White, axis: int) -> list[Basis]:
    """Return the bases of structure on an axis, over the angle of its motor only where waves over it are resolved."""
    known = resolved(white, axis, 0.5 * ORDERS)
    return [basis for basis in white.bases(axis) if known or basis.argument != "motor angle"]


def of_bases(white: White, fit: Fit, axis: int, bases: Sequence[Basis]) -> Iterator[tuple[Basis, Seen]]:
    """Yield those of the bases of structure on an axis that hold anything, with what a fit leaves of their columns."""
    series, held, total = np.empty((sum(b.columns.shape[1] for b in bases), len(white.targets[axis]))), [], 0
    for basis in bases:
        own = white.columns(axis, basis.columns).T
        held.append(np.einsum("ij,ij->i", own, own) > 1e-9)
        count = int(held[-1].sum())
        series[total : total + count] = own if count == len(own) else own[held[-1]]
        total += count
    # The products with the columns of the fit are those of all bases at once.
    every = series[:total].T
    b, cross = fit.projected({axis: every})
    taken, start = cross @ fit.covariance, 0
    for basis, good in zip(bases, held, strict=True):
        own = slice(start, start := start + int(good.sum()))
        if good.any():
            columns = every[:, own]
            full = columns.T @ columns
            yield basis, Seen(columns, good, b[own], full - taken[own] @ cross[own].T, full)


def sources_of(axis: int, joints: int) -> list[int]:
    """Return the axes whose drive may act on `axis`: its neighbours up to two joints away."""
    return [k for k in range(max(0, axis - 2), min(joints, axis + 3)) if k != axis]


def build_dictionary(white: White) -> Dictionary:
    """Evaluate every effect of the library on every judged axis."""
    result = Dictionary({}, {}, [])
    for axis in white.problem.judged:
        _add_axis(result, white, axis)
    _add_whole_arm(result, white)
    return result


def _add_axis(dictionary: Dictionary, white: White, axis: int) -> None:
    problem, state = white.problem, white.problem.train_state
    rows, found, start = [], [], 0
    for effect in library().values():
        if effect.whole_arm:
            continue
        why = TOO_COARSE if axis in problem.too_coarse else effect.unmet(state, axis)
        if why:
            dictionary.not_tried.append((effect.identifier, axis, why))
            continue
        unresolved = infinite = 0
        grid = effect.grid(state, axis)
        spreading: list[Candidate] = []
        for source in sources_of(axis, problem.robot.joints) if effect.needs_source else [None]:
            if source is not None and np.ptp(state.position[:, source]) < STILL:
                continue
            for nonlinear in grid:
                if effect.waves is not None and not in_band(problem, axis, effect.waves(state, axis, nonlinear)):
                    unresolved += 1
                    continue
                candidate = Candidate(effect.identifier, axis, source, dict(nonlinear))
                if on_all_axes(candidate):
                    spreading.append(candidate)
                    continue
                columns = raw_columns(white, candidate)
                size = _rms(white, axis, columns)
                if not np.isfinite(size).all():
                    infinite += 1
                    continue
                if not size.any():
                    continue
                std = _std_of_size(white, candidate, size)
                found.append((candidate, slice(start, start + columns.shape[1]), std))
                rows.append(columns.T)
                start += columns.shape[1]
        if spreading:
            dictionary.spreading.append((spreading, _on_all_axes(white, spreading)))
        if unresolved and unresolved == len(grid):
            dictionary.not_tried.append((effect.identifier, axis, "its waves are faster than the sampling"))
        if infinite and not any(one.effect == effect.identifier for one, *_ in found):
            dictionary.not_tried.append((effect.identifier, axis, "its columns are not finite on these data"))
    # A few columns at a time are taken out again: each lies in one piece.
    dictionary.matrix[axis] = white.columns(axis, np.concatenate([*rows, np.zeros((0, len(state.time)))]).T)
    dictionary.entries[axis] = found


def _on_all_axes(white: White, candidates: list[Candidate]) -> dict[int, np.ndarray]:
    """Return axis -> whitened columns, one for each candidate of an effect that spreads."""
    problem = white.problem
    torques = np.empty((problem.robot.joints, len(candidates), int(problem.train.sum())))
    for k, one in enumerate(candidates):
        torques[:, k] = get_effect(one.effect).spread(problem.train_state, one.axis, one.source, one.nonlinear).T
    return {a: np.asfortranarray(white.columns(a, _ended(white, a, torques[a].T))) for a in problem.judged}


def _add_whole_arm(dictionary: Dictionary, white: White) -> None:
    problem = white.problem
    state = problem.train_state
    for effect in library().values():
        if not effect.whole_arm:
            continue
        why = TOO_COARSE if set(problem.judged) == set(problem.too_coarse) else effect.unmet(state, 0)
        if why:
            dictionary.not_tried.append((effect.identifier, None, why))
            continue
        for nonlinear in effect.grid(state, 0):
            columns = effect.columns(state, 0, None, nonlinear)
            blocks = {a: white.columns(a, white.limited(a, columns[:, a])) for a in problem.judged}
            candidate = Candidate(effect.identifier, None, None, dict(nonlinear))
            std = problem.body_prior.get(candidate.effect)
            dictionary.whole.append((candidate, blocks, effect.prior(problem.robot) if std is None else std))
    for link in range(problem.robot.joints):
        blocks = link_mass_blocks(white, link)
        if blocks:
            dictionary.whole.append((Candidate(LINK_MASS, link, None), blocks, np.array([problem.settings.usual])))
