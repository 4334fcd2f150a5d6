"""Names of what may be missing; without numpy, because the Snakefile lists them at every call."""

from __future__ import annotations

from itertools import combinations

NOTHING = "nothing"
# Name of a component: names of those that slow motion cannot tell from it.
NOT_TOLD_APART: dict[str, tuple[str, ...]] = {
    "payload": (),
    "torque_constant_error": (),
    "gravity_scale": ("mass_scale",),
    "mass_scale": ("gravity_scale",),
    "coulomb_scale": (),
    "viscous_scale": (),
    "motor_inertia_scale": (),
    "faster_segments": (),
}
# Hidden causes of the validation.
CAUSES = ("payload", "gravity_scale", "faster_segments", NOTHING)


def candidate_names() -> list[str]:
    """Return the names of all candidates: nothing, every component alone, every pair that is not alike."""
    pairs = [f"{a}+{b}" for a, b in combinations(NOT_TOLD_APART, 2) if b not in NOT_TOLD_APART[a]]
    return [NOTHING, *NOT_TOLD_APART, *pairs]
