"""Products, as the regression of a window shows them: by what it leaves, and by the bodies that seem to move.

A part that is carried on some moves, and that no load at the flange stands for (:mod:`.carried`), is left over by the
regression of a window, and moves the friction of the axes that lift it, those of neighbours opposite ways. What is left
grows or falls with it on several axes at once, from one shift to the next, where wear is of one axis. A part that is
carried all the time moves the bodies of the axes that lift it, each by its share, where a gain moves those of all by
the same. A program with such a product is another program (:mod:`.regimes`): with one that the baseline has it is told
by the likest of the baseline's shifts, with one that it lacks its normal is learnt first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.files.wording import listed, name_axes
from jointwear.monitor.normal.programs import learnt_in_words
from jointwear.monitor.normal.series import Series
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.logs_of_windows import LogsOfWindows
from jointwear.monitor.reading.regimes import programs_or_one
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Differences of the median noise of shifts, as logs: those of the baseline are of other products that differ by the
#: larger on some axis or by the smaller on so many; a later one that leaves the range of all, and of the windows, by
#: both has a product that the baseline lacks. Parts of 0.9 to 3.1 kg that no load stands for changed it by 1.2 to 1.6
#: times on the axes that lift them (two robots of the twenty-fifth fleet). Bodies of the arm that differ by both are
#: another load at any time.
FAR, APART, AXES = np.log(1.25), np.log(1.15), 2
#: The larger where one shift alone says what noise is usual. A part that a new program of a robot of the twenty-eighth
#: fleet did not have at first changed it by 2.1 to 2.4 times on three axes, with bodies just below FAR.
MUCH = np.log(1.5)
#: Standard error of the bodies of a shift above which they show nothing, as a share of APART; bodies are alike within
#: this share of their median, and more than the other of the axes alike are one gain.
KNOWN, SAME_BODIES, MOST_ALIKE = 0.25, 0.5, 0.5
#: Shifts of the baseline that tell its products, and windows of a later one that shows another: of two, one in which a
#: load was not found makes half of the median.
SHIFTS, WINDOWS = 3, 3
#: Most products of the baseline, and fewest shifts with each: more, or single ones, are what shifts scatter by.
MOST, FEWEST_OF_PRODUCT = 3, 2
#: Share of the windows of a shift above which, each being near some product that is known, the shift holds several of
#: these in turn: its medians lie between them. Seven windows of 19 kg and seven of 4 kg were a third part.
MOST_NEAR = 0.5
#: Share of the baseline's windows on either side that tell nothing of its range, so that a loud hour hides no product.
#: Where parts take turns from window to window, the medians of shifts lie close together beside what single windows
#: show, and that of a shift with more of one part leaves their range: three of three such robots of the twenty-sixth
#: fleet had a product that the baseline lacks within four days, by 1.2 to 1.9 times, with parts that it had.
TAIL = 0.05


@dataclass(frozen=True)
class Product:
    """A product that the baseline lacks: its `program` label, and the 1-based `axes` whose noise or bodies differ."""

    program: int
    axes: tuple[int, ...]


def with_products(
    statistics: WindowStatistics,
    scale: Series,
    regime: np.ndarray | None,
    shift: np.ndarray,
    baseline: np.ndarray,
    unseen: np.ndarray | None = None,
) -> tuple[np.ndarray | None, tuple[Product, ...]]:
    """Return the programs (w,), -1 unknown, told apart by products too, and the products that the baseline lacks; None
    where there is one program and one product.

    Parameters
    ----------
    scale : log of the size of the bodies, :func:`.scale.scale_series`.
    regime : (w,) of :mod:`.regimes`, or None for one program. shift : (w,) labels. baseline : (w,) bool.
    unseen : (w,) bool, windows at a speed that the baseline lacks, or of coarser numbers, default none. They tell no
        product: noise and bodies change with the speed as with a part, which the normal state has a column for
        (:mod:`.override`), and the noise with the numbers.
    """
    program = programs_or_one(regime, statistics.windows)
    seen = statistics.judgeable & (statistics.count > 0) & (statistics.noise_variance > 0)
    noise = np.where(seen, 0.5 * np.log(np.where(seen, statistics.noise_variance, 1.0)), np.nan)
    result, products = program.copy(), []
    for name in np.unique(program[program >= 0]):
        own = program == name if unseen is None else (program == name) & ~unseen
        early, late = (_by_shift(own & rows, shift, noise, scale) for rows in (baseline, after_baseline(baseline)))
        lacked = not early
        if lacked and not late:
            continue
        if lacked:
            # The first shift of a program that the baseline lacks stands for the usual product; where it holds an hour
            # or two of it, in which a load may not have been found, with the next.
            counts = np.cumsum([len(rows) for rows, _ in late])
            first = int(np.searchsorted(counts, WINDOWS)) + 1
            early, late = late[:first], late[first:]
        elif len(early) < SHIFTS:
            continue
        known = [middle for _, middle in early]
        windows = np.concatenate([rows for rows, _ in early])
        low, high = _range(known, np.stack([noise[windows], scale.value[windows]], axis=1))
        group = _groups(known)
        labels = [int(name), *(int(result.max()) + 1 + k for k in range(max(group)))]
        centres = [_middle([m for m, g in zip(known, group, strict=True) if g == k]) for k in range(len(labels))]
        for (rows, _), k in zip(early, group, strict=True):
            result[rows] = labels[k]
        products += _label_late(result, late, list(zip(centres, labels, strict=True)), (low, high), noise, lacked)
    return (None if regime is None and np.array_equal(result, program) else result), tuple(products)


def _label_late(
    result: np.ndarray,
    late: Sequence[tuple[np.ndarray, np.ndarray]],
    known: list[tuple[np.ndarray, int]],
    usual: tuple[np.ndarray, np.ndarray],
    noise: np.ndarray,
    of_one: bool,
) -> list[Product]:
    """Give the windows of later shifts the label of their product, and return the products that the baseline lacks.

    Parameters
    ----------
    result : (w,) labels, changed. late : of :func:`_by_shift`. known : middle (2, n) and label of the baseline's
        products. usual : of :func:`_range`. noise : (w, n) of the windows, as a log. of_one : as of :func:`_is_new`.
    """
    low, high = usual
    lacking: list[tuple[np.ndarray, int]] = []
    products = []
    for rows, middle in late:
        beyond = np.where(middle > high, middle - high, np.minimum(middle - low, 0.0))
        if not _is_new(beyond, of_one=of_one):
            distance = np.nan_to_num([_distance(centre, middle) for centre, _ in known])
            result[rows] = known[int(np.argmin(distance))][1]
            continue
        either = [*known, *lacking]
        nearest, distance = _nearest(noise[rows], [other for other, _ in either])
        in_turns = np.mean(distance <= FAR) > MOST_NEAR and not _other_load(beyond[1])
        if len(rows) < WINDOWS or in_turns:
            result[rows] = np.array([n for _, n in either])[nearest]
            continue
        label = next((n for other, n in lacking if _distance(other, middle) <= FAR), None)
        if label is None:
            label = int(result.max()) + 1
            lacking.append((middle, label))
            axes = np.flatnonzero((np.abs(np.nan_to_num(beyond)) > APART).any(axis=0)) + 1
            products.append(Product(label, tuple(axes.tolist())))
        result[rows] = label
    return products


def product_findings(
    statistics: WindowStatistics,
    program: np.ndarray | None,
    products: Sequence[Product],
    judged: np.ndarray,
    logs: LogsOfWindows | None = None,
) -> list[dict[str, Any]]:
    """Return a finding for every product that the baseline lacks.

    Parameters
    ----------
    program : (w,) as :func:`with_products` returns it. judged : (w,) bool, in which most axes are judged.
    logs : that the windows come from, default unknown. Those of a product that few have are named.
    """
    result = []
    for product in products:
        rows = np.flatnonzero(program == product.program)
        words = (
            f"The torque of {name_axes(list(product.axes))} changed at once, as with a part that this program did not "
            "have before and that no load of the robot file stands for: "
        )
        words += learnt_in_words(judged[rows], statistics.length)
        few = [] if logs is None else logs.few(rows)
        if few:
            words = f"{words} {log_words(few, logs.faults(rows))}"
        found = {"time": float(statistics.start[rows[0]]), "axes": [], "kind": "program", "words": words}
        told = {"logs": few} if few else {}
        result.append({**found, "moved": list(product.axes), "judged": bool(judged[rows].any()), **told})
    return result


def log_words(logs: Sequence[str], faults: str = "") -> str:
    """Return in words which few logs something lies in; `faults`: what else is odd about them, in words."""
    whose = listed(list(logs))
    why = f", for {faults}" if faults else ""
    return (
        f"All of it lies in {whose}: look at that first{why}; columns that are exchanged, another unit, lost rows or a "
        "torque that stands still do the same as a part."
    )


def _is_new(beyond: np.ndarray, of_one: bool) -> bool:
    """Return whether noise and bodies (2, n) that leave the range of what is known by so much, as logs, 0 within it and
    NaN unknown, are of another product; `of_one`: one shift alone says what is usual."""
    louder = np.abs(np.nan_to_num(beyond[0]))
    return _other_load(beyond[1]) or (_differ(louder) and bool(louder.max() > (MUCH if of_one else FAR)))


def _differ(step: np.ndarray) -> bool:
    """Return whether shifts that differ by `step` (n,), as logs, may be of other products."""
    return int((np.abs(step) > APART).sum()) >= AXES


def _other_load(step: np.ndarray) -> bool:
    """Return whether bodies that differ by `step` (n,), as logs, NaN unknown, carry another load: a gain of most axes
    makes them differ alike."""
    middle = float(known_median(step, axis=0)) if np.isfinite(step).any() else 0.0
    with np.errstate(invalid="ignore"):
        alike = np.abs(step - middle) < SAME_BODIES * abs(middle)
    if alike.sum() > MOST_ALIKE * np.isfinite(step).sum():
        step = np.where(alike, 0.0, step)
    step = np.nan_to_num(step)
    return _differ(step) and float(np.abs(step).max()) > FAR


def _groups(medians: Sequence[np.ndarray]) -> list[int]:
    """Return for each shift of the baseline, by noise and bodies (2, n) of its axes, which product it is of, 0 the most
    frequent one; all of one where they do not fall into a few groups. A single shift is one if its load differs."""
    members: list[list[int]] = []
    for k, middle in enumerate(medians):
        for own in members:
            step = _middle([medians[m] for m in own]) - middle
            noise = np.nan_to_num(step[0])
            if np.abs(noise).max() <= FAR and not _differ(noise) and not _other_load(step[1]):
                own.append(k)
                break
        else:
            members.append([k])
    members.sort(key=len, reverse=True)
    usual = _middle([medians[m] for m in members[0]])
    single = [own for own in members if len(own) < FEWEST_OF_PRODUCT]
    if len(members) > MOST or not all(_other_load((usual - medians[own[0]])[1]) for own in single):
        return [0] * len(medians)
    result = [0] * len(medians)
    for k, own in enumerate(members):
        for m in own:
            result[m] = k
    return result


def _middle(medians: Sequence[np.ndarray]) -> np.ndarray:
    """Return the middle (2, n) of shifts."""
    return known_median(np.array(medians), axis=0)


def _distance(one: np.ndarray, other: np.ndarray) -> float:
    """Return by how much noise or bodies (2, n) differ on the axis on which most; NaN where none is known of both."""
    return float(np.fmax.reduce(np.abs(one - other), axis=None))


def _nearest(noise: np.ndarray, products: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return (k,) which of `products` (2, n) the noise (k, n) of each window is nearest to, and its distance."""
    apart = np.abs(noise[:, None] - np.stack([own[0] for own in products]))
    distance = np.nan_to_num(np.fmax.reduce(apart, axis=2))
    nearest = np.argmin(distance, axis=1)
    return nearest, distance[np.arange(len(noise)), nearest]


