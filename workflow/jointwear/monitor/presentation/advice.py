"""What to check on a robot when a quantity of an axis has changed: one line each."""

from __future__ import annotations

#: What to check where no friction explains what is told.
CONTRADICTED = (
    "friction alone does not explain it, as Coulomb friction is below normal and viscous friction far above: check the "
    "gear for play at reversals with the flange clamped, belt and coupling, then the load that it carries"
)
#: What to check first where all friction of an axis rose by one share at once.
SCALED = (
    "Coulomb and viscous friction rose at once by about the same share and have kept, as with another scale of the "
    "torque or an axis that is colder, and no wear: check the sensor, unit and torque constant of the drive and "
    "compare temperatures first, and enter it as 'sensor' if it was one; if neither, "
)
#: What to check first where Coulomb friction fell at once while viscous friction rose.
REPAIRED = (
    "was it serviced or greased? Coulomb friction fell at once after its alarm while viscous friction rose, as with "
    "new grease; enter that as a service; if not, "
)
#: What to check first where the error of the growth is as large as the limit.
UNSURE = (
    "its growth is hardly known yet: its standard error is as large as the limit, as under a load or in a program that "
    "the normal period hardly had; ask what changed there first, then "
)


def at_next_service(told: str) -> str:
    """Return the advice `told` for growth that is small and far from its limit."""
    return f"it is small and its limit far off: keep watching it, and at the next service {told}"


def advice(quantity: str, change: float | None, greased: str = "") -> str:
    """Return what to check when a quantity of an axis changed; `change` None counts as growth; `greased`: what viscous
    friction has of new grease rather than wear, a sentence."""
    grew = change is None or change > 0
    if "backlash" in quantity:
        return (
            "check the gear for play with the flange clamped, and belt and coupling"
            if grew
            else "play became smaller: a gear that was replaced or adjusted; tell it as an event of kind service"
        )
    if "viscous" in quantity and grew and greased:
        return (
            f"was it greased? {greased}, as with thicker grease; enter that as a service; if not, "
            f"{advice(quantity, change)}"
        )
    if "viscous" in quantity:
        return (
            "check level, age and kind of the lubricant; a cold drive shows the same: compare at equal temperature"
            if grew
            else "the drive runs warmer or was greased anew; if neither, check the lubricant for the right kind"
        )
    if "scale" in quantity:
        return "check the unit, torque constant and firmware of the drive; all torques of the axis changed by a factor"
    if "offset" in quantity or "asymmetr" in quantity:
        return "check the load at the flange, the balance of the axis and the zero of the torque or current sensor"
    return (
        "check the gear and bearings, the lubricant, belt tension, and whether a brake drags"
        if grew
        else "friction fell: running-in, new grease or a warmer drive; if none of these, check preload and belt tension"
    )
