"""Waves of torque that an encoder makes: its error over a turn, which a controller follows, shakes the joint."""

from __future__ import annotations

import numpy as np

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.problem.candidates import LINK_MASS
from jointwear.discovery.search.in_its_place import place_of
from jointwear.effects import get_effect


def encoder_wave(outcome: Outcome, one: Named) -> float | None:
    """Return the nats by which the wave of an encoder is ahead of an effect that is a wave over the angle, or None.

    Where an encoder is off by A sin(w q), as of an eccentric disc or of lines that are interpolated badly, a controller
    that holds its readings moves the joint by as much. That takes a torque of the inertia times A w^2 v^2: it grows
    with the square of the speed. Cogging, ripple and friction over the angle have a height that does not ask for the
    speed, and of which filters leave less the faster the joint is. The order tells the two apart only where it is a
    whole number per turn of the motor: what meshes with the last wheel repeats a whole number of times in a turn of the
    joint, as the lines of an encoder there do.

    As for :func:`.in_its_place.better_in_its_place` the wave has to be ahead by `accept` and by what the name loses for
    its form, and must not explain as much beside the name.
    """
    candidate, white = one.candidate, outcome.white
    if candidate.effect == LINK_MASS or get_effect(candidate.effect).waves is None:
        return None
    axis, state = candidate.axis, white.problem.train_state
    waves = get_effect(candidate.effect).waves(state, axis, candidate.nonlinear)
    square = state.velocity[:, axis] ** 2
    usual = float(np.mean(square[outcome.problem.usable[:, axis]]))
    x = white.columns(axis, state.waves_of(axis, waves) * (square / usual)[:, None])
    return place_of(outcome, one).lead_of(axis, x)
