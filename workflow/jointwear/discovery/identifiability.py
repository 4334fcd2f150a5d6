"""What a motion can show at all: energy of every effect after the base regression and after each rival.

Nothing here looks at the measured torque except through the level and colour of its noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointwear.discovery.candidates import Candidate, Dictionary
from jointwear.discovery.whitening import White
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
        families: dict[tuple, tuple[float, Candidate, np.ndarray, np.ndarray]] = {}
        energies_of: dict[tuple, list[float]] = {}
        products = dictionary.products(axis, matrix)
        turned = products.projected(fit)[1] @ np.linalg.cholesky(fit.covariance)
        alone = products.squares - np.sum(turned**2, axis=1)
        for candidate, where, std in dictionary.entries[axis]:
            energy = float(alone[where] @ std**2) / len(std)
            energies_of.setdefault(candidate.key, []).append(energy)
            if candidate.key not in families or energy > families[candidate.key][0]:
                families[candidate.key] = (energy, candidate, np.arange(where.start, where.stop), std)
        keys = list(families)
        columns = np.concatenate([families[k][2] for k in keys])
        x = matrix[:, columns]
        full = x.T @ x - turned[columns] @ turned[columns].T
        scale = np.concatenate([families[k][3] for k in keys])
        full = full * scale[:, None] * scale
        starts = np.cumsum([0, *[len(families[k][3]) for k in keys]])
        energies = np.add.reduceat(np.diag(full), starts[:-1])
        # What each family (row) leaves of the energy of each other (column).
        left = np.array([_left_by(full, slice(a, b), starts, energies) for a, b in pairwise(starts)])
        names = np.array([key[0] for key in keys])
        left[names[:, None] == names] = np.inf
        for i, key in enumerate(keys):
            best = int(np.argmin(left[:, i]))
            energy, candidate, _, std = families[key]
            least = left[best, i] / len(std)
            rival, least = (keys[best][0], least) if least < energy else ("", energy)
            middle = float(np.median(energies_of[key]))
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
