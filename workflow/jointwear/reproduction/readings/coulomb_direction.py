"""Which velocity decides the sign of Coulomb friction in the measured torque?"""

STAGE = "simulation"
PAPER = "Once y is obtained, we use inverse dynamics (1) to obtain the measured torque."
DEFAULT = "commanded_velocity"


def commanded_velocity(commanded, measured):
    """The commanded velocity: an axis at rest shows no Coulomb friction, as Table V has it for axis 6 in T1."""
    return commanded


def measured_velocity(commanded, measured):
    """The noisy measured velocity, as a literal second call of rne would take it."""
    return measured
