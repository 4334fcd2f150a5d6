"""Labels of programs as a window keeps them: how many of its samples each holds, as one line of text."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

#: Share of the samples of a window from which on a program counts.
PART = 0.1


def label_text(program: np.ndarray) -> str:
    """Return the samples of each label of `program` (m,) as text; samples without a label are not counted."""
    labels = np.asarray(program, dtype=str)
    if len(labels) and (labels == labels[0]).all():
        # As in most windows; sorting texts takes long.
        return _text({str(labels[0]): len(labels)} if labels[0] else {})
    names, counts = np.unique(labels, return_counts=True)
    return _text({str(k): int(c) for k, c in zip(names, counts, strict=True) if k})


def add_labels(total: np.ndarray, place: Sequence[int] | np.ndarray, texts: Sequence[str] | np.ndarray) -> None:
    """Add the counts of `texts` (k,) to those of `total` (w,), in place, at the rows `place` (k,)."""
    for row, text in zip(place, texts, strict=True):
        if text:
            total[row] = _text(_merged(_counts(total[row]), _counts(text))) if total[row] else text


def window_programs(labels: np.ndarray) -> list[str]:
    """Return the name of the program of every window, empty where the log names none.

    Parameters
    ----------
    labels : (w,) counts of labels as text, :func:`label_text`.
    """
    names = []
    for text in labels:
        counts = _counts(text)
        least = PART * sum(counts.values())
        names.append(" + ".join(sorted(k for k, c in counts.items() if c >= least)))
    return names


def _counts(text: str) -> Mapping[str, int]:
    return json.loads(text) if text else {}


def _merged(one: Mapping[str, int], other: Mapping[str, int]) -> dict[str, int]:
    return {k: one.get(k, 0) + other.get(k, 0) for k in {*one, *other}}


def _text(counts: Mapping[str, Any]) -> str:
    return json.dumps(dict(sorted(counts.items())), ensure_ascii=False) if counts else ""
