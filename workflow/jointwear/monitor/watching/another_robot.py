"""Most axes step at once, some up and some down: logs of another robot of the kind under this name, or other drives.

Gears wear one at a time; oil and weather move all axes to the same side; a gain moves all of them alike
(:mod:`.gain_of_all`). Two robots of a kind differ on every axis, on each by its own share. What such logs are held
against says nothing of them: they are not judged once the robot is itself again, and while it is not, every axis is
learnt anew from the step on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jointwear.monitor.normal.learning import AxisNormal
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.watching.scale import FEWEST_TOGETHER, TOGETHER, cut_beside, shift_steps
from jointwear.monitor.watching.shared_error import FINDING
from jointwear.monitor.watching.watching import Watch
from jointwear.statistics.known import known_median

#: Share of the axes that have to step, by more than what they have in common has to be to be told; fewest of them that
#: rise: one may wear while a service takes friction off the others, unless so many step.
MOST_AXES, FEWEST_RISEN, MANY = 0.5, 2, 5
#: Part of the step that has to lie between a shift and the one before it.
SUDDEN = 0.5
#: It is over where less than this part of the step is left, of more than this share of the axes that show it.
OVER, MOST_OVER = 0.5, 2 / 3


@dataclass(frozen=True)
class Exchange:
    """From `window` to before `end`, None where it goes on, the logs are those of another robot, or drives are others.

    `rose` and `fell` are the 0-based axes that show it, `axes` all that are watched.
    """

    window: int
    end: int | None
    axes: tuple[int, ...]
    rose: tuple[int, ...]
    fell: tuple[int, ...]


def first_exchange(level: Watch, shift: np.ndarray, baseline: np.ndarray) -> Exchange | None:
    """Return the first moment at which most axes step at once, up and down; None where there is none.

    Parameters
    ----------
    level : friction, watched without looking for services and for what axes have in common. shift : (w,) labels.
    baseline : (w,) bool.

    Notes
    -----
    Two shifts in a row must show it, each of the axes to the same side, or the one that runs; and two its end.
    """
    axes = [j for j, axis in enumerate(level.axes) if axis is not None]
    names = np.unique(shift)
    if len(axes) < FEWEST_TOGETHER:
        return None
    # Where an axis has just been learnt anew, nothing is usual but what it was learnt to be.
    usual, step = shift_steps(level, axes, names, shift, unknown=0.0)
    told = np.isfinite(step[..., 0]).sum(axis=1) > 0.5 * len(axes)
    names, usual, step = names[told], usual[told], step[told]
    if not len(names):
        return None
    mean, error = usual + step[..., 0], step[..., 1]
    # The shift that runs has none behind it, and nobody is to be sent to a gear until there is.
    after = np.minimum(np.arange(len(names)) + 1, len(names) - 1)
    first, second = mean - usual, mean[after] - usual
    # What has been growing, or stepped in the shift before, does not step in this one.
    before = np.where(np.isfinite(mean[:-1]), mean[:-1], usual[1:])
    jump = mean - np.concatenate([usual[:1], before])
    both = np.sign(first) == np.sign(second)
    with np.errstate(invalid="ignore"):
        both &= jump * np.sign(second) > SUDDEN * np.abs(second)
        for size, own in ((first, error), (second, error[after])):
            both &= (np.abs(size) > FINDING) & (np.abs(size) > TOGETHER * own)
    rose, fell = both & (first > 0), both & (first < 0)
    known = (np.isfinite(first) & np.isfinite(second)).sum(axis=1)
    found = both.sum(axis=1) >= np.maximum(FEWEST_TOGETHER, MOST_AXES * known)
    found &= rose.any(axis=1) & fell.any(axis=1)
    found &= (rose.sum(axis=1) >= FEWEST_RISEN) | (both.sum(axis=1) >= MANY)
    found &= np.isin(names, shift[after_baseline(baseline)]) & ~np.isin(names, shift[baseline])
    if not found.any():
        return None
    a = int(np.argmax(found))
    some = np.flatnonzero(both[a])
    # What is left of the step, window by window: one while it lasts.
    size = second[a, some]
    part, noise = (level.residual[:, some] - usual[a, some]) / size, level.noise[:, some] / size**2
    begin = cut_beside(part, noise, 1.0, shift, names[max(a - 1, 0) : a + 1], baseline)
    where = (tuple(int(j) for j in np.flatnonzero(x)) for x in (rose[a], fell[a]))
    return Exchange(begin, _end(part, noise, shift, names, a, baseline), tuple(axes), *where)


def _end(
    part: np.ndarray, noise: np.ndarray, shift: np.ndarray, names: np.ndarray, first: int, baseline: np.ndarray
) -> int | None:
    """Return the window from which on most axes are as before the step, two shifts in a row; None where none are.

    Parameters
    ----------
    part, noise : (w, k) what is left of the step, and its variance. shift : (w,) shift of each window.
    names : (s,) of the shifts that are asked, in order. first : place in `names` of the shift that shows the step.
    baseline : (w,) windows of the normal period.
    """
    left = np.full((len(names), part.shape[1]), np.nan)
    for a in range(first + 2, len(names)):
        left[a] = known_median(part[shift == names[a]], axis=0)
    with np.errstate(invalid="ignore"):
        over = (np.abs(left) < OVER).sum(axis=1) > MOST_OVER * np.maximum(np.isfinite(left).sum(axis=1), 1)
    pairs = np.flatnonzero(over[1:] & over[:-1])
    if not len(pairs):
        return None
    return cut_beside(1 - part, noise, 1.0, shift, names[pairs[0] - 1 : pairs[0] + 1], baseline)


def without_exchange(axes: list[AxisNormal | None], one: Exchange) -> list[AxisNormal | None]:
    """Return the normal states with nothing to hold the windows of an exchange that is over against."""

    def blind(axis: AxisNormal | None) -> AxisNormal | None:
        if axis is None:
            return None
        matrix = axis.design.matrix.copy()
        matrix[one.window : one.end] = np.nan
        return replace(axis, design=replace(axis.design, matrix=matrix))

    return [blind(axis) for axis in axes]
