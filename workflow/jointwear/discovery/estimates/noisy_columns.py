"""How much smaller a late torque comes out because its columns hold noise of derived accelerations.

Columns with noise are fitted with coefficients that are too small, by the share of noise in what the base regression
leaves of them (attenuation; Fuller 1987, Measurement error models, chapter 1). How much of that noise the residual
still holds, with the other sign, is not known: up to all of that share is open.
"""

from __future__ import annotations

import numpy as np

from jointwear.discovery.linear import Fit
from jointwear.discovery.noise.spectra import frequencies
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.problem.whitening import White
from jointwear.effects import get_effect
from jointwear.measurement.derived.filtering import zero_phase_gain


def noise_share(white: White, fit: Fit, candidate: Candidate) -> float:
    """Return the share, 0 to 1, of noise in the columns of a late torque on one axis, beside the terms of a fit."""
    effect, axis, problem = get_effect(candidate.effect), candidate.axis, white.problem
    rate, cutoff, whitener = problem.measured.rate, white.cutoffs[axis].late, white.whiteners[axis]
    frequency = frequencies(rate)[1:]
    turn = 2 * np.pi * frequency * abs(float(candidate.nonlinear[effect.scaled]))
    angle = np.minimum(turn, np.pi) if effect.shifts(candidate.nonlinear) else np.arctan(turn)
    density = 2.0 * (1.0 - np.cos(angle)) * problem.noise_in_torque[axis, 1:] / whitener.density(frequency, rate)
    noise = len(whitener.rows) * float(np.mean(density * zero_phase_gain(frequency, cutoff, rate) ** 2))
    _, gram = fit.gram({axis: white.columns(axis, raw_columns(white, candidate))})
    return min(noise / float(gram[0, 0]), 1.0) if gram[0, 0] > 0 else 1.0
