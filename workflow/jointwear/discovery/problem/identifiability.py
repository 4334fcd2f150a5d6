"""What a motion can show at all: energy of every effect after the base regression and after each rival.

Nothing here looks at the measured torque except through the level and colour of its noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointwear.discovery.problem.candidates import Candidate, Dictionary
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect

#: Ridge, over the squares of all columns of a rival together, of what it takes off the others.
RIDGE = 1e-6


@dataclass(frozen=True)
class Visible:
    """One effect on one axis, or on the whole arm, at a usual size.

    `candidate` has the most energy of its family, with coefficients `std` (k,) at that size: `energy` over noise
    variance left after the base regression, `middle` that of the candidate in the middle of the family; `rival` the
    effect that takes most of it, and `left` what that leaves. `size` of an effect of the whole arm is that of its first
    parameter, in `unit`; of others the share of the friction of the axis, without a unit.
    """

    candidate: Candidate
    std: np.ndarray
    energy: float
    middle: float
    rival: str
    left: float
    size: float
    unit: str = ""

    @property
    def effect(self) -> str:
        """Name of the effect."""
        return self.candidate.effect

    @property
    def axis(self) -> int | None:
        """Its axis, 0-based; None for the whole arm."""
        return self.candidate.axis

    @property
    def source(self) -> int | None:
        """The axis that drives it, 0-based."""
        return self.candidate.source

    @property
    def at(self) -> str:
        """The size in words."""
        return f"{self.size:.2g} {self.unit}" if self.unit else f"{100 * self.size:.3g} % of the friction of the joint"


def identifiability(white: White, dictionary: Dictionary) -> list[Visible]:
    """Return the map for all effects and judged axes.

    Of every family the point of the grid with the most energy stands for the family.
    """
    fit, usual = white.fit(), white.problem.settings.usual
    found = []
    for axis, matrix in dictionary.matrix.items():
        if not dictionary.entries[axis]:
            continue
        families: dict[tuple, list[tuple[float, Candidate, slice, np.ndarray]]] = {}
        products = dictionary.products(axis, matrix)
        turned = products.projected(fit)[1] @ np.linalg.cholesky(fit.covariance)
        alone = products.squares - np.sum(turned**2, axis=1)
        for candidate, where, std in dictionary.entries[axis]:
            energy = float(alone[where] @ std**2) / len(std)
            families.setdefault(candidate.key, []).append((energy, candidate, where, std))
        strongest = [max(members, key=lambda member: member[0]) for members in families.values()]
        columns = np.concatenate([np.arange(where.start, where.stop) for _, _, where, _ in strongest])
        x = matrix[:, columns]
        full = x.T @ x - turned[columns] @ turned[columns].T
        scale = np.concatenate([std for *_, std in strongest])
        full = full * scale[:, None] * scale
        starts = np.cumsum([0, *[len(std) for *_, std in strongest]])
        energies = np.add.reduceat(np.diag(full), starts[:-1])
        # What each family (row) leaves of the energy of each other (column).
        left = np.array([_left_by(full, slice(a, b), starts, energies) for a, b in pairwise(starts)])
        names = np.array([candidate.effect for _, candidate, _, _ in strongest])
        left[names[:, None] == names] = np.inf
        for i, (members, (energy, candidate, _, std)) in enumerate(zip(families.values(), strongest, strict=True)):
            best = int(np.argmin(left[:, i]))
            least = left[best, i] / len(std)
            rival, least = (str(names[best]), least) if least < energy else ("", energy)
            middle = float(np.median([member[0] for member in members]))
            found.append(Visible(candidate, std, energy, middle, rival, float(least), usual))
    for candidate, blocks, std in dictionary.whole:
        if candidate.axis is not None:
            continue
        _, gram = fit.gram(blocks)
        scaled = gram * std[:, None] * std
        effect = get_effect(candidate.effect)
        lead = effect.leading or len(std)
        energy = float(np.trace(scaled[:lead, :lead])) / lead
        unit = effect.parameters[0].unit
        found.append(Visible(candidate, std, energy, energy, "", energy, float(std[0]), unit))
    return found


def _left_by(full: np.ndarray, rival: slice, starts: np.ndarray, energies: np.ndarray) -> np.ndarray:
    """Return the energies (k,) of families, which start at `starts` (k + 1,) of a Gram matrix, less what one takes."""
    inner = full[rival, rival] + np.eye(rival.stop - rival.start) * (RIDGE * np.trace(full[rival, rival]) + 1e-12)
    taken = np.sum(full[rival] * np.linalg.solve(inner, full[rival]), axis=0)
    return np.maximum(energies - np.add.reduceat(taken, starts[:-1]), 0.0)
