"""How does the disturbed torque become a motion again?"""

STAGE = "simulation"
PAPER = "Equation (2) is a state-space model of a single axis; Table I, step 3: compute q, q', q'' for each axis."
DEFAULT = "coupled"


def coupled(disturbance, mass_matrix):
    """Through the coupled forward dynamics of the whole arm: a = M^-1 w."""
    import numpy as np

    # By instant rather than by sample: a matrix product for each instant covers all hours.
    inverse = np.linalg.inv(mass_matrix).swapaxes(-1, -2)
    return np.matmul(disturbance.swapaxes(-3, -2), inverse).swapaxes(-3, -2)


def axis_by_axis(disturbance, mass_matrix):
    """Axis by axis, as equation (2) reads: a_i = w_i / M_ii. The other axes then see the mismatch."""
    import numpy as np

    return disturbance / np.diagonal(mass_matrix, axis1=-2, axis2=-1)
