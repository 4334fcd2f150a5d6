"""By which maximum is the torque divided before it is binned?"""

STAGE = "features"
PAPER = "These sixty values are then normalized with respect to maximum torque"
DEFAULT = "training_maximum"


def reference_hour(hourly, reference_hour, reference_period):
    """The largest |torque| of the axis in the first hour of normal operation."""
    return reference_hour[:, None, :]


def hourly_maximum(hourly, reference_hour, reference_period):
    """The largest |torque| of the axis in the same hour; growth that scales all samples then leaves no trace."""
    return hourly


def training_maximum(hourly, reference_hour, reference_period):
    """The largest |torque| of the axis in the whole training period."""
    return reference_period[:, None, :]


def largest_of_all_axes(hourly, reference_hour, reference_period):
    """The largest |torque| of all axes in the first hour of normal operation, one value for the whole arm."""
    return reference_hour.max(axis=-1, keepdims=True)[:, None, :] + 0 * reference_hour[:, None, :]
