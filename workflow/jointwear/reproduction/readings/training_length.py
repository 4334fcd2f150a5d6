"""How long is the normal operation from which the detector learns?"""

STAGE = "training"
PAPER = "Figure 3: a five day training data (0-120 hours); section V: sixty days of normal operation"
DEFAULT = "hours_120"


def hours_120():
    """120 hours, as in Figure 3."""
    return 120


def days_60():
    """Sixty days, as section V says."""
    return 1440
