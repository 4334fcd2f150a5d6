"""Which probability does an empty bin have?"""

STAGE = "features"
PAPER = "The text does not say; Figure 2 reaches 10 nat, and a floor of 0.001 caps the divergence near 6.9 nat."
DEFAULT = "machine_epsilon"


def machine_epsilon():
    """The machine epsilon of MATLAB's eps, 2.2e-16."""
    return 2.220446049250313e-16


def one_thousandth():
    """0.001."""
    return 1e-3


def one_millionth():
    """0.000001."""
    return 1e-6
