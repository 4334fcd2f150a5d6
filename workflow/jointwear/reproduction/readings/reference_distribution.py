"""What is the reference distribution?"""

STAGE = "features"
PAPER = "KL Distance is calculated between the initial distribution and distribution of torque sampled once every hour"
DEFAULT = "first_training_hour"


def first_training_hour(run, training):
    """The histogram of the first hour of normal operation."""
    return training[:, :1]


def training_mean(run, training):
    """The mean histogram of the whole normal operation."""
    return training.mean(axis=1, keepdims=True)


def first_hour_of_run(run, training):
    """The histogram of the first hour of the run itself."""
    return run[:, :1]
