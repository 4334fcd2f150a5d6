"""An arm that was greased and nobody told: viscous friction of all axes stands higher at once, friction hardly.

Thicker grease raises viscous friction and lowers Coulomb friction, on every axis alike, so that no axis stands out of
what they have in common. Cold oil raises viscous friction too, and the level of all friction with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.watching import Watch
from jointwear.publishing.report.numbers import fixed

#: Kind of the finding.
GREASED = "greased"
#: Growth of viscous friction, of itself, that all axes have in common, and how many times that of the level it is: in
#: the cold twice at most, as the level holds a part of viscous friction or takes of it; after greasing four times.
LEAST, TIMES = 0.05, 3.0
#: Shifts in a row that show it, and share of the largest rise that all of them keep: what the weather did goes back bit
#: by bit. Share of the axes that show it by themselves.
LASTS, KEPT, MOST_AXES = 3, 0.5, 0.5


def greasing_findings(
    statistics: WindowStatistics,
    shift: np.ndarray,
    baseline: np.ndarray,
    level: Watch,
    viscous: Watch,
    of_viscous: Sequence[float] | np.ndarray,
) -> list[dict[str, Any]]:
    """Return the finding on viscous friction that stands higher on all axes to this day, or none.

    Parameters
    ----------
    shift : (w,) labels. baseline : (w,) bool. of_viscous : (n,) growth of viscous friction, of itself, for one unit of
    `viscous`.
    """
    judged = after_baseline(baseline) & (np.isfinite(level.residual) & np.isfinite(viscous.residual)).any(axis=1)
    names = np.unique(shift[judged])
    means = [[float(np.mean(w.shared.common[judged & (shift == s)])) for s in names] for w in (level, viscous)]
    whole, part = np.array(means).reshape(2, -1)
    shown = (part > LEAST) & (part > TIMES * np.maximum(whole, 0.0))
    since = len(names) - int(np.argmin(shown[::-1])) if not shown.all() else 0
    if len(names) - since < LASTS or part[since:].min() < KEPT * part[since:].max():
        return []
    rows = judged & np.isin(shift, names[since:])
    grown = np.asarray(of_viscous) * (viscous.residual + viscous.shared.value)[rows]
    told = np.isfinite(grown).any(axis=0)
    own = np.array([float(np.nanmean(grown[:, j])) if told[j] else np.nan for j in range(grown.shape[1])])
    axes = [int(j) + 1 for j in np.flatnonzero(np.nan_to_num(own) > LEAST)]
    if len(axes) <= MOST_AXES * told.sum():
        return []
    size = float(np.median(own[[a - 1 for a in axes]]))
    words = (
        f"Viscous friction of {name_axes(axes)} has risen together, by about {fixed(100 * size, 0, True)} %, and has "
        "kept, while friction as a whole hardly did: was the arm greased? Thicker grease does that, wear and cold do "
        "not. Enter it under 'events' as a service of these axes, or look for another oil or another controller."
    )
    return [{"time": float(statistics.start[np.flatnonzero(rows)[0]]), "axes": axes, "kind": GREASED, "words": words}]
