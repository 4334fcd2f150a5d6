"""The share of what was fitted to a drive that is written, where records left out support it only in part.

Whether a correction of friction is written has been decided by :mod:`jointwear.discovery.model.fallback`. Where nothing
explains what an axis lacks, or the correction helps here and harms there, it stands in for something that the next
record may hold less of. Predictions by the given and by the fitted drive are then stacked (Wolpert 1992, Breiman 1996):
one weight that records left out support, less what it scatters over these.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from scipy.special import ndtri

from jointwear.discovery.linear import Term
from jointwear.discovery.model.fallback import DRIVE, PutBack
from jointwear.discovery.model.left_out import Asked
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.settings import Settings


def drive_shares(white: White, kept: list[Term], open_axes: Collection[int]) -> dict[int, tuple[float, float]]:
    """Return axis (0-based) -> the share of the corrections of its drive that is written, for axes with less than all.

    Behind it stands the error on records left out of the model as fitted, over that of the given robot.

    Parameters
    ----------
    kept : terms of the model that is written.
    open_axes : axes on which structure is left that nothing explains. An axis without an effect of its own is asked
        too where less than nearly all of what the model changes is gained.
    """
    settings = white.problem.settings
    ask = Asked(white, kept)
    found = ask(kept)
    of_effects = {axis for t in kept if t.effect and len(t.blocks) == 1 for axis in t.blocks}
    doubtful = [
        axis
        for axis in sorted({t.drive[0] for t in kept if t.drive} - of_effects)
        if axis in open_axes or found.gained[axis] < settings.nearly_all
    ]
    if not doubtful:
        return {}
    worth = ask.drives(kept)
    shares = {axis: round(supported(worth[axis], settings), 2) for axis in doubtful}
    return {axis: (share, float(found.surely[axis])) for axis, share in shares.items() if share < 1.0}


def surely_impossible(
    nominal: np.ndarray, change: np.ndarray, std: np.ndarray, open_axes: Collection[int], settings: Settings
) -> list[int]:
    """Return the axes (0-based), of `open_axes`, on which a fit has friction that drives or an inertia below zero.

    No motor has it: where structure is left that nothing explains, such a fit stands in for that, and of it no share is
    written. It would be worse on the first motion that differs.

    Parameters
    ----------
    nominal, change, std : (n, 4) parameters of the drives, what is fitted to be added to them, and how well the data
        know it, all of the same sign: friction that brakes is above zero.
    """
    below = (nominal > 0) & (std > 0) & (nominal + change < -ndtri(settings.certainty) * std)
    return [axis for axis in sorted(open_axes) if below[axis].any()]


def supported(worth: np.ndarray, settings: Settings) -> float:
    """Return the share of the corrections of a drive that records left out surely support, in [0, 1].

    It is the one with which all of them together are predicted best, less as many standard deviations as `certainty`
    asks for: it scatters over the records. Where the links that are written lean on the drive it is not so small that
    the axis would become worse than `not_worse` allows.

    Parameters
    ----------
    worth : (r, 4) of one axis, as of :meth:`jointwear.discovery.model.left_out.Asked.drives`.
    """
    count = len(worth)
    right, square, left, given = worth.sum(axis=0)
    if count < 2 or square <= 0.0:
        return 1.0
    best = right / square
    lost = worth[:, 0] - best * worth[:, 1]
    spread = np.sqrt(count / (count - 1) * np.sum(lost**2)) / square
    share = best - ndtri(settings.certainty) * spread
    # What is left at a share s is left - 2 s right + s^2 square.
    above = left - settings.not_worse**2 * given
    if above > 0.0:
        share = max(share, best - np.sqrt(max(best**2 - above / square, 0.0)))
    return float(np.clip(share, 0.0, 1.0))


def told_shares(shares: dict[int, tuple[float, float]], model: str) -> tuple[PutBack, ...]:
    """Return what is said of the drives that a model holds in part."""
    return tuple(
        PutBack(
            model,
            axis + 1,
            float(f"{ratio:.4g}"),
            f"friction and motor inertia at {share:g} of what was fitted" if share else DRIVE,
            in_part=share > 0.0,
        )
        for axis, (share, ratio) in shares.items()
    )
