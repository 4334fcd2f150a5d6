"""How is the limit of the Q-statistic found?"""

STAGE = "detection"
PAPER = "We use 95% confidence level to set threshold on the Q-statistic [31]"
DEFAULT = "jackson_mudholkar"


def jackson_mudholkar(theory, training_q, confidence):
    """From the residual eigenvalues by the formula of Jackson and Mudholkar (1979)."""
    return theory


def empirical_quantile(theory, training_q, confidence):
    """The quantile of Q in training."""
    import numpy as np

    return float(np.quantile(training_q, confidence))
