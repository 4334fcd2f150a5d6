"""Up to which frequency a robot file has the rates of a load, of which the motion tells nothing but noise above.

A gear behind a link encoder adds the second derivative of its load. That of a logged motion holds the noise of derived
accelerations with the fourth power of the frequency: the torque is there, and the file followed the log worse for it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.estimates.effect_estimates import Estimate
from jointwear.discovery.model.final_model import Final
from jointwear.discovery.problem.candidates import on_its_axis_alone
from jointwear.discovery.problem.problem import Problem
from jointwear.effects import get_effect

#: Bands that are tried in each octave.
EACH_OCTAVE = 4


def with_known_bands(final: Final, torque: np.ndarray) -> Final:
    """Return a model whose effects on rates of a load end where its file follows the training motion best.

    One parameter in a few steps learns little of that motion by heart. A model of which nothing changes is returned
    as it is.

    Parameters
    ----------
    torque : (m, n) that the file of the model gives [N m].
    """
    estimates = tuple(_in_its_band(final, e, torque) for e in final.estimates)
    same = all(new is old for new, old in zip(estimates, final.estimates, strict=True))
    return final if same else replace(final, estimates=estimates)


def _in_its_band(final: Final, estimate: Estimate, torque: np.ndarray) -> Estimate:
    problem, candidate = final.outcome.problem, estimate.named.candidate
    if not on_its_axis_alone(candidate) or not get_effect(candidate.effect).band:
        return estimate
    effect, axis = get_effect(candidate.effect), candidate.axis
    lowest = final.white.cutoffs[axis].timing
    if not np.isfinite(lowest):
        return estimate
    used = (problem.moving & problem.train[:, None])[:, axis]
    as_written = estimate.parameters.get(effect.band, 0.0)

    def of_band(band: float) -> np.ndarray:
        return effect.torque(problem.state, axis, None, {**estimate.parameters, effect.band: band})[used]

    without = (problem.measured.torque - torque)[used, axis] + of_band(as_written)
    error = {band: np.mean((without - of_band(band)) ** 2) for band in (as_written, 0.0, *_bands(problem, lowest))}
    best = min(error, key=error.get)
    return estimate if best == as_written else replace(estimate, parameters={**estimate.parameters, effect.band: best})


def _bands(problem: Problem, lowest: float) -> list[float]:
    """Return the bands [Hz] that are tried, from where columns of rates of torque end to half of the rate."""
    highest = 0.5 * problem.measured.rate
    count = max(int(np.ceil(EACH_OCTAVE * np.log2(highest / lowest))), 1)
    return [float(f"{x:.3g}") for x in np.geomspace(lowest, highest, count + 1)[:-1]]