def _range(medians: Sequence[np.ndarray], windows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the largest noise and bodies (2, n) that the baseline shows, by the medians of its shifts
    and by its `windows` (w, 2, n) but for the tails."""
    known = np.isfinite(windows)
    ordered = np.sort(np.where(known, windows, np.inf), axis=0)
    count = known.sum(axis=0)
    cut = np.floor(TAIL * count).astype(int)
    ends = (np.take_along_axis(ordered, np.maximum(k, 0)[None], 0)[0] for k in (cut, count - 1 - cut))
    least, largest = (np.where(count > 0, end, np.nan) for end in ends)
    return np.fmin.reduce([*medians, least]), np.fmax.reduce([*medians, largest])


def _by_shift(
    rows: np.ndarray, shift: np.ndarray, noise: np.ndarray, scale: Series
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the windows of each shift among `rows` (w,) bool, with the medians (2, n) of their `noise` (w, n) and of
    their bodies, NaN where these are not known."""
    result = []
    for name in np.unique(shift[rows]):
        own = np.flatnonzero(rows & (shift == name))
        value, variance = scale.value[own], scale.variance[own]
        middle, count = known_median(value, axis=0), np.isfinite(value).sum(axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            error = np.sqrt(np.nansum(variance, axis=0) + np.nansum((value - middle) ** 2, axis=0))
            bodies = np.where((count >= WINDOWS) & (error / count < KNOWN * APART), middle, np.nan)
        result.append((own, np.array([known_median(noise[own], axis=0), bodies])))
    return result
