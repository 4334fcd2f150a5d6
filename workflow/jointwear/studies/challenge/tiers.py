"""What is tried: the difficulty tiers, the hidden effects, the disturbances outside the library, and how many of each.

The Snakefile imports this at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from dataclasses import dataclass

#: Identifiers of the effects that verdicts may name; one stands for one physical cause.
EFFECTS = (
    "stribeck_friction",
    "nonlinear_viscous_friction",
    "load_dependent_friction",
    "temperature_dependent_viscous_friction",
    "temperature_dependent_coulomb_friction",
    "position_dependent_friction",
    "presliding_hysteresis",
    "cogging_torque",
    "torque_constant_ripple",
    "torque_constant_error",
    "torque_constant_temperature",
    "torque_offset_drift",
    "joint_spring",
    "payload",
    "mounting_tilt",
    "joint_flexibility",
    "actuation_delay",
    "drive_coupling",
    "wear_drift",
)

#: Effects of the whole arm: they have no axis.
WHOLE_ARM = ("payload", "mounting_tilt")

#: Disturbances that no effect of the library describes; the right verdict is "unknown".
OUTSIDE = (
    "end_stop_bump",
    "broken_tooth",
    "beat",
    "step_in_time",
    "product_of_positions",
    "random_walk",
    "dead_zone",
    "saturation",
    "neighbour_position_friction",
    "chirp",
)

#: Parameters of the nominal model; a wrong one makes a case "retuned", not an effect.
MODEL_PARAMETERS = ("coulomb_friction", "viscous_friction", "motor_inertia", "link_inertia")

KINDS = ("single", "nothing", "retuned", "two", "outside")

#: Seed sets. Thresholds are chosen on "choose", "sample" is the quick look, "report" is run once.
SETS = ("choose", "sample", "report")

#: How often the cases of a set have been drawn. Once results on report cases have been looked at, whatever is changed
#: in discovery afterwards has to be reported on cases drawn anew.
DRAWINGS = {"choose": 1, "sample": 1, "report": 35}

#: Cases of each kind in one tier.
FULL = {"single": 20 * len(EFFECTS), "nothing": 350, "retuned": 60, "two": 150, "outside": 120}
SAMPLE = {"single": 2 * len(EFFECTS), "nothing": 20, "retuned": 8, "two": 10, "outside": 10}

#: Cases of a set, and how many make a batch: one job that is lost at most when a run is killed.
COUNTS = {"choose": FULL, "sample": SAMPLE, "report": FULL}
BATCH = {"choose": 40, "sample": 14, "report": 40}

#: The cases are part of the test, not of an experiment: their seed does not follow the configuration.
SEED = 560


@dataclass(frozen=True)
class Tier:
    """How hard the cases are.

    Attributes
    ----------
    inertial_error, drive_error : relative error of every inertial parameter, and of every friction coefficient and
        motor inertia, of the nominal model.
    noise : standard deviation of the torque noise over that of the axis's torque.
    colour : coefficient of the first-order autoregression of the noise at the sampling rate; 0 is white.
    motion : "fourier" or "transfer" (pick and place).
    """

    name: str
    inertial_error: float
    drive_error: float
    noise: float
    colour: float
    motion: str


TIERS = {
    tier.name: tier
    for tier in (
        Tier("clean", 0.0, 0.0, 0.01, 0.0, "fourier"),
        Tier("dirty", 0.05, 0.10, 0.03, 0.9, "fourier"),
        Tier("factory", 0.05, 0.10, 0.03, 0.9, "transfer"),
    )
}

#: What has to be reached: (clean, dirty, factory) for every score; see :mod:`jointwear.studies.challenge.scores`.
TARGETS = {
    "identifiable_share": (0.85, 0.70, 0.60),
    "name_first": (0.95, 0.95, 0.95),
    "axis": (0.97, 0.97, 0.97),
    "exact_set": (0.93, 0.93, 0.93),
    "false_names": (0.01, 0.01, 0.01),
    "retuned": (0.95, 0.90, 0.90),
    "unknown": (0.93, 0.93, 0.93),
    "two_found": (0.85, 0.85, 0.85),
    "two_exact": (0.75, 0.75, 0.75),
    "gap_median": (0.93, 0.93, 0.93),
    "gap_tenth": (0.75, 0.75, 0.75),
    "worse": (0.0, 0.0, 0.0),
    "not_worse": (0.99, 0.99, 0.99),
    "tie_holds": (0.97, 0.95, 0.95),
    "tie_size": (1.2, 1.3, 1.3),
    "coverage": ((0.90, 0.98), (0.90, 0.98), (0.90, 0.98)),
    "calibration_error": (0.05, 0.05, 0.05),
    "seconds": (2.0, 2.0, 2.0),
}
