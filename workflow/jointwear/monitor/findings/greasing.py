"""An arm that was greased and nobody told, or that is colder than it was: viscous friction of all axes stands higher.

Thicker grease raises viscous friction and lowers Coulomb friction, on every axis alike, so that no axis stands out of
what they have in common. The cold raises viscous friction too, and the level of all friction with it, each shift in the
same proportion. So what the level lacks of that proportion tells them apart: new grease takes it down from one shift to
the next, and there it stays however the weather changes viscous friction. Where the level has not fallen, either may
be.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.files.shown_numbers import fixed
from jointwear.files.wording import name_axes
from jointwear.monitor.normal.conditions import SAME
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.watching import Watch

#: Kind of the finding.
GREASED = "greased"
#: Growth of viscous friction, of itself, that all axes have in common, and how many times that of the level it is: in
#: the cold twice at most, as the level holds a part of viscous friction or takes of it; after greasing four times.
LEAST, TIMES = 0.05, 3.0
#: Shifts in a row that show it, and share of the largest rise that all of them keep: what the weather did goes back bit
#: by bit. Share of the axes that show it by themselves.
LASTS, KEPT, MOST_AXES = 3, 0.5, 0.5
#: What the level lacks of what the cold does to it, after greasing: at least so much, and so many times what it
#: differs by between shifts before. Shifts before that tell.
FALLEN, TIMES_BEFORE, FEWEST_SHIFTS = 0.02, 4.0, 3
#: Growth of the level for one of viscous friction in the cold: none at least, that of :data:`TIMES` less than once at
#: most.
COLD = (0.0, 0.5)


def greasing_findings(
    statistics: WindowStatistics,
    shift: np.ndarray,
    baseline: np.ndarray,
    level: Watch,
    viscous: Watch,
    of_viscous: Sequence[float] | np.ndarray,
) -> list[dict[str, Any]]:
    """Return the finding on viscous friction that stands higher on all axes to this day, or none; `unsure` where it may
    be the cold as well.

    Parameters
    ----------
    shift : (w,) labels. baseline : (w,) bool. of_viscous : (n,) growth of viscous friction, of itself, for one unit of
    `viscous`.
    """
    known = (np.isfinite(level.residual) & np.isfinite(viscous.residual)).any(axis=1)
    judged = after_baseline(baseline) & known
    names = np.unique(shift[judged])
    whole, part = (_means(w, shift, judged) for w in (level, viscous))
    lacks = _beside_the_cold(level, viscous, shift, baseline & known, judged)
    since = _fell_since(part, *lacks)
    unsure = since is None
    if unsure:
        since = _risen_since(whole, part)
    if since is None:
        return []
    rows = judged & np.isin(shift, names[since:])
    grown = np.asarray(of_viscous) * (viscous.residual + viscous.shared.value)[rows]
    told = np.isfinite(grown).any(axis=0)
    own = np.array([float(np.nanmean(grown[:, j])) if told[j] else np.nan for j in range(grown.shape[1])])
    axes = [int(j) + 1 for j in np.flatnonzero(np.nan_to_num(own) > LEAST)]
    if len(axes) <= MOST_AXES * told.sum():
        return []
    size = float(np.median(own[[a - 1 for a in axes]]))
    warmer = _warmer(statistics.temperature[:, [a - 1 for a in axes]], baseline, rows)
    words = _words(axes, fixed(100 * size, 0, True), unsure, warmer)
    doubt = {"unsure": True} if unsure else {}
    time = float(statistics.start[np.flatnonzero(rows)[0]])
    return [{"time": time, "axes": axes, "kind": GREASED, "words": words, **doubt}]


def _warmer(temperature: np.ndarray, baseline: np.ndarray, rows: np.ndarray) -> float:
    """Return by how much axes are warmer in windows `rows` (w,) than in the `baseline` (w,) [K], NaN where the
    temperature of any of them (w, k) is not known in either, or never changed there.

    What it says of friction is taken out of what is told.
    """
    known = np.isfinite(temperature)
    there = [(known & part[:, None]).any(axis=0).all() for part in (baseline, rows)]
    if not all(there):
        return np.nan
    usual, now = (np.where(known & part[:, None], temperature, np.nan) for part in (baseline, rows))
    if not np.all(np.nanmax(usual, axis=0) - np.nanmin(usual, axis=0) > SAME):
        return np.nan
    return float(np.mean(np.nanmean(now, axis=0) - np.nanmean(usual, axis=0)))


def _words(axes: list[int], size: str, unsure: bool, warmer: float) -> str:
    risen = f"Viscous friction of {name_axes(axes)} has risen together, by about {size} %, and has kept, while friction"
    if not unsure:
        return (
            f"{risen} at low speed fell with it: was the arm greased? Thicker grease does that, wear and cold do not. "
            "Enter it under 'events' as a service of these axes, or look for another oil or another controller."
        )
    if np.isfinite(warmer):
        return (
            f"{risen} as a whole hardly did. Their thermometers show {_by_degrees(warmer)} than in the normal period, "
            "and what is normal allows for that: was the arm greased, or is the oil colder than where the thermometers "
            "sit? Either does that, wear does not. Only if it was greased, enter that under 'events' as a service of "
            "these axes, for what is normal is then learnt anew."
        )
    return (
        f"{risen} as a whole hardly did: is the arm colder than in the normal period, or was the arm greased? Either "
        "does that, wear does not. Compare temperatures; only if it was greased, enter that under 'events' as a "
        "service of these axes, for what is normal is then learnt anew."
    )


def _by_degrees(warmer: float) -> str:
    """Return a difference of temperatures [K] in words, before `than`."""
    size = fixed(abs(warmer), 0)
    return "no other temperature" if size == "0" else f"{size} K {'more' if warmer > 0 else 'less'}"


def _means(watched: Watch, shift: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return what all axes have in common in each shift (s,) of windows `rows` (w,) bool, in order of its label."""
    return np.array([float(np.mean(watched.shared.common[rows & (shift == s)])) for s in np.unique(shift[rows])])


