"""From the coarsened log odds of a name to the probability that it is right, as fitted on choosing cases."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from scipy.special import expit

from jointwear.files.json_documents import read_json

#: The fit with its source, written by `python -m jointwear.studies.world.calibration --store`.
FILE = Path(__file__).with_name("calibration.json")
#: Evidence counts for less the more of it there is, because no form is exact: a coarsened posterior (Miller and
#: Dunson 2019), in which so many nats make up one. A part of the features that the fit was made with.
COARSE = 0.005
#: What the probability depends on.
FEATURES = (
    "one",
    "asinh of the log odds",
    "minus the logarithm of the share of what the axis lacks that it leaves",
    "structure is left on the axis",
)
#: Share that a name leaves from which less is told apart no more: shares are known no better.
LEAST_LEFT = 0.02


def features(log_odds: float, share: float, left: bool) -> tuple[float, ...]:
    """Return the values of :data:`FEATURES` for a name.

    Parameters
    ----------
    log_odds : coarsened, against its rivals. share : of the squared error beyond the noise that it explains in records
        left out. left : whether its axis stays unexplained.
    """
    leaves = LEAST_LEFT + 1.0 - float(np.clip(share, 0.0, 1.0))
    return 1.0, float(np.arcsinh(log_odds)), float(-np.log(leaves)), float(left)


def calibrated(log_odds: float, share: float, left: bool) -> float:
    """Return the probability that a name is right; parameters as of :func:`features`.

    No name is given whose log odds are below zero, so that no fit has seen one: there they count as they are. Above
    zero nothing else of the library is as likely as the name, whatever it explains: one half at least, so that no name
    depends on the fit. Where structure is left there is something else.
    """
    probability = float(expit(np.dot(_coefficients(), features(log_odds, share, left))))
    if log_odds < 0:
        return min(probability, float(expit(log_odds)))
    return probability if left else max(probability, 0.5)


@cache
def _coefficients() -> tuple[float, ...]:
    return tuple(read_json(FILE)["coefficients"])
