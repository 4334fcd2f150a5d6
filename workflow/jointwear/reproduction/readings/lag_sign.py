"""What sign does the lag of a trailing axis have?"""

STAGE = "location"
PAPER = "A positive value of dt indicates that tau_j is trailing tau_i; conversely, a negative value indicates leading."
DEFAULT = "equation_5"


def equation_5(lag):
    """As equation (5) defines it: positive where axis j trails axis i."""
    return lag


def reversed_sign(lag):
    """Reversed, as MATLAB's xcorr(i, j) counts it: negative where axis j trails axis i."""
    return -lag
