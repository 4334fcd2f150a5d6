"""What enters the principal component analysis?"""

STAGE = "detection"
PAPER = (
    "Given n torque values from all six robot axes, a torque matrix is constructed; Figure 3: PCA based on KL distance"
)
DEFAULT = "kl_divergence"


def kl_divergence(features):
    """The six series of the KL divergence."""
    return features["kl_divergence"]


def mean_absolute_torque(features):
    """The six hourly means of |torque|."""
    return features["mean_absolute_torque"]


def histogram(features):
    """All bins of the six hourly histograms."""
    values = features["histogram"]
    return values.reshape(*values.shape[:2], -1).astype(float)


def maximum_torque(features):
    """The six hourly maxima of |torque|, of which Table V speaks."""
    return features["maximum_torque"]
