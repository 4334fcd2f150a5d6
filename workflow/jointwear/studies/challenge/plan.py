"""Which cases there are, under which seed each is drawn, and how they are dealt into batches.

The Snakefile imports this at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from jointwear.files.errors import InputError, nearest
from jointwear.studies.challenge.tiers import (
    BATCH,
    COUNTS,
    DRAWINGS,
    EFFECTS,
    KINDS,
    MODEL_PARAMETERS,
    OUTSIDE,
    SETS,
    TIERS,
)

_SUBJECTS = {"single": EFFECTS, "retuned": MODEL_PARAMETERS, "outside": OUTSIDE}


@dataclass(frozen=True)
class Case:
    """One case: its seed set, tier, kind and 0-based index within the kind.

    The random numbers of a case depend on these four words alone, so that a case stays the same however many others
    are run beside it.
    """

    set: str
    tier: str
    kind: str
    index: int

    @property
    def name(self) -> str:
        """File name of the case; it says nothing of what is hidden beyond the order of the plan."""
        return f"{self.tier}_{KINDS.index(self.kind)}{self.index:03d}"

    @property
    def key(self) -> tuple[str, ...]:
        """Words of the spawn key; the index is the replicate."""
        drawing = DRAWINGS[self.set]
        return ("challenge", self.set if drawing == 1 else f"{self.set} {drawing}", self.tier, self.kind)

    @property
    def subject(self) -> str | None:
        """The effect, parameter or disturbance that is hidden; None where chance decides or nothing is."""
        subjects = _SUBJECTS.get(self.kind)
        return subjects[self.index % len(subjects)] if subjects else None


def cases(seed_set: str, tier: str, counts: Mapping[str, int]) -> list[Case]:
    """Return the cases of one tier.

    Raises
    ------
    InputError : for a seed set, tier or kind that does not exist.
    """
    for word, allowed in ((seed_set, SETS), (tier, TIERS), *((kind, KINDS) for kind in counts)):
        if word not in allowed:
            raise InputError(f"challenge: there is no '{word}' (allowed: {', '.join(allowed)}){nearest(word, allowed)}")
    return [Case(seed_set, tier, kind, index) for kind in KINDS for index in range(int(counts.get(kind, 0)))]


def batches(seed_set: str, tier: str, counts: Mapping[str, int], size: int) -> list[list[Case]]:
    """Deal the cases of one tier into batches of at most `size`, every batch a like mixture of kinds.

    Raises
    ------
    InputError : if size is not positive, or as :func:`cases`.
    """
    if size < 1:
        raise InputError(f"challenge: the batch size is {size}; the nearest valid value is 1")
    every = cases(seed_set, tier, counts)
    count = -(-len(every) // size)
    return [every[first::count] for first in range(count)]


def batch(seed_set: str, tier: str, index: int) -> list[Case]:
    """Return one batch of a seed set with the counts and batch size that belong to it."""
    return batches(seed_set, tier, COUNTS[seed_set], BATCH[seed_set])[index]


def part_batches(part: str) -> tuple[str, dict[str, int]]:
    """Return the seed set of a part and how many batches of each tier it holds.

    A part is the name of a seed set, or `<set>_first_<k>`: the first k batches of every tier. Batches are like
    mixtures of all kinds, so that a part is a fair sample of its set.
    """
    seed_set, _, first = part.partition("_first_")
    counts = {t: len(batches(seed_set, t, COUNTS[seed_set], BATCH[seed_set])) for t in TIERS}
    return seed_set, {t: min(n, int(first)) if first else n for t, n in counts.items()}
