"""How far the form of a named effect may bend, as columns beside its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, fitted_torque, on_all_axes
from jointwear.discovery.problem.whitening import White
from jointwear.effects import State, get_effect
from jointwear.effects.effect import Parameters, correction_torque
from jointwear.effects.holes import stretches_of, weakest_in_holes


@dataclass(frozen=True)
class Form:
    """Tolerance of the form of one effect: flexible columns over its own argument.

    `knots` (k,) of a table over the argument, or None where the columns need none. `seen` are the stretches of the
    argument that training samples show, where what is written has to say something of holes between them.
    """

    candidate: Candidate
    knots: np.ndarray | None
    seen: tuple[tuple[float, float], ...] = ()

    def columns(self, state: State) -> np.ndarray:
        """Return the columns (N, k) on any ordered state."""
        candidate = self.candidate
        bend = get_effect(candidate.effect).bend
        return bend.columns(state, candidate.axis, candidate.source, candidate.nonlinear, self.knots)


def written_form(form: Form, parameters: Parameters, coefficients: np.ndarray) -> list[Parameters]:
    """Return the parameters of the entries of a robot file for an effect whose form bends by coefficients (k,)."""
    bend = get_effect(form.candidate.effect).bend
    written = bend.written(parameters, form.knots, coefficients)
    return written if bend.law is None else [weakest_in_holes(p, bend.law, form.seen) for p in written]


def changed_in_holes(form: Form, parameters: Parameters, coefficients: np.ndarray, state: State) -> np.ndarray:
    """Return what a robot file says more (N,) [N m] in holes of the argument than was fitted; see `written_form`."""
    effect = get_effect(form.candidate.effect)
    if len(form.seen) < 2:
        return np.zeros(len(state.velocity))
    fitted = effect.bend.written(parameters, form.knots, coefficients)
    written = written_form(form, parameters, coefficients)
    after, before = (
        sum(correction_torque(effect, state, form.candidate.axis, p) for p in entries) for entries in (written, fitted)
    )
    return after - before


def form_of(white: White, candidate: Candidate) -> Form | None:
    """Return the tolerance of the form of a candidate, None where its form is exact, as of a gain or a mass."""
    if candidate.effect == LINK_MASS or candidate.axis is None:
        return None
    effect, axis = get_effect(candidate.effect), candidate.axis
    if effect.bend is None or on_all_axes(candidate):
        return None
    if effect.bend.knots is None:
        return Form(candidate, None)
    used = white.problem.usable[:, axis]
    knots = effect.bend.knots(white.problem.train_state, axis, candidate.source, candidate.nonlinear, used)
    if len(knots) < 2:
        return None
    if effect.bend.law is None:
        return Form(candidate, knots)
    argument = effect.shape(white.problem.train_state, axis, candidate.nonlinear)[1]
    return Form(candidate, knots, stretches_of(argument[used], knots))


def companion(white: White, form: Form, size: float) -> Term:
    """Return the whitened columns of a form with their prior.

    Parameters
    ----------
    size : RMS torque of the effect [N m]; the columns may each be worth its `usual` share.
    """
    axis = form.candidate.axis
    columns = form.columns(white.state_of(get_effect(form.candidate.effect), axis))
    used = white.problem.usable[:, axis]
    # Hats are narrow: their height, not their RMS, is bounded by the size of the effect.
    scale = np.sqrt(np.mean(columns[used] ** 2, axis=0))
    height = np.sqrt(np.mean(columns[used] ** 4, axis=0) / np.maximum(scale**2, 1e-300))
    std = np.where(scale > 1e-12, white.problem.settings.usual * size / np.maximum(height, 1e-12), 1e-9)
    return Term(
        f"form of {form.candidate.effect}",
        {axis: white.columns(axis, columns)},
        np.maximum(std, 1e-9),
        {axis: white.raw(axis, columns)},
    )


def form_term(
    white: White, fit: Fit, candidate: Candidate, blocks: dict[int, np.ndarray], std: np.ndarray
) -> Term | None:
    """Return the :func:`companion` of a candidate that is fitted beside a fit, None where its form is exact; arguments
    as of :func:`.candidates.fitted_torque`."""
    form = form_of(white, candidate)
    if form is None:
        return None
    torque = fitted_torque(white, fit, candidate, blocks, std)
    return companion(white, form, float(np.sqrt(np.mean(torque**2))))
