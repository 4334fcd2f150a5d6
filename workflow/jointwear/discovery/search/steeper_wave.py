"""Waves over the angle of a motor whose height grows faster than its torque: of reluctance, not of a torque
constant."""

from __future__ import annotations

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.problem.candidates import LINK_MASS, raw_columns
from jointwear.discovery.search.in_its_place import place_of
from jointwear.effects import get_effect


def steeper_wave(outcome: Outcome, one: Named) -> float | None:
    """Return the nats by which a wave that grows with the square of the torque is ahead of a ripple of the torque
    constant, or None.

    Where the inductance L of a winding changes with the angle of the motor, a current i makes a torque of
    i^2 (dL/dtheta) / 2, the derivative of its coenergy. A ripple of the torque constant is in proportion to the torque.
    The two differ by the loads that a joint carries, and a ripple stands in for most of the other at loads of one size.
    Ahead it has to be as for :func:`.in_its_place.better_in_its_place`, and must not explain as much beside the name.
    """
    candidate, white = one.candidate, outcome.white
    if candidate.effect == LINK_MASS:
        return None
    effect = get_effect(candidate.effect)
    if effect.waves is None or not effect.of_torque:
        return None
    axis = candidate.axis
    torque = np.abs(white.problem.train_state.torque[:, axis])
    usual = float(np.sqrt(np.mean(torque[outcome.problem.usable[:, axis]] ** 2)))
    if usual <= 0:
        return None
    x = white.columns(axis, raw_columns(white, candidate) * (torque / usual)[:, None])
    return place_of(outcome, one).lead_of(axis, x)
