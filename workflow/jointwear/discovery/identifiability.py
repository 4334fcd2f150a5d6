"""What a motion can show at all: energy of every effect after the base regression and after each rival.

Nothing here looks at the measured torque except through the level and colour of its noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointwear.discovery.candidates import Dictionary
from jointwear.discovery.whitening import White
from jointwear.effects import get_effect

#: Ridge, over the squares of all columns of a rival together, of what it takes off the others.
RIDGE = 1e-6


@dataclass(frozen=True)
class Visible:
    """One effect on one 0-based axis (None: whole arm) at a usual size.

    `energy` over noise variance left after the base regression; `rival` the effect that takes most of it, and
    `left` what that leaves. `size` of an effect of the whole arm is that of its first parameter, in `unit`; of others
    the share of the friction of the axis, without a unit.
    """

    effect: str
    axis: int | None
    source: int | None
    energy: float
    rival: str
    left: float
    size: float
    unit: str = ""

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
        families: dict[tuple, tuple[float, np.ndarray]] = {}
        products = dictionary.products(axis, matrix)
        turned = products.projected(fit)[1] @ np.linalg.cholesky(fit.covariance)
        alone = products.squares - np.sum(turned**2, axis=1)
        for candidate, where, std in dictionary.entries[axis]:
            energy = float(alone[where] @ std**2) / len(std)
            if candidate.key not in families or energy > families[candidate.key][0]:
                families[candidate.key] = (energy, np.arange(where.start, where.stop))
        keys = list(families)
        columns = np.concatenate([families[k][1] for k in keys])
        x = matrix[:, columns]
        full = x.T @ x - turned[columns] @ turned[columns].T
        scale = np.concatenate([s for k in keys for s in [_std(dictionary, axis, families[k][1])]])
        full = full * scale[:, None] * scale
        starts = np.cumsum([0, *[len(families[k][1]) for k in keys]])
        energies = np.add.reduceat(np.diag(full), starts[:-1])
        # What each family (row) leaves of the energy of each other (column).
        left = np.array([_left_by(full, slice(a, b), starts, energies) for a, b in pairwise(starts)])
        names = np.array([key[0] for key in keys])
        left[names[:, None] == names] = np.inf
        for i, key in enumerate(keys):
            best = int(np.argmin(left[:, i]))
            least = left[best, i] / len(families[key][1])
            rival, least = (keys[best][0], least) if least < families[key][0] else ("", families[key][0])
            found.append(Visible(key[0], axis, key[2], families[key][0], rival, float(least), usual))
    for candidate, blocks, std in dictionary.whole:
        if candidate.axis is not None:
            continue
        _, gram = fit.gram(blocks)
        scaled = gram * std[:, None] * std
        effect = get_effect(candidate.effect)
        lead = effect.leading or len(std)
        energy = float(np.trace(scaled[:lead, :lead])) / lead
        unit = effect.parameters[0].unit
        found.append(Visible(candidate.effect, None, None, energy, "", energy, float(std[0]), unit))
    return found


def _left_by(full: np.ndarray, rival: slice, starts: np.ndarray, energies: np.ndarray) -> np.ndarray:
    """Return the energies (k,) of families, which start at `starts` (k + 1,) of a Gram matrix, less what one takes."""
    inner = full[rival, rival] + np.eye(rival.stop - rival.start) * (RIDGE * np.trace(full[rival, rival]) + 1e-12)
    taken = np.sum(full[rival] * np.linalg.solve(inner, full[rival]), axis=0)
    return np.maximum(energies - np.add.reduceat(taken, starts[:-1]), 0.0)


def _std(dictionary: Dictionary, axis: int, columns: np.ndarray) -> np.ndarray:
    for _, where, std in dictionary.entries[axis]:
        if where.start == columns[0]:
            return std
    raise KeyError(axis)
