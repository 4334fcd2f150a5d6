"""Which cases the tier has, under which seed each is drawn, and how they are dealt into batches."""

from __future__ import annotations

from dataclasses import dataclass

from jointwear.files.errors import InputError, nearest

#: Effects that are hidden one at a time; the identifiers of the library.
EFFECTS = (
    "actuation_delay",
    "cogging_torque",
    "drive_coupling",
    "joint_flexibility",
    "joint_spring",
    "load_dependent_friction",
    "mounting_tilt",
    "nonlinear_viscous_friction",
    "payload",
    "position_dependent_friction",
    "presliding_hysteresis",
    "stribeck_friction",
    "temperature_dependent_coulomb_friction",
    "temperature_dependent_viscous_friction",
    "torque_constant_error",
    "torque_constant_ripple",
    "torque_constant_temperature",
    "torque_offset_drift",
    "wear_drift",
)

#: Disturbances that no effect of the library describes.
OUTSIDE = ("push", "gusts", "wall", "bump", "dragging_brake", "two_joint_hose", "tremor", "neighbour_drag")

#: Parameters of the nominal model; a wrong one makes a case "retuned", not an effect.
MODEL_PARAMETERS = ("coulomb_friction", "viscous_friction", "motor_inertia", "link_inertia")

KINDS = ("single", "nothing", "retuned", "two", "outside")
SETS = ("choose", "report")

#: How often the cases of a set have been drawn; see :data:`jointwear.studies.challenge.tiers.DRAWINGS`.
DRAWINGS = {"choose": 1, "report": 47}

#: Cases of each kind.
COUNTS = {"single": 9 * len(EFFECTS), "nothing": 105, "retuned": 32, "two": 48, "outside": 64}

#: Cases of a batch.
BATCH = 15

#: The cases are part of the test: their seed does not follow the configuration.
SEED = 4000

_SUBJECTS = {"single": EFFECTS, "retuned": MODEL_PARAMETERS, "outside": OUTSIDE}


@dataclass(frozen=True)
class Case:
    """One case: seed set, kind and 0-based index within the kind; its random numbers depend on these alone."""

    set: str
    kind: str
    index: int

    @property
    def name(self) -> str:
        """Name of its files."""
        return f"world_{KINDS.index(self.kind)}{self.index:03d}"

    @property
    def key(self) -> tuple[str | int, ...]:
        """Words of the spawn key; the index is the replicate."""
        return ("world", self.set, DRAWINGS[self.set], self.kind)

    @property
    def subject(self) -> str | None:
        """What is hidden; None where chance decides or nothing is."""
        subjects = _SUBJECTS.get(self.kind)
        return subjects[self.index % len(subjects)] if subjects else None


def cases(seed_set: str) -> list[Case]:
    """Return all cases of a seed set, dealt so that every run of neighbours is a like mixture of kinds and subjects.

    Raises
    ------
    InputError : for a seed set that does not exist.
    """
    if seed_set not in SETS:
        raise InputError(
            f"challenge: there is no seed set '{seed_set}' (allowed: {', '.join(SETS)}){nearest(seed_set, SETS)}"
        )
    every = [
        ((index + 0.5) / COUNTS[kind], Case(seed_set, kind, index)) for kind in KINDS for index in range(COUNTS[kind])
    ]
    return [case for _, case in sorted(every, key=lambda pair: pair[0])]


def batches(seed_set: str) -> list[list[Case]]:
    """Return the cases of a seed set in runs of at most `BATCH`; the first ones are a fair sample of all."""
    every = cases(seed_set)
    return [every[k : k + BATCH] for k in range(0, len(every), BATCH)]


def part_batches(part: str) -> tuple[str, int]:
    """Return the seed set of a part and how many batches it holds: a seed set, or `<set>_first_<k>`."""
    seed_set, _, first = part.partition("_first_")
    count = -(-sum(COUNTS.values()) // BATCH)
    return seed_set, min(count, int(first)) if first else count