def _risen_since(whole: np.ndarray, part: np.ndarray) -> int | None:
    """Return the shift since which viscous friction stands higher by more than the cold lets it, None for never."""
    shown = (part > LEAST) & (part > TIMES * np.maximum(whole, 0.0))
    since = _last_run(shown)
    kept = len(shown) - since >= LASTS and part[since:].min() >= KEPT * part[since:].max()
    return since if kept else None


def _beside_the_cold(
    level: Watch, viscous: Watch, shift: np.ndarray, baseline: np.ndarray, judged: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return what the level has in each shift beside what the cold does to it: of the baseline and of those after."""
    (whole, part), (later, risen) = ([_means(w, shift, r) for w in (level, viscous)] for r in (baseline, judged))
    square = float(part @ part)
    slope = float(np.clip(whole @ part / square, *COLD)) if square > 0 else COLD[0]
    return whole - slope * part, later - slope * risen


def _fell_since(part: np.ndarray, before: np.ndarray, after: np.ndarray) -> int | None:
    """Return the shift since which the level lacks as much of what the cold does to it as it did at once, beside
    viscous friction that has risen, None for never.

    Parameters
    ----------
    part : (s,) growth of viscous friction. before, after : of :func:`_beside_the_cold`; after (s,).
    """
    if len(before) < FEWEST_SHIFTS:
        return None
    least = max(FALLEN, TIMES_BEFORE * float(np.sqrt(np.mean(before**2))))
    since = _last_run(after < -least)
    fallen = -after[since:]
    # At once: the first of these shifts shows it as the others do, and those before it did not.
    step = len(fallen) >= LASTS and fallen.min() >= KEPT * fallen.max()
    step = step and np.all(-after[:since] < KEPT * np.median(fallen))
    return since if step and part[since:].mean() > LEAST else None


def _last_run(shown: np.ndarray) -> int:
    """Return where the run of True to the end of (s,) begins, its length where there is none."""
    return len(shown) - int(np.argmin(shown[::-1])) if not shown.all() else 0
