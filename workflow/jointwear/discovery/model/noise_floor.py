"""The noise of every axis once effects have names: what they explain no longer counts as noise."""

from __future__ import annotations

import numpy as np

from jointwear.discovery.model.final_model import Final
from jointwear.discovery.problem.candidates import LINK_MASS, raw_columns
from jointwear.discovery.problem.saturated import axis_noise, noise_level


def floor_with_names(final: Final) -> list[float | None]:
    """Return the standard deviation of the torque noise of every axis [N m], None where it cannot be judged.

    The fit behind the noise holds bases over every argument, but of waves over the motor angle only those that are
    plain, and no wave that bends. With the columns of what was named it is asked again, and the smaller one counts.
    """
    outcome = final.outcome
    floor = outcome.noise_floor
    columns: dict[int, list[np.ndarray]] = {}
    for estimate in (*final.estimates, *final.unwritten):
        candidate = estimate.named.candidate
        if candidate.axis is not None and candidate.effect != LINK_MASS:
            for half in candidate.halves:
                columns.setdefault(half.axis, []).append(raw_columns(outcome.white, half))
    for axis, found in columns.items():
        if floor[axis] is not None:
            known = axis_noise(outcome.problem, axis, np.concatenate(found, axis=1))
            floor[axis] = min(floor[axis], noise_level(outcome.problem, axis, known))
    return floor
