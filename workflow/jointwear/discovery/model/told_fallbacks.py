"""What was given up of the written models, told once for each model and joint: what was tried, and what was kept."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from jointwear.discovery.model.fallback import CLOSER, DRIVE, HELD, LINKS, PutBack
from jointwear.discovery.model.final_model import Final
from jointwear.discovery.verdict import FallBack, Gap, GivenUp

#: Between the steps that were taken one after the other.
THEN = ", then "
#: Steps that give up parameters of the robot alone, and no effect.
OF_ROBOT = (DRIVE, CLOSER, LINKS, HELD)


def told_fallbacks(final: Final, gap: Gap) -> tuple[FallBack, ...]:
    """Return one entry for each model and axis, with the steps in their order and what is written in the end.

    There is none where nothing was lost: what had been fitted to the robot followed records left out as it was given.

    Parameters
    ----------
    gap : errors of the files on held-out motion.
    """
    found: dict[tuple[str, int], list[PutBack]] = {}
    for one in final.fallbacks:
        found.setdefault((one.model, one.axis), []).append(one)
    result = []
    for (model, axis), steps in sorted(found.items()):
        if all(s.ratio == 1.0 and s.step in OF_ROBOT for s in steps):
            continue
        given, written = gap.nominal[axis - 1], getattr(gap, model)[axis - 1]
        result.append(
            FallBack(
                model=model,
                axis=axis,
                ratio=steps[0].ratio,
                step=THEN.join(dict.fromkeys(s.step for s in steps)),
                steps=tuple(GivenUp(s.step, s.ratio) for s in steps),
                kept=_kept(final, model, axis - 1, steps),
                held_out=float(f"{written / given:.4g}") if given and written is not None else None,
            )
        )
    return tuple(result)


def _kept(final: Final, model: str, axis: int, steps: list[PutBack]) -> str:
    """Return in words what a file holds for a 0-based axis on which these steps were taken."""
    augmented = model == "augmented"
    drive = (final.delta_friction if augmented else final.retuned_friction)[axis]
    links = final.delta_inertial if augmented else final.retuned_inertial
    found = (e.named.candidate for e in final.estimates)
    effects = [c.effect for c in found if c.axis is None or axis in c.axes]
    felt = ", but for what this joint feels" if any(s.held for s in steps) and np.any(links) else ""
    words = [
        f"friction and motor inertia {_as(drive, any(s.in_part for s in steps))}",
        f"inertia of the links {_as(links)}{felt}",
    ]
    return ", ".join(words + (list(dict.fromkeys(effects)) if augmented else []))


def _as(change: Collection[float], in_part: bool = False) -> str:
    fitted = "in part as fitted" if in_part else "as fitted"
    return fitted if np.any(change) else "as given"
