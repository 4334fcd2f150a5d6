"""The size from which an effect is named, as far as the gates can be asked before anything is measured of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Term, gain
from jointwear.discovery.problem.identifiability import Visible
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search.acceptance import is_body, share_of_torque
from jointwear.discovery.search.body_or_links import lead_over_links, nats_of_its_mass
from jointwear.robots.inertia import parameters_of_body

#: Sizes that are tried for a body, over the one that stands out of the noise: from one to the next, and the largest.
STEP, LARGEST = 2.0**0.25, 256.0


def smallest_size(white: White, seen: Visible, blocks: dict[int, np.ndarray] | None = None) -> float:
    """Return the size, as that of `seen`, from which this motion shows an effect and a simulation needs it.

    Of a family the curve in its middle has to stand out of the noise beside its rival, not the one that this motion
    shows best: whose parameters are those of the robot is not known before. Its torque has to be the share of that of
    its axis that any name needs. What is a body has to do better than links that are known less well than said, hanging
    at its usual lever in the direction that hides it best.

    Parameters
    ----------
    blocks : whitened columns by axis of an effect of the whole arm.
    """
    settings = white.problem.settings
    # Energy grows with the square of the size; the map is drawn at the usual one.
    left = seen.left * seen.middle / max(seen.energy, 1e-12)
    size = seen.size * np.sqrt(settings.visible / max(left, 1e-12))
    if seen.axis is not None:
        share = share_of_torque(white, seen.candidate, seen.std / np.sqrt(len(seen.std)))
        return float(max(size, seen.size * settings.smallest_share / max(share, 1e-12)))
    if blocks is not None and is_body(seen.candidate):
        return size * _of_a_body(white, Term(seen.effect, blocks, seen.std, effect=True), seen, size)
    return float(size)


def _of_a_body(white: White, term: Term, seen: Visible, size: float) -> float:
    """Return how many times `size` [kg] a body needs for its name, infinite beyond :data:`LARGEST`."""
    white, term = condensed(white, term)
    trial = Named(seen.candidate, term, None, 0.0)
    lever = seen.std[1] / seen.std[0]
    times = 1.0
    for direction in np.eye(3):
        while not _stands(white, trial, parameters_of_body(times * size, lever * direction, np.zeros((3, 3)))):
            times *= STEP
            if times > LARGEST:
                return np.inf
    return times


def _stands(white: White, trial: Named, coefficients: np.ndarray) -> bool:
    """Return whether a body with coefficients (k,) passes the gates of bodies where nothing but it is measured."""
    blocks, accept = trial.term.blocks, white.problem.settings.accept
    targets = [blocks[a] @ coefficients if a in blocks else np.zeros_like(y) for a, y in enumerate(white.targets)]
    white = replace(white, targets=targets)
    beside = white.fit()
    nats = gain(*beside.gram(blocks), trial.term.std)
    return min(nats, lead_over_links(white, [], trial)) >= accept and nats_of_its_mass(white, beside, trial) >= 0


def condensed(white: White, term: Term) -> tuple[White, Term]:
    """Return problem and term with a few rows in place of all samples, whose sums of products are the same."""
    terms = [*white.base, term]
    blocks: list[dict[int, np.ndarray]] = [{} for _ in terms]
    targets = []
    for axis, y in enumerate(white.targets):
        own = [k for k, t in enumerate(terms) if axis in t.blocks]
        if not own:
            targets.append(y[:0])
            continue
        columns = np.concatenate([terms[k].blocks[axis] for k in own], axis=1)
        scale = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        values, vectors = np.linalg.eigh((columns / scale).T @ (columns / scale))
        rows = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T * scale
        edges = np.cumsum([terms[k].blocks[axis].shape[1] for k in own])[:-1]
        for k, part in zip(own, np.split(rows, edges, axis=1), strict=True):
            blocks[k][axis] = part
        targets.append(np.zeros(len(rows)))
    fewer = [replace(t, blocks=b) for t, b in zip(terms, blocks, strict=True)]
    return replace(white, targets=targets, base=fewer[:-1]), fewer[-1]
