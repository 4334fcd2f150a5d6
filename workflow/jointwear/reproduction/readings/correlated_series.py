"""Which series of each axis is correlated?"""

STAGE = "location"
PAPER = "We cross-correlate the output data (torque distribution for each axis across time)"
DEFAULT = "kl_divergence"


def kl_divergence(features, training_mean, training_spread):
    """The KL divergence."""
    return features["kl_divergence"]


def standardised_kl(features, training_mean, training_spread):
    """The KL divergence, standardised by its mean and standard deviation in training."""
    return (features["kl_divergence"] - training_mean[:, None]) / training_spread[:, None]


def mean_absolute_torque(features, training_mean, training_spread):
    """The hourly mean of |torque|."""
    return features["mean_absolute_torque"]
