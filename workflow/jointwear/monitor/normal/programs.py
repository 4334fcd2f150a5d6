"""Programs as the log names them, in place of regimes that are found in the motion (:mod:`.regimes`).

The config says in which columns a log names its program (task, payload, speed override, whatever decides what the arm
does), or what the logs of a name hold. A window that mixes programs is a program of its own, named after all that hold
:data:`~jointwear.monitor.reading.program_labels.PART` of its samples or more. A program with fewer than
:data:`~.regimes.FEWEST_OF_REGIME` windows in the baseline was never seen: its windows are not judged before its
normal has been learnt, as those of a regime that the motion shows late.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from jointwear.files.wording import listed
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.program_labels import window_programs
from jointwear.monitor.reading.regimes import FEWEST_OF_REGIME
from jointwear.monitor.reading.windows import WindowStatistics


def labelled_regimes(labels: np.ndarray, baseline: np.ndarray) -> np.ndarray | None:
    """Return the regime (w,) of every window, -1 where it has none; None where no window has a label.

    Programs of the baseline come first, those that came later behind them.

    Parameters
    ----------
    labels : (w,) of the statistics. baseline : (w,) bool.
    """
    names = np.array(window_programs(labels), dtype=object)
    if not any(names):
        return None
    regime = np.full(len(names), -1)
    for rows in (baseline, ~baseline):
        known, counts = np.unique(names[rows].astype(str), return_counts=True)
        for name in known[counts >= FEWEST_OF_REGIME]:
            if name and not (regime[names == name] >= 0).any():
                regime[(names == name) & (rows | ~baseline)] = regime.max() + 1
    return regime


def unseen_programs(labels: np.ndarray, baseline: np.ndarray) -> list[tuple[str, int]]:
    """Return the programs that the baseline lacks, each with the window in which it first runs.

    Parameters
    ----------
    labels : (w,) as of :func:`window_programs`. baseline : (w,) bool.
    """
    names = window_programs(labels)
    seen = np.array([name for name, inside in zip(names, baseline, strict=True) if inside], dtype=str)
    first: dict[str, int] = {}
    after = after_baseline(baseline)
    for k, name in enumerate(names):
        if name and after[k] and np.sum(seen == name) < FEWEST_OF_REGIME:
            first.setdefault(name, k)
    return list(first.items())


def among_programs(labels: np.ndarray, regime: np.ndarray | None, rows: np.ndarray) -> str:
    """Return in words in which program windows ran, with a preposition; empty where they are of all that there are.

    Parameters
    ----------
    labels : (w,) as of :func:`window_programs`. regime : (w,) program as it is recognised, -1 unknown, or None for one.
    rows : which windows, indices.
    """
    names = np.array(window_programs(labels), dtype=object)
    own, every = set(names[rows]) - {""}, set(names) - {""}
    if own and len(own) < len(every) and all(names[rows]):
        return f"in program{'s' if len(own) > 1 else ''} {listed(repr(name) for name in sorted(own))}"
    if every or regime is None:
        return ""
    own, every = set(regime[rows].tolist()), set(regime.tolist()) - {-1}
    if -1 in own or not own < every:
        return ""
    return f"in {len(own)} of its {len(every)} programs"


def program_findings(statistics: WindowStatistics, baseline: np.ndarray, judged: np.ndarray) -> list[dict[str, Any]]:
    """Return a finding for every program that began after the baseline (w,): its normal has to be learnt first.

    Parameters
    ----------
    judged : (w,) bool, in which most axes are judged.
    """
    names = np.array(window_programs(statistics.labels), dtype=object)
    result = []
    for name, k in unseen_programs(statistics.labels, baseline):
        rows = np.flatnonzero((names == name) & after_baseline(baseline))
        words = f"Program '{name}' began, which the baseline does not hold: "
        words += learnt_in_words(judged[rows], statistics.length)
        result.append({"time": float(statistics.start[k]), "axes": [], "kind": "program", "words": words})
    return result


def learnt_in_words(judged: np.ndarray, length: float) -> str:
    """Return in words from when on most axes are judged in a program that the baseline lacks.

    Parameters
    ----------
    judged : (k,) bool, its windows in which they are. length : of a window [s].
    """
    if not judged.any():
        return "it cannot be judged yet. Its own normal is learnt from its first shifts."
    hours = float(np.argmax(judged)) * length / 3600
    return f"its own normal was learnt from its first shifts, most axes are judged in it after {hours:.3g} h."
