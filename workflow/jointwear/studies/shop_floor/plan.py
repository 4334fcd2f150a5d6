"""How large the study is. Read by the Snakefile at every call: nothing heavy is imported here."""

from __future__ import annotations

#: First robot-month of the reported figures, how many there are, and how many share a job. The months before the first
#: have been reported on, with judgements before this one: they say nothing new of it.
FIRST, REPORTED, TOGETHER = 7700, 200, 20
#: Stated rates [false alarms per 1,000 h].
RATES = (0.3, 1.0, 3.0)


def batch_of(index: int) -> str:
    """Return the name of the batch that a robot belongs to."""
    return f"{index // TOGETHER:03d}"


def batches(robots: int = REPORTED, first: int = FIRST) -> list[str]:
    """Return the names of the batches of so many robots from the `first` on, in order."""
    return sorted({batch_of(index) for index in range(first, first + robots)})


def robots_of(batch: str) -> range:
    """Return the indices of the robots of a batch."""
    first = int(batch) * TOGETHER
    return range(first, first + TOGETHER)
