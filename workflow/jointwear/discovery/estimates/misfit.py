"""How much less is known where the model misses more than noise: what an axis says is divided by its misfit.

The fit takes a residual for noise of known colour. Where structure without a name is left, a wall, a gust or a form
that is off, that noise is far too small, and the estimates are far too certain. The scatter of the whitened
residual over blocks of time tells by how much: standard deviations grow with it, as in generalised estimating equations
(Liang and Zeger 1986) with one scale an axis. The fit itself keeps its weights.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.candidates import Dictionary
from jointwear.discovery.problem.whitening import White


def misfit_of(white: White, fit: Fit) -> np.ndarray:
    """Return the variance of the whitened residual of every axis over that of noise, (n,), at least 1.

    That of single samples or of sums over blocks, whichever is larger, less what so few blocks scatter by chance.
    """
    result = np.ones(len(white.targets))
    for axis, residual in enumerate(fit.residual):
        if len(residual):
            label = white.blocks(axis)
            count = np.bincount(label)
            sums = np.bincount(label, residual)[count > 0] ** 2 / count[count > 0]
            chance = 1.0 + 2.0 * np.sqrt(2.0 / len(sums))
            result[axis] = max(1.0, float(np.mean(residual**2)), float(np.mean(sums)) / chance)
    return result


def tempered(white: White, misfit: np.ndarray) -> White:
    """Return the whitened problem in which the noise of every axis has `misfit` (n,) times its variance."""
    if np.all(misfit <= 1.0):
        return white
    root = np.sqrt(misfit)
    whiteners = [
        None if w is None else replace(w, sigma=w.sigma * s) for w, s in zip(white.whiteners, root, strict=True)
    ]
    targets = [y / s for y, s in zip(white.targets, root, strict=True)]
    return replace(white, whiteners=whiteners, targets=targets, base=[divided(t, misfit) for t in white.base])


def divided(term: Term, misfit: np.ndarray) -> Term:
    """Return a term whose whitened columns belong to the problem that is :func:`tempered` by a misfit (n,)."""
    return replace(term, blocks=_divided(term.blocks, misfit))


def masses_of(dictionary: Dictionary, misfit: np.ndarray, effect: str) -> Dictionary:
    """Return the whole-arm candidates of one effect for the problem that is :func:`tempered` by a misfit (n,)."""
    whole = [(c, _divided(blocks, misfit), std) for c, blocks, std in dictionary.whole if c.effect == effect]
    return Dictionary({}, {}, whole)


def _divided(blocks: dict[int, np.ndarray], misfit: np.ndarray) -> dict[int, np.ndarray]:
    return {axis: x / np.sqrt(misfit[axis]) for axis, x in blocks.items()}
