"""How is the limit of the Q-statistic found?"""

STAGE = "detection"
PAPER = "We use 95% confidence level to set threshold on the Q-statistic [31]"
DEFAULT = "jackson_mudholkar"

# Where the kept components explain everything, the limit is the rounding of eigenvalues; a limit of zero could not
# be divided by.
_ROUNDING = 1e-20


def jackson_mudholkar(theory, training_q, confidence):
    """From the residual eigenvalues by the formula of Jackson and Mudholkar (1979)."""
    return max(theory, _ROUNDING)


def empirical_quantile(theory, training_q, confidence):
    """The quantile of Q in training."""
    import numpy as np

    return max(float(np.quantile(training_q, confidence)), _ROUNDING)
